"""N trackers, each in a world of its own, whose state lies on a device; episodes are drawn here."""

from collections.abc import Iterator
from functools import partial
from itertools import chain
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.optics.pinhole import field_along, focal_length
from eyas.engine.sensors.config import SensorsConfig
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.episodes import Episodes, Sampler
from eyas.engine.sim.latency import is_always_0
from eyas.engine.sim.light import LightChanges
from eyas.engine.sim.simulation import rules_of
from eyas.engine.sim.starts import starts_in
from eyas.engine.sim.step import Orders, StepSurroundings
from eyas.engine.sim.stepper import step_kernels, step_state
from eyas.engine.sim.worlds import Worlds, each_alone
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.posing import PoseCall
from eyas.engine.task.config import Crash
from eyas.engine.task.done import DoneReason
from eyas.engine.trackers.gimbal_command import WITH_GIMBAL, with_gimbal
from eyas.engine.trackers.tracker import Tracker
from eyas.gpu.sim.flight import FEW, START, Flown, Focal, Starts, flight_calls
from eyas.lanes.device import Device

Chosen = NDArray[np.int64]


class HostEpisodes:
    """Draws the episodes of N trackers, each in a world of its own.

    Attributes:
        episodes: What draws them.
        worlds: The worlds, whose looks change in place.
        snapshot: The state before the first reset; later only what is drawn is set.
        memory: What the trackers remember; later only what is drawn is set, see `sampled_of`.
    """

    def __init__(
        self,
        config: SimConfig,  # The settings
        assets: Assets,  # Map and traffic
        tracker: Tracker,  # The kind of the trackers
        count: int,  # N
        size: tuple[int, int],  # Height and width of the pictures [pixels]
    ) -> None:
        self._size, self._aspect = size, config.camera.height / config.camera.width
        self.worlds = Worlds(config, assets, each_alone(count))
        self.snapshot = Snapshot.create(count)
        wind = config.world.wind
        light = LightChanges(config.light, assets.lighting, self.snapshot.light, wind)
        samplers: list[Sampler] = [] if wind is None else [light.blow]
        self.memory = tracker.memory(count, assets.scene.terrain)
        self._sampled = None if tracker.sample is None else tracker.sampled
        if tracker.sample is not None:
            samplers.insert(0, partial(tracker.sample, self.memory))
        traffic, snapshot = assets.traffic, self.snapshot
        starts = starts_in(assets, snapshot, self.worlds, shared_target=config.same_target)
        self.episodes = Episodes(config, traffic, self.worlds, light, snapshot, samplers, starts)

    def begin(self, trackers: Chosen) -> NDArray[Any]:
        """Draw episodes, and return them as rows of `START`, shape (K,).

        Raises:
            SpawnError: A tracker has no possible target.
        """
        pitch = self.episodes.begin(trackers)
        _, cameras, targets, episodes, light = self.snapshot
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

    def sampled_of(self, memory: Any) -> list[Any]:  # noqa: ANN401  # the trackers' record
        """Return those arrays of a memory, here or on a device, in which episodes are drawn."""
        return [] if self._sampled is None else arrays_of(attrgetter(self._sampled)(memory))

    def _focal(self, field: float) -> tuple[float, float]:
        """Return the focal lengths of pictures that show a camera's whole view [pixels]."""
        height, width = self._size
        vertical = field_along(field, self._aspect)
        return focal_length(width, field), focal_length(height, vertical)


def uploaded(device: Device, record: Any) -> Any:  # noqa: ANN401  # a record, an array or a number
    """Return a record, a tuple of arrays, of numbers and of other such tuples, with copies of its
    arrays on a device.
    """
    if isinstance(record, np.ndarray):
        return device.upload(record)
    if not isinstance(record, tuple):
        return record
    parts = [uploaded(device, part) for part in record]
    return type(record)(*parts) if hasattr(record, "_fields") else tuple(parts)


def downloaded(device: Device, record: Any) -> Any:  # noqa: ANN401  # as above
    """Return such a record with copies here of its arrays on a device."""
    if not isinstance(record, tuple):
        return device.read(record) if hasattr(record, "shape") else record
    parts = [downloaded(device, part) for part in record]
    return type(record)(*parts) if hasattr(record, "_fields") else tuple(parts)


