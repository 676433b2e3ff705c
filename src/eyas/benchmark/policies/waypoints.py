"""Slow agents, such as models of language and vision: one looks at the last pictures now and then,
answers after a while with a way to fly, and the drone flies it meanwhile.
"""

import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from inspect import signature
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.config import shown
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.own_code import running
from eyas.engine.policies.policy import Decision, Failure, PolicyInput, Start, env_config
from eyas.engine.policies.steering import PERIOD, pixel_offset
from eyas.engine.settings.env import ActionKind, EnvConfig, ObservationPart
from eyas.engine.task.packet_rows import FLOWN_STATE
from eyas.lanes import exact

Floats = NDArray[np.float64]
Picture = NDArray[np.uint8]

_IMAGE, _SENSORS = ObservationPart.IMAGE.value, ObservationPart.SENSORS.value
_AHEAD = 0.25  # How far ahead on its way a drone aims [s]
_MOST = 200  # Largest number of points in an answer
_FURTHEST = 1e4  # Largest distance and speed in an answer [m, m/s]
_LIMITS = {"rate": (0.01, 125.0), "pictures": (1, 64), "step": (0.01, 60.0)}


class Way(NamedTuple):
    """An answer: a way in the frame of the drone as it was when the last picture was taken."""

    points: Floats
    """Ahead, left, up [m], and turn to the left [rad], shape (K, 4); of a velocity one row [m/s,
    rad/s]."""
    step: float  # Time from one point to the next, and to the first [s]; 0: `points` is a velocity


def way_of(answer: object, step: float, size: tuple[int, int]) -> Way | None:
    """Return the way of an agent's answer; None: it goes on as before.

    Args:
        answer: None; an array of points; or a mapping with `waypoints` (x, y; x, y, turn; or x, y,
            z, turn each, in metres ahead, left and up, and radians to the left) and perhaps `step`
            [s]; or with `velocity` (ahead, left, up [m/s], turn [rad/s]); or with `box` of the
            target in the last picture (left, top, width, height [pixels]).
        step: Time between points where the answer has none [s].
        size: Height and width of the picture [pixels].

    Raises:
        ValueError: It is something else; one line.
    """
    if answer is None:
        return None
    told = answer if isinstance(answer, Mapping) else {"waypoints": answer}
    if "velocity" in told:
        return Way(_numbers(told["velocity"], "velocity", (4,))[None], 0.0)
    if "box" in told:
        left, top, width, height = _numbers(told["box"], "box", (4,)).tolist()
        middle = np.array([left + 0.5 * width]), np.array([top + 0.5 * height])
        ahead, aside = pixel_offset(*middle, size)[0].tolist()
        return Way(np.array([[ahead, aside, 0.0, 0.0]]), step)
    if "waypoints" not in told:
        raise ValueError(f"{shown(sorted(map(str, told)))}: no waypoints, velocity or box")
    own = told.get("step", step)
    low, high = _LIMITS["step"]
    if not isinstance(own, int | float) or not low <= own <= high:
        raise ValueError(f"step: {shown(own)} is not allowed: {low:g} to {high:g} s")
    rows = told["waypoints"]
    if not isinstance(rows, list | tuple | np.ndarray):
        raise ValueError(f"waypoints: {shown(rows)} is not allowed: a list of points")
    if len(rows) > _MOST:
        raise ValueError(f"waypoints: {len(rows)}; allowed: up to {_MOST}")
    if len(rows) == 0:
        return None
    points = np.zeros((len(rows), 4))
    columns = {2: [0, 1], 3: [0, 1, 3], 4: [0, 1, 2, 3]}
    for row, point in enumerate(rows):
        count = len(point) if isinstance(point, list | tuple | np.ndarray) else 0
        if count not in columns:
            raise ValueError("waypoints: 2, 3 or 4 numbers each")
        points[row, columns[count]] = _numbers(point, "waypoints", (count,))
    return Way(points, float(own))


def _numbers(values: object, name: str, shape: tuple[int, ...]) -> Floats:
    try:
        found = np.asarray(values, np.float64)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape != shape or not (np.abs(found) <= _FURTHEST).all():  # also what is no number
        raise ValueError(f"{name}: {shown(values)} is not allowed: {shape[0]} finite numbers")
    return found


