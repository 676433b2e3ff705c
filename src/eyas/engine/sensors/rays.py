"""Where a ray meets the first thing in its way."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sensors.grid import (
    SPACING,
    ObstacleGrid,
    cells_between,
    entered,
    lane_cells,
    walk_along,
)
from eyas.engine.sensors.obstacles import Boxes, Obstacles, Solids
from eyas.engine.sensors.slopes import Slopes, free_way
from eyas.engine.state.terrain import Terrain, ground_at
from eyas.lanes import kernel

_HALVINGS = 24  # How often the part of a ray that enters a hill is halved

_SLACK = 1e-3
"""What is nearer than this is looked at exactly: far more than rounding moves anything [m]."""


class Ray(NamedTuple):
    """A ray in the world frame."""

    x: float  # [m]
    y: float
    z: float
    ahead_x: float  # Unit vector
    ahead_y: float
    ahead_z: float


@kernel(inline=True)
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
    near = _cast_ground(ray, min(reach, best), obstacles.terrain, obstacles.slopes)
    if near < best:
        best, thing = near, obstacles.solids.ground
    return best, thing


@kernel(inline=True)
def _cast_solids(ray: Ray, reach: float, solids: Solids) -> tuple[float, int]:
    """Return the distance of the first solid, infinity if there is none, and its object id.

    Lanes are left when what was found is nearer than the next. Of solids at the same distance, the
    first counts: that of the southernmost row, of the westernmost column, of the least number.
    """
    best, found = math.inf, -1
    end_x, end_y = ray.x + reach * ray.ahead_x, ray.y + reach * ray.ahead_y
    end_z = ray.z + reach * ray.ahead_z
    low, high = min(ray.z, end_z), max(ray.z, end_z)
    grid = solids.grid
    cells = cells_between(grid, (ray.x, end_x), (ray.y, end_y), 0.0)
    start, ahead = (ray.x, ray.y), (ray.ahead_x, ray.ahead_y)
    walk = walk_along(grid, start, ahead, (end_x, end_y), cells)
    lane = walk.lane
    for _ in range(walk.lanes):
        if entered(walk, lane) > best:
            break
        first, last = lane_cells(walk, lane)
        for place in range(first, last + 1):
            cell = lane * walk.stride + place * walk.cell_stride
            if grid.top[cell] < low:
                continue
            for k in range(grid.first[cell], grid.first[cell + 1]):
                item = grid.item[k]
                if solids.top[item] < low or solids.bottom[item] > high:
                    continue
                near = _cast_solid(ray, min(best, reach), solids, item)
                if near < best or (
                    near == best < math.inf and _is_before(grid, cells, item, found)
                ):
                    best, found = near, item
        lane += walk.onward
    return best, (int(solids.thing[found]) if found >= 0 else -1)


@kernel(inline=True)
def _cast_solid(ray: Ray, limit: float, solids: Solids, item: int) -> float:
    """Return the distance of a solid, infinity if it is not met before the limit [m]."""
    if not _may_meet(ray, limit, solids.grid.bounds[item]):
        return math.inf
    prisms = solids.first.shape[0] - 1
    bottom, top = solids.bottom[item], solids.top[item]
    if item < prisms:
        corners = (solids.first[item], solids.first[item + 1])
        return _cast_prism(ray, limit, solids.points, corners, (bottom, top))
    return _cast_cylinder(ray, limit, solids.round[item - prisms], bottom, top)


@kernel(inline=True)
def _is_before(grid: ObstacleGrid, cells: tuple[int, int, int, int], one: int, other: int) -> bool:
    """Return whether an item comes before another in a rectangle of cells, row by row."""
    a, b = grid.bounds[one], grid.bounds[other]
    row_a = max(math.floor((a[1] - grid.south) / SPACING), cells[0])
    row_b = max(math.floor((b[1] - grid.south) / SPACING), cells[0])
    if row_a != row_b:
        return bool(row_a < row_b)
    column_a = max(math.floor((a[0] - grid.west) / SPACING), cells[2])
    column_b = max(math.floor((b[0] - grid.west) / SPACING), cells[2])
    if column_a != column_b:
        return bool(column_a < column_b)
    return one < other


@kernel(inline=True)
def _may_meet(ray: Ray, limit: float, bounds: NDArray[np.float64]) -> bool:
    """Return whether a ray comes by a rectangle on the ground before the limit [m]."""
    half_x, half_y = 0.5 * (bounds[2] - bounds[0]), 0.5 * (bounds[3] - bounds[1])
    x, y = bounds[0] + half_x - ray.x, bounds[1] + half_y - ray.y
    way_x, way_y = abs(ray.ahead_x), abs(ray.ahead_y)
    if abs(x * ray.ahead_y - y * ray.ahead_x) > half_x * way_y + half_y * way_x + _SLACK:
        return False
    middle, half = x * ray.ahead_x + y * ray.ahead_y, half_x * way_x + half_y * way_y + _SLACK
    return bool(-half <= middle <= limit * (way_x * way_x + way_y * way_y) + half)


@kernel(inline=True)
def _cast_boxes(ray: Ray, reach: float, boxes: Boxes, count: int) -> tuple[float, int]:
    best, thing = math.inf, -1
    for box in range(count):
        if not _may_meet(ray, min(best, reach), boxes.bounds[box]):
            continue
        corners, heights = (4 * box, 4 * box + 4), (boxes.bottom[box], boxes.top[box])
        near = _cast_prism(ray, min(best, reach), boxes.corners, corners, heights)
        if near < best:
            best, thing = near, int(boxes.thing[box])
    return best, thing


@kernel(inline=True)
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
        # The share of the side at which it is met is between 0 and 1: no need to divide.
        share = from_x * ray.ahead_y - from_y * ray.ahead_x
        if not (0.0 <= share <= across or across <= share <= 0.0):
            continue
        t = (from_x * side_y - from_y * side_x) / across
        z = ray.z + t * ray.ahead_z
        if 0.0 <= t <= min(limit, best) and bottom <= z <= top:
            best = t
    if ray.ahead_z != 0.0:
        for end in range(2):
            t = ((top if end == 0 else bottom) - ray.z) / ray.ahead_z
            x, y = ray.x + t * ray.ahead_x, ray.y + t * ray.ahead_y
            if 0.0 <= t <= min(limit, best) and _inside(points, first, last, x, y):
                best = t
    return best


@kernel(inline=True)
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


@kernel(inline=True)
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


@kernel(inline=True)
def _cast_ground(ray: Ray, limit: float, terrain: Terrain, slopes: Slopes) -> float:
    """Return the distance of the ground, infinity if it is not met before the limit [m].

    On hills, the ray is followed in steps of half a cell of the relief, and the step that enters
    the ground is halved; what is narrower may be missed. Steps in which the ground, however steep,
    cannot rise to the ray are left out.
    """
    if terrain.relief.shape[0] == 0:
        if ray.ahead_z >= 0.0:
            return math.inf
        t = (terrain.floor - ray.z) / ray.ahead_z
        return t if 0.0 <= t <= limit else math.inf
    steps = int(limit / (0.5 * terrain.spacing)) + 1
    above, at = _above_ground(ray, 0.0, terrain), 0.0
    if above <= 0.0:
        return math.inf
    level = math.sqrt(ray.ahead_x * ray.ahead_x + ray.ahead_y * ray.ahead_y)
    step, per_metre = 0, (steps / limit if limit > 0.0 else 0.0)
    while step < steps:
        place = (ray.x + at * ray.ahead_x, ray.y + at * ray.ahead_y)
        free = free_way(slopes, terrain, place, (level, ray.ahead_z), above)
        step = max(step, math.floor((at + free) * per_metre)) + 1
        if step > steps:
            break
        at = limit * step / steps
        above = _above_ground(ray, at, terrain)
        if above <= 0.0:
            return _entered_ground(ray, limit * (step - 1) / steps, at, terrain)
    return math.inf


@kernel(inline=True)
def _entered_ground(ray: Ray, from_t: float, to_t: float, terrain: Terrain) -> float:
    """Return where a ray enters the ground between two distances [m]."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (from_t + to_t)
        if _above_ground(ray, middle, terrain) <= 0.0:
            to_t = middle
        else:
            from_t = middle
    return to_t


@kernel(inline=True)
def _above_ground(ray: Ray, t: float, terrain: Terrain) -> float:
    """Return the height of a point of the ray above the ground [m]."""
    return (
        ray.z
        + t * ray.ahead_z
        - ground_at(terrain, ray.x + t * ray.ahead_x, ray.y + t * ray.ahead_y)
    )
