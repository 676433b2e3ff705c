"""Elementary functions for kernels, with the same bytes on every processor.

The C library's differ between its versions and between processors, and kernels must not call
anything outside. All of them work on float64 with nothing but sums, products, quotients and square
roots, each rounded on its own, and are within one unit in the last place of the true value. Not a
number, and what has no value, gives not a number; nothing is raised.

In Python, `eyas.lanes.elementary.arrays` computes the same for whole arrays.
"""

from eyas.lanes.elementary.circular import cos, sin, sin_cos, tan
from eyas.lanes.elementary.exponential import exp, log, power, tanh
from eyas.lanes.elementary.inverse import acos, asin, atan, atan2
from eyas.lanes.elementary.lengths import hypot

__all__ = [
    "OF_MATH",
    "OF_NUMPY",
    "acos",
    "asin",
    "atan",
    "atan2",
    "cos",
    "exp",
    "hypot",
    "log",
    "power",
    "sin",
    "sin_cos",
    "tan",
    "tanh",
]

OF_MATH = ("acos", "asin", "atan", "atan2", "cos", "exp", "hypot", "log", "sin", "tan", "tanh")
"""Those that `math` has by the same names; kernels that name `math`'s get these."""

OF_NUMPY = tuple(
    (name, name.replace("a", "arc", 1) if name[0] == "a" else name) for name in OF_MATH
)
"""Those that numpy has, with its names for them."""