class Look(NamedTuple):
    """What an agent is asked with."""

    pictures: Picture  # The last K, the newest last, shape (K, H, W, 3); before the first, black
    words: str  # The instruction, if `begin` takes `words`; empty where the protocol has none
    time: float  # Since the start of the flight [s]
    state: Floats
    """Position [m], velocity [m/s] and orientation (w, x, y, z) by the sensors, world frame, shape
    (10,): `observation.state` of exports in LeRobot's format."""


class _Flight:
    """One drone: where it is by its own commands, what it was answered, and what it waits for."""

    def __init__(self, agent: Any, words: str, box: tuple[int, ...] | None) -> None:  # noqa: ANN401
        self.agent, self.words, self.box = agent, words, box
        self.pose = np.zeros(4)  # East of its first heading, north of it, up [m], turn [rad]
        self.command = np.zeros(4)  # Last, in its own frame [m/s, rad/s]
        self.moved_at = 0.0
        self.asks_at = 0.0
        self.pictures: deque[Picture] = deque(maxlen=agent.pictures)
        self.waiting: tuple[float, Way, Floats, float] | None = None
        """When the answer comes [s], the answer, where it looked from, and when it looked [s]."""
        self.way: tuple[Way, Floats, float] | None = None

    def move(self, now: float) -> None:
        """Count where the last command has brought the drone."""
        time, self.moved_at = now - self.moved_at, now
        self.pose = self.pose + time * _turned(self.command, float(self.pose[3]))

    def steer(self, now: float) -> Floats:
        """Return the command at a time: ahead, left, up [m/s], turn [rad/s], shape (4,)."""
        if self.waiting is not None and now >= self.waiting[0] - 1e-9:
            _, way, origin, looked = self.waiting
            self.way, self.waiting = (way, origin, looked), None
        if self.way is None:
            self.command = np.zeros(4)
        elif self.way[0].step == 0.0:
            self.command = self.way[0].points[0]
        else:
            way, origin, looked = self.way
            own = np.concatenate([np.zeros((1, 4)), way.points])
            own = origin + np.stack([_turned(point, float(origin[3])) for point in own])
            at = way.step * np.arange(len(own))
            goal = [np.interp(now - looked + _AHEAD, at, column) for column in own.T]
            self.command = _turned((np.array(goal) - self.pose) / _AHEAD, -float(self.pose[3]))
        return self.command


def _turned(vector: Floats, by: float) -> Floats:
    """Return ahead, left, up and turn in a frame that is turned to the right by an angle [rad]."""
    cosine, sine = float(exact.cos(by)), float(exact.sin(by))
    x, y, z, turn = vector.tolist()
    return np.array([cosine * x - sine * y, sine * x + cosine * y, z, turn])


