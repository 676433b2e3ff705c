"""Where a camera may fly and what it sees from there: heights that are clear, targets in sight.

It reads the ground and the solids that contacts and rays read; what moves does not count, so that
one answer holds at any time.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sensors.grid import cells_between
from eyas.engine.sensors.obstacles import Obstacles, Solids, obstacles_of
from eyas.engine.sensors.rays import Ray, cast_ray
from eyas.engine.state.motion import Motion
from eyas.engine.state.terrain import Terrain, ground_at
from eyas.lanes import compiled, kernel

Floats = NDArray[np.float64]

_LIFTS = 64  # Most things above each other that a column is lifted over

_SHORT = 0.2  # How much nearer than a point a ray ends, which may lie on a surface [m]


class Margin(NamedTuple):
    """How near a body may come to things."""

    aside: float  # Radius around it that is free [m]
    above: float  # Height above and below it that is free [m]
    ground: float  # Least height above the ground [m]


class Clearance:
    """Answers for many places at once.

    Args:
        solids: What stands.
        terrain: The ground.
        motion: Traffic, none of which counts.
    """

    def __init__(self, solids: Solids, terrain: Terrain, motion: Motion) -> None:
        nobody = np.zeros((1, 0), np.int32)
        self._obstacles = obstacles_of(solids, terrain, motion, np.zeros(1, np.int32), nobody)

    def lifted(self, places: Floats, margin: Margin) -> Floats:
        """Return the least heights, from those of places up, that are free of things [m].

        Args:
            places: World frame [m], shape (M, 3).
            margin: How near things may be.

        Returns:
            z, shape (M,).
        """
        height = np.array(places[:, 2], np.float64)
        here = np.ascontiguousarray(places, np.float64)
        _lift_all.bind(_Lifting(self._obstacles, margin, here, height))()
        return height

    def in_sight(self, eyes: Floats, points: Floats) -> NDArray[np.bool_]:
        """Return whether nothing that stands is between eyes and points.

        Args:
            eyes: World frame [m], shape (M, 3).
            points: P points for each [m], shape (M, P, 3).

        Returns:
            Shape (M, P).
        """
        seen = np.zeros(points.shape[:2], np.bool_)
        from_, to = np.ascontiguousarray(eyes), np.ascontiguousarray(points)
        _look_all.bind(_Looking(self._obstacles, from_, to, seen))()
        return seen


class _Lifting(NamedTuple):
    obstacles: Obstacles
    margin: Margin
    places: Floats
    height: Floats


class _Looking(NamedTuple):
    obstacles: Obstacles
    eyes: Floats
    points: Floats
    seen: NDArray[np.bool_]


@compiled
def _lift_all(work: _Lifting) -> None:
    for place in range(work.places.shape[0]):
        obstacles, at = work.obstacles, work.places[place]
        work.height[place] = lifted_over(
            obstacles.solids, obstacles.terrain, work.margin, at[0], at[1], at[2]
        )


@kernel(inline=True)
def lifted_over(
    solids: Solids, terrain: Terrain, margin: Margin, x: float, y: float, z: float
) -> float:
    """Return the least height, from `z` up, that is free of things [m]."""
    height = max(z, _lowest(terrain, margin, x, y))
    for _ in range(_LIFTS):
        free = _over_solids(solids, margin, x, y, height)
        if free == height:
            break
        height = free
    return height


@kernel(inline=True)
def _lowest(terrain: Terrain, margin: Margin, x: float, y: float) -> float:
    """Return the least height over the ground around a point [m]."""
    highest = ground_at(terrain, x, y)
    for corner in range(4):
        aside = margin.aside if corner < 2 else -margin.aside
        along = margin.aside if corner % 2 == 0 else -margin.aside
        highest = max(highest, ground_at(terrain, x + aside, y + along))
    return highest + margin.ground


@kernel(inline=True)
def _over_solids(solids: Solids, margin: Margin, x: float, y: float, z: float) -> float:
    """Return the height over those solids that are beside a height; itself if none is [m]."""
    free, prisms, grid = z, solids.first.shape[0] - 1, solids.grid
    first_row, last_row, left, right = cells_between(grid, (x, x), (y, y), margin.aside)
    for row in range(first_row, last_row + 1):
        for column in range(left, right + 1):
            cell = row * grid.columns + column
            if grid.top[cell] + margin.above <= z:
                continue
            for k in range(grid.first[cell], grid.first[cell + 1]):
                item = grid.item[k]
                over = solids.top[item] + margin.above
                if over <= free or solids.bottom[item] - margin.above >= z or over <= z:
                    continue
                if item < prisms:
                    first, last = solids.first[item], solids.first[item + 1]
                    near = _near_prism(solids.points, first, last, x, y, margin.aside)
                else:
                    round_ = solids.round[item - prisms]
                    off_x, off_y, reach = x - round_[0], y - round_[1], margin.aside + round_[2]
                    near = off_x * off_x + off_y * off_y < reach * reach
                if near:
                    free = over
    return free


@kernel(inline=True)
def _near_prism(points: Floats, first: int, last: int, x: float, y: float, reach: float) -> bool:
    """Return whether a point is inside an outline, or nearer to it than a distance [m]."""
    odd, near, before = False, False, last - 1
    for corner in range(first, last):
        a_x, a_y = points[before, 0] - x, points[before, 1] - y
        b_x, b_y = points[corner, 0] - x, points[corner, 1] - y
        side_x, side_y = b_x - a_x, b_y - a_y
        square = side_x * side_x + side_y * side_y
        share = 0.0
        if square > 0.0:
            share = min(max(-(a_x * side_x + a_y * side_y) / square, 0.0), 1.0)
        off_x, off_y = a_x + share * side_x, a_y + share * side_y
        if off_x * off_x + off_y * off_y < reach * reach:
            near = True
        if (a_y > 0.0) != (b_y > 0.0) and a_x - a_y / (b_y - a_y) * side_x > 0.0:
            odd = not odd
        before = corner
    return near or odd


@compiled
def _look_all(work: _Looking) -> None:
    for eye in range(work.points.shape[0]):
        for point in range(work.points.shape[1]):
            x, y, z = work.eyes[eye, 0], work.eyes[eye, 1], work.eyes[eye, 2]
            to = work.points[eye, point]
            way_x, way_y, way_z = to[0] - x, to[1] - y, to[2] - z
            length = math.sqrt(way_x * way_x + way_y * way_y + way_z * way_z)
            reach = length - _SHORT
            if reach <= 0.0:
                work.seen[eye, point] = True
                continue
            ray = Ray(x, y, z, way_x / length, way_y / length, way_z / length)
            distance, _ = cast_ray(ray, reach, work.obstacles, 0)
            work.seen[eye, point] = distance > reach
