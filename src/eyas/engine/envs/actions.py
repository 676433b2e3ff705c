"""The actions of agents, and the commands that they mean."""

from typing import Any, Protocol

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ActionError
from eyas.engine.settings.env import ActionKind, ActionSpeeds, EnvConfig, EnvSpeeds, GimbalConfig
from eyas.engine.trackers.gimbal_command import WIDTH, WITH_GIMBAL

Commands = NDArray[np.float64]
"""Forward [m/s], left [m/s], up [m per 2 ms], counter-clockwise [rad/s], shape (N, 4); or with what
turns the camera, shape (N, 8), see `eyas.engine.trackers.gimbal_command`."""


class Actions(Protocol):
    """A space of actions."""

    space: gymnasium.Space[Any]  # The actions of one agent
    allowed: str  # The allowed actions in words

    def commands(self, actions: Any) -> Commands:  # noqa: ANN401  # whatever a learner returns
        """Return the commands of N actions.

        Raises:
            ActionError: One of them is not in the space of actions.
        """


def make_actions(env: EnvConfig) -> Actions:
    """Return the actions of some settings."""
    speeds, gimbal = env.speeds, env.gimbal
    match env.actions:
        case ActionKind.DISCRETE:
            return Discrete(speeds)
        case ActionKind.SHARES:
            return Shares(speeds)
        case ActionKind.VELOCITY:
            return Velocity(speeds)
        case ActionKind.DISCRETE_GIMBAL:
            return DiscreteGimbal(speeds, gimbal)
        case ActionKind.SHARES_GIMBAL:
            return GimbalNumbers(Shares(speeds), gimbal, shares=True)
        case ActionKind.VELOCITY_GIMBAL:
            return GimbalNumbers(Velocity(speeds), gimbal, shares=False)


def command_width(kind: ActionKind) -> int:
    """Return how many numbers the command of an action has."""
    return WITH_GIMBAL if kind.gimbal else WIDTH


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


class Discrete:
    """Seven actions, one axis at a time.

    0 forward, 1 backward, 2 left, 3 right, 4 turn counter-clockwise, 5 turn clockwise, 6 hover.

    Attributes:
        table: The command of each, shape (7, 4).
    """

    allowed = "a whole number from 0 to 6"

    def __init__(self, speeds: ActionSpeeds) -> None:
        self.space: gymnasium.Space[Any] = gymnasium.spaces.Discrete(7)
        self.table = np.concatenate((action_table(speeds), np.zeros((1, 4))))

    def commands(self, actions: Any) -> Commands:  # noqa: ANN401  # as in the protocol
        """Return the commands of N numbers, shape (N,)."""
        numbers = _array(actions)
        if numbers.ndim != 1 or numbers.dtype.kind not in "iu":
            raise _refused(actions, self.allowed)
        if numbers.size and not 0 <= numbers.min() <= numbers.max() < len(self.table):
            wrong = int(np.flatnonzero((numbers < 0) | (numbers >= len(self.table)))[0])
            raise _refused(numbers[wrong], self.allowed, wrong, len(numbers))
        commands: Commands = self.table[numbers]
        return commands


class FourNumbers:
    """Four numbers: forward, left, up, turn counter-clockwise; out of range, they are clipped.

    Attributes:
        low: Smallest of each, shape (4,).
        high: Largest of each, shape (4,).
        at_minus_1: Commands backward, right, down, clockwise, shape (4,).
        at_1: Their opposites, shape (4,).
    """

    allowed = "four finite numbers"
    UNITS = np.array([1.0, 1.0, 500.0, 1.0])
    """Factors on commanded velocities: the third is in m per 2 ms."""

    def __init__(self, low: Commands, high: Commands, ends: tuple[Commands, Commands]) -> None:
        self.space: gymnasium.Space[Any] = gymnasium.spaces.Box(
            low.astype(np.float32), high.astype(np.float32)
        )
        self.low, self.high = low, high
        self.at_minus_1, self.at_1 = ends

    def clipped(self, actions: Any) -> Commands:  # noqa: ANN401  # as in the protocol
        """Return N actions within the limits, shape (N, 4)."""
        return _clipped(actions, self.low, self.high, self.allowed)


class Shares(FourNumbers):
    """Four numbers in -1 to 1: forward, left, up, turn counter-clockwise, as shares of the speeds.

    Args:
        speeds: The speeds that -1 and 1 mean.
    """

    allowed = "four finite numbers, each from -1 to 1"

    def __init__(self, speeds: EnvSpeeds) -> None:
        super().__init__(-np.ones(4), np.ones(4), _ends(speeds))

    def commands(self, actions: Any) -> Commands:  # noqa: ANN401  # as in the protocol
        """Return the commands of N times four shares, shape (N, 4)."""
        shares = self.clipped(actions)
        return np.abs(shares) * np.where(shares >= 0.0, self.at_1, self.at_minus_1)


class Velocity(FourNumbers):
    """Four velocities: forward, left, up [m/s], turn counter-clockwise [rad/s]."""

    allowed = "four finite numbers: forward, left, up [m/s], turn counter-clockwise [rad/s]"

    def __init__(self, speeds: EnvSpeeds) -> None:
        ends = _ends(speeds)
        super().__init__(np.minimum(*ends) * self.UNITS, np.maximum(*ends) * self.UNITS, ends)

    def commands(self, actions: Any) -> Commands:  # noqa: ANN401  # as in the protocol
        """Return the commands of N times four velocities, shape (N, 4)."""
        commands: Commands = self.clipped(actions) / self.UNITS
        return commands


