"""Relief as irregular triangles: that of a plan, its surface and covers, and its raster."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate, of_one_material
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.state.terrain import Terrain
from eyas.engine.world.build.materials import TEXTURES
from eyas.engine.world.build.millimetres import rounded
from eyas.lanes import exact
from eyas.maps.land.mounds import Mound, highest
from eyas.maps.plan import plan

_JITTER = 0.36
"""Most by which a point is moved from its place in the lattice, as a share of the spacing."""

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Relief:
    """The ground where it rises above the floor. V points, T triangles."""

    points: Points  # East, north, and height above the floor [m], shape (V, 3)
    triangles: NDArray[np.int64]  # Indices of points, counter-clockwise from above, shape (T, 3)

    @property
    def corners(self) -> Points:
        """Corners of the triangles [m], shape (T, 3, 3)."""
        return self.points[self.triangles]

    @property
    def area(self) -> shapely.Geometry:
        """Area of rising ground, in plan view [m]."""
        return shapely.union_all(shapely.polygons(self.corners[..., :2]))


def relief(
    # Returns the heights above the floor [m] at points, shape (P, 2)
    heights: Callable[[Points], Points],
    # Half the side of the square in the middle, and of the whole relief [m]
    half: tuple[float, float],
    spacing: tuple[float, float],  # Distance between points in the middle and outside of it [m]
    flat: shapely.Geometry,  # Area that no triangle may touch [m]
    rng: np.random.Generator,
) -> Relief:
    """Return a rising ground as triangles, small ones in the middle of the map."""
    inner = _lattice(half[0], spacing[0], rng)
    outer = _lattice(half[1], spacing[1], rng)
    outer = outer[np.abs(outer).max(axis=1) > half[0] + 0.4 * spacing[0]]
    points = np.concatenate([inner, outer])
    height = heights(points)
    cells = shapely.get_parts(shapely.delaunay_triangles(shapely.multipoints(points)))
    index = _indices(points, shapely.get_coordinates(cells).reshape(-1, 4, 2)[:, :3])
    index = index[(height[index] > 0).any(axis=1)]
    shapely.prepare(flat)
    touching = shapely.intersects(flat, shapely.polygons(points[index]))
    height[index[touching].ravel()] = 0.0
    index = index[(height[index] > 0).any(axis=1)]
    edge = points[index][:, 1:] - points[index][:, :1]
    clockwise = edge[:, 0, 0] * edge[:, 1, 1] < edge[:, 0, 1] * edge[:, 1, 0]
    index[clockwise] = index[clockwise][:, ::-1]
    used, triangles = np.unique(index, return_inverse=True)
    return Relief(
        np.column_stack([points, height])[used], triangles.reshape(-1, 3).astype(np.int64)
    )


def terrain_of(
    ground: Relief,
    floor: float,  # z of the floor [m]
    half: float,  # Half the side of the raster [m]
    spacing: float = 4.0,  # Distance between its points [m]
) -> Terrain:
    """Return the raster of a relief."""
    count = int(np.ceil(2 * half / spacing)) + 1
    axis = -half + spacing * np.arange(count)
    x, y = (a.ravel() for a in np.meshgrid(axis, axis))
    raster = heights_of(ground, np.column_stack([x, y]))
    rows = np.maximum(rounded(raster), 0.0).reshape(count, count).astype(np.float32)
    return Terrain(floor, rows, -half, -half, spacing)


def heights_of(
    ground: Relief,
    points: Points,  # East and north [m], shape (P, 2)
) -> Points:
    """Return the height of a relief above the floor at points, 0 beside it [m]."""
    corners = ground.corners
    tree = shapely.STRtree(shapely.polygons(corners[..., :2]))
    point, cell = tree.query(shapely.points(points), predicate="intersects")
    a, b, c = np.moveaxis(corners[cell], 1, 0)
    across, up, way = b - a, c - a, points[point] - a[:, :2]
    double = across[:, 0] * up[:, 1] - across[:, 1] * up[:, 0]
    one = (way[:, 0] * up[:, 1] - way[:, 1] * up[:, 0]) / double
    other = (across[:, 0] * way[:, 1] - across[:, 1] * way[:, 0]) / double
    height = np.zeros(len(points))
    height[point] = a[:, 2] + one * across[:, 2] + other * up[:, 2]
    return height


def surface_of(
    ground: Relief,
    floor: float,  # z of the floor [m]
    cover: Sequence[Material],  # Materials
    kind: NDArray[np.integer],
    *,
    # Whether light changes smoothly over the edges of triangles; otherwise each is flat
    smooth: bool = False,
    # u of each point where the second cover has a distance there, shape (V,) [m]
    along: Points | None = None,
) -> Mesh:
    """Return the surface of a relief."""
    normals = _normals(ground, smooth=smooth)
    made = []
    for index, material in enumerate(cover):
        some = kind == index
        if not some.any():
            continue
        corners = ground.corners[some].reshape(-1, 3)
        uvs = corners[:, :2] / TEXTURES[material.texture]
        if along is not None and index == 1:
            uvs = np.column_stack([along[ground.triangles[some]].ravel(), np.zeros(len(corners))])
        triangles = np.arange(len(corners)).reshape(-1, 3)
        placed = corners + np.array([0.0, 0.0, floor])
        made.append(of_one_material(placed, normals[some].reshape(-1, 3), uvs, triangles, material))
    return concatenate(made)


def _normals(ground: Relief, *, smooth: bool) -> Points:
    """Return unit normals at the corners of the triangles, shape (T, 3, 3)."""
    corners = ground.corners
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    if smooth:
        total = np.zeros_like(ground.points)
        np.add.at(total, ground.triangles, face[:, None])
        # The feet join level ground.
        total[ground.points[:, 2] == 0] = (0.0, 0.0, 1.0)
        normals = total[ground.triangles]
    else:
        normals = np.repeat(face[:, None], 3, axis=1)
    return np.asarray(normals / np.linalg.norm(normals, axis=-1, keepdims=True), np.float64)


def _lattice(half: float, spacing: float, rng: np.random.Generator) -> Points:
    """Return points of a square lattice, each moved at random, in whole millimetres."""
    count = int(2 * half / spacing)
    axis = spacing * (np.arange(count) - 0.5 * (count - 1))
    points = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    return rounded(points + spacing * rng.uniform(-_JITTER, _JITTER, points.shape))


def _indices(points: Points, corners: Points) -> NDArray[np.int64]:
    """Return the index of the point at each corner; both have the same coordinates."""
    keys = _pairs(points)
    order = np.argsort(keys, kind="stable")
    places = np.searchsorted(keys, _pairs(corners), sorter=order)
    return np.asarray(order[places], np.int64)


def _pairs(points: Points) -> NDArray[np.complex128]:
    """Return points as numbers that are ordered by the first coordinate, then by the second."""
    return np.ascontiguousarray(points, np.float64).view(np.complex128)[..., 0]


_TOP = 45.0  # Height from which the last cover lies [m]
_SNOW_LINE = 4.0  # Height from which snow lies on a white mound [m]
_MARGIN = 1.0  # Height by which a white mound must top its neighbour to be white there [m]
_WAVE = 1.5  # Amplitude of the border's waves [m]


def relief_of(layer: plan.Hills, seed: int) -> Relief:
    """Return the triangles of rising ground."""
    rng = layer.chance.generator(seed)

    def heights(points: Points) -> Points:
        smooth, _ = highest(layer.mounds, points)
        if not layer.rough:
            return smooth
        return np.round(smooth * (1.0 + rng.uniform(-layer.rough, layer.rough, len(points))), 3)

    return relief(heights, layer.half, layer.spacing, layer.flat or shapely.Polygon(), rng)


def kinds_of(ground: Relief, covers: int, rng: np.random.Generator) -> NDArray[np.intp]:
    """Return which cover each triangle has: higher up mostly a later one."""
    height = ground.corners[..., 2].mean(axis=1)
    level = np.clip(height / _TOP, 0.0, 1.0) * (covers - 2) + rng.uniform(0.0, 1.8, len(height))
    return np.asarray(np.clip(level.astype(np.intp), 0, covers - 1), np.intp)


def snow_over(ground: Relief, dunes: Sequence[Mound], white: set[int]) -> Points:
    """Return how far the points of a relief lie above the line where snow begins, shape (V,) [m].

    Snow lies where a white dune is the highest, above a line that rises and falls along its foot.
    """
    points = ground.points
    own, _ = highest([dunes[index] for index in sorted(white)], points[:, :2])
    others, _ = highest([d for index, d in enumerate(dunes) if index not in white], points[:, :2])
    over = points[:, 2] + _WAVE * exact.sin(0.11 * points[:, 0]) * exact.sin(0.13 * points[:, 1])
    return rounded(np.minimum(own - others - _MARGIN, over - _SNOW_LINE))
