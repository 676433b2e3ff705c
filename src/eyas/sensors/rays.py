"""Where a ray meets the first thing in its way."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import step_kernel
from eyas.sensors.grid import cells_between
from eyas.sensors.obstacles import Boxes, Obstacles, Solids
from eyas.state.terrain import Terrain, ground_at

__all__ = ["Ray", "cast_ray"]

_HALVINGS = 24
"""How often the part of a ray that enters a hill is halved."""


class Ray(NamedTuple):
    """A ray in the world frame."""

    x: float
    """[m]"""
    y: float
    z: float
    ahead_x: float
    """Unit vector."""
    ahead_y: float
    ahead_z: float


@step_kernel
def cast_ray(ray: Ray, reach: float, obstacles: Obstacles, boxes: int) -> tuple[float, int]:
    """Return the distance of the first thing [m], infinity if there is none, and its object id.

    Rays that begin inside a solid meet its far side.

    Args:
        ray: The ray.
        reach: Its length [m].
        obstacles: What it may meet.
        boxes: Number of boxes in `obstacles.boxes`.
    """
    best, thing = _cast_solids(ray, reach, obstacles.solids)
    near, actor = _cast_boxes(ray, min(reach, best), obstacles.boxes, boxes)
    if near < best:
        best, thing = near, actor
    near = _cast_ground(ray, min(reach, best), obstacles.terrain)
    if near < best:
        best, thing = near, obstacles.solids.ground
    return best, thing


@step_kernel
def _cast_solids(ray: Ray, reach: float, solids: Solids) -> tuple[float, int]:
    best, thing = math.inf, -1
    end_x, end_y = ray.x + reach * ray.ahead_x, ray.y + reach * ray.ahead_y
    end_z = ray.z + reach * ray.ahead_z
    low, high = min(ray.z, end_z), max(ray.z, end_z)
    prisms = solids.first.shape[0] - 1
    grid = solids.grid
    first_row, last_row, left, right = cells_between(grid, (ray.x, end_x), (ray.y, end_y), 0.0)
    for row in range(first_row, last_row + 1):
        for column in range(left, right + 1):
            cell = row * grid.columns + column
            if grid.top[cell] < low:
                continue
            for k in range(grid.first[cell], grid.first[cell + 1]):
                item = grid.item[k]
                bottom, top = solids.bottom[item], solids.top[item]
                if top < low or bottom > high:
                    continue
                limit = min(best, reach)
                if item < prisms:
                    corners = (solids.first[item], solids.first[item + 1])
                    near = _cast_prism(ray, limit, solids.points, corners, (bottom, top))
                else:
                    near = _cast_cylinder(ray, limit, solids.round[item - prisms], bottom, top)
                if near < best:
                    best, thing = near, int(solids.thing[item])
    return best, thing


@step_kernel
def _cast_boxes(ray: Ray, reach: float, boxes: Boxes, count: int) -> tuple[float, int]:
    best, thing = math.inf, -1
    for box in range(count):
        corners, heights = (4 * box, 4 * box + 4), (boxes.bottom[box], boxes.top[box])
        near = _cast_prism(ray, min(best, reach), boxes.corners, corners, heights)
        if near < best:
            best, thing = near, int(boxes.thing[box])
    return best, thing


@step_kernel
def _cast_prism(
    ray: Ray,
    limit: float,
    points: NDArray[np.float64],
    corners: tuple[int, int],
    heights: tuple[float, float],
) -> float:
    """Return the distance of a prism, infinity if it is not met before the limit [m]."""
    best, (first, last), (bottom, top) = math.inf, corners, heights
    before = last - 1
    for corner in range(first, last):
        from_x, from_y = points[before, 0] - ray.x, points[before, 1] - ray.y
        side_x, side_y = (
            points[corner, 0] - points[before, 0],
            points[corner, 1] - points[before, 1],
        )
        before = corner
        across = ray.ahead_x * side_y - ray.ahead_y * side_x
        if across == 0.0:
            continue
        t = (from_x * side_y - from_y * side_x) / across
        share = (from_x * ray.ahead_y - from_y * ray.ahead_x) / across
        z = ray.z + t * ray.ahead_z
        if 0.0 <= share <= 1.0 and 0.0 <= t <= min(limit, best) and bottom <= z <= top:
            best = t
    if ray.ahead_z != 0.0:
        for end in range(2):
            t = ((top if end == 0 else bottom) - ray.z) / ray.ahead_z
            x, y = ray.x + t * ray.ahead_x, ray.y + t * ray.ahead_y
            if 0.0 <= t <= min(limit, best) and _inside(points, first, last, x, y):
                best = t
    return best


@step_kernel
def _inside(points: NDArray[np.float64], first: int, last: int, x: float, y: float) -> bool:
    """Return whether a point is inside a polygon: sides to its east are crossed an odd number of
    times.
    """
    odd, before = False, last - 1
    for corner in range(first, last):
        a_x, a_y, b_x, b_y = (
            points[before, 0],
            points[before, 1],
            points[corner, 0],
            points[corner, 1],
        )
        before = corner
        if (a_y > y) != (b_y > y) and x < a_x + (y - a_y) / (b_y - a_y) * (b_x - a_x):
            odd = not odd
    return odd


@step_kernel
def _cast_cylinder(
    ray: Ray, limit: float, place: NDArray[np.float64], bottom: float, top: float
) -> float:
    """Return the distance of a cylinder, infinity if it is not met before the limit [m]."""
    best = math.inf
    x, y, radius = ray.x - place[0], ray.y - place[1], place[2]
    square = ray.ahead_x * ray.ahead_x + ray.ahead_y * ray.ahead_y
    half = x * ray.ahead_x + y * ray.ahead_y
    excess = x * x + y * y - radius * radius
    under = half * half - square * excess
    if square > 0.0 and under >= 0.0:
        for sign in range(2):
            root = math.sqrt(under) if sign else -math.sqrt(under)
            t = (root - half) / square
            z = ray.z + t * ray.ahead_z
            if 0.0 <= t <= min(limit, best) and bottom <= z <= top:
                best = t
    if ray.ahead_z != 0.0:
        for end in range(2):
            t = ((top if end == 0 else bottom) - ray.z) / ray.ahead_z
            off_x, off_y = x + t * ray.ahead_x, y + t * ray.ahead_y
            if 0.0 <= t <= min(limit, best) and off_x * off_x + off_y * off_y <= radius * radius:
                best = t
    return best


@step_kernel
def _cast_ground(ray: Ray, limit: float, terrain: Terrain) -> float:
    """Return the distance of the ground, infinity if it is not met before the limit [m].

    On hills, the ray is followed in steps of half a cell of the relief, and the step that enters
    the ground is halved; what is narrower may be missed.
    """
    if terrain.relief.shape[0] == 0:
        if ray.ahead_z >= 0.0:
            return math.inf
        t = (terrain.floor - ray.z) / ray.ahead_z
        return t if 0.0 <= t <= limit else math.inf
    steps = int(limit / (0.5 * terrain.spacing)) + 1
    from_t = 0.0
    if _above_ground(ray, 0.0, terrain) <= 0.0:
        return math.inf
    for step in range(1, steps + 1):
        to_t = limit * step / steps
        if _above_ground(ray, to_t, terrain) <= 0.0:
            for _ in range(_HALVINGS):
                middle = 0.5 * (from_t + to_t)
                if _above_ground(ray, middle, terrain) <= 0.0:
                    to_t = middle
                else:
                    from_t = middle
            return to_t
        from_t = to_t
    return math.inf


@step_kernel
def _above_ground(ray: Ray, t: float, terrain: Terrain) -> float:
    """Return the height of a point of the ray above the ground [m]."""
    return (
        ray.z
        + t * ray.ahead_z
        - ground_at(terrain, ray.x + t * ray.ahead_x, ray.y + t * ray.ahead_y)
    )
