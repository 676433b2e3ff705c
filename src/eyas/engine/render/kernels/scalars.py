"""Short names of scalar types. A bare number in a kernel is float64 or int64 and widens all
arithmetic that it takes part in, so constants in float32 arithmetic are written `f4(0.5)`.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

__all__ = ["f4", "i4", "i8", "u4"]

if TYPE_CHECKING:  # numba needs the exact types; for mypy they are float and int
    f4: Callable[[float], float]
    i4: Callable[[float], int]
    i8: Callable[[float], int]
    u4: Callable[[float], int]
else:
    f4, i4, i8, u4 = np.float32, np.int32, np.int64, np.uint32
