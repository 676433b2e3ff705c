"""The low-pass filter of commands and gimbal angles."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.lanes import kernel

# A second-order Butterworth filter by the bilinear transform, as in the original. Its _K for 20 Hz
# is twice pi * 20 Hz * step, so the -3 dB frequency is 39 Hz.
_K = 2.0 * math.pi * 20.0 * PHYSICS_STEP
_D = _K * _K + math.sqrt(2.0) * _K + 1.0
_B0 = _K * _K / _D
_B1 = 2.0 * _B0
_B2 = _B0
_A1 = 2.0 * (_K * _K - 1.0) / _D
_A2 = (_K * _K - math.sqrt(2.0) * _K + 1.0) / _D


@kernel(inline=True)
def low_pass(
    memory: NDArray[np.float64],  # State of one filter, shape (2,); updated
    value: float,  # Input value
) -> float:
    """Return the filtered value of one 2 ms step."""
    # Transposed direct form II: the same response as direct form I with half the state.
    result: float = _B0 * value + memory[0]
    memory[0] = _B1 * value - _A1 * result + memory[1]
    memory[1] = _B2 * value - _A2 * result
    return result


@kernel(inline=True)
def settle(memory: NDArray[np.float64], value: float) -> None:
    """Set the filter to its steady state for the input `value`."""
    memory[1] = (_B2 - _A2) * value
    memory[0] = (_B1 - _A1) * value + memory[1]
