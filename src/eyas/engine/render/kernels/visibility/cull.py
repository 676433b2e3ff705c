"""Culling: boxes and spheres against the planes of a band of a view, eight at once.

What is left out is certainly outside; what is kept may be. The tests are computed in float32, and
allow for its rounding.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import NEAR, Plane, Planes, Projection, Row
from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import kernel
from eyas.lanes.vector import bits_of, load

SLACK = 0.05
"""How far outside a plane things are still kept [m]: more than float32 rounds places off."""


@kernel(inline=True)
def _plane(x: float, y: float, z: float, w: float) -> Plane:
    return Plane(x, y, z, w, math.sqrt(x * x + y * y + z * z))


@kernel(inline=True)
def _border(row: Row, sign: float, distance: Row, share: float) -> Plane:
    """Return the plane `sign * row + share * distance`."""
    return _plane(
        sign * row.x + share * distance.x,
        sign * row.y + share * distance.y,
        sign * row.z + share * distance.z,
        sign * row.w + share * distance.w,
    )


@kernel(inline=True)
def planes_of(screen: Projection, width: float, height: float, top: float, bottom: float) -> Planes:
    """Return the planes around the space that rows `top` to `bottom` of a picture show."""
    column, row, distance = screen.column, screen.row, screen.distance
    middle_x, middle_y = 0.5 * width, 0.5 * height
    return Planes(
        _border(column, 1.0, distance, middle_x),
        _border(column, -1.0, distance, middle_x),
        _border(row, 1.0, distance, middle_y - top),
        _border(row, -1.0, distance, bottom - middle_y),
        _plane(distance.x, distance.y, distance.z, distance.w - NEAR),
    )


class Side(NamedTuple):
    """A plane, of float32; things outside by no more than `SLACK` are taken for inside."""

    x: float
    y: float
    z: float
    least: float  # What `x`, `y` and `z` times a place come to inside, at least
    length: float


class Sides(NamedTuple):
    """Planes around what is shown."""

    left: Side
    right: Side
    top: Side
    bottom: Side
    near: Side


@kernel(inline=True)
def _side(plane: Plane) -> Side:
    least = f4(-plane.w - SLACK * plane.length)
    return Side(f4(plane.x), f4(plane.y), f4(plane.z), least, f4(plane.length))


@kernel(inline=True)
def sides_of(planes: Planes) -> Sides:
    """Return planes in float32; once for a loop, as a card takes long to convert them."""
    return Sides(
        _side(planes.left),
        _side(planes.right),
        _side(planes.top),
        _side(planes.bottom),
        _side(planes.near),
    )


@kernel(inline=True)
def _box_reaches(side: Side, boxes: NDArray[np.float32], at: int, step: int) -> bool:
    """Return which of eight boxes may reach inside a plane."""
    reach = side.x * load(boxes, at + (3 * step if side.x > f4(0.0) else 0))
    reach += side.y * load(boxes, at + (4 * step if side.y > f4(0.0) else step))
    reach += side.z * load(boxes, at + (5 * step if side.z > f4(0.0) else 2 * step))
    return reach > side.least


@kernel(inline=True)
def in_boxes(sides: Sides, boxes: NDArray[np.float32], at: int, step: int) -> bool:
    """Return which of eight boxes may reach inside all planes.

    Args:
        sides: The planes.
        boxes: Lower corner x, y, z and upper corner x, y, z of boxes, a row each.
        at: Index of the first number of the first box.
        step: Length of the rows.
    """
    return (
        _box_reaches(sides.left, boxes, at, step)
        & _box_reaches(sides.right, boxes, at, step)
        & _box_reaches(sides.top, boxes, at, step)
        & _box_reaches(sides.bottom, boxes, at, step)
        & _box_reaches(sides.near, boxes, at, step)
    )


@kernel(inline=True)
def boxes_seen(sides: Sides, boxes: NDArray[np.float32], first: int) -> int:
    """Return which of the eight boxes from column `first` on may reach inside all planes, a bit
    each.
    """
    return bits_of(in_boxes(sides, boxes, first, boxes.shape[1]))


@kernel(inline=True)
def _sphere_reaches(side: Side, x: float, y: float, z: float, radius: float) -> bool:
    return side.x * x + side.y * y + side.z * z + side.length * radius > side.least


@kernel(inline=True)
def spheres_seen(sides: Sides, x: float, y: float, z: float, radius: float) -> bool:
    """Return which spheres, of float32, may reach inside all planes."""
    return (
        _sphere_reaches(sides.left, x, y, z, radius)
        & _sphere_reaches(sides.right, x, y, z, radius)
        & _sphere_reaches(sides.top, x, y, z, radius)
        & _sphere_reaches(sides.bottom, x, y, z, radius)
        & _sphere_reaches(sides.near, x, y, z, radius)
    )


@kernel(inline=True)
def _height(plane: Plane, x: float, y: float, z: float) -> float:
    return plane.x * x + plane.y * y + plane.z * z + plane.w


@kernel(inline=True)
def sphere_is_visible(planes: Planes, x: float, y: float, z: float, radius: float) -> bool:
    """Return whether a sphere, of float64, reaches inside all planes."""
    return (
        _height(planes.left, x, y, z) >= -radius * planes.left.length
        and _height(planes.right, x, y, z) >= -radius * planes.right.length
        and _height(planes.top, x, y, z) >= -radius * planes.top.length
        and _height(planes.bottom, x, y, z) >= -radius * planes.bottom.length
        and _height(planes.near, x, y, z) >= -radius * planes.near.length
    )
