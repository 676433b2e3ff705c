"""The vector environment for PufferLib: N drones that write into the arrays of its trainer."""

from collections.abc import Mapping
from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from eyas.core.errors import ConfigError
from eyas.envs.choice import EnvChoices, Source
from eyas.envs.vector_env import EyasVectorEnv

try:
    from pufferlib import PufferEnv
except ImportError:  # its contract needs nothing of it

    class PufferEnv:  # type: ignore[no-redef]
        """The arrays that PufferLib's own class has."""

        single_observation_space: gymnasium.spaces.Box
        num_agents: int

        def __init__(self, buf: Mapping[str, NDArray[Any]] | None = None) -> None:
            space, count = self.single_observation_space, self.num_agents
            self.observations = np.zeros((count, *space.shape), space.dtype)
            self.rewards = np.zeros(count, np.float32)
            self.terminals, self.truncations = np.zeros((2, count), np.bool_)
            self.masks = np.ones(count, np.bool_)
            vars(self).update(buf or {})


__all__ = ["EyasPufferEnv"]

Infos = list[dict[str, float]]


class EyasPufferEnv(PufferEnv):  # type: ignore[misc]  # no types
    """N environments as one `PufferEnv`: arrays are written in place, episodes follow each other.

    Args:
        num_envs: N.
        config: Settings, see `eyas.envs.choice.Source`.
        buf: PufferLib's arrays; None: new ones.
        seed: Seed of the first reset; None: that of the configuration, or a fresh one.
        render_mode: `rgb_array` or None.
        choices: Settings by keyword, see `eyas.envs.choice.EnvChoices`; an observation has one
            part.

    Raises:
        EyasError: A setting is wrong; the message is one line.
    """

    def __init__(
        self,
        num_envs: int = 64,
        config: Source = None,
        *,
        buf: Mapping[str, NDArray[Any]] | None = None,
        seed: int | None = None,
        render_mode: str | None = None,
        **choices: Unpack[EnvChoices],
    ) -> None:
        self._env = EyasVectorEnv(
            num_envs,
            config,
            autoreset_mode=AutoresetMode.SAME_STEP,
            render_mode=render_mode,
            **choices,
        )
        self.single_observation_space = self._env.single_observation_space
        self.single_action_space = self._env.single_action_space
        self.num_agents, self.render_mode = num_envs, render_mode
        if not isinstance(self.single_observation_space, gymnasium.spaces.Box):
            raise ConfigError("env.observation.parts: not allowed: one part, as PufferLib wants it")
        super().__init__(buf)
        self._seed = seed
        self._return, self._length = np.zeros(num_envs), np.zeros(num_envs, np.int64)

    def reset(self, seed: int | None = None) -> tuple[NDArray[Any], Infos]:
        """Begin new episodes.

        Args:
            seed: s; the environments have the seeds from s N on, since PufferLib gives s + 1 to its
                next process. None: they continue.
        """
        seed, self._seed = self._seed if seed is None else seed, None
        first = None if seed is None else seed * self.num_agents
        self._env.reset(seed=first, out=self.observations)
        self.rewards[:], self.terminals[:], self.truncations[:] = 0.0, False, False
        self._return[:], self._length[:] = 0.0, 0
        return self.observations, []

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any], Infos]:
        """Return the arrays after an action of each, and the figures of episodes that ended."""
        _, reward, terminated, truncated, _ = self._env.step(actions, out=self.observations)
        self.rewards[:], self.terminals[:], self.truncations[:] = reward, terminated, truncated
        self._return += reward
        self._length += 1
        ended = terminated | truncated
        infos = [
            {"episode_return": total, "episode_length": float(length)}
            for total, length in zip(
                self._return[ended].tolist(), self._length[ended].tolist(), strict=True
            )
        ]
        self._return[ended], self._length[ended] = 0.0, 0
        return self.observations, self.rewards, self.terminals, self.truncations, infos

    def render(self) -> NDArray[np.uint8] | None:
        """Return the picture of the first camera, shape (H, W, 3)."""
        return None if self.render_mode is None else self._env.render_one(0)

    def close(self) -> None:
        """Free what the environments hold."""
        self._env.close()
