"""Playing by hand: a window that shows pictures, by pygame, and keys of `gymnasium.utils.play`.

W, A, S, D move, Q and E turn, R and F climb and sink; K and I turn the camera down and up, J and L
to the left and right. Nothing pressed must mean hover:
`play(env, noop=hover_action(env.action_space))`.
"""

from itertools import product
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import MissingExtraError
from eyas.engine.envs.actions import make_actions
from eyas.engine.settings.env import EnvConfig

if TYPE_CHECKING:
    import pygame


class Window:
    """A window for the pictures of one environment; it opens with the first picture.

    Raises:
        MissingExtraError: pygame is not installed.
    """

    def __init__(self, rate: int) -> None:
        self._pygame = load_pygame()
        self._rate = rate
        self._clock = self._pygame.time.Clock()
        self._screen: pygame.Surface | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        """Describe a copy: a window of its own."""
        return Window, (self._rate,)

    def show(self, picture: NDArray[np.uint8]) -> None:
        """Show a picture, RGB, shape (H, W, 3); wait if the last one is not old enough."""
        if self._screen is None:
            self._pygame.display.init()
            self._pygame.display.set_caption("Eyas")
            self._screen = self._pygame.display.set_mode(picture.shape[1::-1])
        self._pygame.event.pump()  # else the system takes the window for frozen
        self._pygame.surfarray.blit_array(self._screen, picture.swapaxes(0, 1))
        self._pygame.display.flip()
        self._clock.tick(self._rate)

    def close(self) -> None:
        """Close the window."""
        if self._screen is not None:
            self._pygame.display.quit()
            self._screen = None


def load_pygame() -> Any:  # noqa: ANN401  # a module
    """Return the module.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import pygame
    except ImportError as error:
        raise MissingExtraError("a window", "play") from error
    return pygame


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
