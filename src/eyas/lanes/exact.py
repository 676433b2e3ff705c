"""Mathematics for numpy code whose last bits are the same on every processor.

numpy and BLAS choose their functions by the features of the processor, and so does the C library:
the last bits of their sines, powers and products of matrices differ from one to the next. Wherever
numbers decide what is simulated, drawn, labelled or kept, these take their place;
`tests/engine/core/test_exact_everywhere.py` refuses the others there, and says which parts of numpy
are safe.

What is added is added in a fixed order, one product after the other.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.lanes.elementary import arrays
from eyas.lanes.elementary.arrays import (
    acos,
    asin,
    atan,
    atan2,
    cos,
    exp,
    hypot,
    log,
    sin,
    tan,
    tanh,
)

__all__ = [
    "acos",
    "asin",
    "atan",
    "atan2",
    "cbrt",
    "convolved",
    "cos",
    "cross",
    "determinant",
    "dot",
    "exp",
    "geomspace",
    "hypot",
    "length",
    "lengths",
    "log",
    "log2",
    "normal",
    "power",
    "product",
    "sin",
    "tan",
    "tanh",
]

_DIGITS = 12  # Decimal places of random numbers that come of a logarithm of the C library


def log2(value: ArrayLike) -> Any:  # noqa: ANN401  # a number or an array, as numpy's
    """Return the logarithm to the base 2; exact for powers of 2."""
    part, whole = np.frexp(value)
    return whole + log(part) / -log(0.5)


def power(base: Any, exponent: float) -> Any:  # noqa: ANN401  # as numpy's
    """Return a power of what is not negative; with a whole exponent of anything."""
    if isinstance(exponent, int):
        whole = _whole_power(base, abs(exponent))
        return whole if exponent >= 0 else 1.0 / whole
    return arrays.power(base, exponent)


def _whole_power(base: ArrayLike, exponent: int) -> Any:  # noqa: ANN401
    factor, made = np.asarray(base, np.float64), np.ones_like(base, np.float64)
    while exponent:
        if exponent & 1:
            made = made * factor
        factor = np.square(factor)
        exponent >>= 1
    return made[()]


def cbrt(value: ArrayLike) -> Any:  # noqa: ANN401  # as numpy's
    """Return the cube root; of whole cubes exactly."""
    value = np.asarray(value, np.float64)
    root = power(np.abs(value), 1.0 / 3.0)
    square = np.where(root > 0.0, root * root, 1.0)
    return np.copysign(root - (root - np.abs(value) / square) / 3.0, value)[()]


def geomspace(first: float, last: float, count: int) -> NDArray[np.float64]:
    """Return numbers from the first to the last, each larger by the same factor."""
    made: NDArray[np.float64] = exp(np.linspace(log(first), log(last), count))
    made[0], made[-1] = first, last
    return made


def product(a: ArrayLike, b: ArrayLike) -> Any:  # noqa: ANN401  # as numpy's
    """Return what `a @ b` is: the product of matrices, of stacks of them, or of vectors."""
    first, second = np.asarray(a), np.asarray(b)
    rows = first[None] if first.ndim == 1 else first
    columns = second[:, None] if second.ndim == 1 else second
    if rows.shape[-1] != columns.shape[-2]:
        raise ValueError(f"matrices of shapes {first.shape} and {second.shape} have no product")
    if rows.shape[-1] == 0:  # a sum of nothing
        return first @ second
    total = rows[..., :, :1] * columns[..., :1, :]
    for k in range(1, rows.shape[-1]):
        total += rows[..., :, k : k + 1] * columns[..., k : k + 1, :]
    if second.ndim == 1:
        total = total[..., 0]
    if first.ndim == 1:
        total = total[..., 0] if second.ndim == 1 else total[..., 0, :]
    return total


def dot(a: ArrayLike, b: ArrayLike) -> Any:  # noqa: ANN401  # a number or an array
    """Return the dot products of vectors along the last axis of two arrays."""
    first, second = np.asarray(a), np.asarray(b)
    total = first[..., 0] * second[..., 0]
    for k in range(1, first.shape[-1]):
        total = total + first[..., k] * second[..., k]
    return total


def lengths(vectors: NDArray[Any]) -> NDArray[Any]:
    """Return the lengths along the last axis; `np.linalg.norm`, of the same bytes, is slower."""
    return np.asarray(np.sqrt(dot(vectors, vectors)))


def length(vector: ArrayLike) -> float:
    """Return the length of one vector."""
    whole = np.asarray(vector, np.float64)
    return math.sqrt(dot(whole, whole))


def cross(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    """Return the cross products of vectors along the last axis of two arrays, of shape (..., 3).

    The bytes are those of `np.cross`, which takes three times as long for a few.
    """
    (a0, a1, a2), (b0, b1, b2) = _axes(a), _axes(b)
    first = a1 * b2 - a2 * b1
    made = np.empty((*first.shape, 3), first.dtype)
    made[..., 0], made[..., 1], made[..., 2] = first, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
    return made


def _axes(vectors: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    return vectors[..., 0], vectors[..., 1], vectors[..., 2]


def determinant(matrix: NDArray[np.floating]) -> float:
    """Return the determinant of a matrix of shape (3, 3)."""
    a, b, c = np.asarray(matrix, np.float64)
    return float(dot(a, cross(b, c)))


def convolved(
    values: NDArray[np.float64],  # Shape (S,)
    weights: NDArray[np.float64],  # Shape (W,), with W <= S
) -> NDArray[np.float64]:
    """Return values smoothed by weights, wherever these all have a value to weigh.

    Returns:
        Shape (S - W + 1,), as `numpy.convolve` in its mode "valid".
    """
    count = len(values) - len(weights) + 1
    total = np.zeros(count)
    for k, weight in enumerate(weights[::-1].tolist()):
        total += weight * values[k : k + count]
    return total


def normal(
    rng: np.random.Generator,
    mean: float = 0.0,
    deviation: float = 1.0,
    size: int | tuple[int, ...] | None = None,
) -> Any:  # noqa: ANN401  # as numpy's
    """Return normally distributed random numbers, as the method of a generator.

    For one in four thousand, in the tails, numpy takes a logarithm of the C library: so all are
    rounded to twelve decimal places.
    """
    return mean + deviation * np.round(rng.standard_normal(size), _DIGITS)
