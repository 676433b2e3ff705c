"""A user's own policy: a function of pictures, or one object for each episode."""

import inspect
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from eyas.benchmark.flight.team_radio import MESSAGE
from eyas.benchmark.policies.box_trackers import Box, BoxTracker, box_tracker
from eyas.benchmark.policies.simple import HOVER
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.own_code import imported, left_out, running, takes
from eyas.engine.envs.observation import Observation
from eyas.engine.policies.policy import Decision, Failure, Policy, PolicyInput, Start, env_config
from eyas.engine.policies.steering import pixel_offset, towards
from eyas.engine.settings.env import EnvConfig

_IN_WORDS = frozenset({"words", "attributes"})
SETTINGS = "env_settings"  # Attribute of a user's policy: changes of the defaults of `env`


class PerEpisodePolicy:
    """Calls one object for each episode.

    Args:
        make: Returns the policy of an episode: a function of its observation, or an object with
            `act(observation)` and, if it wants the target's first box, `reset(box)`; in a team, it
            may `hear(messages)` before and `say()` after it acts.
        env: What it sees, and what its actions mean.
        path: Where its code is, for messages.
        told: What its `reset` asks for.
    """

    sampled = False

    def __init__(
        self, make: Callable[[], Any], env: EnvConfig, path: str, told: frozenset[str] = frozenset()
    ) -> None:
        self.env, self._make, self._path, self.told = env, make, path, told

    def begin(self, start: Start) -> None:
        """Make the policy of each episode; a box tracker gets the box in its first picture."""
        with running("--policy", self._path):
            self._own = [self._make() for _ in start.seeds]
            self._said = np.full((len(self._own), MESSAGE), np.nan)
            if self.told:
                self._tell(start)

    def _tell(self, start: Start) -> None:
        """Give each policy what the parameters of its `reset` ask for."""
        names = self.told
        words = names & _IN_WORDS
        boxes = start.boxes().tolist() if "box" in names else None
        for row, own in enumerate(self._own):
            if not words:
                assert boxes is not None
                own.reset(tuple(boxes[row]))
                continue
            told: dict[str, Any] = {} if boxes is None else {"box": tuple(boxes[row])}
            if "words" in names:
                told["words"] = "" if start.told is None else start.told.words[row]
            if "attributes" in names:
                told["attributes"] = (
                    None if start.told is None else start.told.attributes[row].copy()
                )
            own.reset(**told)

    def act(self, sight: PolicyInput) -> Decision:
        """Ask the policies of those who decide."""
        actions: list[Any] = [no_action(self.env)] * len(self._own)
        failed = {}
        messages = None if sight.heard is None else self._said
        for row in np.flatnonzero(sight.deciding).tolist():
            own = self._own[row]
            try:
                if sight.heard is not None and hasattr(own, "hear"):
                    own.hear(sight.heard[row].copy())
                actions[row] = getattr(own, "act", own)(one_of(sight.observation, row))
                if messages is not None and hasattr(own, "say"):
                    messages[row] = own.say()
            except KeyboardInterrupt:
                raise
            except BaseException as error:  # whatever a user's code raises ends only its episode
                failed[row] = Failure.of(error)
        return Decision(actions, failed, messages)


class BatchedFunction:
    """Calls one function with the observations of all episodes; it cannot tell them apart."""

    sampled = False
    told: frozenset[str] = frozenset()

    def __init__(self, function: Callable[[Any], Any], env: EnvConfig, path: str) -> None:
        self.env, self._function, self._path = env, function, path

    def begin(self, start: Start) -> None:
        """No-op: a function is stateless."""

    def act(self, sight: PolicyInput) -> Decision:
        """Call the function."""
        with running("--policy", self._path):
            return Decision(self._function(sight.observation))


def _asked_for(found: type) -> frozenset[str]:
    """Return what the `reset` of a class wants to be told: the first box, unless it names words."""
    reset = getattr(found, "reset", None)
    if reset is None:
        return frozenset()
    names = frozenset(inspect.signature(reset).parameters)
    wanted = names & (_IN_WORDS | {"box"})
    return wanted if wanted & _IN_WORDS else frozenset({"box"})


def no_action(env: EnvConfig) -> Any:  # noqa: ANN401  # a number, or several
    """Return the action that does nothing."""
    return HOVER if env.actions.numbered else np.zeros(env.actions.size)


