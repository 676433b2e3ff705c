"""The vector environment for stable-baselines3, which takes none of Gymnasium's."""

import time
from collections.abc import Iterable, Sequence
from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError, MissingExtraError
from eyas.engine.envs.choice import EnvChoices, Source
from eyas.engine.envs.information import Info
from eyas.engine.envs.observation import Observation
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.settings.env import ObservationPart

try:
    from stable_baselines3.common.monitor import Monitor
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as error:
    raise MissingExtraError("eyas.engine.envs.sb3", "train") from error

Indices = None | int | Iterable[int]


class EyasVecEnv(VecEnv):  # type: ignore[misc]  # no types where it is not installed
    """N environments as one `VecEnv`. Pictures are channels-first unless chosen otherwise.

    `infos` holds what stable-baselines3 reads: at the end of an episode the last observation
    (`terminal_observation`), whether it was cut off (`TimeLimit.truncated`), and its return, length
    and time (`episode`, as from `VecMonitor`).

    Attributes:
        info: What all environments tell after the last step, in arrays; see
            `eyas.engine.envs.information`.

    Args:
        num_envs: N.
        config: Settings, see `eyas.engine.envs.choice.Source`.
        render_mode: `rgb_array` or None.
        overlay: As for `TrackingEnv`.
        choices: Settings by keyword, see `eyas.engine.envs.choice.EnvChoices`.

    Raises:
        EyasError: A setting is wrong; the message is one line.
    """

    def __init__(
        self,
        num_envs: int,
        config: Source = None,
        *,
        render_mode: str | None = None,
        overlay: bool = False,
        **choices: Unpack[EnvChoices],
    ) -> None:
        choices.setdefault("observation", {"layout": "chw"})
        self._env = EyasVectorEnv(
            num_envs,
            config,
            autoreset_mode=AutoresetMode.SAME_STEP,
            render_mode=render_mode,
            overlay=overlay,
            **choices,
        )
        space = self._env.single_observation_space
        if isinstance(space, gymnasium.spaces.Dict) and ObservationPart.WORDS in space.spaces:
            raise ConfigError(
                "env.observation.parts: 'words' is not allowed here: stable-baselines3 takes no "
                "text; use 'attributes'"
            )
        self._actions: NDArray[Any] = np.zeros(0)
        self._return, self._length = np.zeros(num_envs), np.zeros(num_envs, np.int64)
        self._start = time.monotonic()
        self.info: Info = {}
        super().__init__(
            num_envs, self._env.single_observation_space, self._env.single_action_space
        )

    def reset(self) -> Observation:
        """Begin new episodes, of the seeds that `seed` has set."""
        seeds = None if all(seed is None for seed in self._seeds) else list(self._seeds)
        observations, self.info = self._env.reset(seed=seeds)
        self.reset_infos = [{"seed": int(seed)} for seed in self.info["seed"]]
        self._return[:], self._length[:] = 0.0, 0
        self._reset_seeds()
        self._reset_options()
        return observations

    def step_async(self, actions: NDArray[Any]) -> None:
        """Take the actions of the next step."""
        self._actions = actions

    def step_wait(self) -> tuple[Observation, NDArray[np.float32], NDArray[np.bool_], list[Info]]:
        """Return observations, rewards, ends and `infos` after the actions."""
        observations, rewards, terminated, truncated, self.info = self._env.step(self._actions)
        done = terminated | truncated
        self._return += rewards
        self._length += 1
        infos: list[Info] = [{} for _ in range(self.num_envs)]
        for index in np.flatnonzero(done).tolist():
            infos[index] = {
                "terminal_observation": self.info["final_obs"][index],
                "TimeLimit.truncated": bool(truncated[index]),
                "episode": {
                    "r": float(self._return[index]),
                    "l": int(self._length[index]),
                    "t": round(time.monotonic() - self._start, 6),
                },
            }
        self._return[done], self._length[done] = 0.0, 0
        return observations, rewards.astype(np.float32), done, infos

    def close(self) -> None:
        """Free what the environments hold."""
        self._env.close()

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """Return an attribute of some environments."""
        sub_envs = map(self._env.sub_env, self._get_indices(indices))
        return [getattr(sub_env, attr_name) for sub_env in sub_envs]

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:  # noqa: ANN401  # anything
        """Give some environments an attribute."""
        for index in self._get_indices(indices):
            setattr(self._env.sub_env(index), attr_name, value)

    def env_method(
        self,
        method_name: str,
        *method_args: Any,  # noqa: ANN401  # anything
        indices: Indices = None,
        **method_kwargs: Any,  # noqa: ANN401  # anything
    ) -> list[Any]:
        """Call a method of some environments."""
        methods = self.get_attr(method_name, indices)
        return [method(*method_args, **method_kwargs) for method in methods]

    def env_is_wrapped(self, wrapper_class: Any, indices: Indices = None) -> list[bool]:  # noqa: ANN401  # a class
        """Return whether each does what a wrapper does: `Monitor`'s part is done, see above."""
        monitored = issubclass(wrapper_class, Monitor)
        return [monitored for _ in self._get_indices(indices)]

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """Return the cameras' pictures."""
        return self._env.render() or [None] * self.num_envs
