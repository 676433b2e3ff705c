"""What stands in the way of those on foot: solid shapes, water, the edge of the map."""

from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.scene import Fixtures, ObjectClass, Scene
from eyas.engine.state.terrain import Terrain, reliefs
from eyas.engine.world.roads.areas import corridors, split_on_grid
from eyas.lanes import exact

_STEP: Final = 0.3  # Height above the ground up to which one can step over things [m]

_HEAD: Final = 2.2  # Height above the ground over which nothing is in the way [m]

_CLUTTER: Final = frozenset(
    "litter,fallen leaves,drain,road sign,bus stop,cabinet,planter,rubbish,wheeled bins,shop board,"
    "cafe table,crates,bicycle rack,trampoline,washing line,garden pool,logs,letter box".split(",")
)
"""Names of kinds of things, without their numbers, that stand where people do not walk along."""

_STEEP: Final = 0.5  # Largest rise within a cell of the relief, per metre of its side

_EDGE: Final = 5.0  # Distance to the edge of the map that is kept [m]

_FAR: Final = 1e5  # Farther than anything is put [m]

_SOLID: Final = (ObjectClass.BUILDING, ObjectClass.TREE, ObjectClass.STRUCTURE, ObjectClass.POLE)

Floats = NDArray[np.float64]


class GroundObstacles:
    """The plan shapes of all obstacles of a map.

    Args:
        scene: The map.
        roads: Whether roads are obstacles too, as cars drive on them.
        others: All but the roads, if they are known.
    """

    def __init__(
        self, scene: Scene, *, roads: bool, others: "GroundObstacles | None" = None
    ) -> None:
        shapes = (
            [others._tree.geometries]
            if others is not None
            else [
                _prisms(scene),
                _cylinders(scene),
                _fixtures(scene.fixtures, as_placed=scene.footways.told),
                _walls(scene),
                _water(scene),
                _steep(scene.terrain),
                _beyond(scene),
            ]
        )
        if roads and len(scene.network.lane_width):
            shapes.append(np.array(split_on_grid(corridors(scene.network)), object))
        every = np.concatenate([np.asarray(part, object).ravel() for part in shapes])
        self._tree: shapely.STRtree = shapely.STRtree(every[~shapely.is_empty(every)])

    def near(self, shape: shapely.Geometry, distance: float) -> NDArray[np.object_]:
        """Return the obstacles within a distance [m] of a shape."""
        found: NDArray[np.object_] = self._tree.geometries.take(
            self._tree.query(shape, predicate="dwithin", distance=distance)
        )
        return found

    def blocked(self, shapes: NDArray[np.object_], radius: float) -> NDArray[np.bool_]:
        """Return whether an obstacle is within a radius [m] of each point or line, shape (K,)."""
        which, _ = self._tree.query(shapes, predicate="dwithin", distance=radius)
        blocked = np.zeros(len(shapes), np.bool_)
        blocked[which] = True
        return blocked

    def reach(
        self,
        start: Floats,  # Where from [m], shape (K, 2)
        direction: Floats,  # Headings [rad], shape (K,)
        far: float,  # The most that is returned [m]
        radius: float,  # Distance to obstacles that is kept [m]
    ) -> Floats:
        """Return how far one can go straight on [m], shape (K,)."""
        end = start + far * np.column_stack([exact.cos(direction), exact.sin(direction)])
        lines = shapely.linestrings(np.stack([start, end], axis=1))
        which, what = self._tree.query(lines, predicate="dwithin", distance=radius)
        # A polygon around the obstacle, a little larger than the circle of eight edges in it.
        different, again = np.unique(what, return_inverse=True)
        near = self._tree.geometries.take(different)
        swollen = shapely.buffer(near, 1.01 * radius, quad_segs=4)
        met = shapely.intersection(lines[which], swollen[again])
        away = shapely.distance(shapely.points(start)[which], met)
        reach = np.full(len(start), far)
        np.minimum.at(reach, which, np.where(np.isfinite(away), away, far))
        return reach


def _prisms(scene: Scene) -> NDArray[np.object_]:
    colliders = scene.colliders
    first = colliders.prism_first
    low = colliders.prism_points[first[:-1]] if len(first) > 1 else np.zeros((0, 2))
    kept = _in_the_way(scene, low, colliders.prism_bottom, colliders.prism_top)
    kept &= np.diff(first) >= 3
    rings = [colliders.prism_points[first[i] : first[i + 1]] for i in np.flatnonzero(kept)]
    return np.array([shapely.make_valid(shapely.Polygon(ring)) for ring in rings], object)


def _cylinders(scene: Scene) -> NDArray[np.object_]:
    colliders = scene.colliders
    centre = colliders.cylinder_centre
    kept = _in_the_way(scene, centre, colliders.cylinder_bottom, colliders.cylinder_top)
    # Its polygon of 16 corners lies outside the circle.
    radius = colliders.cylinder_radius[kept] / exact.cos(np.pi / 16)
    return np.asarray(shapely.buffer(shapely.points(centre[kept]), radius, quad_segs=4), object)


