"""Walls, ledges and roofs of buildings. Outlines are counter-clockwise, lengths in metres."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import flat_polygon, quads, walls
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import TEXTURES
from eyas.lanes import exact

PARAPET = 0.9  # Height of the wall around a flat roof [m]

_PROUD = 0.015
"""How far it stands out from the walls, so that it does not share their planes where a taller part
of the building rises from its edge [m]."""

Outline = NDArray[np.float64]

_TILE = 12.0  # Size of one repeat of a facade, four bays and four storeys [m]


def window_wall(
    outline: Outline,  # Corners [m]
    bottom: float,  # z of the foot [m]
    top: float,  # z of the upper edge [m]
    wall: Material,  # Material with windows
    # Bay and storey of the texture at which each wall starts, so that blinds differ from wall to
    # wall, shape (K, 2)
    starts: NDArray[np.integer],
    stretch: float = 1.0,  # Factor on the height of storeys
) -> Mesh:
    """Return walls whose windows meet corners and storeys in whole bays.

    Walls too short for a window show only the pier between two windows.
    """
    mesh = walls(outline, bottom, top, wall, _TILE)
    length = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1)
    uv = mesh.uvs.reshape(-1, 4, 2)
    short = length < 1.8
    uv[short, 1:3, 0] = 0.012
    uv[short, 0, 0] = uv[short, 3, 0] = -0.012
    if stretch != 1.0:
        uv[..., 1] /= stretch
    uv += np.reshape(starts, (-1, 1, 2)).astype(np.float32) / 4
    return mesh


def ledge(outline: Outline, z: float, stone: Material) -> Mesh:
    """Return a thin band around a building that stands out from its wall."""
    shape = shapely.Polygon(outline)
    out = _outer(shapely.buffer(shape, 0.22, join_style="mitre"))
    band = walls(out, z - 0.18, z + 0.12, stone, 6.0)
    return concatenate([band, flat_polygon(shapely.Polygon(out) - shape, z + 0.12, stone, 6.0)])


def flat_roof(shape: shapely.Polygon, top: float, stone: Material, cover: Material) -> Mesh:
    """Return a roof with a parapet around it, and around its courtyards."""
    inside = shapely.buffer(shape, -0.35, join_style="mitre")
    outside = shapely.buffer(shape, _PROUD, join_style="mitre")
    edge = top + PARAPET
    pieces = [
        walls(ring, top - 0.02, edge, stone, 6.0)
        for part in shapely.get_parts(outside)
        for ring in rings(part)
    ]
    pieces.append(flat_polygon(outside - inside, edge, stone, 6.0))
    pieces += [
        walls(ring[::-1], top, edge, stone, 6.0)
        for part in shapely.get_parts(inside)
        for ring in rings(part)
    ]
    pieces.append(flat_polygon(inside, top, cover, TEXTURES[cover.texture]))
    return concatenate(pieces)


def rings(shape: shapely.Polygon) -> list[Outline]:
    """Return the outlines of a shape, each with the inside of the shape on its left [m]."""
    solid = shapely.geometry.polygon.orient(shape)
    return [
        np.ascontiguousarray(shapely.get_coordinates(ring)[:-1], np.float64)
        for ring in (solid.exterior, *solid.interiors)
    ]


def underside(shape: shapely.Polygon, z: float, stone: Material) -> Mesh:
    """Return a shape that is seen from below."""
    mesh = flat_polygon(shape, z, stone, 6.0)
    mesh.triangles = np.ascontiguousarray(mesh.triangles[:, ::-1])
    mesh.normals = -mesh.normals
    return mesh


def pyramid_rise(outline: Outline) -> float:
    """Return the height of a pyramid roof above its eaves [m]."""
    return float(np.clip(0.3 * _short_side(outline), 2.5, 7.0))


def pyramid_roof(outline: Outline, top: float, stone: Material, tiles: Material) -> Mesh:
    """Return a tiled roof with eaves, rising to a point, or to a ridge over a long rectangle."""
    shape = shapely.Polygon(outline)
    eaves = _outer(shapely.buffer(shape, 0.6, join_style="mitre"))
    peak = top + pyramid_rise(outline)
    centre = shapely.get_coordinates(shape.centroid)[0]
    start, end = eaves, np.roll(eaves, -1, axis=0)
    ridge = _ridge(outline, centre)
    near = [ridge[np.argmin(np.linalg.norm(ridge - p, axis=1))] for p in start]
    apex = np.column_stack([np.array(near), np.full(len(eaves), peak)])
    apex_end = np.roll(apex, -1, axis=0)
    low = np.full((len(eaves), 1), top)
    corners = np.stack([np.hstack([start, low]), np.hstack([end, low]), apex_end, apex], axis=1)
    along = (end - start) / np.linalg.norm(end - start, axis=1, keepdims=True)
    offset = corners - corners[:, :1]
    u = exact.dot(offset[:, :, :2], along[:, None])
    up = np.linalg.norm(
        offset - np.concatenate([u[..., None] * along[:, None], 0 * u[..., None]], axis=2), axis=2
    )
    slopes = quads(corners, np.stack([u, up], axis=2) / 4.0, tiles)
    slopes.triangles = slopes.triangles[_areas(slopes) > 1e-6]
    slopes.materials = slopes.materials[: len(slopes.triangles)]
    return concatenate([slopes, underside(shapely.Polygon(eaves) - shape, top, stone)])


def _areas(mesh: Mesh) -> NDArray[np.float64]:
    """Return the areas of triangles; some triangles of a slope that ends in a point are empty."""
    corners = np.asarray(mesh.positions[mesh.triangles], np.float64)
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.linalg.norm(face, axis=1) / 2, np.float64)


def _ridge(outline: Outline, centre: Outline) -> Outline:
    """Return the ends of the ridge: one point unless the outline is a long rectangle."""
    if len(outline) != 4:
        return centre[None]
    sides = np.roll(outline, -1, axis=0) - outline
    lengths = np.linalg.norm(sides, axis=1)
    half = max(float(lengths.max() - lengths.min()) / 2, 0.0)
    if half < 0.15 * lengths.max():
        return centre[None]
    along = sides[int(np.argmax(lengths))] / lengths.max()
    return np.array([centre - half * along, centre + half * along])


def _short_side(outline: Outline) -> float:
    ring = shapely.get_coordinates(shapely.minimum_rotated_rectangle(shapely.Polygon(outline)))
    return float(np.linalg.norm(np.diff(ring, axis=0)[:2], axis=1).min())


def _outer(shape: shapely.Polygon) -> Outline:
    return rings(shape)[0]
