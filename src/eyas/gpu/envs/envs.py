"""N environments on a device: what `EyasVectorEnv` does there."""

from itertools import compress
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import physics_steps
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.envs.actions import make_actions
from eyas.engine.envs.batch import Seeds, Truth
from eyas.engine.envs.trained_with import describe
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import originals_named
from eyas.engine.sim.build import assets_of, tracker_in
from eyas.engine.sim.worlds import each_alone
from eyas.gpu.envs.actions import DeviceActions
from eyas.gpu.envs.devices import device_of, drawer_of
from eyas.gpu.envs.observation import DeviceObserver, as_bool, copied, tensor_of
from eyas.gpu.sim.simulation import DeviceSimulation, downloaded
from eyas.gpu.sim.view import DeviceView
from eyas.lanes.device import Device

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
        drawer = drawer_of(where, assets.renderer, config.camera.samples)
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
