"""Motion of the trackers of a recording: with their targets, at random, on paths, by a policy."""

from functools import partial
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import physics_steps
from eyas.engine.core.doors import first_brought
from eyas.engine.core.errors import ActionError, ConfigError, UnknownNameError
from eyas.engine.core.files import user_path
from eyas.engine.core.rng import stream
from eyas.engine.custom.tracks import endings, is_track, tracks_in
from eyas.engine.envs.actions import action_table, command_width, make_actions, turn_rates
from eyas.engine.envs.observation import Observation, Observer
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.policies.policy import Failure, Policy, PolicyInput, Start
from eyas.engine.policies.sight import subjects, visible_shares
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.flights.registry import PATHS, SETTING, path_named
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.trackers.config import TrackerKind
from eyas.engine.trackers.gimbal_command import WIDTH
from eyas.engine.traffic.config import Source
from eyas.engine.video.camera_flights import CameraFlights
from eyas.engine.video.logged_flights import LoggedFlight

# Flies the trackers of a recording by a policy of `eyas evaluate`.

_SEEDS = 2**62  # Seeds of policies are below it


class PolicyPilot:
    """Each tracker is flown by a policy of its own, since their episodes begin at different times.

    A policy looks at the start of each control period of its action, as in `eyas evaluate`.

    Args:
        sim: The trackers.
        config: Seed, control frequency, and what policies see if they leave that open.
        name: What the user calls the policy.

    Raises:
        EyasError: There is no such policy, or it cannot be loaded.
    """

    def __init__(self, sim: Simulation, config: EyasConfig, name: str) -> None:
        self._sim, self._seed, self._name = sim, config.seed, name
        changes = config.env.model_dump(
            mode="json", exclude_defaults=True, exclude={"mixture", "log_folder"}
        )
        open_policy = first_brought("eyas.policy_opener")
        if open_policy is None:
            raise ConfigError(f"video.policy: {name!r}: no house here brings policies")
        self._policies: list[Policy] = [open_policy(name, changes) for _ in range(sim.count)]
        env = self._policies[0].env
        self._env, self._observer = env, Observer(env.observation, sim)
        self._actions = make_actions(env)
        self._period = physics_steps(config.control.frequency) * env.action_repeat
        self._commands = np.zeros((sim.count, command_width(env.actions)))
        self._numbers = np.full(sim.count, -1)

    def begin(self, trackers: NDArray[np.int64], longest: int) -> None:
        """Tell the policies of these trackers that an episode begins."""
        episodes = self._sim.snapshot.episodes
        for tracker in trackers.tolist():
            rng = stream(self._seed, "video policy", tracker, int(episodes.number[tracker]))
            seeds = np.array([rng.integers(_SEEDS)])
            boxes = partial(self._first_box, tracker)
            try:
                self._policies[tracker].begin(Start(seeds, boxes, roads=self._roads))
            except Exception as error:  # whatever a user's code raises
                raise self._failed(tracker, Failure.of(error)) from error

    def move(self) -> None:
        """Advance the simulation by one 2 ms step."""
        steps = self._sim.snapshot.episodes.step_count
        deciding = np.flatnonzero(steps % self._period == 0).astype(np.int32)
        if len(deciding):
            self._observer.look(deciding, steps[deciding] == 0)
            for tracker in deciding.tolist():
                self._decide(tracker)
        self._sim.advance(self._commands, 1)

    def action(self, tracker: int) -> RecordedAction:
        """Return a tracker's action in the last step."""
        command = self._commands[tracker]
        turned = None
        if len(command) > WIDTH:
            turned = turn_rates(command[None], self._env.gimbal)[0]
        return RecordedAction(int(self._numbers[tracker]), command[:WIDTH].copy(), turned)

    def _decide(self, tracker: int) -> None:
        sight = PolicyInput(
            self._observed(tracker),
            deciding=np.ones(1, np.bool_),
            snapshot=lambda: self._of(tracker),
            visible=lambda: self._visible(tracker),
            covered=np.zeros(1, np.bool_),
        )
        try:
            decision = self._policies[tracker].act(sight)
        except Exception as error:  # whatever a user's code raises
            raise self._failed(tracker, Failure.of(error)) from error
        for failure in decision.failed.values():
            raise self._failed(tracker, failure)
        try:
            self._commands[tracker] = self._actions.commands([decision.actions[0]])[0]
        except (ActionError, IndexError, KeyError, TypeError) as error:
            raise self._failed(tracker, Failure.of(error, traced=False)) from error
        if self._env.actions.numbered:
            self._numbers[tracker] = int(decision.actions[0])

    def _observed(self, tracker: int) -> Observation:
        """Return the latest observation of a tracker as one of one drone, shape (1, ...)."""
        seen = self._observer.one(tracker)
        return {k: v[None] for k, v in seen.items()} if isinstance(seen, dict) else seen[None]

    def _of(self, tracker: int) -> Snapshot:
        """Return the state of one tracker, as of one drone."""
        parts: list[Any] = list(self._sim.snapshot)  # records of arrays
        rows = slice(tracker, tracker + 1)
        return Snapshot(*(type(part)(*(array[rows] for array in part)) for part in parts))

    def _failed(self, tracker: int, failure: Failure) -> ConfigError:
        return ConfigError(
            f"video.policy: '{self._name}' has failed with tracker {tracker}: {failure.line}"
        )

    def _first_box(self, tracker: int) -> NDArray[np.int32]:
        """Return the true box of a tracker's target in its first picture, see `Start.boxes`."""
        image = self._env.observation
        size = image.height, image.width
        return subjects(self._sim, np.array([tracker], np.int32), size)[1]

    def _roads(self) -> list[RoadNetwork]:
        return [self._sim.scene.network]

    def _visible(self, tracker: int) -> NDArray[np.float64]:
        return visible_shares(subjects(self._sim, np.array([tracker], np.int32))[0])


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
    if is_track(user_path(flight)):
        if why := _no_path(config):
            raise ConfigError(f"{SETTING}: {flight!r} is not possible with {why}")
        tracks_in(user_path(flight))  # raises before anything is built
        return
    if flight not in PATHS.names() and ":" not in flight:
        known = (_EXACT, _RANDOM, *PATHS.names())
        raise UnknownNameError(SETTING, flight, known, others=f"a file {', '.join(endings())}")
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
        case path if is_track(file := user_path(path)):
            return CameraFlights(sim, config, LoggedFlight(file, sim, config))
        case path:
            return CameraFlights(sim, config, path_named(path))
