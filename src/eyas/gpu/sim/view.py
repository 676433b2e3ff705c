"""What trackers on a device see: their draw lists, cameras and pictures, all made there."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.render.kernels.bundles import Movers
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.views.actor_bounds import ActorBounds, bounds_of, make_rows
from eyas.engine.sim.views.near_actors import CAMERA, Listed, ViewQuery, column_actors, kind_table
from eyas.engine.sim.views.pictures import is_timed
from eyas.engine.state.draw import NO_SPRAY
from eyas.engine.state.lighting import LightState
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.posing import PoseCall, Slots
from eyas.gpu.render.device_views import DeviceDrawer, DeviceViews
from eyas.gpu.sim.flight import FEW
from eyas.gpu.sim.near import (
    Cast,
    Counts,
    DeviceCameras,
    Surroundings,
    empty_slots,
    list_actors,
    pose_call,
)
from eyas.gpu.sim.records import Mirrored, uploaded
from eyas.gpu.sim.signals import signal_times
from eyas.gpu.sim.simulation import DeviceSimulation

_ENTRIES, _SLOTS = 8, 64  # Actors, and slots, for which there is room at first


class DeviceView:
    """Draws what N trackers see.

    Attributes:
        movers: The draw lists, on the device.

    Args:
        simulation: The trackers.
        drawer: Draws on their device.
    """

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
        self._chosen, self._count = Mirrored(device, query.world), Mirrored(device, query.worlds)
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