def arrays_of(record: Any) -> list[Any]:  # noqa: ANN401  # as above
    """Return all arrays of a record, here or on a device."""
    if isinstance(record, tuple):
        return [array for part in record for array in arrays_of(part)]
    return [record] if hasattr(record, "shape") else []


class MirroredArray:
    """An array on a device that only the host writes: what does not change is not sent again."""

    def __init__(self, device: Device, content: NDArray[Any]) -> None:
        self.array = device.upload(content)
        self._device, self._content = device, content.copy()

    def write(self, values: NDArray[Any]) -> None:
        """Write the first rows."""
        known = self._content[: len(values)]
        if not np.array_equal(known, values):
            known[:] = values
            self._device.write(self.array, known)


_CAMERA = ("width", "height", "field_of_view", "samples", "pixel_filter", "mount")
"""Settings of the camera that may have any value."""


def check_device(config: SimConfig, assets: Assets, tracker: Tracker) -> None:
    """Refuse settings that need the host in a step.

    Raises:
        ConfigError: There is such a setting.
    """
    refused = chain(_sensed(config), _simulated(config, assets, tracker), _drawn(assets))
    for setting, allowed in refused:
        raise ConfigError(f"{setting} is not there on a device; allowed: {allowed}")


Refused = Iterator[tuple[str, str]]
"""Settings with their values, and what is allowed in the place of each."""


def _sensed(config: SimConfig) -> Refused:
    for name in ("action_latency_steps", "observation_latency_steps"):
        value = getattr(config.control, name)
        if not is_always_0(value):
            yield f"control.{name}: {value}", "0"
    usual = CameraConfig()
    for name in CameraConfig.model_fields:
        if name not in _CAMERA and getattr(config.camera, name) != getattr(usual, name):
            yield f"camera.{name}: a value of its own", f"{getattr(usual, name)!r}"
    for name in SensorsConfig.model_fields:
        if getattr(config.sensors, name) != getattr(SensorsConfig(), name):
            what = "a sensor" if name == "further" else "an error, a rate or a delay"
            yield f"sensors.{name}: {what}", "none"
    if config.cameras:
        yield f"cameras: {', '.join(camera.name for camera in config.cameras)}", "none"
    if config.lidar.enabled:
        yield "lidar.enabled: true", "false"


def _simulated(config: SimConfig, assets: Assets, tracker: Tracker) -> Refused:
    if config.done.crash is not Crash.ORIGINAL:
        yield f"done.crash: '{config.done.crash}'", f"'{Crash.ORIGINAL}'"
    for name in config.reward.terms:
        yield f"reward.terms: '{name}'", "none, the built-in reward"
    if tracker.sample is not None and tracker.sampled is None:
        yield f"tracker.kind: a '{tracker.name}' with a sample", "one that tells what is sampled"
    if assets.traffic.live:
        yield "traffic.source: 'live'", "'recorded'"


def _drawn(assets: Assets) -> Refused:
    if assets.lighting.spray > 0.0:
        yield "world.spray: true on wet roads", "false"
    for kind, cast in zip(assets.rigs.kinds, assets.rigs.casts, strict=True):
        if not isinstance(cast.rig.pose, PoseCall):
            yield f"custom or airborne: a '{kind.name}'", "vehicles, people and robots"


