"""What is sensed after each physics step: contacts, lidar, and the errors of the other sensors.

What is off does not exist here, so that it costs nothing.
"""

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.event_sensor import EventSensors
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.core.variation import bounds
from eyas.engine.sensors.grain import Grain
from eyas.engine.sensors.lidar import CAR_MOUNT, MOUNT, Lidar
from eyas.engine.sensors.obstacles import Obstacles, obstacles_of
from eyas.engine.sensors.readings import Readings, must_read
from eyas.engine.sensors.table import fitted_sensors
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.views.further_camera import FurtherOptics
from eyas.engine.sim.views.optics import Optics
from eyas.engine.sim.worlds import Worlds
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.config import Crash
from eyas.engine.task.contact import Contacts
from eyas.engine.trackers.config import TrackerKind


class _Sensor(Protocol):
    def begin(self, tracker: int, rng: np.random.Generator) -> None: ...


class SensorSuite:
    """The sensors of N trackers that the settings ask for.

    Attributes:
        lidar: None if it is off.
        fitted: The sensors whose readings are numbers.
        readings: None if these are only the original's, without errors.
        grain: None if the camera has no noise.
        optics: What is modelled of the camera beyond a pinhole.
        further: The cameras that trackers have beside that one.
        events: None if there are no event cameras.
        follow: Whether `advance` must be called after each physics step.
    """

    def __init__(
        self,
        config: SimConfig,  # The settings
        assets: Assets,  # Map and traffic
        worlds: Worlds,  # The worlds of the trackers
        snapshot: Snapshot,  # Their state
        active: NDArray[np.bool_],  # Whether each moves in a step, shape (N,); read at each
        *,
        bodies: bool,  # Whether they have bodies, which others meet
    ) -> None:
        self.lidar: Lidar | None = None
        self.readings: Readings | None = None
        self._contacts: Contacts | None = None
        crash = config.done.crash
        if config.lidar.enabled or crash is not Crash.ORIGINAL:
            obstacles = obstacles_of(
                assets.solids(),
                assets.scene.terrain,
                assets.traffic.motion,
                worlds.of,
                worlds.models,
                snapshot.trackers if bodies else None,
            )
            if crash is not Crash.ORIGINAL:
                self._contacts = _contacts(config, snapshot, obstacles, active)
            if config.lidar.enabled:
                latest = round(bounds(config.control.observation_latency_steps)[1])
                mount = CAR_MOUNT if config.tracker.kind is TrackerKind.CAR else MOUNT
                self.lidar = Lidar(config.lidar, snapshot, obstacles, active, latest, mount)
        self.fitted = fitted_sensors(config.sensors)
        if must_read(self.fitted):
            self.readings = Readings(self.fitted, snapshot, assets.scene.terrain, active)
        self.grain = Grain.of(config.sensors.camera, len(active))
        size = config.camera.height, config.camera.width
        self.events = EventSensors.of(config.camera.events, size, len(active))
        taken = assets, config.world.hour, len(active)
        self.optics = Optics(config.camera, *taken)
        self.further = tuple(FurtherOptics(camera, *taken) for camera in config.cameras)
        # Contacts come first: they may end the episode that the others then see.
        self._following = [
            sensor for sensor in (self._contacts, self.lidar, self.readings) if sensor is not None
        ]
        self.follow = bool(self._following)

    @property
    def told(self) -> NDArray[np.float64] | None:
        """What sensors read, see `Readings`; None if packets hold the same."""
        return None if self.readings is None else self.readings.told

    def begin(self, trackers: Sequence[int], key_of: Callable[[int], EpisodeKey]) -> None:
        """Begin episodes of some trackers, which are at their starts.

        Args:
            trackers: The trackers.
            key_of: Returns what the random numbers of a tracker's episode depend on.
        """
        sensors: dict[str, _Sensor | None] = {
            "contacts": self._contacts,
            "readings": self.readings,
            "grain": self.grain,
            "events": self.events,
        }
        on = [(name, sensor) for name, sensor in sensors.items() if sensor is not None]
        optics = self.optics, *self.further
        for tracker in trackers:
            key = key_of(tracker)
            if self.lidar is not None:
                self.lidar.begin(tracker, key)
            for name, sensor in on:
                sensor.begin(tracker, key.stream(name))
            for camera in optics:
                camera.begin(tracker, key.stream)
        self.advance()

    def settle(self) -> None:
        """Sense what waits until it is asked for."""
        if self.lidar is not None:
            self.lidar.settle()

    def renew(self) -> None:
        """Begin a command."""
        if self._contacts is not None:
            self._contacts.renew()

    def advance(self) -> None:
        """Sense, after a physics step."""
        for sensor in self._following:
            sensor.advance()


def _contacts(
    config: SimConfig, snapshot: Snapshot, obstacles: Obstacles, active: NDArray[np.bool_]
) -> Contacts:
    ends = config.done.crash is Crash.END
    return Contacts(snapshot, obstacles, active, config.done.grace_steps, ends=ends)
