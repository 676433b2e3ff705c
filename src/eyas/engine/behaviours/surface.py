"""The height of what one walks on: pavements are higher than roads, lawns lower."""

from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.state.terrain import reliefs

_WALKABLE: Final = (ObjectClass.GROUND, ObjectClass.ROAD, ObjectClass.PAVEMENT)

_NEAR: Final = 0.7
"""Largest distance from the height of the terrain, as bridges and floors are not ground [m]."""

_GRAIN: Final = 0.04
"""Distance between the points at which the ground is sought: slow robots share many [m]."""

_ROW: Final = 2**31  # More than all points between one end of a map and the other

Floats = NDArray[np.float64]


class Footing(NamedTuple):
    """The ground at K points, shape (K,) each."""

    height: Floats  # z [m]
    pavement: NDArray[np.bool_]  # Whether it is a pavement


class WalkedSurface:
    """The upper sides of ground, roads and pavements.

    Args:
        scene: The map.
    """

    def __init__(self, scene: Scene) -> None:
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
        which, what = self._tree.query(shapely.points(points), predicate="intersects")
        if len(which):
            corner, across = self._corners[what, 0], self._across[what]
            aside = points[which] - corner[:, :2]
            z = corner[:, 2] - (across[:, :2] * aside).sum(axis=1) / across[:, 2]
            np.maximum.at(height, which, z)
            top = z >= height[which] - 1e-6
            pavement[which[top]] = self._pavement[what[top]]
        return Footing(np.where(np.isfinite(height), height, floor), pavement)
