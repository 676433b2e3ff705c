"""Pictures: the loop over bands of views, and the steps of each."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.optics.lens import Lens
from eyas.engine.render.kernels.bundles import (
    Air,
    Band,
    Canvas,
    Direction,
    Geometry,
    Glass,
    Illumination,
    Job,
    LensTables,
    Light,
    Movers,
    Output,
    Scratch,
    Task,
    View,
)
from eyas.engine.render.kernels.lens.outputs import darken, write_bent_depth
from eyas.engine.render.kernels.lens.resampling import (
    face_rows,
    face_view,
    glass_of,
    look_through,
    shown_rows,
)
from eyas.engine.render.kernels.light.casters import cast_light
from eyas.engine.render.kernels.light.sunlight import sunlit
from eyas.engine.render.kernels.scalars import f4, i8
from eyas.engine.render.kernels.sky.flakes import let_flakes_fall
from eyas.engine.render.kernels.sky.halos import draw_halos
from eyas.engine.render.kernels.sky.plumes import draw_plumes
from eyas.engine.render.kernels.sky.radiance import draw_backdrop
from eyas.engine.render.kernels.surface.band import shade_band
from eyas.engine.render.kernels.surface.normals import write_normals
from eyas.engine.render.kernels.tent import filter_rows
from eyas.engine.render.kernels.visibility.measure import measure_actors, measure_subject
from eyas.engine.render.kernels.visibility.outputs import write_classes, write_depth, write_objects
from eyas.engine.render.kernels.visibility.passes import draw_scene
from eyas.engine.render.kernels.visibility.transform import view_of
from eyas.engine.render.kernels.wind import in_wind
from eyas.engine.state.draw import DrawStage
from eyas.engine.state.lighting import LightState
from eyas.lanes import address_of, claim, kernel, parallel

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
    tables: LensTables,
) -> None:
    """Draw all jobs. Each is drawn alone, so neither workers nor other jobs change its bytes."""
    job = task.job
    index = i8(worker)
    while index < len(job.band):
        if len(job.lens) > 0:
            _draw_through_lens(
                index, geometry, light, scratch, movers, output, task, tables, worker
            )
        else:
            _draw_band(index, geometry, light, scratch, movers, output, task, worker)
        if task.tent == 1:
            pixels = output.rgb[job.picture[job.band[index, 0]]]
            line, total = scratch.line[worker], scratch.total[worker]
            filter_rows(pixels, pixels, line, total, 0, task.height)
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
    number = job.band[index, 0]
    view = address_of(view_of(task, index))
    lit = address_of(light_at(light, job, number))
    world = i8(job.world[number])
    glass = address_of(no_glass(scratch, worker))
    band = address_of(
        band_of(geometry, light, lit, movers, world, view, glass, until, scratch, worker, 0, 1)
    )
    band.key[:] = 0
    count = draw_scene(band)
    write_facts(band, band, count, output, task, index)
    if until > RASTERISING and _coloured(output):
        cast_light(band)
    write_colours(band, output, task, index)


@kernel
def _draw_through_lens(
    index: int,
    geometry: Geometry,
    light: Light,
    scratch: Scratch,
    movers: Movers,
    output: Output,
    task: Task,
    tables: LensTables,
    worker: int,
) -> None:
    """Draw job `index` face by face; each writes the pixels that show it."""
    job, until = task.job, task.until
    number, top, bottom = job.band[index, 0], job.band[index, 1], job.band[index, 2]
    slot = job.lens[number]
    lit = address_of(light_at(light, job, number))
    world, coloured = i8(job.world[number]), until > RASTERISING and _coloured(output)
    if tables.dark[slot] == 1:
        darken(task, tables, output, index)
    for face in range(tables.faces[slot]):
        # Only the rows of the picture that show the face: they are half of all, for five faces.
        begin, end = shown_rows(tables, slot, face, top, bottom)
        first, last = face_rows(tables, slot, face, begin, end)
        if first >= last:
            continue
        view = address_of(face_view(task, tables, number, face, first, last))
        plain = address_of(no_glass(scratch, worker))
        band = address_of(
            band_of(geometry, light, lit, movers, world, view, plain, until, scratch, worker, 0, 1)
        )
        band.key[:] = 0
        count = draw_scene(band)
        if coloured:
            cast_light(band)
        glass = address_of(glass_of(task, tables, number, face, begin))
        bent = address_of(bent_band(band, glass, scratch, worker, task.width, end - begin))
        look_through(band, scratch.word[worker], bent, coloured)
        write_facts(band, bent, count, output, task, index)
        write_colours(bent, output, task, index)


@kernel(inline=True)
def light_at(light: Light, job: Job, number: int) -> Illumination:
    """Return light and air of a view, where it is."""
    here = view_light(light.weather, job.light, number)
    if light.weather.air.windy > f4(0.0) and len(job.instant) > 0:
        wind_x, wind_y = job.light.wind_x[number], job.light.wind_y[number]
        here = in_wind(here, wind_x, wind_y, job.instant[number])
    if light.weather.air.glare > f4(0.0):
        here = with_veil(light, here, job.eye[number])
    return here


@kernel(inline=True)
def _coloured(output: Output) -> bool:
    """Return whether colours are wanted."""
    return len(output.rgb) > 0 or len(output.radiance) > 0


@kernel(inline=True)
def _rows_of(shown: Band) -> tuple[int, int]:
    """Return the first row of pixels of the picture that a band shows, and the one after the last:
    through a lens, those of a face.
    """
    top = i8(shown.camera.top // shown.camera.down)
    if shown.glass.on == 1:
        top = i8(shown.glass.top)
    return top, top + shown.lines


@kernel(inline=True)
def write_facts(
    band: Band,  # What was drawn, with `count` rows of `Band.drawn`
    shown: Band,  # What the picture shows: the same, or the picture of which it is a face
    count: int,
    output: Output,  # Where to
    task: Task,  # The views
    index: int,  # The job
) -> None:
    """Write what is wanted of job `index` but colours."""
    job, until, (top, bottom) = task.job, task.until, _rows_of(shown)
    number = job.band[index, 0]
    into = job.picture[number]
    if len(output.depth) > 0:
        if shown.glass.on == 1:
            write_bent_depth(shown, output.depth[into, top:bottom])
        else:
            write_depth(shown.key, output.depth[into, top:bottom], band.member, band.members)
    if len(output.object_id) > 0:
        write_objects(shown, output.object_id[into, top:bottom])
    if len(output.class_id) > 0:
        write_classes(shown, output.class_id[into, top:bottom])
    if len(output.normal) > 0 and until >= RASTERISING:
        write_normals(shown, output.normal[into, top:bottom])
    if len(output.subject) > 0 and until >= RASTERISING:
        measure_subject(band, shown, job.subject[number], count, output.subject[index])
    if len(output.actor) > 0 and until >= RASTERISING:
        measure_actors(band, shown, count, output.actor[index])


@kernel(inline=True)
def write_colours(shown: Band, output: Output, task: Task, index: int) -> None:
    """Write the colours of job `index`, if they are wanted."""
    job, (top, bottom) = task.job, _rows_of(shown)
    if not _coloured(output) or task.until <= MOVERS_LIGHT:
        return
    number = job.band[index, 0]
    canvas = address_of(canvas_of(output, job.picture[number], top, bottom))
    draw_backdrop(shown, canvas)
    shade_band(shown, canvas)
    air, none = shown.lit.air, f4(0.0)
    if air.lamps > none or (air.wet > none and air.daytime_lamps > none):
        draw_halos(shown, canvas)
    if len(job.instant) > 0:
        draw_plumes(shown, job.instant[number], canvas)
    if task.falls == 1:
        let_flakes_fall(shown, job.instant[number], canvas)


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
    glass: Glass,
    until: int,
    scratch: Scratch,
    row: int,
    member: int,
    members: int,
) -> Band:
    """Return a band of a view with a row of the working memory.

    What it points to, `lit`, `view` and `glass`, lies on the stack of the caller: what a kernel
    that is inlined puts there is gone when it returns.
    """
    rows = view.rows
    return Band(
        geometry, light, lit, movers, world, view, until, view.width // view.across,
        rows // view.down,
        glass, scratch.key[row, :rows],
        scratch.alone[row, :rows], scratch.shade[row, :rows], scratch.drawn[row],
        scratch.mesh[row], scratch.tiles[row], scratch.order[row],
        scratch.triangle[row * members + member], scratch.polygon[row * members + member],
        scratch.span[row * members + member], scratch.leaning[row], scratch.item[row],
        scratch.item_row[row], scratch.seen[row], scratch.found[row], scratch.record[row],
        scratch.record_shown[row], scratch.unit[row], scratch.recorded[row], i8(member),
        i8(members),
    )  # fmt: skip


@kernel(inline=True)
def no_glass(scratch: Scratch, worker: int) -> Glass:
    """Return what stands for a lens where there is none: arrays of the same kinds."""
    floats, whole = scratch.tiles[worker], scratch.drawn[worker]
    zero, none = 0.0, i8(0)
    lens = Lens(none, zero, zero, zero, zero, zero, zero, zero, zero, zero)
    return Glass(
        none, floats, floats, floats, whole, none, scratch.bent_tile, scratch.triangle[worker],
        none, lens, zero, zero, zero, zero,
    )  # fmt: skip


@kernel(inline=True)
def bent_band(
    face: Band,  # The face, whose places are those of the camera
    glass: Glass,  # The lens
    scratch: Scratch,  # The working memory
    worker: int,  # Whose
    columns: int,  # Width of the picture [pixels]
    lines: int,  # Rows of the band [pixels]
) -> Band:
    """Return a band of a picture through a lens, of one of its faces."""
    rows = lines * face.camera.down
    return Band(
        face.geometry, face.light, face.lit, face.movers, face.world, face.camera, face.until,
        i8(columns), i8(lines), glass, scratch.bent_key[worker, :rows], face.alone,
        scratch.bent_shade[worker, :rows], face.drawn, face.mesh, face.tiles, face.order,
        face.triangle, face.polygon, face.span, face.leaning, face.item,
        face.item_row, face.seen, face.found, face.record, face.record_shown,
        face.unit, face.recorded, face.member, face.members,
    )  # fmt: skip


@kernel(inline=True)
def with_veil(light: Light, lit: Illumination, eye: NDArray[np.float64]) -> Illumination:
    """Return light and air of a view with as much veil as sun reaches its lens."""
    x, y, z = f4(eye[0]), f4(eye[1]), f4(eye[2])
    air = lit.air
    return Illumination(
        lit.sun, lit.sun_colour, lit.zenith, lit.horizon, lit.above, lit.below, lit.tinge,
        lit.fog, lit.fog_density,
        Air(
            air.power, air.exposure, air.offset, air.snow, air.lamps, air.windows, air.clouds,
            air.flakes, air.rain, air.leaves, air.wet, air.litter, air.mist, air.per_mist_depth,
            air.glare, sunlit(light, x, y, z), air.daytime_lamps, air.stars, air.star_cosine,
            air.star_sine, air.moon_lit, air.limb_x, air.limb_y, air.limb_z, air.longest_shadow,
            air.windy, air.spray, air.banks,
        ),
        lit.wind,
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
        _scaled(f4(0.5) * (sky + sun), weather.tinge),
        _scaled(sky, weather.fog),
        changes.fog_density[view],
        weather.air,
        weather.wind,
    )
