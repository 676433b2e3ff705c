"""What actions mean, found out on a device."""

import math
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ActionError
from eyas.engine.envs.actions import (
    Actions,
    Discrete,
    GimbalNumbers,
    Shares,
    Velocity,
    turn_commands,
)
from eyas.engine.envs.mixed_batch import array_of
from eyas.gpu.envs.observation import is_tensor, torch_of
from eyas.lanes import parallel
from eyas.lanes.device import Device


class Numbers(NamedTuple):
    """Actions that are numbers of a table."""

    action: NDArray[np.int64]  # Shape (N,)
    table: NDArray[np.float64]  # The command of each number, shape (7, 4) or (11, 8)


class Quads(NamedTuple):
    """Actions of four numbers."""

    action: NDArray[np.float64]  # Shape (N, 4)
    low: NDArray[np.float64]  # They are clipped to this, shape (4,)
    high: NDArray[np.float64]  # And to this, shape (4,)
    per_unit: NDArray[np.float64]  # What 1 means if it is a share, shape (4,)
    per_minus: NDArray[np.float64]  # What -1 means if it is a share, shape (4,)
    units: NDArray[np.float64]  # What it is divided by if it is none, shape (4,)
    shares: int  # 1: they are shares


class Turns(NamedTuple):
    """The last two numbers of actions of six."""

    action: NDArray[np.float64]  # Shape (N, 6)
    low: NDArray[np.float64]  # They are clipped to this, shape (6,)
    high: NDArray[np.float64]  # And to this, shape (6,)
    per_unit: NDArray[np.float64]  # Rates that 1 means, shape (2,)
    most: NDArray[np.float64]  # Where rates that are not negative lead, shape (2,)
    least: NDArray[np.float64]  # Where others lead, shape (2,)


class Commanded(NamedTuple):
    """What actions mean."""

    commands: NDArray[np.float64]
    """See `eyas.engine.trackers.tracker.Tracker.advance`, shape (N, 4) or (N, 8)."""
    refused: NDArray[np.int64]  # 1: one of the actions is not allowed, shape (1,)


class DeviceActions:
    """Writes the commands of N agents.

    Args:
        actions: What an agent chooses from.
        device: Where the commands are.
        commands: Shape (N, 4), or (N, 8) of those that turn the camera, on the device.
    """

    def __init__(self, actions: Actions, device: Device, commands: Any) -> None:  # noqa: ANN401
        self._actions, self._device, self._commands = actions, device, commands
        self._count = commands.shape[0]
        self._refused = device.zeros(1, np.int64)
        if isinstance(actions, Discrete):
            self._given = device.zeros(self._count, np.int64)
            given: Numbers | Quads = Numbers(self._given, actions.table)
            self._calls = [(_command_numbers, device.held(given))]
        else:
            own = actions.own if isinstance(actions, GimbalNumbers) else actions
            assert isinstance(own, Shares | Velocity)
            self._given = device.zeros((self._count, *(actions.space.shape or ())), np.float64)
            given = Quads(self._given, own.low, own.high, own.at_1, own.at_minus_1,
                          own.UNITS, int(isinstance(own, Shares)))  # fmt: skip
            self._calls = [(_command_quads, device.held(given))]
            if isinstance(actions, GimbalNumbers):
                turns = _turns(actions, self._given)
                self._calls.append((_command_turns, device.held(turns)))
        self._held = device.held(Commanded(commands, self._refused))

    @cached_property
    def _tensor(self) -> Any:  # noqa: ANN401  # of PyTorch
        """The memory for actions that are tensors."""
        return torch_of(self._given)

    def take(self, actions: Any) -> None:  # noqa: ANN401  # whatever a learner returns
        """Write the commands of N actions: a tensor on the device, or anything else that the
        actions take.

        Raises:
            ActionError: One of them is not in the space of actions.
        """
        device = self._device
        if not is_tensor(actions):
            commands = self._actions.commands(array_of(actions, self._count))
            device.write(self._commands, np.ascontiguousarray(commands))
            return
        shape, fractions = tuple(actions.shape), actions.is_floating_point()
        discrete = self._given.dtype == np.int64
        if shape != self._given.shape or (fractions and discrete):
            raise ActionError(
                f"actions: a tensor of shape {shape} and type {actions.dtype} is not allowed: "
                f"{self._actions.allowed} for each of {self._count} environments"
            )
        self._tensor.copy_(actions)
        device.clear(self._refused)
        for call, given in self._calls:
            device.launch(call, self._count, given, self._held)
        if device.read(self._refused)[0]:
            raise ActionError(f"actions: one is not allowed: {self._actions.allowed}")


def _turns(actions: GimbalNumbers, given: Any) -> Turns:  # noqa: ANN401  # on a device
    ends = turn_commands(np.array([[1.0, 1.0], [-1.0, -1.0]]), actions.gimbal)
    return Turns(given, actions.low, actions.high, actions.rates, ends[0, :2], ends[1, :2])


@parallel
def _command_numbers(worker: int, workers: int, given: Numbers, out: Commanded) -> None:
    """Write what `Discrete.commands` returns."""
    for n in range(worker, given.action.shape[0], workers):
        action = given.action[n]
        if action < 0 or action >= given.table.shape[0]:
            out.refused[0] = 1  # whoever writes it
            continue
        for axis in range(given.table.shape[1]):
            out.commands[n, axis] = given.table[action, axis]


@parallel
def _command_quads(worker: int, workers: int, given: Quads, out: Commanded) -> None:
    """Write what `Shares.commands` or `Velocity.commands` returns."""
    for n in range(worker, given.action.shape[0], workers):
        for axis in range(4):
            action = given.action[n, axis]
            if not math.isfinite(action):
                out.refused[0] = 1  # whoever writes it
                continue
            action = min(max(action, given.low[axis]), given.high[axis])
            if given.shares == 1:
                most = given.per_unit[axis] if action >= 0.0 else given.per_minus[axis]
                out.commands[n, axis] = abs(action) * most
            else:
                out.commands[n, axis] = action / given.units[axis]


@parallel
def _command_turns(worker: int, workers: int, given: Turns, out: Commanded) -> None:
    """Write what `GimbalNumbers.commands` returns behind the first four numbers."""
    for n in range(worker, given.action.shape[0], workers):
        for axis in range(2):
            action = given.action[n, 4 + axis]
            if not math.isfinite(action):
                out.refused[0] = 1  # whoever writes it
                continue
            action = min(max(action, given.low[4 + axis]), given.high[4 + axis])
            rate = action * given.per_unit[axis]
            out.commands[n, 4 + axis] = given.most[axis] if rate >= 0.0 else given.least[axis]
            out.commands[n, 6 + axis] = abs(rate)
