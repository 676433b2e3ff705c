"""Short names of scalar types. A bare number in a kernel is float64 or int64 and drags along all it
meets, so constants in float32 arithmetic are written `f4(0.5)`.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

__all__ = ["f4", "i4", "i8", "u4"]

if TYPE_CHECKING:  # numba gives all scalars their exact type; to mypy they are float and int
    f4: Callable[[float], float]
    i4: Callable[[float], int]
    i8: Callable[[float], int]
    u4: Callable[[float], int]
else:
    f4, i4, i8, u4 = np.float32, np.int32, np.int64, np.uint32
