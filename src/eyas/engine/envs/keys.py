"""Keys of `gymnasium.utils.play`: W, A, S, D move, Q and E turn, R and F climb and sink; K and I
turn the camera down and up, J and L to the left and right.

Nothing pressed must mean hover: `play(env, noop=hover_action(env.action_space))`.
"""

from itertools import product
from typing import Any

import gymnasium
import numpy as np

from eyas.engine.envs.actions import make_actions
from eyas.engine.settings.env import EnvConfig

__all__ = ["hover_action", "keys_to_action"]

Keys = dict[tuple[str, ...], Any]

_NUMBERS = {"w": 0, "s": 1, "a": 2, "d": 3, "q": 4, "e": 5, "k": 7, "i": 8, "j": 9, "l": 10}
_PAIRS = ("ws", "ad", "rf", "qe", "ki", "jl")
"""Keys for the most and the least on each axis: forward, left, up, turn counter-clockwise, camera
down, camera to the left."""


def keys_to_action(env: EnvConfig) -> Keys:
    """Return the action of each set of keys that do not contradict each other."""
    kind, space = env.actions, make_actions(env).space
    if kind.numbered:
        return {(key,): number for key, number in _NUMBERS.items() if number < kind.size}
    assert isinstance(space, gymnasium.spaces.Box)
    keys: Keys = {}
    for signs in product((0, 1, -1), repeat=kind.size):
        pairs = zip(_PAIRS, signs, strict=False)
        pressed = [pair[0 if sign > 0 else 1] for pair, sign in pairs if sign]
        if pressed:
            ends = np.where(np.array(signs) > 0, space.high, space.low)
            keys[tuple(pressed)] = np.where(signs, ends, 0.0).astype(np.float32)
    return keys


def hover_action(space: gymnasium.Space[Any]) -> Any:  # noqa: ANN401  # an action of the space
    """Return the action that stays in place."""
    if isinstance(space, gymnasium.spaces.Discrete):
        return 6
    return np.zeros(space.shape or (), np.float32)
