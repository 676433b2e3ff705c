"""The actions of an agent, and the commands that they mean."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.envs.config import ActionSpeeds, EnvSpeeds

__all__ = ["ContinuousActions", "DiscreteActions", "action_table"]


def action_table(speeds: ActionSpeeds) -> NDArray[np.float64]:
    """Return the command that each action number means, shape (6, 4).

    Columns: forward, left, up, yaw rate. It is the original's table, in which the names of actions
    4 and 5 are swapped.
    """
    table = np.zeros((6, 4))
    table[0:2, 0] = speeds.forward_speed, speeds.backward_speed
    table[2:4, 1] = speeds.left_speed, speeds.right_speed
    table[4:6, 3] = speeds.counter_clockwise_rate, speeds.clockwise_rate
    return table


class DiscreteActions:
    """Seven actions, one axis at a time.

    0 forward, 1 backward, 2 left, 3 right, 4 turn counter-clockwise, 5 turn clockwise, 6 hover.

    Args:
        speeds: The speeds of the actions.
    """

    def __init__(self, speeds: ActionSpeeds) -> None:
        self.space: gymnasium.Space[Any] = gymnasium.spaces.Discrete(7)
        hover = np.zeros((1, 4))
        self._table = np.concatenate((action_table(speeds), hover))

    def command(self, action: int | np.integer[Any]) -> NDArray[np.float64]:
        """Return forward, left, up, yaw rate as one command, shape (1, 4)."""
        return self._table[None, int(action)].copy()


class ContinuousActions:
    """Four numbers in -1 to 1: forward, left, up, turn counter-clockwise, as shares of the speeds.

    Args:
        speeds: The speeds that -1 and 1 mean.
    """

    def __init__(self, speeds: EnvSpeeds) -> None:
        self.space: gymnasium.Space[Any] = gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32)
        up, turn = speeds.vertical_speed, speeds.counter_clockwise_rate
        self._at_1 = np.array([speeds.forward_speed, speeds.left_speed, up, turn])
        turn = speeds.clockwise_rate
        self._at_minus_1 = np.array([speeds.backward_speed, speeds.right_speed, -up, turn])

    def command(self, action: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return forward, left, up, yaw rate as one command, shape (1, 4)."""
        shares: NDArray[np.float64] = np.clip(np.asarray(action, np.float64), -1.0, 1.0)
        return np.atleast_2d(np.where(shares < 0, -shares * self._at_minus_1, shares * self._at_1))