def _in_the_way(scene: Scene, at: Floats, low: Floats, high: Floats) -> NDArray[np.bool_]:
    """Return which of some heights, from low to high [m], are in the way at points."""
    ground = reliefs(scene.terrain, at)
    kept: NDArray[np.bool_] = (low < ground + _HEAD) & (high > ground + _STEP)
    return kept


def _fixtures(fixtures: Fixtures, *, as_placed: bool) -> NDArray[np.object_]:
    """Return what trees, benches, lamps and parked cars cover at the height of people.

    Args:
        fixtures: All of them.
        as_placed: Whether heights are those of the copies, so that one walks below crowns of trees.
            On maps with wide pavements heights are those of the prototypes: the crowns of trees,
            which are 1 m high, are kept clear of as a whole.

    The clutter of streets stands where people do not walk along, and so that who wanders about goes
    his way as before there was any, it is in nobody's way.
    """
    shapes: list[shapely.Geometry] = []
    for number, levels in enumerate(fixtures.levels):
        if fixtures.names and fixtures.names[number].rstrip(" 0123456789") in _CLUTTER:
            continue
        pose = fixtures.pose[fixtures.prototype == number].astype(np.float64)
        scale = np.ones(len(pose))
        if as_placed:
            scale = np.maximum(np.round(np.linalg.norm(pose[:, :, 2], axis=1), 1), 0.1)
        for size in np.unique(scale).tolist():
            ring = _outline(levels[0].positions, size)
            if ring is not None:
                own = pose[scale == size]
                placed = exact.product(ring, own[:, :2, :2].swapaxes(1, 2)) + own[:, None, :2, 3]
                shapes += list(shapely.polygons(placed))
    return np.array(shapes, object)


def _outline(points: NDArray[np.float32], size: float) -> Floats | None:
    """Return the outline of what is in the way of people, for a prototype at a scale."""
    points = points[(points[:, 2] > 0.0) & (points[:, 2] < _HEAD / size)]
    if not len(points) or points[:, 2].max() < _STEP / size:
        return None
    plan = shapely.convex_hull(shapely.MultiPoint(points[:, :2]))
    return shapely.get_coordinates(plan) if plan.geom_type == "Polygon" else None


def _triangles(scene: Scene, classes: tuple[ObjectClass, ...]) -> Floats:
    """Return the static triangles of some classes, shape (T, 3, 3) [m]."""
    chosen = np.isin(scene.object_class[scene.static_object], classes)
    return scene.static.positions[scene.static.triangles[chosen]].astype(np.float64)


def _walls(scene: Scene) -> NDArray[np.object_]:
    """Return what the triangles of solid things cover at the height of people."""
    triangles = _triangles(scene, _SOLID)
    low, high = triangles[..., 2].min(axis=1), triangles[..., 2].max(axis=1)
    kept = _in_the_way(scene, triangles[:, 0, :2], low, high)
    plan = triangles[kept][..., :2]
    # Upright triangles have no area, but a convex hull: a line.
    corners = shapely.multipoints(plan) if len(plan) else np.zeros(0, object)
    return np.asarray(shapely.convex_hull(corners), object)


def _water(scene: Scene) -> NDArray[np.object_]:
    plan = _triangles(scene, (ObjectClass.WATER,))[..., :2]
    return np.asarray(shapely.polygons(plan) if len(plan) else np.zeros(0), object)


def _steep(terrain: Terrain) -> NDArray[np.object_]:
    """Return the cells of the relief that are too steep to be climbed."""
    if terrain.relief.size == 0:
        return np.zeros(0, object)
    relief = terrain.relief.astype(np.float64)
    corners = np.stack([relief[:-1, :-1], relief[:-1, 1:], relief[1:, :-1], relief[1:, 1:]])
    row, column = np.nonzero(np.ptp(corners, axis=0) > _STEEP * terrain.spacing)
    west, south = terrain.west + column * terrain.spacing, terrain.south + row * terrain.spacing
    boxes = shapely.box(west, south, west + terrain.spacing, south + terrain.spacing)
    return np.asarray(boxes, object)


def _beyond(scene: Scene) -> NDArray[np.object_]:
    """Return all beyond the edge of the map, a strip at each side."""
    east, north = scene.size[0] / 2 - _EDGE, scene.size[1] / 2 - _EDGE
    low = [[-_FAR, -_FAR], [-_FAR, -_FAR], [east, -_FAR], [-_FAR, north]]
    high = [[_FAR, -north], [-east, _FAR], [_FAR, _FAR], [_FAR, _FAR]]
    return np.asarray(shapely.box(*np.transpose(low), *np.transpose(high)), object)
