"""The actions of an agent, and the commands that they mean."""

import math
import operator
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import ActionError
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
        """Return forward, left, up, yaw rate as one command, shape (1, 4).

        Raises:
            ActionError: It is not one of the seven.
        """
        try:
            number = operator.index(action)
        except TypeError:
            number = -1
        if not 0 <= number < len(self._table):
            raise _refused(action, "a whole number from 0 to 6")
        return self._table[None, number].copy()


class ContinuousActions:
    """Four numbers in -1 to 1: forward, left, up, turn counter-clockwise, as shares of the speeds.

    Args:
        speeds: The speeds that -1 and 1 mean.
    """

    def __init__(self, speeds: EnvSpeeds) -> None:
        self.space: gymnasium.Space[Any] = gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32)
        up, turn = speeds.vertical_speed, speeds.counter_clockwise_rate
        at_1 = (speeds.forward_speed, speeds.left_speed, up, turn)
        turn = speeds.clockwise_rate
        self._speeds = tuple(
            zip((speeds.backward_speed, speeds.right_speed, -up, turn), at_1, strict=True)
        )

    def command(self, action: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return forward, left, up, yaw rate as one command, shape (1, 4); shares are clipped.

        Raises:
            ActionError: It is not four finite numbers.
        """
        try:
            array = np.asarray(action, np.float64)
        except (TypeError, ValueError):
            array = np.empty(0)
        # Plain numbers take a fifth of the time of arrays of four.
        shares = array.tolist() if array.shape == (4,) else [math.nan]
        if not all(map(math.isfinite, shares)):
            raise _refused(action, "four finite numbers, each from -1 to 1")
        pairs = zip(shares, self._speeds, strict=True)
        return np.array([[min(abs(s), 1.0) * ends[s >= 0.0] for s, ends in pairs]])


def _refused(action: object, allowed: str) -> ActionError:
    shown = " ".join(str(action).split())
    return ActionError(f"action: {shown:.60} is not allowed: {allowed}")
