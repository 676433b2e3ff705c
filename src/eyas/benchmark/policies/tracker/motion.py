"""Where targets are and how they move: a Kalman filter whose acceleration lasts for a while.

R. A. Singer (1970), IEEE Transactions on Aerospace and Electronic Systems 6, pages 473 to 483: the
acceleration is random and decays. A filter that knows of no acceleration lags behind a car that
turns or brakes, and would go on with a wrong velocity once it is hidden. Both axes are independent
and have the same variances.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]

_PLACE, _VELOCITY, _ACCELERATION = range(3)  # Rows of a state
_TOGETHER = 0.7  # Correlation of place and velocity on a course: who is ahead of it is fast


class MotionFilter:
    """The motion of N targets on the level, east and north.

    Attributes:
        lasting: Time constant of accelerations [s], shape (N,).
        acceleration: Their standard deviation in each axis [m/s^2], shape (N,).

    Args:
        widest: Largest standard deviation of a place [m].
    """

    def __init__(self, count: int, widest: float) -> None:
        self._state = np.zeros((count, 3, 2))
        self._variance = np.zeros((count, 3, 3))  # Covariance of either axis, shape (N, 3, 3)
        self.acceleration, self.lasting = np.ones(count), np.ones(count)
        self._widest = widest

    @property
    def place(self) -> Floats:
        """Where they are [m], shape (N, 2)."""
        return self._state[:, _PLACE]

    @property
    def velocity(self) -> Floats:
        """[m/s], shape (N, 2)."""
        return self._state[:, _VELOCITY]

    def begin(
        self,
        rows: Rows,  # K of the targets, shape (K,)
        place: Floats,  # Where they are [m], shape (K, 2)
        velocity: Floats,  # [m/s], shape (K, 2)
        spread: float,  # Standard deviation of the places [m]
        speed: Floats,  # That of the velocities [m/s], shape (K,)
    ) -> None:
        """Begin with what is known of targets."""
        self._state[rows] = np.stack((place, velocity, np.zeros_like(place)), axis=1)
        self._variance[rows] = 0.0
        self._variance[rows, _PLACE, _PLACE] = spread * spread
        self._variance[rows, _VELOCITY, _VELOCITY] = np.square(speed)
        self._variance[rows, _ACCELERATION, _ACCELERATION] = np.square(self.acceleration[rows])

    def stop(
        self,
        rows: Rows,  # Which they are, shape (K,)
        speed: float,  # Standard deviation of their velocities [m/s]
    ) -> None:
        """Expect K targets to stand or to move from where they are now, in any direction."""
        spread = self._variance[rows, _PLACE, _PLACE]
        still = np.zeros((len(rows), 2))
        self.begin(rows, self.place[rows], still, 0.0, np.full(len(rows), speed))
        self._variance[rows, _PLACE, _PLACE] = spread

    def expect(
        self,
        rows: Rows,  # Which they are, shape (K,)
        place: Floats,  # Where they should be [m], shape (K, 2)
        velocity: Floats,  # [m/s], shape (K, 2)
        spread: Floats,  # Standard deviation of the places [m], shape (K,)
        speed: Floats,  # That of the velocities [m/s], shape (K,)
    ) -> None:
        """Expect K targets where their courses lead."""
        spread = np.minimum(spread, self._widest)
        self.begin(rows, place, velocity, 0.0, speed)
        self._variance[rows, _PLACE, _PLACE] = np.square(spread)
        both = _TOGETHER * spread * speed
        self._variance[rows, _PLACE, _VELOCITY] = self._variance[rows, _VELOCITY, _PLACE] = both

    def spread(self, rows: Rows) -> Floats:
        """Return the standard deviation of places [m], shape (K,)."""
        spread: Floats = np.sqrt(self._variance[rows, _PLACE, _PLACE])
        return spread

    def predict(self, rows: Rows, time: Floats) -> None:
        """Let time pass [s], shape (K,)."""
        step = self._step(rows, time)
        self._state[rows] = exact.product(step, self._state[rows])
        variance = exact.product(exact.product(step, self._variance[rows]), step.swapaxes(1, 2))
        variance += self._noise(rows, time)
        # A place that may be anywhere is no reason to doubt how the target moves.
        most = np.ones((len(rows), 3))
        place = np.sqrt(variance[:, _PLACE, _PLACE])
        most[:, _PLACE] = self._widest / np.maximum(place, self._widest)
        self._variance[rows] = most[:, :, None] * variance * most[:, None]

    def _step(self, rows: Rows, time: Floats) -> Floats:
        """Return how states become those of later, shape (K, 3, 3)."""
        lasting = self.lasting[rows]
        left = exact.exp(-time / lasting)
        gained = lasting * (1.0 - left)
        step = np.zeros((len(rows), 3, 3))
        step[:, _PLACE, _PLACE] = step[:, _VELOCITY, _VELOCITY] = 1.0
        step[:, _PLACE, _VELOCITY] = time
        step[:, _PLACE, _ACCELERATION] = lasting * (time - gained)
        step[:, _VELOCITY, _ACCELERATION] = gained
        step[:, _ACCELERATION, _ACCELERATION] = left
        return step

    def _noise(self, rows: Rows, time: Floats) -> Floats:
        """Return variances that are added in a time which is short beside `lasting`, (K, 3, 3)."""
        square = time * time
        cube, fourth = square * time, square * square
        noise = (
            (fourth * time / 20.0, fourth / 8.0, cube / 6.0),
            (fourth / 8.0, cube / 3.0, square / 2.0),
            (cube / 6.0, square / 2.0, time),
        )
        rate = 2.0 * np.square(self.acceleration[rows]) / self.lasting[rows]
        added: Floats = np.moveaxis(rate * np.array(noise), -1, 0)
        return added

    def distance(self, rows: Rows, place: Floats, variance: Floats) -> Floats:
        """Return how far seen places are from the expected ones, in standard deviations, (K,).

        Args:
            place: Where they are seen [m], shape (K, 2).
            variance: Of that in each axis [m^2], shape (K,).
        """
        away = np.square(place - self.place[rows]).sum(axis=1)
        distance: Floats = np.sqrt(away / (self._variance[rows, _PLACE, _PLACE] + variance))
        return distance

    def update(self, rows: Rows, place: Floats, variance: Floats, belief: Floats) -> None:
        """Take what is seen, as far as it is believed to be the target: probabilistic data
        association with one candidate (Bar-Shalom, Daum, Huang 2009, "The probabilistic data
        association filter", equations 38 to 44).

        Args:
            belief: Probability that it is the target, shape (K,).
        """
        both = self._variance[rows, _PLACE]
        gain = both / (both[:, :1] + variance[:, None])
        away = place - self.place[rows]
        self._state[rows] += (belief[:, None] * gain)[:, :, None] * away[:, None]
        # What is gained where it is the target, and how far apart both cases are.
        doubt = 0.5 * belief * (1.0 - belief) * np.square(away).sum(axis=1)
        apart = doubt[:, None, None] * gain[:, :, None] * gain[:, None]
        self._variance[rows] += apart - belief[:, None, None] * gain[:, :, None] * both[:, None]
