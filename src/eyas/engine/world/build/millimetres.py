"""Plan geometry in whole millimetres, so that a map is the same on every processor.

Sines, logarithms and matrix products differ in their last bits from one processor to the next,
because numpy and BLAS choose their kernels by the features of the processor. A last bit can decide
whether a point lies on a line, and after the first different decision all random numbers differ.
So the results of such functions are rounded before any decision depends on them.
"""

import math

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

_DIGITS = 3  # Decimals of metres
_STEP = 0.001  # One millimetre [m]


def rounded(points: ArrayLike) -> NDArray[np.float64]:
    """Return coordinates as whole millimetres [m]."""
    return np.round(np.asarray(points, np.float64), _DIGITS).astype(np.float64, copy=False)


def snapped(shape: shapely.Geometry) -> shapely.Geometry:
    """Return a valid shape whose corners are at whole millimetres [m], without slivers."""
    whole = shapely.set_precision(shape, _STEP)
    # Shapes that are cut out of this one later must not be rounded: the edges would no longer meet.
    return shapely.set_precision(whole, 0.0)


def dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Return the dot product of two vectors in a plane, without BLAS."""
    return float(a[0] * b[0] + a[1] * b[1])


def length(vector: NDArray[np.float64]) -> float:
    """Return the length of a vector in a plane, without BLAS."""
    return math.sqrt(dot(vector, vector))


def unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the vector of length 1 in the same direction."""
    return np.asarray(vector / length(vector), np.float64)
