"""Where a hidden target should be: further straight on, or along the lanes of the map.

All are baselines: they neither turn with a target nor search for it.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.lane_graph import SPACING, Lanes
from eyas.benchmark.policies.sighted import Clue, SightOracle
from eyas.engine.policies.policy import Start
from eyas.lanes import exact

Floats = NDArray[np.float64]


class ConstantVelocity:
    """The target goes on at its last velocity."""

    def begin(self, start: Start) -> None:
        """No-op: this predictor is stateless."""

    def places(self, clue: Clue) -> Floats:
        """Return where the targets are after going straight on, shape (N, 2)."""
        places: Floats = clue.last.place + clue.last.velocity * clue.age[:, None]
        return places


class StraightAndWait:
    """The target goes straight on for a distance, and is waited for there.

    45 m is the length of the covers of the village: a floor that a policy in `recover` must be
    above, as the two others never wait. `recover-wide` has covers for which no distance is right.
    """

    def __init__(self, distance: float) -> None:  # [m]
        self._distance = distance

    def begin(self, start: Start) -> None:
        """No-op: this predictor is stateless."""

    def places(self, clue: Clue) -> Floats:
        """Return where the targets are waited for, shape (N, 2)."""
        speed = np.asarray(exact.hypot(*clue.last.velocity.T))
        time = np.minimum(clue.age, self._distance / np.maximum(speed, 1e-3))
        places: Floats = clue.last.place + clue.last.velocity * time[:, None]
        return places


class AlongLanes:
    """The target goes on at its last speed in its lane, or straight on where there is none."""

    def begin(self, start: Start) -> None:
        """Take the lanes of the maps."""
        self._lanes = Lanes(start.roads())
        count = len(start.seeds)
        self._point = np.full(count, -1)
        """Last point of its lane that each hidden target has passed; -1: it is in no lane."""
        self._past = np.zeros(count)
        """Distance past that point [m]."""
        self._age = np.zeros(count)
        """Age of each target when it was last moved [s]."""
        self._straight = ConstantVelocity()

    def places(self, clue: Clue) -> Floats:
        """Return where the targets are in their lanes, shape (N, 2)."""
        places = self._straight.places(clue)
        graph, last = self._lanes.graph, clue.last
        for row in np.flatnonzero(clue.known & (clue.age > 0.0) & (self._age == 0.0)).tolist():
            found = self._lanes.near(row, last.place[row], float(last.yaw[row]))
            self._point[row], self._past[row] = found[0] if len(found) else -1, 0.0
        self._past += exact.hypot(*last.velocity.T) * (clue.age - self._age)
        self._age = np.where(clue.known, clue.age, 0.0)
        while (far := self._past >= SPACING).any():
            self._past[far] -= SPACING
            self._point[far] = graph.after[self._point[far], 0]
        inside = clue.known & (clue.age > 0.0) & (self._point >= 0)
        point, share = self._point[inside], self._past[inside, None] / SPACING
        following = graph.place[graph.after[point, 0]]
        places[inside] = (1.0 - share) * graph.place[point] + share * following
        return places


def constant_velocity(changes: Mapping[str, Any]) -> SightOracle:
    """Return the oracle that goes straight on."""
    return SightOracle(changes, ConstantVelocity())


def wait_20(changes: Mapping[str, Any]) -> SightOracle:
    """Return the oracle that goes straight on for 20 m, and waits there."""
    return SightOracle(changes, StraightAndWait(20.0))


def wait_45(changes: Mapping[str, Any]) -> SightOracle:
    """Return the oracle that goes straight on for 45 m, and waits there."""
    return SightOracle(changes, StraightAndWait(45.0))


def wait_90(changes: Mapping[str, Any]) -> SightOracle:
    """Return the oracle that goes straight on for 90 m, and waits there."""
    return SightOracle(changes, StraightAndWait(90.0))


def road_graph(changes: Mapping[str, Any]) -> SightOracle:
    """Return the oracle that goes on along the lanes."""
    return SightOracle(changes, AlongLanes())