class DeviceSimulation:
    """Steps trackers on a device, to the same bytes as `eyas.engine.sim.simulation.Simulation`.
    Episodes are drawn on the host, by the same code, and only they are uploaded.

    Attributes:
        config: The settings.
        count: N.
        device: The device.
        assets: Map, traffic and renderer.
        snapshot: The state, a `Snapshot` of arrays on the device.
        looks: Models and colours of all actors in the N worlds, on the device.
        held_focal: The `Focal` of the pictures, held by the device.
        flown: How the trackers have done in the last action, on the device.
        commands: Commands of the trackers, see `eyas.engine.trackers.tracker.Tracker.advance`, on
            the device, shape (N, 4) or (N, 8).

    Raises:
        ConfigError: Devices cannot do what a setting asks for.
    """

    def __init__(
        self,
        config: SimConfig,  # The settings
        assets: Assets,  # Map, traffic and renderer
        tracker: Tracker,  # The kind of the trackers
        count: int,  # N
        device: Device,
        *,
        # Height and width of the pictures [pixels], which may squeeze the camera's
        size: tuple[int, int],
        steps: int,  # Physics steps of a command
        repeat: int = 1,  # Commands of an action
        # Whether commands turn the cameras, see `eyas.engine.trackers.gimbal_command`
        gimbal: bool = False,
    ) -> None:
        check_device(config, assets, tracker)
        self.config, self.count, self.device, self.assets = config, count, device, assets
        host = self._host = HostEpisodes(config, assets, tracker, count, size)
        self.snapshot: Snapshot = uploaded(device, host.snapshot)
        self.looks: Looks = uploaded(device, host.worlds.looks)
        memory = uploaded(device, host.memory)
        drawn = host.sampled_of(host.memory), host.sampled_of(memory)
        self._sampled = list(zip(*drawn, strict=True))
        self.held_focal = device.held(Focal(device.zeros((count, 2), np.float64)))
        around = StepSurroundings(assets.traffic.motion, assets.scene.terrain)
        rules = rules_of(config, tracker)
        state = device.held(step_state(config, tracker, self.snapshot, memory, around, rules))
        orders = Orders.create(count)
        if gimbal:
            orders = orders._replace(commands=np.zeros((count, WITH_GIMBAL)))
            tracker = with_gimbal(tracker)
        orders.steps[0] = steps
        self._active = MirroredArray(device, orders.active)
        orders = uploaded(device, orders)._replace(active=self._active.array)
        self.commands = orders.commands
        self.flown: Flown = uploaded(device, _flown(count, repeat, config.reward.weight))
        self._calls = flight_calls(step_kernels(config, tracker))
        self._act = state, device.held(orders), device.held(self.flown)
        self._starts: Starts = uploaded(device, _starts(count, assets.traffic.actors))
        models, starts = device.held(host.episodes.models), device.held(self._starts)
        self._begin = state, models, device.held(self.looks), self.held_focal, starts

    def reseed_alone(self, trackers: NDArray[np.integer], seeds: NDArray[np.integer]) -> None:
        """See `eyas.engine.sim.simulation.Simulation.reseed_alone`."""
        self._host.episodes.reseed_alone(trackers, seeds)

    @property
    def seeds(self) -> NDArray[np.int64]:
        """See `eyas.engine.sim.simulation.Simulation.seeds`."""
        return self._host.episodes.seeds

    def reset(self, trackers: Chosen) -> None:
        """Begin a new episode of some trackers, shape (K,).

        Raises:
            SpawnError: One has no possible target.
        """
        rows = self._host.begin(trackers)
        device, starts, looks = self.device, self._starts, self._host.worlds.looks
        device.write(starts.length, np.array([len(trackers)], np.int64))
        device.write(starts.row, rows)
        device.write(starts.looks.model, looks.model[trackers])
        device.write(starts.looks.colour, looks.colour[trackers])
        for drawn, there in self._sampled:
            for first, end in _runs(trackers):
                device.write(there, drawn[first:end], first)
        device.launch(self._calls.begin, len(trackers), *self._begin, block=FEW)

    def advance(self, active: NDArray[np.bool_]) -> None:
        """Let trackers follow their commands for an action, or until their episodes end; time
        stands still for those that are not active, shape (N,). `flown` tells how they have done.
        """
        self._active.write(active)
        self.device.launch(self._calls.act, self.count, *self._act, block=FEW)

    def ended(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return whose episodes the last action has terminated and truncated, on the host."""
        reason = self.device.read(self.flown.reason)
        at_limit = reason == DoneReason.STEP_LIMIT
        return (reason > DoneReason.NONE) & ~at_limit, at_limit


def _runs(trackers: Chosen) -> list[tuple[int, int]]:
    """Return the first of each run of neighbours, and the end behind its last."""
    breaks = np.flatnonzero(np.diff(trackers) != 1) + 1
    return [(int(run[0]), int(run[-1]) + 1) for run in np.split(trackers, breaks)]


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
