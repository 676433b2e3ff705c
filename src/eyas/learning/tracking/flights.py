"""Flights that the tracker learns from: who flies them, on all maps, in all weathers."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.policies.tracker.tracker import Tracker
from eyas.benchmark.protocols.lasting import LONG
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.rng import stream
from eyas.engine.policies.policy import Decision, PolicyInput, Start
from eyas.engine.settings.env import EnvConfig
from eyas.engine.targets.config import TargetName
from eyas.lanes import exact
from eyas.learning.tracking.lessons import Shots, projected

Floats = NDArray[np.float64]

PERIOD = 0.128  # Time between two pictures [s]
_FORGETS = 1.5  # Time constant of the oracle's disturbance [s]

_LOST, _PATIENCE = 3.0, (1.5, 10.0)
"""A pupil is lost whose filter is off by more than this [m] for longer than this [s]: soon, to see
more of its target, or late, to wait for it among others."""

_PATIENT = 0.3  # Share of those who are found late
_AT_RANDOM = 0.01  # Share of the looks at which a pupil is corrected, lost or not


class Oracle:
    """Flies to the target's true place beside a wandering disturbance."""

    sampled = False
    told = frozenset({"truth"})

    def __init__(self, env: EnvConfig, rng: np.random.Generator) -> None:
        self.env = env.model_copy(update={"action_repeat": round(PERIOD / 0.008)})
        self._rng = rng
        self.shots: list[Shots] = []

    def begin(self, start: Start) -> None:
        """Draw how strongly each drone is disturbed."""
        count = len(start.seeds)
        self._strength = np.exp(self._rng.uniform(np.log(0.3), np.log(4.0), (count, 1)))
        self._aside = np.zeros((count, 2))

    def act(self, sight: PolicyInput) -> Decision:
        """Keep the picture, and fly."""
        state = sight.snapshot()
        count = len(self._aside)
        unknown = np.full((count, 2), np.nan, np.float32)
        self.shots.append(_shot(self.env, sight, (unknown, unknown[:, 0])))
        step = PERIOD / _FORGETS
        self._aside += self._strength * np.sqrt(2.0 * step) * self._rng.standard_normal((count, 2))
        self._aside -= step * self._aside
        error = state.targets.centre[:, :2] - state.episodes.view_centre[:, :2]
        yaw = state.trackers.euler[:, 2]
        command = _body(state.targets.velocity[:, :2], yaw)
        command += (_body(error, yaw) + self._aside) * (0.6 / PERIOD)
        return Decision(np.concatenate((command, np.zeros((count, 2))), axis=1))


class Pupil:
    """Lets the tracker fly; sets its filter right when it has been lost for a while."""

    sampled = False
    told = frozenset({"box", "truth"})

    def __init__(self, tracker: Tracker, rng: np.random.Generator) -> None:
        self._tracker, self._rng, self.env = tracker, rng, tracker.env
        self.shots: list[Shots] = []

    def begin(self, start: Start) -> None:
        """Begin with the first boxes."""
        self._tracker.begin(start)
        count = len(start.seeds)
        self._lost = np.zeros(count)
        self._patience = np.where(self._rng.random(count) < _PATIENT, *_PATIENCE[::-1])
        self._next = 0.0

    def act(self, sight: PolicyInput) -> Decision:
        """Fly, and keep a picture now and then."""
        assert sight.clock is not None
        decision = self._tracker.act(sight)
        if sight.clock >= self._next - 1e-9:
            self._next = sight.clock + PERIOD
            clue = self._tracker.expected, self._tracker.spread
            self.shots.append(_shot(self.env, sight, clue))
            self._correct(sight)
        return decision

    def _correct(self, sight: PolicyInput) -> None:
        """Set the filters of lost ones right."""
        targets, motion = sight.snapshot().targets, self._tracker.motion
        away = motion.place - targets.centre[:, :2]
        off = np.asarray(exact.hypot(away[:, 0], away[:, 1]))
        self._lost = np.where(off > _LOST, self._lost + PERIOD, 0.0)
        back = (self._lost > self._patience) | (self._rng.random(len(off)) < _AT_RANDOM)
        rows = np.flatnonzero(back & sight.deciding)
        self._lost[rows] = 0.0
        wrong = self._rng.uniform(0.2, 2.0)
        noise = wrong * self._rng.standard_normal((2, len(rows), 2))
        place, velocity = targets.centre[rows, :2], targets.velocity[rows, :2]
        speed = np.minimum(motion.acceleration[rows], wrong)
        motion.begin(rows, place + noise[0], velocity + noise[1], wrong, speed)
        self._tracker.left[rows] = motion.place[rows]
        self._tracker.course.forget(rows)


def _shot(
    env: EnvConfig, sight: PolicyInput, clue: tuple[NDArray[np.floating], NDArray[np.floating]]
) -> Shots:
    image = env.observation
    return Shots(
        sight.observation["image"].copy(),
        projected(sight.snapshot(), (image.height, image.width)),
        sight.visible().astype(np.float32),
        clue[0].astype(np.float32),
        clue[1].astype(np.float32),
        sight.deciding.copy(),
    )


