"""Motion of the trackers of a recording: with their targets, at random, on paths, by a policy."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import physics_steps
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.rng import stream
from eyas.engine.envs.actions import action_table
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.flights.registry import PATHS, SETTING, path_named
from eyas.engine.sim.simulation import Simulation
from eyas.engine.trackers.config import TrackerKind
from eyas.engine.traffic.config import Source
from eyas.engine.video.camera_flights import CameraFlights
from eyas.engine.video.policy import PolicyPilot

_EXACT, _RANDOM = "exact", "random"  # Values of `video.flight` beside camera paths


class Mover(Protocol):
    """Moves all trackers by one 2 ms step."""

    def begin(self, trackers: NDArray[np.int64], longest: int) -> None:
        """Begin the episodes of trackers that have just been reset.

        Args:
            trackers: The trackers, shape (K,).
            longest: Most 2 ms steps that an episode may take from now on.
        """

    def move(self) -> None:
        """Advance the simulation by one 2 ms step."""

    def action(self, tracker: int) -> RecordedAction:
        """Return a tracker's action in the last step."""


class Exact:
    """Each tracker keeps its place relative to its target."""

    def __init__(self, sim: Simulation) -> None:
        self._sim = sim

    def begin(self, trackers: NDArray[np.int64], longest: int) -> None:
        """Do nothing."""

    def move(self) -> None:
        """Advance the simulation by one 2 ms step."""
        self._sim.carry(1)

    def action(self, tracker: int) -> RecordedAction:
        """Return an action without a command."""
        return RecordedAction(number=-1, command=None)


class RandomActions:
    """One of six actions, sampled at the start of each control period and held during it."""

    def __init__(self, sim: Simulation, config: EyasConfig) -> None:
        self._sim, self._seed = sim, config.seed
        self._numbers = np.zeros(sim.count, np.int32)
        self._period = physics_steps(config.control.frequency)
        self._vectors = action_table(config.video)
        self._streams: list[np.random.Generator] = [stream(0, "video")] * sim.count

    def begin(self, trackers: NDArray[np.int64], longest: int) -> None:
        """Begin the random numbers of the trackers' episodes."""
        numbers = self._sim.snapshot.episodes.number
        for tracker in trackers.tolist():
            self._streams[tracker] = stream(self._seed, "video", tracker, int(numbers[tracker]))

    def move(self) -> None:
        """Advance the simulation by one 2 ms step."""
        steps = self._sim.snapshot.episodes.step_count
        for tracker in np.flatnonzero(steps % self._period == 0).tolist():
            self._numbers[tracker] = self._streams[tracker].integers(len(self._vectors))
        self._sim.advance(self._vectors[self._numbers], 1)

    def action(self, tracker: int) -> RecordedAction:
        """Return a tracker's action in the last step."""
        number = int(self._numbers[tracker])
        return RecordedAction(number, self._vectors[number])


def flight_of(config: EyasConfig) -> str:
    """Return the flight that the settings select or mean; of a recording without a policy."""
    if config.video.flight is not None:
        return config.video.flight
    return PATHS.built_in[0] if _no_path(config) is None else _EXACT


def check_flight(config: EyasConfig) -> None:
    """Refuse flights that do not exist or cannot be flown, before anything is built.

    Raises:
        ConfigError: One line.
    """
    if config.video.policy is not None or flight_of(config) in (_EXACT, _RANDOM):
        return
    flight = flight_of(config)
    if flight not in PATHS.names() and ":" not in flight:
        raise UnknownNameError(SETTING, flight, (_EXACT, _RANDOM, *PATHS.names()))
    path_named(flight)
    if why := _no_path(config):
        raise ConfigError(
            f"{SETTING}: {flight!r} is not possible with {why}; allowed: '{_EXACT}', '{_RANDOM}', "
            "or a policy (video.policy)"
        )


def _no_path(config: EyasConfig) -> str | None:
    """Return what keeps all camera paths from being flown; None: nothing does."""
    if config.traffic.source is Source.LIVE:
        return "traffic.source 'live', whose future is not known"
    if config.tracker.kind is not TrackerKind.DRONE:
        return f"tracker.kind '{config.tracker.kind}', which is not a drone"
    return None


def mover_of(config: EyasConfig, sim: Simulation) -> Mover:
    """Return the mover that the settings select.

    Raises:
        EyasError: There is no such flight or policy, or it cannot be flown.
    """
    if config.video.policy is not None:
        return PolicyPilot(sim, config, config.video.policy)
    match flight_of(config):
        case "exact":
            return Exact(sim)
        case "random":
            return RandomActions(sim, config)
        case path:
            return CameraFlights(sim, config, path_named(path))
