"""Environments for LeRobot: observations by its names, and a function that its EnvHub calls.

An `env.py` of one line makes a repository on its hub: `from eyas import make_lerobot_env as
make_env`.
"""

from collections.abc import Mapping
from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

from eyas.engine.core.errors import ConfigError
from eyas.engine.envs.choice import EnvChoices, Source
from eyas.engine.envs.vector_env import EyasVectorEnv, Stepped
from eyas.engine.settings.env import ObservationPart
from eyas.engine.task.packet_rows import FLOWN_STATE

_IMAGE, _SENSORS = ObservationPart.IMAGE.value, ObservationPart.SENSORS.value
_NAMES = {
    _IMAGE: "pixels",
    _SENSORS: "agent_pos",
    ObservationPart.PRIVILEGED.value: "environment_state",
}
_CAMERA = "camera"  # LeRobot calls its pictures `observation.images.camera`, as `eyas export` does
SUCCESS = 0.5  # Share of an episode's full length in view from which it counts as a success


class LeRobotVectorEnv(gymnasium.vector.VectorWrapper[Any, Any, Any, Any, Any]):
    """N environments with LeRobot's names: `pixels`, whose `camera` has shape (H, W, 3);
    `agent_pos`, position [m], velocity [m/s] and orientation by the sensors, world frame, shape
    (10,), which exports call `observation.state`; and `environment_state` if
    `env.observation.parts` has `privileged`.

    `info["is_success"]` tells whether an episode was rewarded for at least half of its full length;
    it is False while it goes on.

    Args:
        env: The environments, with several parts in their observations.
    """

    def __init__(self, env: EyasVectorEnv) -> None:
        super().__init__(env)
        self._rewarded = np.zeros(self.num_envs, np.int64)
        single = env.single_observation_space
        if not isinstance(single, gymnasium.spaces.Dict) or not set(single) <= set(_NAMES):
            raise ConfigError(
                "env.observation.parts: not allowed: at least two of image, sensors, privileged"
            )
        self.single_observation_space = gymnasium.spaces.Dict(
            {_NAMES[name]: _space(name, space) for name, space in single.items()}
        )
        self.observation_space = gymnasium.vector.utils.batch_space(
            self.single_observation_space, self.num_envs
        )

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> Any:  # noqa: ANN401  # as in Gymnasium
        """Begin new episodes."""
        observations, info = self.env.reset(seed=seed, options=options)
        self._rewarded[:] = 0
        return _renamed(observations), self._judged(info, np.zeros(self.num_envs, np.bool_))

    def step(self, actions: Any) -> Stepped:  # noqa: ANN401  # as in Gymnasium
        """Hold an action in each environment."""
        observations, rewards, terminated, truncated, info = self.env.step(actions)
        self._rewarded += rewards > 0.0
        ended = terminated | truncated
        self._judged(info, ended)
        self._rewarded[ended] = 0
        return _renamed(observations), rewards, terminated, truncated, info

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:  # noqa: ANN401  # anything
        """Return an attribute of each environment, or call it."""
        return self._eyas.call(name, *args, **kwargs)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return an attribute of each environment."""
        return self._eyas.get_attr(name)

    @property
    def _eyas(self) -> EyasVectorEnv:
        assert isinstance(self.env, EyasVectorEnv)
        return self.env

    def _judged(self, info: dict[str, Any], ended: Any) -> dict[str, Any]:  # noqa: ANN401  # a mask
        limits = np.array(self._eyas.call("_max_episode_steps"))
        info["is_success"] = ended & (self._rewarded >= SUCCESS * limits)
        info["_is_success"] = np.ones(self.num_envs, np.bool_)
        if "final_info" in info:
            info["final_info"] |= {"is_success": info["is_success"], "_is_success": ended}
        return info


def make_lerobot_env(
    n_envs: int = 1,
    use_async_envs: bool = False,  # LeRobot's signature
    cfg: Source = None,
    **choices: Unpack[EnvChoices],
) -> LeRobotVectorEnv:
    """Return environments as LeRobot's EnvHub wants them.

    Args:
        n_envs: Number of environments.
        use_async_envs: Without effect: all threads of one process step them already.
        cfg: Settings, see `eyas.engine.envs.choice.Source`.
        choices: Settings by keyword, see `eyas.engine.envs.choice.EnvChoices`.
    """
    choices.setdefault("observation", {"parts": ["image", "sensors"]})
    choices.setdefault("actions", "velocity")
    return LeRobotVectorEnv(
        EyasVectorEnv(
            n_envs, cfg, autoreset_mode=AutoresetMode.SAME_STEP, render_mode="rgb_array", **choices
        )
    )


def _renamed(observations: Mapping[str, Any]) -> Any:  # noqa: ANN401  # observations
    found: dict[str, Any] = {}
    for name, array in observations.items():
        if name == _SENSORS:
            array = array[:, FLOWN_STATE]
        found[_NAMES[name]] = {_CAMERA: array} if name == _IMAGE else array
    return found


def _space(name: str, space: gymnasium.Space[Any]) -> gymnasium.Space[Any]:
    """Return the space of one part of `_renamed`."""
    if name == _IMAGE:
        return gymnasium.spaces.Dict({_CAMERA: space})
    if name != _SENSORS:
        return space
    assert isinstance(space, gymnasium.spaces.Box)
    low, high = space.low[FLOWN_STATE], space.high[FLOWN_STATE]
    return gymnasium.spaces.Box(low, high, dtype=space.dtype.type)
