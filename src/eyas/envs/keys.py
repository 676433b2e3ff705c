"""Keys of `gymnasium.utils.play`: W, A, S, D move, Q and E turn, R and F climb and sink.

Nothing pressed must mean hover: `play(env, noop=hover(env.action_space))`.
"""

from collections.abc import Callable, Mapping
from itertools import product
from typing import Any

import gymnasium
import numpy as np

from eyas.envs.actions import Velocity
from eyas.envs.config import ActionKind, EnvSpeeds

__all__ = ["KEYS_TO_ACTION", "hover"]

Keys = dict[tuple[str, ...], Any]

_NUMBERS = {"w": 0, "s": 1, "a": 2, "d": 3, "q": 4, "e": 5}
_PAIRS = ("ws", "ad", "rf", "qe")
"""Keys for 1 and -1 on each axis: forward, left, up, turn counter-clockwise."""


def _discrete(_: EnvSpeeds) -> Keys:
    return {(key,): number for key, number in _NUMBERS.items()}


def _shares(_: EnvSpeeds) -> Keys:
    """Return the action of each set of keys that do not contradict each other."""
    keys: Keys = {}
    for signs in product((0, 1, -1), repeat=4):
        pressed = [pair[0 if s > 0 else 1] for pair, s in zip(_PAIRS, signs, strict=True) if s]
        if pressed:
            keys[tuple(pressed)] = np.array(signs, np.float32)
    return keys


def _velocities(speeds: EnvSpeeds) -> Keys:
    space = Velocity(speeds).space
    assert isinstance(space, gymnasium.spaces.Box)
    return {
        keys: np.where(shares > 0, space.high, np.where(shares < 0, space.low, 0.0)).astype("f4")
        for keys, shares in _shares(speeds).items()
    }


KEYS_TO_ACTION: Mapping[ActionKind, Callable[[EnvSpeeds], Keys]] = {
    ActionKind.DISCRETE: _discrete,
    ActionKind.SHARES: _shares,
    ActionKind.VELOCITY: _velocities,
}
"""Returns the keys for each kind of actions."""


def hover(space: gymnasium.Space[Any]) -> Any:  # noqa: ANN401  # an action of the space
    """Return the action that stays in place."""
    return 6 if isinstance(space, gymnasium.spaces.Discrete) else np.zeros(4, np.float32)
