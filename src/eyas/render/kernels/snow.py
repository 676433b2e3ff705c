"""Snow: it lies on what faces up, in patches where it is thin."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.scalars import f4, u4

__all__ = ["snowed"]


@inlined_kernel
def _grain(column: int, row: int) -> float:
    """Return a number, 0 to 1, that looks random, for a cell of the plane."""
    mixed = u4(u4(column) * u4(0x9E3779B1)) ^ u4(u4(row) * u4(0x85EBCA77))
    mixed = u4((mixed ^ (mixed >> u4(15))) * u4(0x2C1B3C6D))
    return f4((mixed ^ (mixed >> u4(13))) & u4(0xFFFF)) * f4(1.0 / 65535.0)


@inlined_kernel
def _noise(x: float, y: float) -> float:
    """Return smooth noise, 0 to 1, with cells of one unit."""
    # Moved so that all cells of the land have numbers above 0, where cutting off is rounding down.
    x, y = max(x + f4(32768.0), f4(0.0)), max(y + f4(32768.0), f4(0.0))
    column, row = u4(x), u4(y)
    across, down = x - f4(column), y - f4(row)
    across *= across * (f4(3.0) - f4(2.0) * across)
    down *= down * (f4(3.0) - f4(2.0) * down)
    right, lower = column + u4(1), row + u4(1)
    a, b = _grain(column, row), _grain(right, row)
    c, d = _grain(column, lower), _grain(right, lower)
    upper = a + across * (b - a)
    return f4(upper + down * (c + across * (d - c) - upper))


@inlined_kernel
def snowed(
    colour: tuple[float, float, float],
    depth: float,
    holds: NDArray[np.float32],
    material: int,
    x: float,
    y: float,
    rise: float,
) -> tuple[float, float, float]:
    """Return the colour of a surface with the snow that lies on it.

    Args:
        colour: Without snow.
        depth: How much has fallen, 0 to 1.
        holds: How much stays on each material, 0 to 1, see `Geometry.holds_snow`.
        material: Which.
        x: The point [m].
        y: The point [m].
        rise: Upward component of its normal.
    """
    one, zero = f4(1.0), f4(0.0)
    stays = depth * holds[material]
    if stays <= zero:
        return colour
    patch = f4(0.6) * _noise(f4(0.45) * x, f4(0.45) * y)
    patch += f4(0.4) * _noise(f4(2.3) * x, f4(2.3) * y)
    # Steep faces are bare; where little stays, it is what lies in the hollows.
    lies = min(max((rise - f4(0.45) + f4(0.5) * (patch - f4(0.5))) * f4(4.0), zero), one)
    hollow = min(max((patch + stays - f4(0.76)) * f4(4.0), zero), one)
    share = lies * hollow * (f4(0.12) + f4(0.85) * stays)
    light = f4(0.88) + f4(0.12) * patch
    return (
        colour[0] + share * (f4(0.84) * light - colour[0]),
        colour[1] + share * (f4(0.86) * light - colour[1]),
        colour[2] + share * (f4(0.89) * light - colour[2]),
    )
