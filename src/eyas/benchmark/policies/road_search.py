"""Searches for hidden targets on the roads: guesses that drive on, until one is looked at in vain.

The built-in oracle `sighted`: how good a policy can be that sees perfectly and knows the map.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.lane_graph import SPACING, Lanes
from eyas.benchmark.policies.predictors import AlongLanes
from eyas.benchmark.policies.sighted import Clue, SightOracle
from eyas.engine.core.rng import stream
from eyas.engine.policies.policy import Start
from eyas.lanes import exact

Floats = NDArray[np.float64]

_GUESSES = 96

_ALONG = 6.0
"""Time for which the target is taken to drive on along its lane; then the search begins [s]. As
long as a tunnel hides it. In 40 flights of `long` in village, 3 and 6 s both had 3 losses."""

_VIEW = 5.5, 7.5
"""Half the ground, ahead and to the left, on which a target in view is surely seen [m]."""

_PATIENCE = 0.7
"""Time after which a guess that is looked at in vain counts a third [s]: it may be hidden there."""

_FEWEST = 20.0
"""Sum of the weights below which the guesses are taken again from those that are likely."""

_NEARBY = 5.0  # Spread of the guesses that count together as a place worth looking at [m]
_RANGE = 60.0  # Way to fly after which a place is half as attractive [m]
_CHANGE = 0.25  # How often the speed of a guess changes [1/s]

_STANDING = 3
"""One of so many guesses stands where the target vanished: it may have stopped out of sight."""

_LONGEST = 80  # Most points of a lane that something hides: the longest roof, 150 m
_PERIOD = 0.064  # Time between two moves of the guesses [s]


class RoadSearch:
    """Goes on along the lane for a moment, then looks where the target can be by now."""

    def begin(self, start: Start) -> None:
        """Forget all guesses."""
        count = len(start.seeds)
        self._ahead = AlongLanes()
        self._ahead.begin(start)
        self._lanes = Lanes(start.roads())
        self._open = self._lanes.evaluated(start.is_open)
        self._exit = self._exits()
        self._random = [stream(seed, "search") for seed in start.seeds.tolist()]
        shape = count, _GUESSES
        self._point, self._past = np.full(shape, -1), np.zeros(shape)
        self._speed, self._weight = np.zeros(shape), np.zeros(shape)
        self._age = np.zeros(count)
        """Age of each target when its guesses were moved last; 0: it has none [s]."""
        self._goal = np.zeros((count, 2))

    def places(self, clue: Clue) -> Floats:
        """Return where to look, shape (N, 2)."""
        self._age[clue.age == 0.0] = 0.0
        due = (clue.age > 0.0) & (clue.age - self._age >= _PERIOD)
        for row in np.flatnonzero(due).tolist():
            if self._age[row] == 0.0:
                self._begin(row, clue)
            self._move(row, float(clue.age[row] - self._age[row]))
            self._age[row] = clue.age[row]
            self._look(row, clue)
        searching = ((clue.age > _ALONG) | ~clue.known) & (self._weight.max(axis=1) > 0.0)
        searching &= self._age > 0.0
        return np.where(searching[:, None], self._goal, self._ahead.places(clue))

    def _begin(self, row: int, clue: Clue) -> None:
        """Guess in which lane the target is."""
        place, random, lanes = clue.last.place[row], self._random[row], self._lanes
        known = bool(clue.known[row])
        near = lanes.near(row, place, float(clue.last.yaw[row]) if known else None)
        if not len(near):
            near = lanes.near(row, place, None, reach=30.0)
        self._weight[row] = 1.0 if len(near) else 0.0
        if not len(near):
            return
        offset = lanes.graph.place[near] - place
        likely = exact.exp(-0.5 * np.square(offset / 3.0).sum(axis=1)) + 1e-9
        cumulated = np.cumsum(likely) / likely.sum()
        chosen = np.searchsorted(cumulated, random.random(_GUESSES), side="right")
        self._point[row] = near[np.minimum(chosen, len(near) - 1)]
        self._past[row] = 0.0
        speed = exact.hypot(*clue.last.velocity[row])
        spread = 1.0 + 0.2 * (random.random(_GUESSES) - 0.5)
        limit = lanes.graph.speed[self._point[row]]
        self._speed[row] = speed * spread if known else limit * random.random(_GUESSES)
        if known:
            self._speed[row, ::_STANDING] = 0.0

    def _move(self, row: int, time: float) -> None:
        """Let the guesses drive on; at junctions each takes one of the ways."""
        graph, random = self._lanes.graph, self._random[row]
        if self._weight[row].max() <= 0.0:
            return
        sampled = random.random((3, _GUESSES))
        changes = sampled[0] < _CHANGE * time
        limit = graph.speed[self._point[row]]
        wanted = np.where(sampled[1] < 0.15, 0.0, limit * (0.3 + 0.75 * sampled[1]))
        self._speed[row] = np.where(changes, wanted, self._speed[row])
        self._past[row] += self._speed[row] * time
        way = (sampled[2] * graph.after.shape[1]).astype(np.int64)
        while (far := self._past[row] >= SPACING).any():
            self._past[row, far] -= SPACING
            self._point[row, far] = graph.after[self._point[row, far], way[far]]

    def _look(self, row: int, clue: Clue) -> None:
        """Doubt the guesses that are in view, and choose where to look next."""
        places = self._lanes.graph.place
        weight, place = self._weight[row], places[self._point[row]]
        if weight.max() <= 0.0:
            return
        offset = place - clue.middle[row]
        if not clue.covered[row]:
            sine, cosine = exact.sin(clue.yaw[row]), exact.cos(clue.yaw[row])
            ahead = cosine * offset[:, 0] + sine * offset[:, 1]
            left = cosine * offset[:, 1] - sine * offset[:, 0]
            inside = (np.abs(ahead) < _VIEW[0]) & (np.abs(left) < _VIEW[1])
            inside &= self._open[self._point[row]]
            weight[inside] *= 1.0 - _PERIOD / _PATIENCE
            weight[:] = np.maximum(weight / weight.max(), 1e-4)
            if weight.sum() < _FEWEST:
                self._resample(row)
                return
        # Who is hidden comes out where his lane does: there one has to wait.
        place = places[self._exit[self._point[row]]]
        offset = place - clue.middle[row]
        east, north = (np.square(side[:, None] - side) for side in place.T)
        close = np.maximum(
            1.0 - (east + north) / (6.0 * _NEARBY * _NEARBY), 0.0
        )  # cubed: nearly a bell
        dense = (weight * close * close * close).sum(axis=1)
        worth = dense / (1.0 + exact.hypot(offset[:, 0], offset[:, 1]) / _RANGE)
        self._goal[row] = place[int(worth.argmax())]

    def _exits(self) -> NDArray[np.int64]:
        """Return where a target at each point is seen: there, or where its lane comes out, (P,)."""
        onward = self._lanes.graph.after[:, 0]
        out = np.arange(len(onward))
        for _ in range(_LONGEST):
            out = np.where(self._open[out], out, onward[out])
        return out

    def _resample(self, row: int) -> None:
        """Take guesses again in proportion to their weights: few are left that are likely."""
        cumulated = np.cumsum(self._weight[row])
        at = (np.arange(_GUESSES) + self._random[row].random()) / _GUESSES
        chosen = np.searchsorted(cumulated / cumulated[-1], at, side="right")
        for own in (self._point, self._past, self._speed):
            own[row] = own[row, np.minimum(chosen, _GUESSES - 1)]
        self._weight[row] = 1.0


def sighted(changes: Mapping[str, Any]) -> SightOracle:
    """Return the oracle that searches."""
    return SightOracle(changes, RoadSearch())
