"""Oracles that are told where the target is only while their camera sees it, and go on from there.

They are as good as a policy can be that sees perfectly: what they cannot know, nobody can.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.oracle_commands import actions_of_oracles, flown_over
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.policies.policy import BLIND, COME_BACK, Decision, PolicyInput, Start, env_config

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

ENOUGH = 0.15  # Share of the target that must be visible: of a car, about the pixels of its bonnet

_LOOK_TICKS = 16
"""Physics steps between two looks at what is visible: as often as the figures count pixels, so
that both share one picture."""


_FASTEST = 30.0  # What moves faster has not moved, but is another guess [m/s]


class LastMotion(NamedTuple):
    """How targets moved when they were last seen."""

    place: Floats  # Centre of each, east and north [m], shape (N, 2)
    velocity: Floats  # [m/s], shape (N, 2)
    yaw: Floats  # Heading [rad], shape (N,)
    turn_rate: Floats  # [rad/s], shape (N,)

    @classmethod
    def create(cls, count: int) -> "LastMotion":
        """Return the motion of targets that nobody has seen."""
        return cls(np.zeros((count, 2)), np.zeros((count, 2)), np.zeros(count), np.zeros(count))


class Clue(NamedTuple):
    """What is known of N targets at an instant."""

    last: LastMotion  # Before the first sighting: place is the middle of the first picture
    age: Floats  # Time since it was seen, or since the start [s], shape (N,); 0: it is seen
    known: Mask  # Whether it has been seen, shape (N,)
    middle: Floats  # Ground point in the middle of the picture, east and north [m], shape (N, 2)
    yaw: Floats  # Heading of the drone [rad], shape (N,)
    covered: Mask  # True if the camera is covered, shape (N,)


class _Flown(NamedTuple):
    """Where an oracle has flown to."""

    places: Floats  # [m], shape (N, 2)
    age: Floats  # See `Clue` [s], shape (N,)


class Predictor(Protocol):
    """Says where targets are that are out of sight."""

    def begin(self, start: Start) -> None:
        """Forget everything: N episodes begin."""
        ...

    def places(self, clue: Clue) -> Floats:
        """Return where the targets should be, east and north [m], shape (N, 2)."""
        ...


class SightOracle:
    """Flies to the target's true place while enough of it is visible, else to where it should be.

    Attributes:
        clue: What it knew when it last acted.
    """

    sampled = False
    told = frozenset({"truth"})

    def __init__(self, changes: Mapping[str, Any], predictor: Predictor) -> None:
        self.env = env_config(
            BLIND, {**changes, "actions": actions_of_oracles(changes.get("actions"))}
        )
        self._predictor = predictor

    def begin(self, start: Start) -> None:
        """Forget the targets."""
        count = len(start.seeds)
        self._last = LastMotion.create(count)
        self._levels = np.zeros((count, 2))  # See `flown_over`
        self._begun = np.zeros((count, 2))  # Middle of each first picture [m], shape (N, 2)
        self._known = np.zeros(count, np.bool_)
        self._sees = np.zeros(count, np.bool_)
        self._seen_at = np.full(count, -1)
        """Physics step at which each was seen last, or at which it began; -1: it has not begun."""
        self._looked_at = np.full(count, -_LOOK_TICKS)
        self._before = _Flown(np.zeros((count, 2)), np.zeros(count))
        self._predictor.begin(start)

    def forget(self, ended: Mask) -> None:
        """Forget the targets of episodes that have ended, shape (N,)."""
        self._known[ended] = self._sees[ended] = False
        self._seen_at[ended], self._looked_at[ended] = -1, -_LOOK_TICKS

    def act(self, sight: PolicyInput) -> Decision:
        """Fly there."""
        state = sight.snapshot()
        trackers, _, _, episodes, _ = state
        tick, middle, yaw = episodes.tick, episodes.view_centre[:, :2], trackers.euler[:, 2]
        new = self._seen_at < 0
        self._last.place[new], self._seen_at[new] = middle[new], tick[new]
        self._levels[new, 0] = (trackers.position - episodes.start_offset[:, :3])[new, 2]
        self._begun[new] = middle[new]
        self._look(sight)
        self.clue = clue = Clue(
            self._last,
            (tick - self._seen_at) * PHYSICS_STEP,
            self._known,
            middle,
            yaw,
            sight.covered,
        )
        places = self._places(clue, sight)
        if sight.told is not None:
            home = np.array([words == COME_BACK for words in sight.told.words])
            places = np.where(home[:, None], self._begun, places)
        speeds = self._speeds(places, clue)
        return Decision(flown_over(state, places, speeds, self._levels, self.env))

    def _speeds(self, places: Floats, clue: Clue) -> Floats:
        """Return how fast the places move to which it flies [m/s], shape (N, 2): where it guesses,
        as far as they have moved since the last action; a guess that jumps stands.
        """
        time = (clue.age - self._before.age)[:, None]
        moved = (places - self._before.places) / np.where(time > 0.0, time, np.inf)
        moved[np.square(moved).sum(axis=1) > _FASTEST * _FASTEST] = 0.0
        self._before = _Flown(places, clue.age)
        return np.where((clue.age == 0.0)[:, None], clue.last.velocity, moved)

    def _places(self, clue: Clue, sight: PolicyInput) -> Floats:
        """Return where to fly, east and north [m], shape (N, 2)."""
        return self._predictor.places(clue)

    def _look(self, sight: PolicyInput) -> None:
        """Remember how the targets move that are visible."""
        _, _, targets, episodes, _ = sight.snapshot()
        due = sight.deciding & (episodes.tick - self._looked_at >= _LOOK_TICKS)
        if due.any():
            self._sees[due] = sight.visible()[due] >= ENOUGH
            self._looked_at[due] = episodes.tick[due]
        seen, last = self._sees & sight.deciding, self._last
        last.place[seen] = targets.centre[seen, :2]
        last.velocity[seen] = targets.velocity[seen, :2]
        last.yaw[seen], last.turn_rate[seen] = targets.yaw[seen], targets.yaw_rate[seen]
        self._levels[:, 1] = 0.0  # what is out of sight keeps its height
        self._levels[seen, 0] = targets.centre[seen, 2]
        self._levels[seen, 1] = targets.velocity[seen, 2]
        self._seen_at[seen] = episodes.tick[seen]
        self._known |= seen