class WaypointPolicy:
    """Flies one agent for each episode.

    Args:
        make: Returns the agent of an episode. Its `plan(look)` returns what `way_of` takes; its
            `begin(words)` or `begin(box)` is called first, if it has one. Attributes: `rate` at
            which it looks [Hz], `latency` from the look to its answer [s] or `"measured"`,
            `pictures` that it gets, `step` between points [s], `size` of pictures (width, height).
        example: What has its attributes, such as its class.
        changes: Changes of `env`.
        name: What it is called in messages.
        threads: Number of agents that are asked at once; for those that wait for another machine.
    """

    sampled = False

    def __init__(
        self,
        make: Callable[[], Any],
        example: object,
        changes: Mapping[str, Any],
        name: str,
        threads: int = 1,
    ) -> None:
        self.told = _checked(example)
        width, height = getattr(example, "size", USUAL["size"])
        fixed = {
            "actions": ActionKind.VELOCITY,
            "observation": {"parts": [_IMAGE, _SENSORS], "width": width, "height": height,
                            "layout": "hwc", "colours": "rgb", "frames": 1},
        }  # fmt: skip
        self.env: EnvConfig = env_config({"action_repeat": 4}, {**changes, **fixed})
        self._make, self._name, self._size, self._threads = make, name, (height, width), threads

    def begin(self, start: Start) -> None:
        """Make the agent of each episode."""
        boxes = start.boxes().tolist() if "box" in self.told else None
        words = [""] * len(start.seeds)
        if start.told is not None and "words" in self.told:
            words = list(start.told.words)
        with running("--policy", self._name):
            self._flights = [
                _Flight(self._make(), words[row], None if boxes is None else tuple(boxes[row]))
                for row in range(len(start.seeds))
            ]
            for flight in self._flights:
                if hasattr(flight.agent, "begin"):
                    own = {"words": flight.words, "box": flight.box}
                    flight.agent.begin(**{name: own[name] for name in self.told})
        self._steps = np.zeros(len(start.seeds))

    def act(self, sight: PolicyInput) -> Decision:
        """Ask those whose time it is, and fly on."""
        seen = sight.observation
        assert isinstance(seen, dict), "two parts"
        pictures, states = seen[_IMAGE], seen[_SENSORS][:, FLOWN_STATE]
        actions = np.zeros((len(self._flights), 4))
        failed: dict[int, Failure] = {}
        asked: list[tuple[int, float]] = []
        rows = np.flatnonzero(sight.deciding).tolist()
        now = [0.0] * len(self._flights)
        for row in rows:
            own = self._steps[row] * self.env.action_repeat * PERIOD
            now[row] = own if sight.clock is None else float(sight.clock)
            self._steps[row] += 1
            flight = self._flights[row]
            flight.move(now[row])
            if sight.told is not None and "words" in self.told:
                flight.words = sight.told.words[row]
            if now[row] >= flight.asks_at - 1e-9 and flight.waiting is None:
                flight.asks_at = max(flight.asks_at + 1.0 / flight.agent.rate, now[row])
                flight.pictures.append(np.array(pictures[row]))
                asked.append((row, now[row]))
        answers = self._answers([(*each, states[each[0]]) for each in asked])
        for (row, when), answer in zip(asked, answers, strict=True):
            if isinstance(answer, Failure):
                failed[row] = answer
            elif answer[0] is not None:
                flight = self._flights[row]
                flight.waiting = (when + answer[1], answer[0], flight.pose.copy(), when)
        for row in rows:
            actions[row] = self._flights[row].steer(now[row])
        return Decision(actions, failed)

    def _answers(
        self, asked: Sequence[tuple[int, float, Floats]]
    ) -> list[tuple[Way | None, float] | Failure]:
        """Return the answer of each agent with its latency [s], or how it failed."""
        if self._threads == 1 or len(asked) < 2:
            return [self._answer(*each) for each in asked]
        with ThreadPoolExecutor(min(self._threads, len(asked))) as pool:
            return list(pool.map(lambda each: self._answer(*each), asked))

    def _answer(self, row: int, when: float, state: Floats) -> tuple[Way | None, float] | Failure:
        flight = self._flights[row]
        agent = flight.agent
        shape = (agent.pictures, *self._size, 3)
        pictures = np.zeros(shape, np.uint8)
        pictures[agent.pictures - len(flight.pictures) :] = np.stack(flight.pictures)
        begun = time.perf_counter()
        try:
            answer = agent.plan(Look(pictures, flight.words, when, state))
            taken = time.perf_counter() - begun
            way = way_of(answer, agent.step, self._size)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # whatever a user's code raises ends only its episode
            return Failure.of(error)
        return way, taken if agent.latency == "measured" else float(agent.latency)


def _checked(agent: object) -> frozenset[str]:
    """Return what the `begin` of an agent wants to know.

    Raises:
        ConfigError: An attribute is out of range.
    """
    for name, usual in USUAL.items():
        value = getattr(agent, name, usual)
        low, high = _LIMITS.get(name, (0.0, 600.0))
        try:
            if name == "size":
                fits = len(value) == 2 and all(8 <= each <= 2048 for each in value)
            else:
                fits = (name == "latency" and value == "measured") or low <= value <= high
        except TypeError:
            fits = False
        if not fits:
            raise ConfigError(f"--policy: {name} = {shown(value)} is not allowed")
    begin = getattr(agent, "begin", None)
    asked = frozenset() if begin is None else frozenset(signature(begin).parameters)
    return asked & {"words", "box"}


USUAL: Mapping[str, Any] = {
    "rate": 2.0,
    "latency": 0.0,
    "pictures": 1,
    "step": 0.5,
    "size": (320, 240),
}
"""Attributes of an agent that has none of its own."""


def own_agent(found: type, changes: Mapping[str, Any], path: str) -> WaypointPolicy:
    """Return the policy of a user's agent, a class with `plan`.

    Raises:
        ConfigError: It is made of something, or an attribute is out of range.
    """
    for name, value in USUAL.items():
        if not hasattr(found, name):
            setattr(found, name, value)
    own = {**getattr(found, "env_settings", {}), **changes}
    return WaypointPolicy(found, found, own, path)