class DiscreteGimbal(Discrete):
    """Eleven actions: those of `Discrete`, then 7 camera down, 8 up, 9 left, 10 right."""

    allowed = "a whole number from 0 to 10"

    def __init__(self, speeds: EnvSpeeds, gimbal: GimbalConfig) -> None:
        super().__init__(speeds)
        rates = np.zeros((11, 2))
        rates[7:9, 0] = gimbal.pitch_rate, -gimbal.pitch_rate
        rates[9:11, 1] = gimbal.yaw_rate, -gimbal.yaw_rate
        flown = np.concatenate((self.table, np.zeros((4, WIDTH))))
        self.space = gymnasium.spaces.Discrete(11)
        self.table = np.concatenate((flown, turn_commands(rates, gimbal)), axis=1)


class GimbalNumbers:
    """Six numbers: those of `Shares` or `Velocity`, then camera down, and to the left.

    Attributes:
        own: The first four.
        gimbal: Rates and range of the camera.
        rates: What is multiplied with the last two to get rates [rad/s], shape (2,).

    Args:
        own: As above.
        gimbal: As above.
        shares: Whether the last two are shares of the rates; else they are rates [rad/s].
    """

    def __init__(self, own: Shares | Velocity, gimbal: GimbalConfig, *, shares: bool) -> None:
        rates = np.array([gimbal.pitch_rate, gimbal.yaw_rate])
        self.own, self.gimbal = own, gimbal
        self.rates = rates if shares else np.ones(2)
        limit = np.ones(2) if shares else rates
        self.low = np.concatenate((own.low, -limit))
        self.high = np.concatenate((own.high, limit))
        self.allowed = own.allowed.replace("four", "six")
        if not shares:
            self.allowed += ", camera down, camera to the left [rad/s]"
        self.space: gymnasium.Space[Any] = gymnasium.spaces.Box(
            self.low.astype(np.float32), self.high.astype(np.float32)
        )

    def commands(self, actions: Any) -> Commands:  # noqa: ANN401  # as in the protocol
        """Return the commands of N times six numbers, shape (N, 8)."""
        given = _clipped(actions, self.low, self.high, self.allowed)
        turned = turn_commands(given[:, WIDTH:] * self.rates, self.gimbal)
        return np.concatenate((self.own.commands(given[:, :WIDTH]), turned), axis=1)


def turn_commands(rates: NDArray[np.float64], gimbal: GimbalConfig) -> NDArray[np.float64]:
    """Return the last four numbers of commands, see `eyas.engine.trackers.gimbal_command`.

    Args:
        rates: Rates of pitch, positive down, and yaw, to the left [rad/s], shape (N, 2).
        gimbal: The range.
    """
    least = np.array([gimbal.least_pitch, -gimbal.most_yaw])
    most = np.array([gimbal.most_pitch, gimbal.most_yaw])
    return np.concatenate((np.where(rates >= 0.0, most, least), np.abs(rates)), axis=1)


def turn_rates(commands: Commands, gimbal: GimbalConfig) -> NDArray[np.float64]:
    """Return the rates of pitch, positive down, and yaw, to the left, that commands ask for
    [rad/s], shape (N, 2): what `turn_commands` has taken.
    """
    most = np.array([gimbal.most_pitch, gimbal.most_yaw])
    goals, rates = commands[:, WIDTH : WIDTH + 2], commands[:, WIDTH + 2 : WITH_GIMBAL]
    return np.where(goals >= most, rates, -rates) + 0.0  # no -0.0


def _ends(speeds: EnvSpeeds) -> tuple[Commands, Commands]:
    """Return the commands backward, right, down, clockwise, and their opposites, shape (4,)."""
    up = speeds.vertical_speed
    return (
        np.array([speeds.backward_speed, speeds.right_speed, -up, speeds.clockwise_rate]),
        np.array([speeds.forward_speed, speeds.left_speed, up, speeds.counter_clockwise_rate]),
    )


def _clipped(actions: object, low: Commands, high: Commands, allowed: str) -> Commands:
    """Return N actions of K numbers, shape (N, K), within limits (K,); `ActionError` if one of them
    is not K finite numbers (`allowed` in words).
    """
    given = _array(actions)
    if given.ndim != 2 or given.shape[1] != len(low) or given.dtype.kind not in "fiu":
        raise _refused(actions, allowed)
    array = given.astype(np.float64)
    if not np.isfinite(array).all():
        wrong = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
        raise _refused(given[wrong], allowed, wrong, len(array))
    clipped: Commands = np.minimum(np.maximum(array, low), high)
    return clipped


def _array(actions: object) -> NDArray[Any]:
    try:
        return np.asarray(actions)
    except (TypeError, ValueError):  # for example rows of different lengths
        return np.empty(0)


def _refused(action: object, allowed: str, index: int = 0, count: int = 1) -> ActionError:
    if isinstance(action, list) and len(action) == 1:
        action = action[0]  # that of a single environment
    shown = " ".join(str(action).split())
    which = f"action of environment {index}" if count > 1 else "action"
    return ActionError(f"{which}: {shown:.60} is not allowed: {allowed}")
