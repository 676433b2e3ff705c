"""Pictures: the loop over bands of views, and the steps of each."""

from eyas.lanes import address_of, claim, kernel, parallel
from eyas.render.kernels.bundles import Geometry, Light, Movers, Output, Scratch, Task
from eyas.render.kernels.light.casters import cast_light
from eyas.render.kernels.light.view_light import view_light
from eyas.render.kernels.scalars import f4, i8
from eyas.render.kernels.sky.backdrop import draw_backdrop
from eyas.render.kernels.sky.flakes import let_flakes_fall
from eyas.render.kernels.surface.band import shade_band
from eyas.render.kernels.visibility.measure import measure_actors, measure_subject
from eyas.render.kernels.visibility.outputs import write_classes, write_depth, write_objects
from eyas.render.kernels.visibility.passes import draw_scene
from eyas.render.kernels.visibility.transform import view_of
from eyas.state.draw import DrawStage

__all__ = ["draw_views"]

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
    """Draw job `index` with a worker's memory."""
    job, until = task.job, task.until
    number, top, bottom = job.band[index, 0], job.band[index, 1], job.band[index, 2]
    world = i8(job.world[number])
    view = address_of(view_of(job, index, task.width, task.height, task.samples))
    key, shade = scratch.key[worker, : view.rows], scratch.shade[worker, : view.rows]
    drawn = scratch.drawn[worker]
    count = draw_scene(until, geometry, movers, world, view, scratch, worker, key)
    if len(output.depth) > 0:
        write_depth(key, output.depth[number, top:bottom])
    if len(output.object_id) > 0:
        write_objects(geometry, movers, world, drawn, key, output.object_id[number, top:bottom])
    if len(output.class_id) > 0:
        write_classes(geometry, movers, world, drawn, key, output.class_id[number, top:bottom])
    if len(output.subject) > 0 and until >= RASTERISING:
        measure_subject(
            geometry, movers, world, job.subject[number], view, scratch, worker, key, count,
            output.subject[index],
        )  # fmt: skip
    if len(output.actor) > 0 and until >= RASTERISING:
        measure_actors(
            geometry, movers, world, view, scratch, worker, key, count, output.actor[index]
        )
    if len(output.rgb) > 0 and until > RASTERISING:
        lamps_on = light.weather.air.lamps > f4(0.0)
        cast_light(geometry, movers, world, view, lamps_on, light.weather.sun, key, drawn, shade)
    if len(output.rgb) > 0 and until > MOVERS_LIGHT:
        lit = address_of(view_light(light.weather, job.light, number))
        pixels = output.rgb[number, top:bottom]
        draw_backdrop(view, light, lit, key, pixels)
        shade_band(view, geometry, light, lit, movers, world, drawn, key, shade, pixels)
        if len(job.instant) > 0 and lit.air.flakes > f4(0.0):
            let_flakes_fall(view, light, lit, job.instant[number], key, pixels)
