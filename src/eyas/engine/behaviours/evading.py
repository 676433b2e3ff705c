"""What a target that is an agent sees, and the fixed drivers that see the same."""

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.evader import EvaderDriver
from eyas.engine.behaviours.steering import RAYS
from eyas.engine.core.rng import EpisodeKey, stream
from eyas.engine.traffic.steering import TOP_SHARE
from eyas.engine.traffic.ways import LEFT, RIGHT, STRAIGHT
from eyas.lanes import exact

COVER_AT: Final = (0.0, 10.0, 20.0, 30.0, 40.0, 60.0)
"""Distances ahead at which a driver sees whether a car is out of sight from above [m]"""

_TRACKER: Final = (
    *("tracker_ahead", "tracker_left", "tracker_up"),  # From the target, in its heading frame [m]
    *("closing_ahead", "closing_left", "closing_up"),
    # Velocity of the tracker less that of the target, same frame [m/s]
    *("view_cosine", "view_sine"),  # Of the tracker's heading less that of the target
    "speed",  # [m/s]
)

CAR_SEEN: Final = (
    *_TRACKER,
    "limit",  # Of the road [m/s]
    "junction",  # Way to the next one [m]
    *("left", "straight", "right"),  # 1: the road leads there at the next junction
    "gap",  # To whoever is ahead, at most 60 m [m]
    "leader_speed",  # [m/s]
    *(f"cover_{at:g}" for at in COVER_AT),  # 1: out of sight of a drone above
)
"""Numbers that a driver sees."""

