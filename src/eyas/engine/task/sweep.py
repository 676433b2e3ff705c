"""When a box that moves along a straight line first touches an upright solid.

The box stands upright, too; its corners are swept, so that no speed lets it pass through. All is
computed in the frame of the box, in which it rests and the solid moves the other way.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel

NEVER = 2.0  # Share of the motion at a touch that does not happen


class Sweep(NamedTuple):
    """The motion of a box."""

    x: float  # Where its middle begins, world frame [m]
    y: float
    z: float
    motion_x: float  # How far it moves [m]
    motion_y: float
    motion_z: float
    cosine: float  # Of its heading
    sine: float
    half_length: float  # [m]
    half_width: float
    half_height: float


class Touch(NamedTuple):
    """The first touch of a solid."""

    share: float  # Share of the motion at the touch, 0 to 1, or `NEVER`
    x: float  # Place, world frame [m]
    y: float


@kernel(inline=True)
def while_level(sweep: Sweep, bottom: float, top: float) -> tuple[float, float]:
    """Return the share of the motion from which, and to which, the box is as high as a solid; the
    first is larger if it never is.
    """
    low, high = bottom - sweep.half_height - sweep.z, top + sweep.half_height - sweep.z
    if sweep.motion_z == 0.0:
        return (0.0, 1.0) if low <= 0.0 <= high else (1.0, 0.0)
    a, b = low / sweep.motion_z, high / sweep.motion_z
    return max(min(a, b), 0.0), min(max(a, b), 1.0)


@kernel(inline=True)
def sweep_prism(
    sweep: Sweep,  # The motion
    points: NDArray[np.float64],  # Corners of prisms [m], shape (K, 2)
    first: int,  # Where those of the prism begin
    last: int,  # Where they end
    start: float,  # From where on the motion matters
    end: float,  # To where it matters
) -> Touch:
    """Return the first touch of a prism between two shares of the motion, from `while_level`.

    Two outlines touch first where a corner of one meets a side of the other.
    """
    best, at_x, at_y = NEVER, 0.0, 0.0
    motion_x, motion_y = _turned(sweep, sweep.motion_x, sweep.motion_y)
    shift_x, shift_y = start * motion_x, start * motion_y
    rest = end - start
    before = last - 1
    odd = False
    b_x, b_y = _turned(sweep, points[before, 0] - sweep.x, points[before, 1] - sweep.y)
    b_x, b_y = b_x - shift_x, b_y - shift_y
    for corner in range(first, last):
        a_x, a_y = b_x, b_y
        b_x, b_y = _turned(sweep, points[corner, 0] - sweep.x, points[corner, 1] - sweep.y)
        b_x, b_y = b_x - shift_x, b_y - shift_y
        # Where the box is at the start, a side may reach into it.
        share = _enters(a_x, a_y, b_x - a_x, b_y - a_y, sweep.half_length, sweep.half_width)
        if share <= 1.0:
            best = 0.0
            at_x, at_y = a_x + share * (b_x - a_x), a_y + share * (b_y - a_y)
            break
        if (a_y > 0.0) != (b_y > 0.0) and a_x - a_y / (b_y - a_y) * (b_x - a_x) > 0.0:
            odd = not odd
        # A corner of the prism meets the box.
        t = _enters(b_x, b_y, -motion_x, -motion_y, sweep.half_length, sweep.half_width)
        if t <= rest and t < best:
            best, at_x, at_y = t, b_x - t * motion_x, b_y - t * motion_y
        # A corner of the box meets a side of the prism.
        side_x, side_y = b_x - a_x, b_y - a_y
        across = motion_x * side_y - motion_y * side_x
        if across == 0.0:
            continue
        for k in range(4):
            from_x = a_x - (sweep.half_length if k < 2 else -sweep.half_length)
            from_y = a_y - (sweep.half_width if k % 2 == 0 else -sweep.half_width)
            t = (from_x * side_y - from_y * side_x) / across
            share = (from_x * motion_y - from_y * motion_x) / across
            if 0.0 <= share <= 1.0 and 0.0 <= t <= rest and t < best:
                best, at_x, at_y = t, a_x + share * side_x - t * motion_x, 0.0
                at_y = a_y + share * side_y - t * motion_y
    if odd and best > 0.0:
        best, at_x, at_y = 0.0, 0.0, 0.0  # the box begins within the prism
    return _touch(sweep, best, start, at_x, at_y)


@kernel(inline=True)
def sweep_cylinder(sweep: Sweep, place: NDArray[np.float64], start: float, end: float) -> Touch:
    """Return the first touch of a cylinder, given by its centre and radius [m], shape (3,)."""
    motion_x, motion_y = _turned(sweep, sweep.motion_x, sweep.motion_y)
    x, y = _turned(sweep, place[0] - sweep.x, place[1] - sweep.y)
    x, y, radius = x - start * motion_x, y - start * motion_y, place[2]
    length, width = sweep.half_length, sweep.half_width
    # The axis meets the outline of the box, moved outwards by the radius: two boxes, four circles.
    best = _enters(x, y, -motion_x, -motion_y, length + radius, width)
    best = min(best, _enters(x, y, -motion_x, -motion_y, length, width + radius))
    for k in range(4):
        off_x = x - (length if k < 2 else -length)
        off_y = y - (width if k % 2 == 0 else -width)
        best = min(best, _reaches(off_x, off_y, -motion_x, -motion_y, radius))
    if best > end - start:
        return _touch(sweep, NEVER, start, 0.0, 0.0)
    at_x, at_y = x - best * motion_x, y - best * motion_y
    at_x, at_y = min(max(at_x, -length), length), min(max(at_y, -width), width)
    return _touch(sweep, best, start, at_x, at_y)


@kernel(inline=True)
def _turned(sweep: Sweep, x: float, y: float) -> tuple[float, float]:
    """Return a horizontal vector in the frame of the box."""
    return sweep.cosine * x + sweep.sine * y, sweep.cosine * y - sweep.sine * x


@kernel(inline=True)
def _touch(sweep: Sweep, best: float, start: float, x: float, y: float) -> Touch:
    """Return a touch at a place in the frame of the box, `best` after the start."""
    if best >= NEVER:
        return Touch(NEVER, 0.0, 0.0)
    share = start + best
    return Touch(
        share,
        sweep.x + share * sweep.motion_x + sweep.cosine * x - sweep.sine * y,
        sweep.y + share * sweep.motion_y + sweep.sine * x + sweep.cosine * y,
    )


@kernel(inline=True)
def _enters(
    x: float,  # Where the point begins in the frame of the box, ahead [m]
    y: float,  # The same, left [m]
    by_x: float,  # Its path, ahead [m]
    by_y: float,  # The same, left [m]
    length: float,  # Half the length of the box [m]
    width: float,  # Half its width [m]
) -> float:
    """Return the share of its path, 0 to 1, at which a point enters a box; else `NEVER`."""
    begin, end = 0.0, 1.0
    for axis in range(2):
        at, by, half = (x, by_x, length) if axis == 0 else (y, by_y, width)
        if by == 0.0:
            if abs(at) > half:
                return NEVER
            continue
        a, b = (-half - at) / by, (half - at) / by
        begin, end = max(begin, min(a, b)), min(end, max(a, b))
    return begin if begin <= end else NEVER


@kernel(inline=True)
def _reaches(x: float, y: float, by_x: float, by_y: float, radius: float) -> float:
    """Return the share of its path, 0 to 1, at which a point enters a circle about the origin."""
    excess = x * x + y * y - radius * radius
    if excess <= 0.0:
        return 0.0
    square, half = by_x * by_x + by_y * by_y, x * by_x + y * by_y
    under = half * half - square * excess
    if half >= 0.0 or under < 0.0:
        return NEVER
    share = (-half - math.sqrt(under)) / square
    return share if share <= 1.0 else NEVER
