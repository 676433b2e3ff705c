"""What trackers on a device see: their draw lists, cameras and pictures, all made there."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.render.kernels.bundles import Movers
from eyas.engine.render.kernels.scalars import f4
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.views.actor_bounds import ActorBounds, bounds_of, make_rows
from eyas.engine.sim.views.near_actors import (
    CAMERA,
    Entry,
    KindTable,
    Listed,
    ViewQuery,
    column_actors,
    kind_table,
    may_show,
    one_may_matter,
    set_camera,
    write_entry,
)
from eyas.engine.sim.views.pictures import is_timed
from eyas.engine.state.draw import NO_SPRAY
from eyas.engine.state.lighting import LightState
from eyas.engine.state.motion import ActorState, Motion
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.targets.kind import Group, Looks
from eyas.engine.targets.posing import PoseCall, Slots
from eyas.engine.targets.vehicles.pose import pose_vehicle as pose_one
from eyas.engine.traffic.interpolation import interpolate_actor, sample_before
from eyas.gpu.render.device_views import DeviceDrawer, DeviceViews
from eyas.gpu.sim.flight import FEW, Focal
from eyas.gpu.sim.signals import SignalTimes, shown_part, signal_times
from eyas.gpu.sim.simulation import DeviceSimulation, MirroredArray, uploaded
from eyas.lanes import ParallelCall, kernel, parallel, specialised


class DeviceCameras(NamedTuple):
    """Cameras as the renderer reads them, see `eyas.gpu.render.device_views.DeviceViews`; where
    they are stands in `ViewQuery.eye`.
    """

    axes: NDArray[np.float64]
    subject: NDArray[np.int32]
    light: LightState
    instant: NDArray[np.float64]
    focal: NDArray[np.float64]


class Surroundings(NamedTuple):
    """What is known of all actors."""

    motion: Motion
    bounds: ActorBounds  # All rows are made
    kinds: KindTable
    looks: Looks  # In the N worlds


class Counts(NamedTuple):
    """How many actors are listed for each view."""

    end: NDArray[np.int64]
    """Where the actors of each of K kinds begin in its row of `Listed.state`, and at last their
    number, shape (V, K + 1)."""
    short: NDArray[np.int64]  # Not 0 if there was no room for some, shape (1,)
    slots: int  # Number of slots for actors; those of signals follow


class Cast(NamedTuple):
    """One kind of actors."""

    kind: int  # Which of the K
    actors: int  # How many there are of it


@parallel
def list_actors(
    worker: int,
    workers: int,
    snapshot: Snapshot,
    focal: Focal,
    around: Surroundings,
    query: ViewQuery,
    shown: DeviceCameras,
    listed: Listed,
    counts: Counts,
) -> None:
    """Write the cameras of views, and list the actors of the world of each; `ViewQuery.world` tells
    which tracker's it is.
    """
    for v in range(worker, query.worlds[0], workers):
        _look(snapshot, focal, query, shown, v)
        set_camera(query, v)
        _list_world(around, query, listed, counts, v)


@kernel(inline=True)
def _look(snapshot: Snapshot, focal: Focal, query: ViewQuery, shown: DeviceCameras, v: int) -> None:
    """Write the camera of view `v`."""
    cameras, light, n = snapshot.cameras, snapshot.light, query.world[v]
    query.time[v] = snapshot.episodes.tick[n] * PHYSICS_STEP
    query.field_of_view[v] = cameras.field_of_view[n]
    for axis in range(3):
        query.eye[v, axis] = cameras.position[n, axis]
        for row in range(3):
            query.rotation[v, row, axis] = cameras.rotation[n, row, axis]
            shown.axes[v, axis, row] = cameras.rotation[n, row, axis]
    shown.subject[v] = ACTOR_OBJECT + snapshot.targets.actor[n]
    own = shown.light
    own.sky[v], own.sun[v], own.fog_density[v] = light.sky[n], light.sun[n], light.fog_density[n]
    own.wind_x[v], own.wind_y[v] = light.wind_x[n], light.wind_y[n]
    if shown.instant.shape[0] > 0:
        shown.instant[v] = query.time[v]
    shown.focal[v, 0], shown.focal[v, 1] = focal.length[n, 0], focal.length[n, 1]


@kernel(inline=True)
def _list_world(
    around: Surroundings, query: ViewQuery, listed: Listed, counts: Counts, v: int
) -> None:
    """List the actors that matter for view `v`, kind by kind, and give each its slots."""
    motion, bounds, kinds = around.motion, around.bounds, around.kinds
    time, columns = query.time[v], listed.state.yaw.shape[1]
    sphere = bounds.sphere[sample_before(motion, time) // bounds.samples[0]]
    listed.used[v], counts.end[v, 0] = 0, 0
    entries, begin = 0, 0
    for k in range(kinds.end.shape[0]):
        reach, slots = kinds.reach[k], kinds.slots[k]
        for column in range(begin, kinds.end[k]):
            x, y, z = sphere[0, column], sphere[1, column], sphere[2, column]
            if not may_show(query.camera[v], x, y, z, sphere[3, column] + f4(reach)):
                continue
            actor = bounds.actor[column]
            pose = interpolate_actor(motion, actor, time)
            if not pose.present or not one_may_matter(query, v, pose, reach):
                continue
            if listed.used[v] + slots <= counts.slots and entries < columns:
                place = v * columns + entries
                entry = Entry(actor, query.world[v], v, slots, place, v, entries, 0)
                write_entry(motion, around.looks, listed, entry, pose, time)
            else:
                counts.short[0] = 1  # whoever writes it
            entries += 1
            listed.used[v] += slots
        counts.end[v, k + 1] = entries
        begin = kinds.end[k]


@parallel
def empty_slots(
    worker: int,
    workers: int,
    snapshot: Snapshot,
    query: ViewQuery,
    listed: Listed,
    counts: Counts,
    signals: SignalTimes,
) -> None:
    """Empty the slots that are not used, and show the signals in those behind."""
    width = listed.part.shape[1]
    for index in range(worker, query.worlds[0] * width, workers):
        v, slot = index // width, index % width
        if slot >= counts.slots:
            tick = snapshot.episodes.tick[query.world[v]]
            listed.part[v, slot] = shown_part(signals, slot - counts.slots, tick)
        elif slot >= listed.used[v]:
            listed.part[v, slot] = -1


@lru_cache(maxsize=16)
def pose_call(one: Callable[..., None]) -> ParallelCall:
    """Return the driver that poses the listed actors of a kind by
    `eyas.engine.targets.posing.PoseCall`'s `one`; it takes its table, `Group`, state and looks of
    the listed actors, `Slots`, `ViewQuery`, `Counts` and `Cast`.
    """
    return parallel(specialised(_pose, pose_one=one))


def _pose(
    worker: int,
    workers: int,
    table: Any,  # noqa: ANN401  # of the kind
    group: Group,
    actors: ActorState,
    looks: Looks,
    out: Slots,
    query: ViewQuery,
    counts: Counts,
    cast: Cast,
) -> None:
    """Write the slots of the listed actors of a kind."""
    for index in range(worker, query.worlds[0] * cast.actors, workers):
        v = index // cast.actors
        column = counts.end[v, cast.kind] + index % cast.actors
        if column < counts.end[v, cast.kind + 1]:
            pose_one(table, group, actors, looks, out, v, v * actors.yaw.shape[1] + column)


_ENTRIES, _SLOTS = 8, 64  # Actors, and slots, for which there is room at first


class DeviceView:
    """Draws what N trackers see, from draw lists (`movers`) on the device."""

    movers: Movers

    def __init__(self, simulation: DeviceSimulation, drawer: DeviceDrawer) -> None:
        self._simulation, self._drawer = simulation, drawer
        config, assets, device = simulation.config, simulation.assets, simulation.device
        self._device, self._assets, count = device, assets, simulation.count
        reach = assets.renderer.influence(assets.rigs.reach(assets.renderer.part_reach()))
        motion, kinds = assets.traffic.motion, kind_table(assets.rigs, reach)
        around = Surroundings(motion, _bounds(assets), kinds, simulation.looks)
        aspect = config.camera.height / config.camera.width
        timed, self._falling = is_timed(config), config.light.flakes
        query = _query(count, aspect)
        self._chosen, self._count = (
            MirroredArray(device, query.world),
            MirroredArray(device, query.worlds),
        )
        self._query: ViewQuery = uploaded(device, query)._replace(
            world=self._chosen.array, worlds=self._count.array
        )
        self._shown: DeviceCameras = uploaded(device, _shown(count, timed=timed))
        self._world = device.upload(np.arange(count, dtype=np.int32))
        last = round(assets.traffic.duration / PHYSICS_STEP)
        self._signals = device.held(signal_times(assets.signals, last))
        self._snapshot = device.held(simulation.snapshot)
        self._looking = (
            self._snapshot,
            simulation.held_focal,
            device.held(around),
            device.held(self._query),
            device.held(self._shown),
        )
        self._views, self._room = 0, (0, 0)
        self._grow(_ENTRIES, _SLOTS)

    def draw(
        self,
        trackers: NDArray[np.int64],
        rgb: Any,  # noqa: ANN401  # a device array
        subject: Any = None,  # noqa: ANN401  # a device array
    ) -> None:
        """Draw the pictures of some trackers' cameras.

        Args:
            trackers: The trackers, shape (V,).
            rgb: On the device, uint8, shape (N, H, W, 3); the first V are written, and perhaps some
                behind them.
            subject: What is measured of their targets, see `DeviceDrawer`, shape (N, 10), likewise.
        """
        # Powers of two and N: working memory of drawing is kept for each number of pictures.
        count = min(1 << (len(trackers) - 1).bit_length(), self._simulation.count)
        self._list(np.append(trackers, np.repeat(trackers[-1:], count - len(trackers))))
        self._pose()
        self._drawer.draw(self.cameras, self.movers, rgb, subject)

    @property
    def cameras(self) -> DeviceViews:
        """The cameras of the last pictures, on the device."""
        query, shown, falling = self._query, self._shown, self._falling
        return DeviceViews(self._views, query.eye, world=self._world, falling=falling,
                           **shown._asdict())  # fmt: skip

    def _list(self, trackers: NDArray[np.int64]) -> None:
        """Write cameras and lists of some trackers, without parts and poses."""
        device, count = self._device, len(trackers)
        self._views = count
        self._count.write(np.array([count]))
        self._chosen.write(trackers)
        device.clear(self._counts.short)
        device.launch(list_actors, count, *self._looking, *self._lists, block=FEW)
        if device.read(self._counts.short)[0]:
            entries = device.read(self._counts.end)[:count, -1].max()
            self._grow(int(entries), int(device.read(self._listed.used)[:count].max()))
            self._list(trackers)

    def _pose(self) -> None:
        """Write the parts and poses of what is listed."""
        device, views = self._device, self._views
        cells = views * self.movers.part.shape[1]
        held = self._snapshot, self._looking[3], *self._lists, self._signals
        device.launch(empty_slots, cells, *held)
        for call, cells, bundles in self._casts:
            device.launch(call, views * cells, *bundles)

    def _grow(self, entries: int, slots: int) -> None:
        """Make room for some actors and slots in each list, and a quarter more; never less."""
        device, simulation, assets = self._device, self._simulation, self._assets
        count, casts = simulation.count, assets.rigs.casts
        entries = max(self._room[0], entries + entries // 4)
        slots = max(self._room[1], slots + slots // 4)
        self._room = entries, slots
        movers = _movers(assets, count, slots)
        self.movers = Movers(*(device.upload(array) for array in movers))
        kinds = len(casts)
        counts = Counts(np.zeros((count, kinds + 1), np.int64), np.zeros(1, np.int64), slots)
        self._counts: Counts = uploaded(device, counts)
        listed: Listed = uploaded(device, _listed(count, entries))
        self._listed = listed._replace(
            part=self.movers.part, object_id=self.movers.object_id, lamps=self.movers.lamps
        )
        self._lists = device.held(self._listed), device.held(self._counts)
        actor = device.upload(np.tile(np.arange(entries), count))
        out = device.held(Slots(*self.movers[:4]))
        state, looks = device.held(self._listed.state), device.held(self._listed.looks)
        self._casts = []
        for number, (rig, group) in enumerate(casts):
            own = group._replace(actor=actor, slot=self._listed.slot)
            cast, posing = Cast(number, len(group.actor)), rig.pose
            assert isinstance(posing, PoseCall)  # else it has been refused
            bundles = (
                *(device.held(posing.table), device.held(own), state, looks, out),
                *(self._looking[3], self._lists[1], device.held(cast)),
            )
            self._casts.append((pose_call(posing.one), cast.actors, bundles))


def _bounds(assets: Assets) -> ActorBounds:
    """Return the bounds of all actors in all seconds."""
    bounds = bounds_of(assets.traffic.motion, column_actors(assets.rigs))
    make_rows(bounds, assets.traffic.motion)
    return bounds


def _query(views: int, aspect: float) -> ViewQuery:
    return ViewQuery(
        worlds=np.zeros(1, np.int64),
        aspect=np.array([aspect]),
        world=np.zeros(views, np.int64),
        time=np.zeros(views),
        end=np.arange(1, views + 1),
        eye=np.zeros((views, 3)),
        rotation=np.zeros((views, 3, 3)),
        field_of_view=np.ones(views),
        camera=np.zeros(views, CAMERA),
    )


def _shown(views: int, *, timed: bool) -> DeviceCameras:
    return DeviceCameras(
        axes=np.zeros((views, 3, 3)),
        subject=np.zeros(views, np.int32),
        light=LightState.create(views),
        instant=np.zeros(views if timed else 0),
        focal=np.ones((views, 2)),
    )


def _listed(views: int, entries: int) -> Listed:
    """Return lists without their slots."""
    nothing = np.zeros((0, 0), np.int32)
    return Listed(
        needed=np.zeros(2, np.int64),
        end=np.zeros(0, np.int64),
        used=np.zeros(views, np.int64),
        slot=np.zeros(views * entries, np.int64),
        state=ActorState.create(views, entries),
        looks=Looks(np.zeros((views, entries), np.int32), np.ones((views, entries, 3), np.float32)),
        part=nothing,
        object_id=nothing,
        lamps=nothing.astype(np.uint8),
    )


def _movers(assets: Assets, worlds: int, slots: int) -> Movers:
    """Return empty draw lists, with the signals behind."""
    signal = assets.traffic.motion.lamps.size > 0
    empty = assets.rigs.short_list(worlds, slots, lamps=signal)
    if assets.signals is not None:
        empty = assets.signals.added(empty, np.zeros(worlds))
    arrays = {name: np.ascontiguousarray(getattr(empty, name)) for name in Movers._fields}
    return Movers(**{**arrays, "spray": NO_SPRAY})
