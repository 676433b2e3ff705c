"""What happens in a protocol's flights beside the flights: covered cameras, words, own figures."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.policies.policy import Instruction

Mask = NDArray[np.bool_]


class Scenario:
    """Nothing happens beside N flights: protocols override what they need."""

    def __init__(self, count: int) -> None:
        self._nobody = np.zeros(count, np.bool_)

    def instruction(self) -> Instruction | None:
        """Return the instruction of policies at the start; None: no words."""
        return None

    def new_instruction(self, step: int) -> Instruction | None:
        """Return the instructions from a control step on; None: they stay as they are."""
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
        """Return the figures of an episode that has ended, beside those of all protocols."""
        return {}