def one_of(observation: Observation, row: int) -> Observation:
    """Return a copy of the observation of one episode."""
    if isinstance(observation, dict):
        return {name: part[row].copy() for name, part in observation.items()}
    copied: Observation = observation[row].copy()
    return copied


def load_callable(path: str, changes: Mapping[str, Any]) -> Policy:
    """Return a user's policy; raise ConfigError if there is no such thing, or it is none of these.

    Args:
        path: `package.module:name` of a function of one observation; of a function whose attribute
            `batched` is true, of observations with a leading axis; of a class with `act`; of a
            subclass of `Policy`, or a class with its `begin` and `act`, one object of which flies
            all episodes; of a box tracker, a class with `begin` and `update`; or of an agent that
            answers with a way to fly, a class with `plan`.
        changes: Changes of `env`; those in the attribute `env_settings` come first.

    Raises:
        ConfigError: There is no such thing, or it is none of these.
    """
    try:
        found: Any = imported(path, "--policy")
    except ImportError as error:
        raise ConfigError(f"--policy: '{path}' cannot be imported: {error}") from error
    if hasattr(found, "begin") and hasattr(found, "update"):
        from eyas.benchmark.policies.own_policy import pilot

        return pilot(path, changes)
    made = inspect.isclass(found)
    if made and hasattr(found, "plan"):
        from eyas.benchmark.policies.waypoints import own_agent

        return own_agent(found, changes, path)
    fits = callable(found) and not (made and left_out(found, ["act"]))
    if not fits or takes(found, *() if made else (None,)):
        raise ConfigError(
            f"--policy: '{path}' is not allowed: a function of an observation, or a class with "
            "act(observation)"
        )
    env = env_config(getattr(found, SETTINGS, {}), changes)
    if made and hasattr(found, "begin"):
        return _together(found, env, path)
    if made:
        return PerEpisodePolicy(found, env, path, _asked_for(found))
    if getattr(found, "batched", False):
        return BatchedFunction(found, env, path)
    return PerEpisodePolicy(lambda: found, env, path)


def _together(found: type, env: EnvConfig, path: str) -> Policy:
    """Return a user's policy that flies all episodes, with what it sees as it was chosen.

    It is never sampled: the seeds of the episodes, which would tell all of them, are not told.
    """
    with running("--policy", path):
        policy: Policy = found()
    policy.env, policy.sampled = env, False
    policy.told = frozenset(getattr(policy, "told", ()))
    return policy


# A box tracker that flies: it gets the target's true first box, a controller steers to its box.

_SIZE = 240, 320  # Height and width of the pictures


class BoxPilot:
    """Tracks one target; hovers while it is lost."""

    def __init__(self, make: Callable[[], BoxTracker], env: EnvConfig) -> None:
        self._tracker, self._env = make(), env
        self._first: Box | None = None

    def reset(self, box: tuple[int, int, int, int]) -> None:
        """Remember the box of the first picture: left, top, right, bottom."""
        left, top, right, bottom = box
        self._first = left, top, right - left, bottom - top

    def act(self, picture: Any) -> int:  # noqa: ANN401  # an array
        """Track, and steer to the middle of the box."""
        box = self._first
        if box is not None:
            self._tracker.begin(picture, box)
            self._first = None
        else:
            box = self._tracker.update(picture)
        if box is None:
            return int(towards(np.zeros((1, 2)), self._env)[0])
        middle = np.array([box[0] + 0.5 * box[2]]), np.array([box[1] + 0.5 * box[3]])
        return int(towards(pixel_offset(*middle, _SIZE), self._env)[0])


def pilot(said: str, changes: Mapping[str, Any]) -> PerEpisodePolicy:
    """Return the policy of a box tracker.

    Args:
        said: A name of `BOX_TRACKERS`, or `package.module:Class`.

    Raises:
        EyasError: The box tracker cannot be used here.
    """
    make = box_tracker(said, "--policy")
    image = {"width": _SIZE[1], "height": _SIZE[0], "layout": "hwc", "colours": "rgb", "frames": 1}
    fixed = {"observation": image, "actions": "discrete"}
    env = env_config({**fixed, "action_repeat": 4}, {**changes, **fixed})
    return PerEpisodePolicy(lambda: BoxPilot(make, env), env, said, frozenset({"box"}))


csrt, kcf, mosse = (partial(pilot, name) for name in ("csrt", "kcf", "mosse"))
medianflow, nano, stay = (partial(pilot, name) for name in ("medianflow", "nano", "stay"))