def _body(vectors: Floats, yaw: Floats) -> Floats:
    """Return vectors of the level, ahead and to the left, shape (N, 2)."""
    sine, cosine = exact.sin(yaw), exact.cos(yaw)
    ahead = cosine * vectors[:, 0] + sine * vectors[:, 1]
    return np.stack((ahead, cosine * vectors[:, 1] - sine * vectors[:, 0]), axis=-1)


Pilot = Oracle | Pupil

MAPS = ("citystreet", "downtown", "village", "lake", "desert", "farmland")
"""The first three are flown twice as often: there is more to hide behind."""

WEATHERS = ("day", "night", "foggy", "snow")
_TURN = (MAPS[0], MAPS[1], MAPS[2], MAPS[3], MAPS[0], MAPS[1], MAPS[2], MAPS[4], MAPS[5])
_FLIGHTS = 8  # Flights for each weather of a batch
_WORLDS = 4  # Worlds for each batch of traffic without flights
_STEPS = 5_000  # Length of a flight [2 ms]
_OTHERS = {TargetName.SUMO_VEHICLE, TargetName.QUADROTOR}
_WALKERS = tuple(name for name in TargetName if name not in _OTHERS)
_WALKING = 0.2  # Share of the flights with a target other than a vehicle
_ALIKE = 0.15  # Share of the batches in which all vehicles look like the target
_HIDING = 0.5  # Share of a pupil's batches on maps with covers in which drivers hide
_COVERED = "citystreet", "village"  # Maps for which traffic with such drivers comes with Eyas
_LATENCIES = ("0", "0", "40", "80")  # Latencies of a pupil [ms]
_SEEDS = 2**40  # Range of the seeds of episodes, which tests draw below 100,000,000

_TRAFFIC: tuple[dict[str, Any], ...] = (
    {"demand": "respawn", "group_size": 12},
    {"demand": "respawn", "group_size": 40},
    {"demand": "keep_alive"},
)
_HIDDEN = {"demand": "keep_alive", "drivers": "hiding"}


def flown(
    make: Callable[[np.random.Generator], Pilot],
    batches: range,  # Numbers of the batches; each depends on its number and the seed only
    seed: int,
) -> Iterator[Shots]:
    """Yield the pictures of batches of flights."""
    for number in batches:
        rng = stream(seed, "tracking flights", number)
        pilot = make(rng)
        pupil = isinstance(pilot, Pupil)
        hides = pupil and _TURN[number % len(_TURN)] in _COVERED and rng.random() < _HIDING
        protocol = protocol_of_batch(rng, varied=not pupil, hides=bool(hides))
        late = str(rng.choice(_LATENCIES)) if pupil else "0"
        flight = BatchFlight(_episodes(rng, number), protocol, pilot, delay_from(late))
        for _ in flight.fly():
            pass
        yield Shots.of(pilot.shots)


def protocol_of_batch(rng: np.random.Generator, *, varied: bool, hides: bool = False) -> Protocol:
    """Return the settings of a batch; `varied`: with other heights and pitches; `hides`: with
    drivers who hide.
    """
    traffic = _TRAFFIC[rng.integers(len(_TRAFFIC))]
    changes: dict[str, Any] = {
        "traffic": _HIDDEN if hides else traffic,
        "done": {"total_steps": _STEPS},
        "light": {"sun": {"uniform": [-0.3, 0.3]}},
    }
    if varied:
        changes["start"] = {"height": {"uniform": [18.0, 25.0]}, "pitch": {"uniform": [1.25, 1.42]}}
    protocol = LONG.changed(changes)
    return replace(protocol, alike=bool(rng.random() < _ALIKE), tells_solvable=False)


def _episodes(rng: np.random.Generator, number: int) -> list[EpisodeSpec]:
    """Return the episodes of a batch, on one map in all weathers."""
    episodes = []
    for weather in WEATHERS:
        walks = rng.random() < _WALKING
        target = str(rng.choice(_WALKERS)) if walks else TargetName.SUMO_VEHICLE.value
        place = Place(_TURN[number % len(_TURN)], weather, target)
        for _ in range(_FLIGHTS):
            direction = float(rng.uniform(-np.pi, np.pi))
            episodes.append(EpisodeSpec(place, direction, int(rng.integers(2**30, _SEEDS))))
    return episodes


def episodes_by_day(rng: np.random.Generator, number: int) -> list[EpisodeSpec]:
    """Return where and when vehicles are on one map, by day; arguments as those of a batch."""
    place = Place(_TURN[number % len(_TURN)], "day", TargetName.SUMO_VEHICLE.value)
    return [EpisodeSpec(place, 0.0, int(rng.integers(2**30, _SEEDS))) for _ in range(_WORLDS)]
