"""The renderer: pictures, depths, object ids and subject measurements of many views at once."""

from collections.abc import Callable, Hashable
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.bounds import FARTHEST, checked
from eyas.engine.core.errors import ConfigError
from eyas.engine.render.bake.ambient import bake_ambient
from eyas.engine.render.bake.land import land_map, no_land
from eyas.engine.render.bake.shadows import bake_shadows
from eyas.engine.render.bake.sway import with_room
from eyas.engine.render.bake.tracks import TrackMap, kept_track_map
from eyas.engine.render.jobs import Size, new_task, set_views
from eyas.engine.render.kernels.bundles import Geometry, Light, Movers, Output, Scratch, Task
from eyas.engine.render.kernels.draw import draw_views
from eyas.engine.render.kernels.light.casters import influence
from eyas.engine.render.kernels.tent import filter_pixels, memory
from eyas.engine.render.kernels.visibility.clusters import CLUSTER
from eyas.engine.render.kernels.visibility.fill import SPAN_ROWS
from eyas.engine.render.kernels.visibility.items import ITEM_COLUMNS
from eyas.engine.render.kernels.visibility.key import MOST_INSTANCES
from eyas.engine.render.kernels.visibility.occlusion import TILE
from eyas.engine.render.kernels.visibility.triangles import TRIANGLE_ROWS
from eyas.engine.render.lenses import NO_TABLES, LensBank
from eyas.engine.render.outputs import (
    NO_OUTPUT,
    measured_alone,
    picture_size,
    wanted_output,
    write_measured,
)
from eyas.engine.render.pack.light import Baked, build_light
from eyas.engine.state.draw import NO_SPRAY, DrawList, DrawStage, Picture, Views
from eyas.engine.state.lighting import Lighting
from eyas.engine.state.scene import Scene
from eyas.lanes import PackedBundle, interpreted, thread_count
from eyas.lanes.vector import WIDTH


