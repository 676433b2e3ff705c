"""What actions mean, found out on a device."""

import math
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import ActionError
from eyas.envs.actions import Actions, Discrete, Shares, Velocity
from eyas.envs.device.tensors import is_tensor, torch_of
from eyas.envs.mixed_batch import array_of
from eyas.lanes import parallel
from eyas.lanes.device import Device

__all__ = ["DeviceActions"]


class Numbers(NamedTuple):
    """Actions that are numbers of a table."""

    action: NDArray[np.int64]
    """Shape (N,)."""
    table: NDArray[np.float64]
    """The command of each number, shape (7, 4)."""


class Quads(NamedTuple):
    """Actions of four numbers."""

    action: NDArray[np.float64]
    """Shape (N, 4)."""
    low: NDArray[np.float64]
    """They are clipped to this, shape (4,)."""
    high: NDArray[np.float64]
    """And to this, shape (4,)."""
    per_unit: NDArray[np.float64]
    """What 1 means if it is a share, shape (4,)."""
    per_minus: NDArray[np.float64]
    """What -1 means if it is a share, shape (4,)."""
    units: NDArray[np.float64]
    """What it is divided by if it is none, shape (4,)."""
    shares: int
    """1: they are shares."""


class Commanded(NamedTuple):
    """What actions mean."""

    commands: NDArray[np.float64]
    """See `eyas.trackers.tracker.Tracker.advance`, shape (N, 4)."""
    refused: NDArray[np.int64]
    """1: one of the actions is not allowed, shape (1,)."""


class DeviceActions:
    """Writes the commands of N agents.

    Args:
        actions: What an agent chooses from.
        device: Where the commands are.
        commands: Shape (N, 4), on the device.
    """

    def __init__(self, actions: Actions, device: Device, commands: Any) -> None:  # noqa: ANN401
        self._actions, self._device, self._commands = actions, device, commands
        self._count = commands.shape[0]
        self._refused = device.zeros(1, np.int64)
        if isinstance(actions, Discrete):
            self._given = device.zeros(self._count, np.int64)
            given: Numbers | Quads = Numbers(self._given, actions.table)
            self._call = _command_numbers
        else:
            assert isinstance(actions, Shares | Velocity)
            self._given = device.zeros((self._count, 4), np.float64)
            given = Quads(self._given, actions.low, actions.high, actions.at_1, actions.at_minus_1,
                          actions.UNITS, int(isinstance(actions, Shares)))  # fmt: skip
            self._call = _command_quads
        self._held = device.held(given), device.held(Commanded(commands, self._refused))

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
        device.launch(self._call, self._count, *self._held)
        if device.read(self._refused)[0]:
            raise ActionError(f"actions: one is not allowed: {self._actions.allowed}")


@parallel
def _command_numbers(worker: int, workers: int, given: Numbers, out: Commanded) -> None:
    """Write what `Discrete.commands` returns."""
    for n in range(worker, given.action.shape[0], workers):
        action = given.action[n]
        if action < 0 or action >= given.table.shape[0]:
            out.refused[0] = 1  # whoever writes it
            continue
        for axis in range(4):
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
