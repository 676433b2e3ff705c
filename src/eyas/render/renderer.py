"""The renderer: pictures, depths, object ids and subject measurements of many views at once."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import ConfigError
from eyas.core.jit import interpreted, thread_count
from eyas.core.lanes import WIDTH
from eyas.core.parallel import Held
from eyas.render.bake.ambient import bake_ambient
from eyas.render.bake.shadows import bake_shadows
from eyas.render.bake.tracks import TrackMap, track_map
from eyas.render.classes import class_table, write_classes
from eyas.render.jobs import build_jobs, picture_size, write_measured
from eyas.render.kernels.bundles import Geometry, Light, Movers, Output, Scratch, Task
from eyas.render.kernels.draw import draw_views
from eyas.render.kernels.light.casters import influence
from eyas.render.kernels.visibility.clusters import CLUSTER
from eyas.render.kernels.visibility.fill import SPAN_ROWS
from eyas.render.kernels.visibility.hidden import TILE
from eyas.render.kernels.visibility.key import MOST_INSTANCES
from eyas.render.kernels.visibility.triangles import TRIANGLE_ROWS
from eyas.render.pack.light import build_light
from eyas.state.draw import DrawList, DrawStage, Picture, Views
from eyas.state.lighting import Lighting
from eyas.state.scene import Scene

__all__ = ["Renderer", "build_renderer"]


class Renderer:
    """Draws a scene and the things that move in it.

    A picture depends on nothing but its view: other views, their order, the number of threads
    and the division into bands do not change a byte.

    Args:
        geometry: Everything that can be drawn.
        light: Light and air.
        classes: Class of each object of the scene, see `class_table`.
        ready: Called before anything is drawn; returns when the kernels are compiled.
    """

    def __init__(
        self,
        geometry: Geometry,
        light: Light,
        classes: NDArray[np.uint8],
        ready: Callable[[], object] | None = None,
    ) -> None:
        self._geometry, self._light = geometry, light
        self._classes, self._ready = classes, ready
        self._held = Held(geometry), Held(light)
        self._last = Held(_NO_MOVERS), Held(_NOTHING)
        self._scratch: dict[tuple[int, ...], Held[Scratch]] = {}

    @property
    def textures(self) -> NDArray[np.uint32]:
        """All textures with their mip levels, see `Geometry.texture`."""
        return self._geometry.texture

    def part_reach(self) -> NDArray[np.float64]:
        """Return how far the corners of each part of the library are from its origin [m]."""
        box = self._geometry.box[self._geometry.part_first :].astype(np.float64)
        far = np.maximum(-box[:, :3], box[:, 3:])
        reach: NDArray[np.float64] = np.sqrt((far * far).sum(axis=1))
        return reach

    def influence(self, reach: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distance up to which things, their shadows and lamps may show [m].

        Args:
            reach: How far the corners of their parts may be from any point of them [m].
        """
        sun, lamps_on = self._light.weather.sun, bool(self._light.weather.air.lamps > 0.0)
        return np.array([_influence(one, sun, lamps_on) for one in reach.tolist()])

    def draw(
        self,
        views: Views,
        draw_list: DrawList,
        picture: Picture,
        samples: int = 1,
        until: DrawStage = DrawStage.SHADING,
    ) -> None:
        """Draw views into the arrays of a picture that are not None.

        Args:
            views: V cameras.
            draw_list: The moving things.
            picture: Written in place.
            samples: Colour samples per pixel, 1 or 4. Depth, objects and the subject's
                measurements are always those at the pixels' centres.
            until: Last stage to run, to measure the cost of each stage.

        Raises:
            ConfigError: `samples` is neither 1 nor 4.
        """
        if samples not in (1, 4):
            raise ConfigError(f"camera.samples: {samples} is not allowed; allowed: 1, 4")
        if self._ready is not None:
            self._ready()
        movers = Movers(draw_list.part, draw_list.pose, draw_list.colour, draw_list.object_id)
        output = _output(picture)
        if samples == 4 and picture.rgb is not None:
            colours = _NOTHING._replace(rgb=output.rgb)
            self._draw(views, movers, colours, picture, 2, until)
            output = output._replace(rgb=_NOTHING.rgb)
        if any(len(array) for array in output):
            self._draw(views, movers, output, picture, 1, until)
        if picture.class_id is not None:
            write_classes(self._classes, draw_list, views.world, output.object_id, picture.class_id)

    def _draw(
        self,
        views: Views,
        movers: Movers,
        output: Output,
        picture: Picture,
        side: int,
        until: DrawStage,
    ) -> None:
        """Draw with `side` x `side` samples per pixel."""
        height, width = picture_size(picture)
        threads = thread_count()
        density = float(self._light.weather.air.density)
        job = build_jobs(views, height, width, threads, density)
        rows = int((job.band[:, 2] - job.band[:, 1]).max(initial=0))
        workers = int(job.begun[0])
        jobs = len(job.band)
        output = output._replace(
            subject=np.zeros((jobs if len(output.subject) else 0, 6), np.int32),
            actor=np.zeros((jobs if len(output.actor) else 0, *output.actor.shape[1:]), np.int32),
        )
        wanted = len(output.subject) + len(output.actor) > 0
        scratch = self._scratch_for(workers, rows, width, side, movers.part.shape[1], wanted)
        # Mostly the same arrays as in the last call.
        held = self._last[0].again(movers), self._last[1].again(output)
        self._last = held
        task = Held(Task(side, width, height, int(until), job))
        draw_views(workers, *self._held, scratch, *held, task)
        if wanted:
            write_measured(job, output, picture)

    def _scratch_for(
        self, workers: int, rows: int, width: int, side: int, slots: int, measured: bool
    ) -> Held[Scratch]:
        """Return working memory, the same as last time for the same size."""
        key = (workers, rows, width, side, slots, measured)
        if key not in self._scratch:
            if len(self._scratch) >= 4:  # sizes seldom change; forget the oldest
                del self._scratch[next(iter(self._scratch))]
            plane = (workers, rows * side, (width + -width % WIDTH) * side)
            chunks, fixtures = len(self._geometry.chunk_range), len(self._geometry.fixture_object)
            # What is measured alone takes rows after those of the whole picture.
            instances = min(fixtures + slots * (2 if measured else 1), MOST_INSTANCES)
            scratch = Scratch(
                key=np.zeros(plane, np.int64),
                alone=np.zeros(plane if measured else (workers, 0, 0), np.int64),
                shade=np.empty((*plane, 4), np.uint8),
                drawn=np.empty((workers, instances, 2), np.int32),
                mesh=np.empty((workers, instances), np.int32),
                tiles=np.empty((workers, -(-plane[1] // TILE), plane[2] // TILE), np.float32),
                order=np.empty((workers, chunks + instances), np.int64),
                triangle=np.empty((workers, TRIANGLE_ROWS, CLUSTER)),
                polygon=np.zeros((workers, 15, CLUSTER)),
                span=np.empty((workers, SPAN_ROWS, WIDTH), np.int32),
            )
            self._scratch[key] = Held(scratch)
        return self._scratch[key]


def build_renderer(
    scene: Scene,
    geometry: Geometry,
    lighting: Lighting,
    *,
    cache: Path | None = None,
    ready: Callable[[], object] | None = None,
) -> Renderer:
    """Return a renderer of a scene, its shadows baked.

    Args:
        scene: The static scene.
        geometry: The scene and the moving things, see `build_geometry`.
        lighting: Light and air.
        cache: Folder of the cache; None: the user's.
        ready: See `Renderer`.
    """
    shadows = bake_shadows(geometry, lighting.sun_direction, scene.terrain.floor, cache)
    tracks = track_map(scene) if lighting.snow > 0 else TrackMap.none()
    ambient = bake_ambient(scene, cache)
    light = build_light(scene, lighting, shadows, ambient, tracks, geometry)
    return Renderer(geometry, light, class_table(scene), ready)


_influence = interpreted(influence)

_NO_MOVERS = Movers(
    part=np.empty((0, 0), np.int32),
    pose=np.empty((0, 0, 3, 4), np.float32),
    colour=np.empty((0, 0, 3), np.float32),
    object_id=np.empty((0, 0), np.int32),
)

_NOTHING = Output(
    rgb=np.empty((0, 0, 0, 3), np.uint8),
    depth=np.empty((0, 0, 0), np.float32),
    object_id=np.empty((0, 0, 0), np.int32),
    subject=np.empty((0, 6), np.int32),
    actor=np.empty((0, 0, 6), np.int32),
)


def _objects(picture: Picture) -> NDArray[np.int32]:
    """Return the array for object ids; classes need them even if they are not wanted."""
    if picture.object_id is not None:
        return picture.object_id
    if picture.class_id is not None:
        return np.empty(picture.class_id.shape, np.int32)
    return _NOTHING.object_id


def _output(picture: Picture) -> Output:
    """Return the wanted arrays; those of measurements are only flags, jobs get their own.

    If all actors are measured, the subjects are among them.
    """
    actors = picture.actor_box if picture.actor_pixels is None else picture.actor_pixels
    subject = picture.subject_box is not None or picture.subject_pixels is not None
    return Output(
        rgb=_NOTHING.rgb if picture.rgb is None else picture.rgb,
        depth=_NOTHING.depth if picture.depth is None else picture.depth,
        object_id=_objects(picture),
        subject=np.zeros((1 if subject and actors is None else 0, 6), np.int32),
        actor=_NOTHING.actor if actors is None else np.zeros((1, actors.shape[1], 6), np.int32),
    )
