"""The picture that weights trained with the original expect."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError

Floats = NDArray[np.float32]


def scrambled(pictures: NDArray[np.uint8], *, centred: bool = False) -> Floats:
    """Return pictures as the original's client hands them to its networks.

    It reads an array in the order rows, columns, channels as if it had the order channels, rows,
    columns, without moving any number. All three baselines published with it learned from that.

    Args:
        pictures: RGB, shape (..., H, W, 3).
        centred: True: -1 to 1 (the client's `Norm_Type` 1); False: 0 to 1 (0, its default).

    Returns:
        Shape (..., 3, H, W).
    """
    *leading, height, width, channels = pictures.shape
    numbers = pictures.astype(np.float32)
    numbers = (numbers - 128.0) / 128.0 if centred else numbers / 255.0
    return numbers.reshape(*leading, channels, height, width)


class LegacyObservation(gymnasium.ObservationWrapper[Floats, Any, NDArray[np.uint8]]):
    """Gives the scrambled picture of the original's client, see `scrambled`.

    For a vector environment:
    `gymnasium.wrappers.vector.TransformObservation(env, scrambled, space)`.

    Args:
        env: Its observations are RGB pictures, shape (H, W, 3).
        centred: See `scrambled`.

    Raises:
        ConfigError: The observations are something else.
    """

    def __init__(self, env: gymnasium.Env[Any, Any], *, centred: bool = False) -> None:
        super().__init__(env)
        space = env.observation_space
        if space.shape is None or space.shape[2:] != (3,) or space.dtype != np.uint8:
            raise ConfigError("env: not allowed: its observations must be RGB, shape (H, W, 3)")
        height, width, _ = space.shape
        low, high = (-1.0, 1.0) if centred else (0.0, 1.0)
        self.observation_space = gymnasium.spaces.Box(low, high, (3, height, width), np.float32)
        self._centred = centred

    def observation(self, observation: NDArray[np.uint8]) -> Floats:
        """Return one picture, scrambled."""
        return scrambled(observation, centred=self._centred)
