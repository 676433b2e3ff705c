"""Steers drones by velocities so that what they follow comes into the middle of the picture."""

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.tracker.ground import Ground
from eyas.engine.settings.env import EnvConfig
from eyas.lanes import exact

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]

_CONTROL_STEP = 0.008  # Control step of all protocols [s]


class Steering:
    """Steers N drones.

    Attributes:
        period: How long an action lasts [s].
    """

    def __init__(
        self, count: int, env: EnvConfig, ground: Ground, gain: float, lag: float = 0.0
    ) -> None:
        self.period = _CONTROL_STEP * env.action_repeat
        self._ground, self._gain, self._lag = ground, gain, lag
        self._fastest = env.speeds.forward_speed
        self._looked = np.full(count, np.nan)  # When each looked last [s]; NaN: not yet
        self._command = np.zeros((count, 2))  # Latest command of each, east and north [m/s]
        self._told = np.zeros((count, 2))  # Where the commands of each bring it, east and north [m]

    def time_since(self, rows: Rows, clock: float | None) -> Floats:
        """Return the time since the last look of each [s], shape (K,); NaN: there was none.

        Args:
            rows: K of the drones, which look now, shape (K,).
            clock: Time since the start of the flight [s]; None: an action lasts from look to look.
        """
        before = self._looked[rows]
        now = np.where(np.isnan(before), 0.0, before + self.period) if clock is None else clock
        self._looked[rows] = now
        since: Floats = now - before
        return since

    def steer(
        self,
        rows: Rows,  # K of the drones, shape (K,)
        # Where they are, east and north [m], (K, 2), and their heading [rad], (K,)
        pose: tuple[Floats, Floats],
        since: Floats,
        # Where their targets are [m] and how these move [m/s], east and north, (K, 2)
        target: tuple[Floats, Floats],
    ) -> Floats:
        """Return commands ahead and to the left [m/s], shape (K, 2).

        Looks that are farther apart than an action lasts show how late actions are: the drone then
        flies on as it was told before, and the action lasts as long.
        """
        (place, yaw), (where, velocity) = pose, target
        late = np.where(since > 1.5 * self.period, since, 0.0)[:, None]
        lasts = np.maximum(late, self.period)
        if self._lag == 0.0:
            away = where - place + late * (velocity - self._command[rows])
        else:
            away = where + late * velocity - self._led_to(rows, place, since)
        away = away - turned(np.tile(self._ground.middle, (len(rows), 1)), yaw)
        self._command[rows] = velocity + self._gain * away / lasts
        ahead = turned(self._command[rows], -yaw)
        ahead = np.clip(ahead, -self._fastest, self._fastest)
        self._command[rows] = turned(ahead, yaw)
        return ahead

    def _led_to(self, rows: Rows, place: Floats, since: Floats) -> Floats:
        """Return where the commands until now bring drones, east and north [m], shape (K, 2).

        One that a flight controller flies is behind its command while it tilts, and on its way: who
        steers where it is asks for that way again with each action, until it swings.

        Args:
            rows: K of the drones, shape (K,).
            place: Where they are [m], shape (K, 2).
        """
        time = np.where(np.isnan(since), 0.0, since)[:, None]
        told = self._told[rows] + self._command[rows] * time
        told = np.where(
            time > 0.0, told + (place - told) * np.minimum(time / self._lag, 1.0), place
        )
        self._told[rows] = told
        return told


def turned(vectors: Floats, angle: Floats) -> Floats:
    """Return vectors turned counter-clockwise, shape (K, 2)."""
    sine, cosine = exact.sin(angle), exact.cos(angle)
    east = cosine * vectors[:, 0] - sine * vectors[:, 1]
    north = sine * vectors[:, 0] + cosine * vectors[:, 1]
    return np.stack((east, north), axis=-1)
