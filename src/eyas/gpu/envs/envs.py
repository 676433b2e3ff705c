"""N environments on a device: what `EyasVectorEnv` does there."""

import math
from functools import cached_property
from itertools import compress
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import physics_steps
from eyas.engine.core.errors import ActionError, ConfigError, EyasError
from eyas.engine.envs.actions import (
    Actions,
    Discrete,
    GimbalNumbers,
    Shares,
    Velocity,
    make_actions,
    turn_commands,
)
from eyas.engine.envs.batch import Seeds, Truth
from eyas.engine.envs.mixed_batch import array_of
from eyas.engine.envs.trained_with import describe
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import originals_named
from eyas.engine.sim.build import assets_of, tracker_in
from eyas.engine.sim.worlds import each_alone
from eyas.gpu.envs.devices import device_of, drawer_of
from eyas.gpu.envs.observation import (
    DeviceObserver,
    as_bool,
    copied,
    is_tensor,
    tensor_of,
    torch_of,
)
from eyas.gpu.sim.simulation import DeviceSimulation, downloaded
from eyas.gpu.sim.view import DeviceView
from eyas.lanes import parallel
from eyas.lanes.device import Device

# What actions mean, found out on a device.


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


Mask = NDArray[np.bool_]


class DeviceEnvs:
    """N environments of the same settings, each in a world of its own, on a device.

    Attributes:
        action_space: The actions of one agent.
        observation_space: What it sees.
        ended: Whose episodes the last step has ended, on the host, shape (N,).

    Raises:
        EyasError: A setting is wrong, or not there on a device; the message is one line.
    """

    def __init__(
        self,
        config: EyasConfig,  # The settings
        count: int,  # N
        device: Device | str,  # The device, or its name
        *,
        measures: bool = False,  # As for `EyasVectorEnv`
    ) -> None:
        where = device_of(device)
        _check(config)
        with originals_named(config):
            assets = assets_of(config, each_alone(count))
            seen = config.env.observation
            simulation = self._simulation = DeviceSimulation(
                config,
                assets,
                tracker_in(config, assets),
                count,
                where,
                size=(seen.height, seen.width),
                steps=physics_steps(config.control.frequency),
                repeat=config.env.action_repeat,
                gimbal=config.env.actions.gimbal,
            )
        drawer = drawer_of(where, assets.renderer, config.camera)
        view = DeviceView(simulation, drawer)
        self._observer = DeviceObserver(seen, simulation, view, measures=measures)
        actions = make_actions(config.env)
        describe(actions.space, config)
        self._actions = DeviceActions(actions, where, simulation.commands)
        self.action_space, self.observation_space = actions.space, self._observer.space
        flown = simulation.flown
        ends = (as_bool(tensor_of(array)) for array in (flown.terminated, flown.truncated))
        self._told = tensor_of(flown.reward), *ends
        self.ended = np.zeros(count, np.bool_)

    def __reduce__(self) -> NoReturn:
        """Refuse to be copied."""
        raise EyasError("device: environments on a device cannot be copied")

    def begin(self, chosen: Mask, seeds: Seeds = None) -> None:
        """Begin new episodes, see `eyas.engine.envs.batch.Batch.begin`."""
        trackers = np.flatnonzero(chosen)
        for tracker, seed in zip(trackers.tolist(), compress(seeds or (), chosen), strict=False):
            if seed is not None:
                self._simulation.reseed_alone(np.array([tracker]), np.array([seed]))
        self._simulation.reset(trackers)

    @property
    def seeds(self) -> NDArray[np.int64]:
        """Seed of the sequence of episodes of each, shape (N,)."""
        return self._simulation.seeds

    def step(self, actions: Any, active: Mask) -> tuple[Any, Any, Any]:  # noqa: ANN401  # whatever a learner returns
        """Hold an action of each agent, see `eyas.engine.envs.batch.Batch.step`.

        Returns:
            Rewards, terminations and truncations, as tensors that later steps leave alone.

        Raises:
            ActionError: An action is not in the space of actions.
        """
        simulation = self._simulation
        self._actions.take(actions)
        simulation.advance(active)
        self.ended = np.logical_or(*simulation.ended())
        reward, terminated, truncated = map(copied, self._told)
        return reward, terminated, truncated

    def look(self, chosen: Mask, begun: Mask, *, final: bool = False) -> None:
        """Observe some trackers.

        Args:
            chosen: Which, shape (N,).
            begun: Whose episodes have just begun, shape (N,).
            final: Whether these are the last observations of their episodes.
        """
        self._observer.look(np.flatnonzero(chosen), begun[chosen], final=final)

    def truth(self) -> Truth:
        """Return a copy on the host of what is true now, see `EyasVectorEnv.truth`."""
        simulation = self._simulation
        there = downloaded(simulation.device, simulation.snapshot)
        return Truth(there, self._observer.visible)

    def latest(self, out: Any = None, *, final: bool = False) -> Any:  # noqa: ANN401  # as users get it
        """Return the latest observations, see `DeviceObserver.latest`."""
        return self._observer.latest(out, final=final)


def _check(config: EyasConfig) -> None:
    """Refuse settings of environments that need the host in a step."""
    wanted = {
        "env.mixture: several kinds of environments": bool(config.env.mixture),
        "env.log_folder: a log of each step": config.env.log_folder is not None,
        "verbose: true": config.verbose,
    }
    for setting in compress(wanted, wanted.values()):
        raise ConfigError(f"{setting} is not there on a device; allowed: none")
