"""The height of what one walks on: pavements are higher than roads, lawns lower."""

from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.state.terrain import reliefs
from eyas.lanes import compiled

_WALKABLE: Final = (ObjectClass.GROUND, ObjectClass.ROAD, ObjectClass.PAVEMENT)

_NEAR: Final = 0.7
"""Largest distance from the height of the terrain, as bridges and floors are not ground [m]."""

_GRAIN: Final = 0.04
"""Distance between the points at which the ground is sought: slow robots share many [m]."""

_ROUNDING: Final = 3.4e-16
"""Largest error of which side of a line a point is on, as a share of what is subtracted (J. R.
Shewchuk, 1997)."""

_CLOSE: Final = 2  # So near to an edge that rounding decides on which side of it

_ROW: Final = 2**31  # More than all points between one end of a map and the other

Floats = NDArray[np.float64]


class Footing(NamedTuple):
    """The ground at K points, shape (K,) each."""

    height: Floats  # z [m]
    pavement: NDArray[np.bool_]  # Whether it is a pavement


class WalkedSurface:
    """The upper sides of ground, roads and pavements."""

    def __init__(
        self,
        scene: Scene,  # The map
    ) -> None:
        self._terrain = scene.terrain
        kinds = scene.object_class[scene.static_object]
        corners = scene.static.positions[scene.static.triangles].astype(np.float64)
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        level = across[:, 2] > 0.5 * np.linalg.norm(across, axis=1)
        off = corners.mean(axis=1)[:, 2] - reliefs(scene.terrain, corners.mean(axis=1)[:, :2])
        kept = np.isin(kinds, _WALKABLE) & level & (np.abs(off) < _NEAR)
        self._corners, self._across = corners[kept], across[kept]
        self._pavement = kinds[kept] == ObjectClass.PAVEMENT
        plan = self._corners[..., :2]
        self._tree = shapely.STRtree(shapely.polygons(plan) if len(plan) else [])

    def at(self, points: Floats) -> Footing:
        """Return the ground at points [m], shape (K, 2); without any, that of the terrain.

        Its height above the terrain is that of a point less than `_GRAIN` away.
        """
        # As single numbers, points are sorted eight times as fast as in pairs.
        east, north = np.rint(points / _GRAIN).astype(np.int64).T
        different, place = np.unique(east * _ROW + north, return_inverse=True)
        column, row = np.divmod(different + _ROW // 2, _ROW)
        rounded = np.column_stack([column, row - _ROW // 2]).astype(np.float64)
        found = self._exactly(rounded * _GRAIN)
        above = found.height - reliefs(self._terrain, rounded * _GRAIN)
        height = reliefs(self._terrain, points) + above[place]
        return Footing(height, found.pavement[place])

    def _exactly(self, points: Floats) -> Footing:
        floor = self._terrain.floor + reliefs(self._terrain, points)
        height, pavement = np.full(len(points), -np.inf), np.zeros(len(points), np.bool_)
        which, what = self._under(points)
        if len(which):
            corner, across = self._corners[what, 0], self._across[what]
            aside = points[which] - corner[:, :2]
            z = corner[:, 2] - (across[:, :2] * aside).sum(axis=1) / across[:, 2]
            np.maximum.at(height, which, z)
            top = z >= height[which] - 1e-6
            pavement[which[top]] = self._pavement[what[top]]
        return Footing(np.where(np.isfinite(height), height, floor), pavement)

    def _under(self, points: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the pairs of points and triangles on which they lie; edges belong to both."""
        which, what = self._tree.query(shapely.points(points))
        found = np.empty(len(which), np.int8)
        _test(np.ascontiguousarray(points), self._corners, which, what, found)
        close = np.flatnonzero(found == _CLOSE)
        near = shapely.points(points[which[close]]), self._tree.geometries[what[close]]
        found[close] = shapely.intersects(*near)
        return which[found > 0], what[found > 0]


@compiled
def _test(
    points: Floats,
    corners: Floats,  # Of triangles, counter-clockwise from above, shape (T, 3, 3)
    which: NDArray[np.intp],  # Points of the pairs
    what: NDArray[np.intp],  # Triangles of the pairs
    found: NDArray[np.int8],  # Filled: 1 where the point lies in the triangle, 0, or `_CLOSE`
) -> None:
    for k in range(len(which)):
        x, y, own, inside = points[which[k], 0], points[which[k], 1], corners[what[k]], 1
        for end in range(3):
            ax, ay, bx, by = own[end - 1, 0], own[end - 1, 1], own[end, 0], own[end, 1]
            left, right = (bx - ax) * (y - ay), (by - ay) * (x - ax)
            error = _ROUNDING * (abs(left) + abs(right))
            if left - right < -error:
                inside = 0
                break
            if left - right <= error:
                inside = _CLOSE
        found[k] = inside
