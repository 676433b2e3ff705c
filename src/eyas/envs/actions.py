"""What an agent may say, and the command that it means."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.core.config import Config

__all__ = ["ContinuousActions", "DiscreteActions", "Speeds"]


class Speeds(Config):
    """How fast the actions are. Defaults are those of the original's algorithm side."""

    forward: float = 40.0
    """Forward and backward [m/s]."""
    lateral: float = 40.0
    """Left and right [m/s]."""
    vertical: float = 0.01
    """Up and down [m per 2 ms step]; only continuous actions use it."""
    yaw_rate: float = 2.0
    """Turning [rad/s]."""


class DiscreteActions:
    """Seven actions, one axis at a time.

    0 forward, 1 backward, 2 left, 3 right, 4 turn counter-clockwise, 5 turn clockwise, 6 hover:
    the original's table, where 4 and 5 carry each other's names.

    Args:
        speeds: How fast.
    """

    def __init__(self, speeds: Speeds) -> None:
        self.space: gymnasium.Space[Any] = gymnasium.spaces.Discrete(7)
        self._table = np.zeros((7, 4))
        self._table[0, 0], self._table[1, 0] = speeds.forward, -speeds.forward
        self._table[2, 1], self._table[3, 1] = speeds.lateral, -speeds.lateral
        self._table[4, 3], self._table[5, 3] = speeds.yaw_rate, -speeds.yaw_rate

    def command(self, action: int | np.integer[Any]) -> NDArray[np.float64]:
        """Return forward, left, up, yaw rate as one command, shape (1, 4)."""
        return self._table[None, int(action)].copy()


class ContinuousActions:
    """Four numbers in -1 to 1: forward, left, up, turn counter-clockwise, as shares of the speeds.

    Args:
        speeds: What 1 means.
    """

    def __init__(self, speeds: Speeds) -> None:
        self.space: gymnasium.Space[Any] = gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32)
        self._scale = np.array([speeds.forward, speeds.lateral, speeds.vertical, speeds.yaw_rate])

    def command(self, action: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return forward, left, up, yaw rate as one command, shape (1, 4)."""
        shares: NDArray[np.float64] = np.clip(np.asarray(action, np.float64), -1.0, 1.0)
        return np.atleast_2d(shares * self._scale)
