"""People and robots who are told where to go and how fast: free on foot, but not through solids."""

from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.targets.habit import Habit
from eyas.engine.traffic.steering import Steps
from eyas.engine.traffic.ways import wrapped
from eyas.lanes import exact

TOP_SHARE: Final = 2.0
"""Highest speed that one may want, as a multiple of the usual one of the kind."""

_DETOURS: Final = (0.0, 0.5, -0.5, 1.0, -1.0, 1.4, -1.4)
"""Changes of the step's heading that are tried in this order where something is in the way [rad]"""

RAYS: Final = 8  # Directions in which one looks how far one could go
FARTHEST: Final = 10.0  # The most that one sees there [m]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class SteeredWalkers:
    """N people or robots on foot.

    Attributes:
        at: East and north [m], shape (N, 2).
        yaw: Heading, without jumps [rad], shape (N,).
        speed: [m/s], shape (N,).
        top: Highest speed that may be wanted [m/s].
    """

    def __init__(
        self,
        obstacles: GroundObstacles,  # What is in the way
        habit: Habit,  # How the kind moves
        radius: float,  # Distance to obstacles that is kept [m]
        count: int,
    ) -> None:
        self.at = np.zeros((count, 2))
        self.yaw, self.speed = np.zeros((2, count))
        self.top: Final = TOP_SHARE * habit.speed
        self._blocked, self._reach = obstacles.blocked, obstacles.reach
        self._habit, self._radius = habit, radius

    def begin(self, rows: Integers, place: Floats, yaw: Floats, speed: Floats) -> None:
        """Put some where they are, with headings [rad] and speeds [m/s]."""
        self.at[rows], self.yaw[rows], self.speed[rows] = place, yaw, speed

    def advance(
        self,
        rows: Integers,  # Those who go, shape (K,)
        heading: Floats,  # Where each wants to go, counter-clockwise from east [rad], shape (K,)
        wanted: Floats,  # How fast [m/s], shape (K,)
        period: float,  # Length of the step [s]
    ) -> Steps:
        """Go on for a step; who finds no way stops."""
        habit, old = self._habit, self.speed[rows]
        most = habit.yaw_rate * period
        turned = np.clip(wrapped(heading - self.yaw[rows]), -most, most)
        change = habit.acceleration * period
        new = np.clip(np.clip(wanted, 0.0, self.top), old - change, old + change)
        goes = np.zeros(len(rows), np.bool_)
        place = self.at[rows].copy()
        yaw = self.yaw[rows] + turned
        for detour in _DETOURS:
            left = np.flatnonzero(~goes & (new > 0.0))
            if not len(left):
                break
            way = yaw[left] + detour
            slower = exact.cos(detour)  # along what is in the way
            step = 0.5 * (old + new)[left] * period * slower
            next_ = self.at[rows[left]] + step[:, None] * np.stack(
                [exact.cos(way), exact.sin(way)], axis=1
            )
            free = ~self._blocked(shapely.points(next_), self._radius)
            here = left[free]
            place[here], goes[here] = next_[free], True
            turned[here] += detour
            new[here] *= slower
        new = np.where(goes, new, 0.0)
        turned = np.clip(turned, -2.0 * most, 2.0 * most)
        self.yaw[rows] += turned
        step = place - self.at[rows]
        self.at[rows], self.speed[rows] = place, new
        driven = np.asarray(exact.hypot(step[:, 0], step[:, 1]))
        course = np.where(driven > 0.0, exact.atan2(step[:, 1], step[:, 0]), self.yaw[rows])
        velocity = new[:, None] * np.stack([exact.cos(course), exact.sin(course)], axis=1)
        return Steps(place, velocity, self.yaw[rows].copy(), turned / period, driven)

    def free(self, rows: Integers) -> Floats:
        """Return how far each could go straight on in `RAYS` directions, the first one ahead, the
        others counter-clockwise [m], shape (K, RAYS).
        """
        turns = 2.0 * np.pi / RAYS * np.arange(RAYS)
        headings = (self.yaw[rows, None] + turns).ravel()
        start = np.repeat(self.at[rows], RAYS, axis=0)
        reach = self._reach(start, headings, FARTHEST, self._radius)
        return np.asarray(reach.reshape(len(rows), RAYS))
