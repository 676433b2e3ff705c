"""A window that shows pictures, by pygame."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import MissingExtraError

if TYPE_CHECKING:
    import pygame

__all__ = ["Window", "load_pygame"]


class Window:
    """A window for the pictures of one environment; it opens with the first picture.

    Args:
        rate: Largest number of pictures per second.

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
