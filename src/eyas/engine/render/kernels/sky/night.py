"""The sky at night: stars and the face of the moon."""

import math

from eyas.engine.render.kernels.bundles import Illumination
from eyas.engine.render.kernels.hash_noise import hashed
from eyas.engine.render.kernels.scalars import f4, u4
from eyas.lanes import kernel
from eyas.lanes.vector import greater, lesser, like, magnitude, root, select, to_f4, to_i4, to_u4

_STAR_ROWS = f4(72.0)  # Rows of cells from the horizon to the zenith, of equal area

_STAR_COLUMNS = f4(80.0)  # Columns of cells in a quarter of the horizon

_POLE = (math.sqrt(0.5), math.sqrt(0.5))
"""Northward and upward component of the direction to the celestial pole, at 45 degrees north."""

_DISC = f4(0.0062)  # Radius of the disc of sun and moon [rad]

_STAR_SIZE = f4(0.0011)
"""Radius to which the brightness of stars refers [rad]; wider pixels dim them."""


@kernel(inline=True)
def starlight(
    x: float,  # The direction
    y: float,  # The direction
    z: float,  # The direction
    around: float,  # Its `azimuth`
    pixel: float,  # Angle that a pixel spans [rad]
) -> tuple[float, float]:
    """Return the radiance of the star in a direction of length 1, and its tint: red above 0.

    Each cell's hash says where its star stands and how bright it is: few are bright, most cells
    have one too faint to see.
    """
    zero, one, unit, byte = f4(0.0), f4(1.0), f4(1.0 / 255.0), u4(255)
    column, row = to_i4(around * _STAR_COLUMNS), to_i4(greater(z, zero) * _STAR_ROWS)
    bits = hashed(to_u4(column), to_u4(row), like(to_u4(row), u4(0x57A2)))
    # Not too near to the cell's edge, where the star would be cut.
    aside = f4(0.25) + f4(0.5 / 255.0) * to_f4(bits & byte)
    over = f4(0.25) + f4(0.5 / 255.0) * to_f4((bits >> u4(8)) & byte)
    turn, high = (to_f4(column) + aside) / _STAR_COLUMNS, (to_f4(row) + over) / _STAR_ROWS
    east = magnitude(turn - f4(2.0)) - one
    north = select(turn < f4(3.0), one - magnitude(turn - one), turn - f4(4.0))
    flat = root((one - high * high) / (east * east + north * north))
    dx, dy, dz = x - east * flat, y - north * flat, z - high
    radius = greater(like(x, _STAR_SIZE), f4(0.62) * pixel)
    near = greater(one - (dx * dx + dy * dy + dz * dz) / (radius * radius), zero)
    rank = to_f4((bits >> u4(16)) & byte) * unit
    rank *= rank
    rank *= rank
    dim = _STAR_SIZE / radius
    tint = f4(0.3) * to_f4((bits >> u4(24)) & u4(127)) * f4(1.0 / 127.0) - f4(0.15)
    return lesser(f4(0.9) * rank * rank * rank * near * dim, one), tint


@kernel(inline=True)
def azimuth(x: float, y: float) -> float:
    """Return the azimuth of the direction (x, y), 0 to 4."""
    share = y / (magnitude(x) + magnitude(y) + f4(1e-9))
    south = select(y < f4(0.0), share + f4(4.0), share)
    return select(x < f4(0.0), f4(2.0) - share, south)


@kernel(inline=True)
def moon_face(lit: Illumination, x: float, y: float, z: float) -> float:
    """Return whether the part of the moon's disc in a direction is lit, 0 to 1.

    The terminator is half an ellipse: seen with the bright limb on the right, the sphere is lit
    where `u > (1 - 2 share) sqrt(radius^2 - v^2)`.
    """
    air, sun, zero, one = lit.air, lit.sun, f4(0.0), f4(1.0)
    dx, dy, dz = x - sun.x, y - sun.y, z - sun.z
    u = dx * air.limb_x + dy * air.limb_y + dz * air.limb_z
    across = dx * dx + dy * dy + dz * dz - u * u
    edge = (one - f4(2.0) * air.moon_lit) * root(greater(_DISC * _DISC - across, zero))
    return lesser(greater((u - edge) * f4(1500.0) + f4(0.5), zero), one)


@kernel(inline=True)
def turned_stars(lit: Illumination, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return where a direction was before the stars turned round the pole (Rodrigues' formula).

    Those of the southern sky are its northern ones mirrored.
    """
    air, north, up = lit.air, f4(_POLE[0]), f4(_POLE[1])
    along = (f4(1.0) - air.star_cosine) * (north * y + up * z)
    return (
        air.star_cosine * x + air.star_sine * (north * z - up * y),
        air.star_cosine * y + air.star_sine * up * x + along * north,
        magnitude(air.star_cosine * z - air.star_sine * north * x + along * up),
    )
