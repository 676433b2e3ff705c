"""The vehicles that one drone sees, followed from look to look, and what is known of each."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.listener.detector import BODIES, NAMES, Detections, shares
from eyas.benchmark.policies.tracker.motion import MotionFilter
from eyas.lanes import exact

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]

_MOST: Final = 64  # Vehicles that are followed at once
_NOISE: Final = 0.5  # Standard deviation of a place that the network finds [m]
_ACCELERATION: Final = 4.0  # Standard deviation of a vehicle's acceleration, each axis [m/s^2]

_SPEED: Final = 8.0
"""Standard deviation of the velocity of a vehicle at its first look, each axis [m/s]."""

_WIDEST: Final = 8.0  # Largest standard deviation of a place [m]

_GATE: Final = 3.5
"""Largest distance of a vehicle from where it is expected, in standard deviations."""

_FAR: Final = 3.0  # Largest distance from where it is expected [m]

_OTHER: Final = -4.0
"""Logarithm of how alike two looks are, below which they are not of the same vehicle, if one of
them is known from so many pictures."""

_LOOKED: Final = 5
_ALIKE: Final = 0.7  # Weight of its looks, against that of its place
_UNLIKE: Final = -6.0  # Least logarithm of how alike two looks are

_KNOWN, _LONG = 0.25, 12.0
"""How much rather one is taken that has been seen so often before, up to so many looks: for that
one, if another has begun on the same vehicle."""

_SURER: Final = 1.5  # Share of vehicles among things in which the network believes by 1
_NEW: Final = 0.35  # Least belief in a vehicle that has not been seen before

_FORGOTTEN: Final = 1.0
"""Time unseen after which a vehicle is forgotten, unless it is the target [s]."""

_YOUNG: Final = 0.07  # Patience for each look at which it has been seen, up to `_FORGOTTEN` [s]
_REMEMBERED: Final = 0.05  # Least share of the latest look in what is known of a vehicle's looks


_MISSED: Final = 0.2  # Time unseen after which another one may be the target [s]

_NEAR, _WIDER = 3.0, 4.0
"""How far it may be from where the target is expected [m], and how much farther for each second in
which that is not seen [m/s]."""

_SHADOW: Final = 1.0
"""How long before the target vanished it may have come: a second one on the same vehicle [s]."""

_CONFIRMED: Final = 2  # Looks at which it must have been seen

_SURELY: Final = -4.5
"""Least logarithm of how alike they are, less twice the distance by the farthest."""


class TrackedVehicles(NamedTuple):
    """K vehicles."""

    row: Rows  # Index in the filter, shape (K,)
    colour: Floats  # Logarithms of probabilities of `NAMES`, shape (K, 22)
    body: Floats  # Logarithms of probabilities of `BODIES`, shape (K, 9)
    heading: Floats  # Mean direction east and north, and of twice the angle, shape (K, 4)
    first: Floats  # Time of the first look [s], shape (K,)
    begin: Floats  # Place at that time, east and north [m], shape (K, 2)
    velocity: Floats  # [m/s], shape (K, 2)
    ways: list[Floats]
    """All looks at each: time [s], east and north [m], direction of its axis [rad], shape (L,
    4)."""


class Candidates:
    """The vehicles around one drone.

    Attributes:
        target: Number of the chosen one; None: nobody is chosen yet.
        motion: Where they are and how they move.
    """

    def __init__(self) -> None:
        self.target: int | None = None
        self.motion = MotionFilter(_MOST, _WIDEST)
        self.motion.acceleration[:] = _ACCELERATION
        self._alive = np.zeros(_MOST, np.bool_)
        self._colour, self._body = np.zeros((_MOST, len(NAMES))), np.zeros((_MOST, len(BODIES)))
        self._heading = np.zeros((_MOST, 4))
        self._first, self._last = np.zeros(_MOST), np.zeros(_MOST)
        self._begin = np.zeros((_MOST, 2))
        self._looks = np.zeros(_MOST)
        self._ways: list[list[Floats]] = [[] for _ in range(_MOST)]
        self._time = 0.0

    def look(self, found: Detections, where: Floats, heading: Floats, since: float) -> None:
        """Take what a picture shows.

        Args:
            where: Where they are, east and north [m], shape (D, 2).
            heading: As in `TrackedVehicles`, shape (D, 4).
            since: Time since the last look [s].
        """
        self._time += since
        rows = np.flatnonzero(self._alive)
        self.motion.predict(rows, np.full(len(rows), since))
        pairs = self._pairs(rows, found, where)
        known = np.array([row for row, _ in pairs], np.int64)
        mine = np.array([one for _, one in pairs], np.int64)
        belief = np.minimum(_SURER * found.belief[mine], 1.0)
        self.motion.update(known, where[mine], np.full(len(known), _NOISE * _NOISE), belief)
        self._forget()
        new = np.setdiff1d(np.flatnonzero(found.belief > _NEW), mine)
        free = np.flatnonzero(~self._alive)[: len(new)]
        new = new[: len(free)]
        self._begin_with(free, where[new])
        for row, one in (*pairs, *zip(free.tolist(), new.tolist(), strict=True)):
            self._learn(row, found, one, where[one], heading[one])
        self._recover()

    def seen(self) -> TrackedVehicles:
        """Return what is known of all of them."""
        rows = np.flatnonzero(self._alive)
        return TrackedVehicles(
            rows,
            shares(self._colour[rows]),
            shares(self._body[rows]),
            self._heading[rows],
            self._first[rows],
            self._begin[rows],
            self.motion.velocity[rows],
            [np.array(self._ways[row]) for row in rows.tolist()],
        )

    def _pairs(self, rows: Rows, found: Detections, where: Floats) -> list[tuple[int, int]]:
        """Return which of the known ones are which of those in a picture: the likeliest first."""
        if not len(rows) or not len(where):
            return []
        variance = np.square(self.motion.spread(rows)) + _NOISE * _NOISE
        square = np.square(where[None] - self.motion.place[rows][:, None]).sum(axis=-1)
        away = square / variance[:, None]
        alike = _alike(shares(self._colour[rows]), found.colour)
        alike = alike + _alike(shares(self._body[rows]), found.body)
        cost = 0.5 * away + exact.log(variance)[:, None] - _ALIKE * np.maximum(alike, _UNLIKE)
        cost = cost - _KNOWN * np.minimum(self._looks[rows], _LONG)[:, None]
        cost = cost - exact.log(found.belief)
        other = (alike < _OTHER) & (self._looks[rows] >= _LOOKED)[:, None]
        cost = np.where((away > _GATE * _GATE) | (square > _FAR * _FAR) | other, np.inf, cost)
        pairs: dict[int, int] = {}
        taken: set[int] = set()
        for index in np.argsort(cost, axis=None, kind="stable").tolist():
            row, one = divmod(index, len(where))
            if np.isinf(cost[row, one]):
                break
            if row not in pairs and one not in taken:
                pairs[row] = one
                taken.add(one)
        return [(int(rows[row]), one) for row, one in pairs.items()]

    def _forget(self) -> None:
        """Forget those that have not been seen for long."""
        patience = np.minimum(_FORGOTTEN, _YOUNG * self._looks)
        old = self._alive & (self._time - self._last > patience)
        if self.target is not None:
            old[self.target] = False
        self._alive[old] = False

    def _recover(self) -> None:
        """Take another one for the target that has vanished: one that has come since, near where
        the target is expected, and that looks like it.
        """
        target = self.target
        if target is None or (unseen := self._time - self._last[target]) < _MISSED:
            return
        rows = np.flatnonzero(self._alive & (self._first > self._last[target] - _SHADOW))
        rows = rows[self._looks[rows] >= _CONFIRMED]
        if not len(rows):
            return
        away = self.motion.place[rows] - self.motion.place[target]
        far = np.sqrt(np.square(away).sum(axis=1)) / (_NEAR + _WIDER * unseen)
        alike = sum(
            _alike(shares(known[rows]), shares(known[[target]]))[:, 0]
            for known in (self._colour, self._body)
        )
        score = np.where(far < 1.0, alike - 2.0 * far, -np.inf)
        if score.max() > _SURELY:
            self.target = int(rows[score.argmax()])

    def _begin_with(self, rows: Rows, where: Floats) -> None:
        """Begin to follow some."""
        self._alive[rows] = True
        self.motion.begin(rows, where, np.zeros_like(where), _NOISE, np.full(len(rows), _SPEED))
        self._looks[rows], self._first[rows], self._begin[rows] = 0.0, self._time, where
        for row in rows.tolist():
            self._ways[row] = []

    def _learn(self, row: int, found: Detections, one: int, where: Floats, heading: Floats) -> None:
        """Add a look at one of them to what is known of it."""
        share = max(1.0 / (self._looks[row] + 1.0), _REMEMBERED)
        for known, new in (
            (self._colour, found.colour[one]),
            (self._body, found.body[one]),
            (self._heading, heading),
        ):
            known[row] += share * (new - known[row])
        self._looks[row] += 1.0
        self._last[row] = self._time
        if self.target is None:
            axis = 0.5 * float(exact.atan2(heading[3], heading[2]))
            self._ways[row].append(np.array([self._time, *where, axis]))


def _alike(known: Floats, found: Floats) -> Floats:
    """Return the logarithm of the probability that two have the same word, shape (K, D)."""
    both = exact.exp(known[:, None] + found[None]).sum(axis=-1)
    alike: Floats = exact.log(np.maximum(both, 1e-6))
    return alike
