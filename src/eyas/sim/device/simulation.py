"""N trackers, each in a world of its own, whose state lies on a device."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.core.pinhole import field_along, focal_length
from eyas.lanes.device import Device
from eyas.sim.assets import Assets
from eyas.sim.config import SimConfig
from eyas.sim.device.flight import START, Flown, Focal, Starts, flight_calls
from eyas.sim.device.records import Mirrored, uploaded
from eyas.sim.device.refusals import check_device
from eyas.sim.episodes import Episodes
from eyas.sim.light import LightChanges
from eyas.sim.simulation import rules_of
from eyas.sim.step import Orders, StepSurroundings
from eyas.sim.stepper import step_kernels, step_state
from eyas.sim.worlds import Worlds, each_alone
from eyas.state.snapshot import Snapshot
from eyas.targets.kind import Looks
from eyas.task.done import DoneReason
from eyas.trackers.tracker import Tracker

__all__ = ["DeviceSimulation"]

Chosen = NDArray[np.int64]


class DeviceSimulation:
    """Steps trackers on a device, to the same bytes as `eyas.sim.simulation.Simulation`. Episodes
    are drawn on the host, by the same code, and only they are uploaded.

    Attributes:
        config: The settings.
        count: N.
        device: The device.
        assets: Map, traffic and renderer.
        snapshot: The state, a `Snapshot` of arrays on the device.
        looks: Models and colours of all actors in the N worlds, on the device.
        held_focal: The `Focal` of the pictures, held by the device.
        flown: How the trackers have done in the last action, on the device.
        commands: Commands of the trackers, see `eyas.trackers.tracker.Tracker.advance`, on the
            device, shape (N, 4).

    Args:
        config: The settings.
        assets: Map, traffic and renderer.
        tracker: The kind of the trackers.
        count: N.
        device: The device.
        size: Height and width of the pictures [pixels], which may squeeze the camera's.
        steps: Physics steps of a command.
        repeat: Commands of an action.

    Raises:
        ConfigError: Devices cannot do what a setting asks for.
    """

    def __init__(
        self,
        config: SimConfig,
        assets: Assets,
        tracker: Tracker,
        count: int,
        device: Device,
        *,
        size: tuple[int, int],
        steps: int,
        repeat: int = 1,
    ) -> None:
        check_device(config, assets, tracker)
        self.config, self.count, self.device, self.assets = config, count, device, assets
        self._size, self._worlds = size, Worlds(config, assets, each_alone(count))
        host = self._host = Snapshot.create(count)
        light = LightChanges(config.light, assets.lighting, host.light, config.world.wind)
        samplers = () if config.world.wind is None else (light.blow,)
        traffic, worlds = assets.traffic, self._worlds
        self._episodes = Episodes(config, traffic, worlds, light, host, samplers)
        self._models = self._episodes.models
        self.snapshot: Snapshot = uploaded(device, host)
        self.looks: Looks = uploaded(device, worlds.looks)
        self.held_focal = device.held(Focal(device.zeros((count, 2), np.float64)))
        terrain = assets.scene.terrain
        memory = uploaded(device, tracker.memory(count, terrain))
        around = StepSurroundings(traffic.motion, terrain)
        rules = rules_of(config, tracker)
        state = device.held(step_state(config, tracker, self.snapshot, memory, around, rules))
        orders = Orders.create(count)
        orders.steps[0] = steps
        self._active = Mirrored(device, orders.active)
        orders = uploaded(device, orders)._replace(active=self._active.array)
        self.commands = orders.commands
        self.flown: Flown = uploaded(device, _flown(count, repeat, config.reward.weight))
        self._calls = flight_calls(step_kernels(config, tracker))
        self._act = state, device.held(orders), device.held(self.flown)
        self._starts: Starts = uploaded(device, _starts(count, traffic.actors))
        models, starts = device.held(self._models), device.held(self._starts)
        self._begin = state, models, device.held(self.looks), self.held_focal, starts

    def reseed_alone(self, trackers: NDArray[np.integer], seeds: NDArray[np.integer]) -> None:
        """See `eyas.sim.simulation.Simulation.reseed_alone`."""
        self._episodes.reseed_alone(trackers, seeds)

    def reset(self, trackers: Chosen) -> None:
        """Begin a new episode of some trackers, shape (K,).

        Raises:
            SpawnError: One has no possible target.
        """
        rows = self._drawn(trackers, self._episodes.begin(trackers))
        device, starts, looks = self.device, self._starts, self._worlds.looks
        device.write(starts.length, np.array([len(trackers)], np.int64))
        device.write(starts.row, rows)
        device.write(starts.looks.model, looks.model[trackers])
        device.write(starts.looks.colour, looks.colour[trackers])
        device.launch(self._calls.begin, len(trackers), *self._begin)

    def advance(self, active: NDArray[np.bool_]) -> None:
        """Let trackers follow their commands for an action, or until their episodes end; time
        stands still for those that are not active, shape (N,). `flown` tells how they have done.
        """
        self._active.write(active)
        self.device.launch(self._calls.act, self.count, *self._act)

    def ended(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return whose episodes the last action has terminated and truncated, on the host."""
        reason = self.device.read(self.flown.reason)
        at_limit = reason == DoneReason.STEP_LIMIT
        return (reason > DoneReason.NONE) & ~at_limit, at_limit

    def _drawn(self, trackers: Chosen, pitch: NDArray[np.float64]) -> NDArray[Any]:
        """Return the rows of `Starts` of episodes that have just been drawn."""
        _, cameras, targets, episodes, light = self._host
        rows = np.zeros(len(trackers), START)
        rows["tracker"], rows["pitch"] = trackers, pitch
        rows["number"], rows["tick"] = episodes.number[trackers], episodes.tick[trackers]
        rows["actor"], rows["model"] = targets.actor[trackers], targets.model[trackers]
        for axis, name in enumerate(("ahead", "left", "up", "heading")):
            rows[name] = episodes.start_offset[trackers, axis]
        rows["field_of_view"] = cameras.field_of_view[trackers]
        fields, which = np.unique(rows["field_of_view"], return_inverse=True)
        focal = np.array([self._focal(field) for field in fields.tolist()]).reshape(-1, 2)
        rows["focal_x"], rows["focal_y"] = focal[which].T
        for name in light._fields:
            rows[name] = getattr(light, name)[trackers]
        return rows

    def _focal(self, field: float) -> tuple[float, float]:
        """Return the focal lengths of pictures that show a camera's whole view [pixels]."""
        (height, width), camera = self._size, self.config.camera
        vertical = field_along(field, camera.height / camera.width)
        return focal_length(width, field), focal_length(height, vertical)


def _flown(count: int, repeat: int, weight: float) -> Flown:
    return Flown(
        repeat=np.array([repeat], np.int64),
        weight=np.array([weight], np.float64),
        reward=np.zeros(count),
        reason=np.zeros(count, np.int64),
        terminated=np.zeros(count, np.uint8),
        truncated=np.zeros(count, np.uint8),
    )


def _starts(count: int, actors: int) -> Starts:
    looks = Looks(np.zeros((count, actors), np.int32), np.zeros((count, actors, 3), np.float32))
    return Starts(np.zeros(1, np.int64), np.zeros(count, START), looks)
