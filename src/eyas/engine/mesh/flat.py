"""Meshes of flat faces: quadrilaterals, polygons on the ground, walls. Lengths in metres, z up."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.mesh.assembly import of_one_material
from eyas.engine.mesh.panels import cells
from eyas.engine.state.mesh import Material, Mesh
from eyas.lanes import exact

if TYPE_CHECKING:
    import shapely

Rows = NDArray[np.float64]


def quads(corners: ArrayLike, uvs: ArrayLike, material: Material) -> Mesh:
    """Return flat-shaded quadrilaterals.

    Args:
        corners: Counter-clockwise as seen from outside [m], shape (Q, 4, 3).
        uvs: Texture coordinates in tiles, shape (Q, 4, 2).
        material: Material of all of them.
    """
    points = np.asarray(corners, np.float64).reshape(-1, 4, 3)
    normals = exact.cross(points[:, 2] - points[:, 0], points[:, 3] - points[:, 1])
    normals /= np.maximum(exact.lengths(normals), 1e-12)[:, None]
    first = 4 * np.arange(len(points), dtype=np.int32)[:, None]
    triangles = np.concatenate(
        [first + np.array([0, 1, 2]), first + np.array([0, 2, 3])], axis=1
    ).reshape(-1, 3)
    return of_one_material(
        points.reshape(-1, 3),
        np.repeat(normals, 4, axis=0),
        np.asarray(uvs).reshape(-1, 2),
        triangles,
        material,
    )


def flat_polygon(
    polygon: "shapely.Geometry", z: float, material: Material, tile: float, turn: float = 0.0
) -> Mesh:
    """Return a horizontal polygon (holes and several parts allowed) that faces up.

    The texture is aligned with the world's axes, or turned counter-clockwise by `turn` [rad].
    """
    return flat_polygons([polygon], z, material, tile, turn)


def flat_polygons(
    polygons: "Sequence[shapely.Geometry]",
    z: float,
    material: Material,
    tile: float,
    turn: float = 0.0,
) -> Mesh:
    """Return polygons as one mesh, see `flat_polygon`; they share no vertices."""
    import shapely  # not needed to move and join meshes, as each start does

    split = shapely.constrained_delaunay_triangles(np.asarray(polygons, object))
    cells, owner = shapely.get_parts(split, return_index=True)
    flat = shapely.get_coordinates(cells).reshape(-1, 4, 2)[:, :3]
    edge = flat[:, 1:] - flat[:, :1]
    area = edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0]
    flat[area < 0] = flat[area < 0][:, ::-1]
    # Collinear corners give triangles narrower than a micrometre, which cannot be shaded.
    wide = np.abs(area) > 1e-6 * np.abs(edge).max(axis=(1, 2))
    corners = np.column_stack([np.repeat(owner[wide], 3), flat[wide].reshape(-1, 2)])
    points, index = _distinct(corners)
    positions = np.column_stack([points, np.full(len(points), z)])
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    cosine, sine = exact.cos(turn), exact.sin(turn)
    u = points[:, 0] * cosine + points[:, 1] * sine
    v = points[:, 1] * cosine - points[:, 0] * sine
    uvs = np.column_stack([u, v]) / tile
    return of_one_material(positions, up, uvs, index.reshape(-1, 3), material)


def _distinct(corners: Rows) -> tuple[Rows, NDArray[np.intp]]:
    """Return the points of polygons in order, and the index of the point of each corner, from
    corners (C, 3): number of the polygon, east, north.
    """
    order = np.lexsort(corners.T[::-1])
    ordered = corners[order]
    new = np.ones(len(order), np.bool_)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    index = np.empty(len(order), np.intp)
    index[order] = np.cumsum(new) - 1
    return ordered[new, 1:], index


def walls(outline: ArrayLike, bottom: float, top: float, material: Material, tile: float) -> Mesh:
    """Return vertical walls around a closed counter-clockwise outline, shape (K, 2).

    Each wall has a whole number of window bays (quarter tiles of the texture); v is measured from
    the bottom.
    """
    start = np.asarray(outline, np.float64)
    length = np.linalg.norm(np.roll(start, -1, axis=0) - start, axis=1)
    repeats = np.maximum(np.round(length / tile * 4), 1) / 4
    uvs = np.zeros((len(start), 4, 2))
    uvs[:, 1:3, 0] = repeats[:, None]
    uvs[:, 2:, 1] = (top - bottom) / tile
    ring = np.concatenate([start, start[:1]])
    return quads(_upright(ring, bottom, top), uvs, material)


def wall_along(line: ArrayLike, bottom: float, top: float, material: Material, tile: float) -> Mesh:
    """Return the vertical wall along a line, shape (K, 2), with its outside on the right.

    The texture is continuous along the line; v is measured from the bottom.
    """
    points = np.asarray(line, np.float64)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    low = np.column_stack([along / tile, np.zeros(len(along))])
    high = np.column_stack([along / tile, np.full(len(along), (top - bottom) / tile)])
    return quads(_upright(points, bottom, top), cells([low, high]), material)


def _upright(line: NDArray[np.float64], bottom: float, top: float) -> NDArray[np.float64]:
    """Return the panels of a wall along a line, shape (K - 1, 4, 3)."""
    low, high = (np.column_stack([line, np.full(len(line), z)]) for z in (bottom, top))
    return cells([low, high])
