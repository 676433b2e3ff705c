"""What happens in a protocol's flights beside the flights: covered cameras, words, own figures."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Scenario", "Told"]

Mask = NDArray[np.bool_]


class Told(NamedTuple):
    """What N policies are told of their targets at the start."""

    words: tuple[str, ...]
    """A phrase for each."""
    attributes: NDArray[np.float32]
    """What the phrase says, as numbers, shape (N, A)."""


class Scenario:
    """Nothing happens beside N flights: protocols override what they need.

    Args:
        count: N.
    """

    def __init__(self, count: int) -> None:
        self._nobody = np.zeros(count, np.bool_)

    def told(self) -> Told | None:
        """Return what policies are told at the start; None: no words."""
        return None

    def covered(self, step: int) -> Mask:
        """Return whose cameras show nothing at a control step, shape (N,)."""
        return self._nobody

    def measure(self, step: int, active: Mask) -> None:
        """Measure after a control step of the active flights, shape (N,)."""

    def over(self, active: Mask) -> Mask:
        """Return whose figures are final, shape (N,); `active` tells who still flies."""
        return ~active

    def figures(self, row: int) -> dict[str, float | None]:
        """Return the figures of an episode that has ended, beside those of all protocols.

        Args:
            row: Its place in the batch.
        """
        return {}
