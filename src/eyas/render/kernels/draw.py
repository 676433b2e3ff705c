"""Pictures: the loop over bands of views, and the steps of each."""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import address_of, claim, kernel, parallel
from eyas.render.kernels.bundles import (
    Air,
    Band,
    Canvas,
    Direction,
    Geometry,
    Illumination,
    Light,
    Movers,
    Output,
    Scratch,
    Task,
    View,
)
from eyas.render.kernels.light.casters import cast_light
from eyas.render.kernels.light.sunlight import sunlit
from eyas.render.kernels.scalars import f4, i8
from eyas.render.kernels.sky.flakes import let_flakes_fall
from eyas.render.kernels.sky.radiance import draw_backdrop
from eyas.render.kernels.surface.band import shade_band
from eyas.render.kernels.surface.normals import write_normals
from eyas.render.kernels.visibility.measure import measure_actors, measure_subject
from eyas.render.kernels.visibility.outputs import write_classes, write_depth, write_objects
from eyas.render.kernels.visibility.passes import draw_scene
from eyas.render.kernels.visibility.transform import view_of
from eyas.state.draw import DrawStage
from eyas.state.lighting import LightState

__all__ = ["band_of", "draw_views", "view_light", "with_veil"]

RASTERISING = int(DrawStage.RASTERISING)
MOVERS_LIGHT = int(DrawStage.MOVERS_LIGHT)


@parallel
def draw_views(
    worker: int,
    workers: int,
    geometry: Geometry,
    light: Light,
    scratch: Scratch,
    movers: Movers,
    output: Output,
    task: Task,
) -> None:
    """Draw all jobs. Each is drawn alone, so neither workers nor other jobs change its bytes."""
    job = task.job
    index = i8(worker)
    while index < len(job.band):
        _draw_band(index, geometry, light, scratch, movers, output, task, worker)
        index = claim(job.begun)


@kernel
def _draw_band(
    index: int,
    geometry: Geometry,
    light: Light,
    scratch: Scratch,
    movers: Movers,
    output: Output,
    task: Task,
    worker: int,
) -> None:
    """Draw job `index` with a worker's memory, and write what is wanted of it."""
    job, until = task.job, task.until
    number, top, bottom = job.band[index, 0], job.band[index, 1], job.band[index, 2]
    view = address_of(view_of(job, index, task.width, task.height, task.samples))
    here = view_light(light.weather, job.light, number)
    if light.weather.air.glare > f4(0.0):
        here = with_veil(light, here, job.eye[number])
    lit = address_of(here)
    world = i8(job.world[number])
    band = address_of(band_of(geometry, light, lit, movers, world, view, until, scratch, worker))
    count = draw_scene(band)
    into = job.picture[number]
    if len(output.depth) > 0:
        write_depth(band.key, output.depth[into, top:bottom])
    if len(output.object_id) > 0:
        write_objects(band, output.object_id[into, top:bottom])
    if len(output.class_id) > 0:
        write_classes(band, output.class_id[into, top:bottom])
    if len(output.normal) > 0 and until >= RASTERISING:
        write_normals(band, output.normal[into, top:bottom])
    if len(output.subject) > 0 and until >= RASTERISING:
        measure_subject(band, job.subject[number], count, output.subject[index])
    if len(output.actor) > 0 and until >= RASTERISING:
        measure_actors(band, count, output.actor[index])
    coloured = len(output.rgb) > 0 or len(output.radiance) > 0
    if coloured and until > RASTERISING:
        cast_light(band)
    if coloured and until > MOVERS_LIGHT:
        canvas = address_of(canvas_of(output, into, top, bottom))
        draw_backdrop(band, canvas)
        shade_band(band, canvas)
        if len(job.instant) > 0:
            let_flakes_fall(band, job.instant[number], canvas)


@kernel(inline=True)
def canvas_of(output: Output, picture: int, top: int, bottom: int) -> Canvas:
    """Return where the colours of some rows of a picture are written."""
    return Canvas(
        output.rgb[picture, top:bottom],
        output.radiance[picture, 0, top:bottom],
        output.radiance[picture, 1, top:bottom],
        output.radiance[picture, 2, top:bottom],
    )


@kernel(inline=True)
def band_of(
    geometry: Geometry,
    light: Light,
    lit: Illumination,
    movers: Movers,
    world: int,
    view: View,
    until: int,
    scratch: Scratch,
    worker: int,
) -> Band:
    """Return a band of a view with a worker's rows of the working memory."""
    rows = view.rows
    return Band(
        geometry, light, lit, movers, world, view, until, scratch.key[worker, :rows],
        scratch.alone[worker, :rows], scratch.shade[worker, :rows], scratch.drawn[worker],
        scratch.mesh[worker], scratch.tiles[worker], scratch.order[worker],
        scratch.triangle[worker], scratch.polygon[worker], scratch.span[worker],
    )  # fmt: skip


@kernel(inline=True)
def with_veil(light: Light, lit: Illumination, eye: NDArray[np.float64]) -> Illumination:
    """Return light and air of a view with as much veil as sun reaches its lens."""
    x, y, z = f4(eye[0]), f4(eye[1]), f4(eye[2])
    air = lit.air
    return Illumination(
        lit.sun, lit.sun_colour, lit.zenith, lit.horizon, lit.above, lit.below, lit.fog,
        lit.fog_density,
        Air(
            air.power, air.exposure, air.offset, air.snow, air.lamps, air.windows, air.clouds,
            air.flakes, air.rain, air.leaves, air.wet, air.litter, air.mist, air.per_mist_depth,
            air.glare, sunlit(light, x, y, z), air.daytime_lamps, air.stars, air.star_cosine,
            air.star_sine, air.moon_lit, air.limb_x, air.limb_y, air.limb_z, air.longest_shadow,
        ),
    )  # fmt: skip


@kernel(inline=True)
def _scaled(share: float, colour: Direction) -> Direction:
    return Direction(share * colour.x, share * colour.y, share * colour.z)


@kernel(inline=True)
def view_light(weather: Illumination, changes: LightState, view: int) -> Illumination:
    """Return the light of a view: the weather's, with what differs in the view.

    The air's colour is scattered light of the sky; light reflected by the ground comes from both
    sky and sun.
    """
    sky, sun = changes.sky[view], changes.sun[view]
    return Illumination(
        weather.sun,
        _scaled(sun, weather.sun_colour),
        _scaled(sky, weather.zenith),
        _scaled(sky, weather.horizon),
        _scaled(sky, weather.above),
        _scaled(f4(0.5) * (sky + sun), weather.below),
        _scaled(sky, weather.fog),
        changes.fog_density[view],
        weather.air,
    )
