"""Products of two float64 without error, as sums of two.

The method is Dekker's: A floating-point technique for extending the available precision (Numerische
Mathematik 18, 1971). It needs no fused operations, which not all processors have.
"""

from eyas.lanes.jit import kernel


@kernel(inline=True)
def leading(x: float) -> float:
    """Return the first 26 bits of a number; the magnitude of the number must be below 1e300."""
    shifted = 134217729.0 * x  # 2^27 + 1
    return shifted - (shifted - x)


@kernel(inline=True)
def product_error(a: float, b: float, product: float) -> float:
    """Return a * b - product, for the rounded product of numbers that are neither huge nor tiny."""
    a_high, b_high = leading(a), leading(b)
    a_low, b_low = a - a_high, b - b_high
    return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