class CpuRenderer:
    """Draws a scene and the things that move in it, in bands, with all threads; see `Renderer`.

    What it draws is packed when it is first needed: simulations without pictures never need it.
    """

    def __init__(
        self,
        pack: Callable[[], tuple[Geometry, Light]],  # Returns `packed`, the same at each call
    ) -> None:
        self._pack = pack
        self._last = PackedBundle(_NO_MOVERS), PackedBundle(NO_OUTPUT), PackedBundle(NO_TABLES)
        self._scratch: dict[tuple[object, ...], PackedBundle[Scratch]] = {}
        self._banks: dict[tuple[int, int, int, int], LensBank] = {}
        self._tasks: dict[Size, PackedBundle[Task]] = {}

    @cached_property
    def packed(self) -> tuple[Geometry, Light]:
        """Everything that can be drawn, and light and air, as kernels read them."""
        return self._pack()

    @cached_property
    def _held(self) -> tuple[PackedBundle[Geometry], PackedBundle[Light]]:
        geometry, light = self.packed
        return PackedBundle(geometry), PackedBundle(light)

    def part_reach(self) -> NDArray[np.float64]:
        """Return how far the corners of each part of the library are from its origin [m]."""
        geometry, _ = self.packed
        box = geometry.box[geometry.part_first :].astype(np.float64)
        far = np.maximum(-box[:, :3], box[:, 3:])
        reach: NDArray[np.float64] = np.sqrt((far * far).sum(axis=1))
        return reach

    def influence(self, reach: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distance up to which things may show [m], see `Renderer`."""
        _, light = self.packed
        sun, air = light.weather.sun, light.weather.air
        longest, lamps_on = float(air.longest_shadow), bool(air.lamps > 0.0)
        return np.array([_influence(one, sun, longest, lamps_on) for one in reach.tolist()])

    def draw(
        self,
        views: Views,
        draw_list: DrawList,
        picture: Picture,
        samples: int = 1,
        until: DrawStage = DrawStage.SHADING,
    ) -> None:
        """Draw views into the arrays of a picture that are not None, see `Renderer`."""
        if samples not in GRIDS:
            raise ConfigError(f"camera.samples: {samples} is not allowed; allowed: 1, 2, 4")
        position = checked(views.position, FARTHEST, "position of a camera")
        rotation = checked(views.rotation, 1e3, "rotation of a camera")
        if position is not views.position or rotation is not views.rotation:
            views = replace(views, position=position, rotation=rotation)
        movers = Movers(*(getattr(draw_list, name) for name in Movers._fields))
        output = wanted_output(picture)
        grid, several = GRIDS[samples], samples > 1
        if len(output.radiance) and (several or len(output.rgb)):
            colours = NO_OUTPUT._replace(radiance=output.radiance)
            self._draw(views, movers, colours, picture, grid, until)
            output = output._replace(radiance=NO_OUTPUT.radiance)
        if len(output.rgb) and several:
            colours = NO_OUTPUT._replace(rgb=output.rgb)
            self._draw(views, movers, colours, picture, grid, until)
            output = output._replace(rgb=NO_OUTPUT.rgb)
        if any(len(array) for array in output):
            self._draw(views, movers, output, picture, GRIDS[1], until)

    def _draw(
        self,
        views: Views,
        movers: Movers,
        output: Output,
        picture: Picture,
        grid: tuple[int, int],
        until: DrawStage,
    ) -> None:
        """Draw with some samples along a row and along a column of each pixel."""
        height, width = picture_size(picture)
        timed, threads = views.instant is not None, thread_count()
        falls = timed and views.falling
        parts = views.rows is not None
        coloured = until == DrawStage.SHADING and len(output.rgb) > 0
        tent = coloured and views.filters(grid[0] * grid[1])
        bent = views.lens is not None
        size = Size(
            len(views.position), height, width, *grid, int(until), falls, parts, threads,
            bent, timed, tent,
        )  # fmt: skip
        # Taken away while it is in use, so that another thread that draws gets another one.
        task = self._tasks.pop(size, None) or PackedBundle(new_task(size))
        band = task.bundle.job.band
        jobs, workers = len(band), min(threads, len(band))
        set_views(task.bundle, views, float(self.packed[1].weather.fog_density), workers)
        bank = self._banks.pop((height, width, *grid), None) if bent else None
        if views.lens is not None:
            bank = bank or LensBank(height, width, *grid)
            task.bundle.job.lens[:] = bank.slots(views.lens, task.bundle.job.focal)
        wanted = len(output.subject) + len(output.actor) > 0
        if wanted:
            output = measured_alone(output, jobs)
        rows = height if jobs == size.views else int((band[:, 2] - band[:, 1]).max(initial=0))
        face = None if bank is None else bank.size
        slots = movers.part.shape[1]
        scratch = self._scratch_for(workers, rows, size, slots, wanted, face)
        # Mostly the same arrays as in the last call.
        tables = NO_TABLES if bank is None else bank.tables
        last = self._last
        held = last[0].again(movers), last[1].again(output), last[2].again(tables)
        self._last = held
        draw_views(workers, *self._held, scratch, *held[:2], task, held[2])
        if tent and not task.bundle.tent:
            filter_pixels(output.rgb)
        if wanted:
            write_measured(task.bundle.job, output, picture)
        _keep(self._tasks, size, task)
        if bank is not None:
            _keep(self._banks, (height, width, *grid), bank)

    def _scratch_for(
        self,
        workers: int,
        rows: int,
        size: Size,
        slots: int,
        measured: bool,
        face: tuple[int, int] | None,
    ) -> PackedBundle[Scratch]:
        """Return working memory, the same as last time for the same size.

        `face` is the largest width and height of a lens' faces [pixels], None without lenses.
        """
        width, grid = size.width, (size.across, size.down)
        key = (workers, rows, width, grid, slots, measured, face)
        if key not in self._scratch:
            geometry, light = self.packed
            bent = (workers, 0, 0) if face is None else _plane(workers, rows, width, grid)
            plane = _plane(workers, rows, width, grid)
            if face is not None:
                plane = _plane(workers, face[1], face[0], grid)
            shade = np.empty((*plane, 4), np.uint8)
            chunks, fixtures = len(geometry.chunk_range), len(geometry.fixture_object)
            # What is measured alone takes rows after those of the whole picture.
            instances = min(fixtures + slots * (2 if measured else 1), MOST_INSTANCES)
            swaying = instances if len(light.sway) else 0
            line, total = memory(workers, width)
            scratch = Scratch(
                key=np.zeros(plane, np.int64),
                alone=np.zeros(plane if measured else (workers, 0, 0), np.int64),
                shade=shade,
                drawn=np.empty((workers, instances, 2), np.int32),
                mesh=np.empty((workers, instances), np.int32),
                tiles=np.empty((workers, -(-plane[1] // TILE), plane[2] // TILE), np.float32),
                order=np.empty((workers, chunks + instances), np.int64),
                triangle=np.empty((workers, TRIANGLE_ROWS, CLUSTER)),
                polygon=np.zeros((workers, 15, CLUSTER)),
                span=np.empty((workers, SPAN_ROWS, WIDTH), np.int32),
                word=shade.view(np.uint32)[..., 0],
                bent_key=np.zeros(bent, np.int64),
                bent_shade=np.zeros((*bent, 4), np.uint8),
                leaning=np.empty((workers, swaying, 3, 4), np.float32),
                item=np.empty((workers, 0, ITEM_COLUMNS)),
                item_row=np.empty((workers, 0), np.int64),
                seen=np.empty((workers, 0), np.int64),
                found=np.empty((workers, 0), np.int64),
                record=np.empty((workers, 0, TRIANGLE_ROWS, CLUSTER)),
                record_shown=np.empty((workers, 0, 2), np.int64),
                unit=np.empty((workers, 0), np.int32),
                recorded=np.empty((workers, 0), np.int64),
                line=line,
                total=total,
                bent_tile=np.zeros((0, 0, 4), np.int32),
            )
            _keep(self._scratch, key, PackedBundle(scratch))
        return self._scratch[key]


def build_renderer(
    scene: Scene,  # The static scene
    geometry: Geometry,  # The scene and the moving things, see `build_geometry`
    lighting: Lighting,  # Light and air
    *,
    cache: Path | None = None,  # Folder of the cache; None: the user's
) -> CpuRenderer:
    """Return a renderer of a scene."""
    return CpuRenderer(partial(pack_scene, scene, geometry, lighting, cache=cache))


def pack_scene(
    scene: Scene, geometry: Geometry, lighting: Lighting, *, cache: Path | None = None
) -> tuple[Geometry, Light]:
    """Return what a renderer draws, shadows baked; the arguments are those of `build_renderer`."""
    shadows = bake_shadows(geometry, lighting.sun_direction, scene.terrain.floor, cache)
    tracks = kept_track_map(scene, cache) if lighting.snow > 0 else TrackMap.empty()
    ambient = bake_ambient(scene, cache)
    covered = max(lighting.mist, lighting.litter, lighting.leaves) > 0
    land = land_map(scene, ambient, cache) if covered else no_land()
    light = build_light(scene, lighting, Baked(shadows, ambient, land, tracks), geometry)
    if len(light.sway):
        geometry = with_room(geometry, light.sway)
    return geometry, light


Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value")

GRIDS = {1: (1, 1), 2: (1, 2), 4: (2, 2)}
"""Samples along a row and along a column of a pixel, by their number. Two lie one above the other:
seen from a drone, kerbs, sills and lines of the road lie rather across the picture."""

_KEPT = 4  # Sizes of pictures for which arrays are kept

_influence = interpreted(influence)

_NO_MOVERS = Movers(
    part=np.empty((0, 0), np.int32),
    pose=np.empty((0, 0, 3, 4), np.float32),
    colour=np.empty((0, 0, 3), np.float32),
    object_id=np.empty((0, 0), np.int32),
    object_class=np.empty((0, 0), np.uint8),
    lamps=np.empty((0, 0), np.uint8),
    spray=NO_SPRAY,
)


def _plane(workers: int, rows: int, width: int, grid: tuple[int, int]) -> tuple[int, int, int]:
    """Return the shape of a plane of samples for each worker; rows are padded."""
    across, down = grid
    return workers, rows * down, (width + -width % WIDTH) * across


def _keep(kept: dict[Key, Value], key: Key, value: Value) -> None:
    """Keep something for the next call of the same size; sizes seldom change."""
    if len(kept) >= _KEPT:
        kept.pop(next(iter(kept), key), None)  # the oldest, unless another thread did so
    kept[key] = value
