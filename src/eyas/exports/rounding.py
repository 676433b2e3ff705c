"""Rounding of numbers for files."""

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["rounded", "rounded_list"]

DECIMALS = 6
"""Decimals of every number (micrometres, microradians); few enough for identical bytes."""


def rounded(value: float) -> float | None:
    """Return a number with fixed decimals, without a negative zero; None if it is not finite."""
    return round(float(value), DECIMALS) + 0.0 if np.isfinite(value) else None


def rounded_list(values: ArrayLike) -> list[float | None]:
    """Return `rounded` of each value, shape (K,)."""
    return [rounded(value) for value in np.asarray(values, np.float64)]
