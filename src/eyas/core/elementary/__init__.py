"""Elementary functions for kernels, with the same bytes on every processor.

The C library's differ between its versions and between processors, and kernels must not call
anything outside. All of them work on float64 with nothing but sums, products, quotients and square
roots, each rounded on its own, and are within one unit in the last place of the true value. Not a
number, and what has no value, gives not a number; nothing is raised.

In Python, `eyas.core.elementary_arrays` computes the same for whole arrays.
"""

from eyas.core.elementary.circular import cos, sin, sin_cos, tan
from eyas.core.elementary.exponential import exp, log, power, tanh
from eyas.core.elementary.inverse import acos, asin, atan, atan2
from eyas.core.elementary.lengths import hypot

__all__ = [
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