WALKER_SEEN: Final = (
    *_TRACKER,
    "top",  # Highest speed [m/s]
    *("yaw_cosine", "yaw_sine"),  # Of its own heading, counter-clockwise from east
    *(f"free_{number}" for number in range(RAYS)),
    # Way that is free ahead, and counter-clockwise all round, at most 10 m [m]
)
"""Numbers that a walker sees."""

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class FixedDrivers:
    """The fixed drivers of N targets, see `EvaderDriver`.

    Args:
        driver: Which.
        walks: Whether the targets are on foot.
        count: N.
    """

    def __init__(self, driver: EvaderDriver, count: int, *, walks: bool) -> None:
        self._walks, self._driver = walks, driver
        self._key = np.zeros((count, 3), np.int64)  # See `EpisodeKey`
        self._draws = np.zeros(count, np.int64)  # Random numbers that each has drawn
        self._turn = np.full(count, STRAIGHT)
        self._junction = np.full(count, -np.inf)
        self._until, self._clock = np.zeros((2, count))  # Time of the next decision, and now [s]
        self._mode = np.zeros(count, np.int64)  # 0: goes on; 1: brakes; 2: dashes
        self._heading = np.zeros(count)

    def begin(self, rows: Integers, key_of: Callable[[int], EpisodeKey]) -> None:
        """Begin the episodes of some targets, each with random numbers of its own."""
        self._draws[rows] = 0
        for row in rows.tolist():
            self._key[row] = key_of(row)
            self._until[row] = self._between(row, 2.0, 8.0)
        self._clock[rows], self._mode[rows], self._turn[rows] = 0.0, 0, STRAIGHT
        self._junction[rows] = -np.inf
        self._heading[rows] = np.nan

    def actions(self, rows: Integers, seen: Floats, period: float) -> Floats:
        """Return the actions of some targets for the next step of a length [s], shape (K, 2).

        Args:
            rows: The targets, shape (K,).
            seen: What they see, columns `CAR_SEEN` or `WALKER_SEEN`, shape (K, C).
        """
        self._clock[rows] += period
        decide = self._walk if self._walks else self._drive
        return np.array([decide(row, own) for row, own in zip(rows.tolist(), seen, strict=True)])

    def _drive(self, row: int, seen: Floats) -> tuple[float, float]:
        see = dict(zip(CAR_SEEN, seen.tolist(), strict=True))
        if see["junction"] > self._junction[row] + 1.0:
            self._turn[row] = self._next_turn(row, see)
        self._junction[row] = see["junction"]
        turn = float(STRAIGHT - self._turn[row])  # 1: left, -1: right
        limit, late = see["limit"], self._clock[row] >= self._until[row]
        if self._driver is EvaderDriver.CRUISE:
            return limit, turn
        if self._driver is EvaderDriver.ABRUPT:
            if late:
                self._change_mode(row, see["junction"] > 40.0)
            return limit * (1.0, 0.0, TOP_SHARE)[self._mode[row]], turn
        return self._hiding(row, see, late=late), turn

    def _hiding(self, row: int, see: dict[str, float], *, late: bool) -> float:
        """Return the speed of one who stands below what hides him, for a while."""
        covered = [see[f"cover_{at:g}"] > 0.0 for at in COVER_AT]
        if self._mode[row] == 1:  # it stands, and goes on some time
            if late:
                self._mode[row], self._until[row] = 2, self._clock[row] + 8.0
            return 0.0
        if covered[0] and late:
            self._mode[row], self._until[row] = 1, self._clock[row] + self._between(row, 4.0, 10.0)
            return 0.0
        if late and covered[1]:
            return 5.0
        if late and covered[2]:
            return 9.0
        return see["limit"] * TOP_SHARE

    def _change_mode(self, row: int, may_brake: bool) -> None:
        spans = ((6.0, 12.0), (2.0, 5.0), (5.0, 9.0))
        mode = 0 if self._mode[row] else int(self._generator(row).integers(1, 3))
        mode = 2 if mode == 1 and not may_brake else mode
        self._mode[row] = mode
        self._until[row] = self._clock[row] + self._between(row, *spans[mode])

    def _next_turn(self, row: int, see: dict[str, float]) -> int:
        """Return the way on at the next junction."""
        open_ = [
            way
            for way, name in ((LEFT, "left"), (STRAIGHT, "straight"), (RIGHT, "right"))
            if see[name] > 0.0
        ]
        if not open_:
            return STRAIGHT
        drawn = open_[int(self._generator(row).integers(len(open_)))]
        if self._driver is not EvaderDriver.HIDE:
            return drawn
        # As far as can be from where the tracker heads; often enough at random.
        if self._generator(row).random() < 0.3:
            return drawn
        view = float(exact.atan2(see["view_sine"], see["view_cosine"]))
        away = {way: exact.cos(view - (STRAIGHT - way) * 0.5 * np.pi) for way in open_}
        return min(open_, key=lambda way: (float(away[way]), way))

    def _walk(self, row: int, seen: Floats) -> tuple[float, float]:
        see = dict(zip(WALKER_SEEN, seen.tolist(), strict=True))
        yaw = float(exact.atan2(see["yaw_sine"], see["yaw_cosine"]))
        late = self._clock[row] >= self._until[row]
        usual = 0.5 * see["top"]
        if np.isnan(self._heading[row]):
            self._heading[row] = yaw
        blocked = see["free_0"] < 1.5
        if self._driver is EvaderDriver.HIDE:
            if late or blocked:
                away = float(exact.atan2(-see["tracker_left"], -see["tracker_ahead"]))
                self._heading[row] = yaw + self._free_way(see, away)
                self._until[row] = self._clock[row] + self._between(row, 1.0, 3.0)
            return self._heading[row], see["top"]
        if blocked:
            self._heading[row] = yaw + self._free_way(see, self._between(row, -np.pi, np.pi))
        if self._driver is EvaderDriver.ABRUPT and late:
            self._heading[row] = yaw + self._between(row, -np.pi, np.pi)
            self._mode[row] = int(self._generator(row).integers(3))
            self._until[row] = self._clock[row] + self._between(row, 2.0, 6.0)
        return self._heading[row], usual * (1.0, 0.0, 2.0)[self._mode[row]]

    def _free_way(self, see: dict[str, float], wanted: float) -> float:
        """Return the direction, relative to the heading, that leads on and about where wanted."""
        turns = 2.0 * np.pi / RAYS * np.arange(RAYS)
        free = np.array([see[f"free_{number}"] for number in range(RAYS)])
        fits = exact.cos(turns - wanted) + 0.2 * np.minimum(free, 5.0)
        return float(turns[int(np.argmax(fits))])

    def _generator(self, row: int) -> np.random.Generator:
        """Return the generator of the next random number."""
        self._draws[row] += 1
        seed, tracker, episode = self._key[row].tolist()
        return stream(seed, "evader", tracker, episode, int(self._draws[row]))

    def _between(self, row: int, low: float, high: float) -> float:
        return float(self._generator(row).uniform(low, high))
