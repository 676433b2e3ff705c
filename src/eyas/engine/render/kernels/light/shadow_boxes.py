"""Light that the two boxes of a moving thing block."""

from typing import NamedTuple

from eyas.engine.render.kernels.bundles import Direction
from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import kernel
from eyas.lanes.vector import greater, lesser, magnitude, root, select

_UNDER = 0.88  # Share of the sky's light that a car blocks on the ground under it

_INSET = 0.3  # Distance from the edge of a body inwards at which the blocking begins [m]

_EDGE = 0.15  # Length of the ray inside a box that hides all of the sun, for a point at the box [m]

_WIDENING = 0.12  # Growth of that length with the distance of the box

_SHOE = 0.13  # Distance of the middle of a shoe from its toes [m]

_PER_LENGTH, _PER_WIDTH = f4(1.0 / 0.24), f4(1.0 / 0.17)
"""One over half the length and half the width of the dark ground around a foot [1/m]."""

_TOUCH = f4(0.8)  # Share of all light that a shoe hides from the ground at its sole

_STEEP = 1e-4  # Smallest step of a ray along an axis, so that its inverse is finite


class Box(NamedTuple):
    """An upright box in the frame of a moving thing [m]; of float32."""

    back: float
    front: float
    right: float
    left: float
    bottom: float
    top: float


class ShadowBoxes(NamedTuple):
    """What blocks light, in the thing's own frame: origin at the middle of its bottom [m]."""

    lower: Box  # Like the body of a car
    upper: Box  # Like its cabin
    inverse: Direction  # 1 over each part of the unit vector to the sun
    slide: tuple[float, float]  # Way along x and y of a ray to the sun while it rises by 1 m
    beside: tuple[float, float]
    """Half length and half width of the ground around the thing that it darkens, at least [m]."""
    reach: float
    """Inverse of the distance over which the thing blocks the sky's light on the ground [1/m]."""
    most: float  # Share of it that is blocked under the thing
    feet: float
    """Distance of the feet of what stands on two of them from its middle [m]; 0: it does not."""


@kernel(inline=True)
def _inverse(step: float) -> float:
    return f4(1.0 / (step if abs(step) > _STEEP else _STEEP))


@kernel(inline=True)
def shadow_boxes(
    lower: Box,  # See `ShadowBoxes`
    upper: Box,  # See `ShadowBoxes`
    sun: Direction,  # Unit vector to it, in the thing's frame
    width: float,  # Half the width of the thing [m]
    # Distance from the thing up to which it blocks the sky's light on the ground [m]
    beyond: float,
    upright: bool,  # Whether it stands on two feet
) -> ShadowBoxes:
    """Return what blocks light."""
    half, rise = 0.5 * (lower.left - lower.right), max(sun.z, 1e-3)
    return ShadowBoxes(
        lower,
        upper,
        Direction(_inverse(sun.x), _inverse(sun.y), f4(1.0 / rise)),
        (f4(sun.x / rise), f4(sun.y / rise)),
        (f4(lower.front + beyond), f4(width + beyond)),
        f4(1.0 / (beyond + _INSET)),
        f4(_UNDER * min(half + 0.35, 1.0)),  # light comes under a motorbike from both sides
        f4(max(lower.front - _SHOE, 0.04) if upright else 0.0),
    )


@kernel(inline=True)
def _between(start: float, inverse: float, low: float, high: float) -> tuple[float, float]:
    """Return when a point enters and leaves a range; `inverse` is 1 over its speed."""
    first, last = (low - start) * inverse, (high - start) * inverse
    return lesser(first, last), greater(first, last)


@kernel(inline=True)
def _blocked(x: float, y: float, z: float, box: Box, inverse: Direction) -> float:
    """Return how much of the sun a box hides from a point; 1 or more is all.

    The longer the ray to the sun is inside the box, the more: this gives a soft edge, which is
    the wider the farther the box is from the point.
    """
    front, back = _between(x, inverse.x, box.back, box.front)
    right, left = _between(y, inverse.y, box.right, box.left)
    low, high = _between(z, inverse.z, box.bottom, box.top)
    enters = greater(greater(front, right), greater(low, f4(0.0)))
    inside = greater(lesser(lesser(back, left), high) - enters, f4(0.0))
    return inside / (f4(_EDGE) + f4(_WIDENING) * enters)


@kernel(inline=True)
def may_darken(boxes: ShadowBoxes, x: float, y: float, z: float) -> bool:
    """Return which points in the thing's frame it may darken; it is certain of the others."""
    up = boxes.upper.top - z
    end_x, end_y = x + up * boxes.slide[0], y + up * boxes.slide[1]
    far_x, far_y = boxes.beside
    inside = (lesser(x, end_x) < far_x) & (greater(x, end_x) > -far_x)
    return inside & (lesser(y, end_y) < far_y) & (greater(y, end_y) > -far_y) & (up >= f4(0.0))


@kernel(inline=True)
def darken(boxes: ShadowBoxes, x: float, y: float, z: float) -> tuple[float, float]:
    """Return the shares of sun and sky light that a thing lets through to points in its frame."""
    zero, one = f4(0.0), f4(1.0)
    lower, upper = boxes.lower, boxes.upper
    hidden = _blocked(x, y, z, lower, boxes.inverse) + _blocked(x, y, z, upper, boxes.inverse)
    # Little light of the sky reaches the ground under a body and beside it.
    half, middle = f4(0.5) * (lower.left - lower.right), f4(0.5) * (lower.left + lower.right)
    out_x = greater(magnitude(x) - lower.front + f4(_INSET), zero)
    out_y = greater(magnitude(y - middle) - half + lesser(f4(_INSET), half), zero)
    near = greater(one - root(out_x * out_x + out_y * out_y) * boxes.reach, zero)
    near = select(magnitude(z) > f4(0.3), zero, near)
    share = boxes.most * near * near * (f4(3.0) - f4(2.0) * near)
    if boxes.feet > zero:
        along, aside = (magnitude(x) - boxes.feet) * _PER_LENGTH, (y - middle) * _PER_WIDTH
        touch = greater(one - along * along - aside * aside, zero)
        touch = select(magnitude(z) > f4(0.1), zero, touch * touch)
        hidden += _TOUCH * touch
        share += (one - share) * _TOUCH * touch
    return one - lesser(hidden, one), one - share
