"""Where targets are and how they move: a Kalman filter with constant velocity.

Bar-Shalom, Li, Kirubarajan, "Estimation with Applications to Tracking and Navigation" (2001),
section 6.3.2: between two looks the acceleration is constant and random. Both axes are independent
and have the same variances.
"""

import numpy as np
from numpy.typing import NDArray

__all__ = ["MotionFilter"]

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]

_CORRELATED = 0.95
"""Largest correlation of place and velocity where the variance of the place is limited."""


class MotionFilter:
    """The motion of N targets on the level, east and north.

    Attributes:
        place: [m], shape (N, 2).
        velocity: [m/s], shape (N, 2).
        acceleration: Standard deviation in each axis [m/s^2], shape (N,).

    Args:
        count: N.
        widest: Largest standard deviation of a place [m].
    """

    def __init__(self, count: int, widest: float) -> None:
        self.place, self.velocity = np.zeros((count, 2)), np.zeros((count, 2))
        self.acceleration = np.ones(count)
        self._variance = np.zeros((count, 3))
        """Of place, place with velocity, velocity."""
        self._widest = widest * widest

    def begin(
        self, rows: Rows, place: Floats, velocity: Floats, spread: float, speed: Floats
    ) -> None:
        """Begin with what is known of targets.

        Args:
            rows: K of the targets, shape (K,).
            place: Where they are [m], shape (K, 2).
            velocity: [m/s], shape (K, 2).
            spread: Standard deviation of the places [m].
            speed: That of the velocities [m/s], shape (K,).
        """
        self.place[rows], self.velocity[rows] = place, velocity
        self._variance[rows] = np.stack(
            (np.full(len(rows), spread * spread), np.zeros(len(rows)), speed * speed), axis=-1
        )

    def stop(self, rows: Rows, speed: float) -> None:
        """Expect K targets to stand or to move from where they are now, in any direction.

        Args:
            rows: Which they are, shape (K,).
            speed: Standard deviation of their velocities [m/s].
        """
        self.velocity[rows] = 0.0
        self._variance[rows, 1:] = 0.0, speed * speed

    def spread(self, rows: Rows) -> Floats:
        """Return the standard deviation of places [m], shape (K,)."""
        spread: Floats = np.sqrt(self._variance[rows, 0])
        return spread

    def predict(self, rows: Rows, time: Floats) -> None:
        """Let time pass [s], shape (K,)."""
        self.place[rows] += time[:, None] * self.velocity[rows]
        place, both, speed = self._variance[rows].T
        noise = np.square(self.acceleration[rows] * time)
        place = place + time * (2.0 * both + time * (speed + 0.25 * noise))
        both = both + time * (speed + 0.5 * noise)
        place, speed = np.minimum(place, self._widest), speed + noise
        most = _CORRELATED * np.sqrt(place * speed)
        self._variance[rows] = np.stack((place, np.clip(both, -most, most), speed), axis=-1)

    def distance(self, rows: Rows, place: Floats, variance: Floats) -> Floats:
        """Return how far seen places are from the expected ones, in standard deviations, (K,).

        Args:
            rows: K of the targets.
            place: Where they are seen [m], shape (K, 2).
            variance: Of that in each axis [m^2], shape (K,).
        """
        away = np.square(place - self.place[rows]).sum(axis=1)
        distance: Floats = np.sqrt(away / (self._variance[rows, 0] + variance))
        return distance

    def update(self, rows: Rows, place: Floats, variance: Floats, belief: Floats) -> None:
        """Take what is seen, as far as it is believed to be the target: probabilistic data
        association with one candidate (Bar-Shalom, Daum, Huang 2009, "The probabilistic data
        association filter", equations 38 to 44).

        Args:
            rows: As in `distance`.
            place: As in `distance`.
            variance: As in `distance`.
            belief: Probability that it is the target, shape (K,).
        """
        own, both = self._variance[rows, :2].T
        gain = np.stack((own, both), axis=-1) / (own + variance)[:, None]
        away = place - self.place[rows]
        self.place[rows] += belief[:, None] * gain[:, :1] * away
        self.velocity[rows] += belief[:, None] * gain[:, 1:] * away
        # What is gained where it is the target, and how far apart both cases are.
        doubt = 0.5 * belief * (1.0 - belief) * np.square(away).sum(axis=1)
        pairs = np.stack(
            (np.square(gain[:, 0]), gain[:, 0] * gain[:, 1], np.square(gain[:, 1])), axis=-1
        )
        gained = np.stack((gain[:, 0] * own, gain[:, 0] * both, gain[:, 1] * both), axis=-1)
        self._variance[rows] += doubt[:, None] * pairs - belief[:, None] * gained
