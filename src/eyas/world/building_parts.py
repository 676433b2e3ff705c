"""Walls, ledges and roofs of buildings. Outlines are counter-clockwise, lengths in metres."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.state.mesh import Material, Mesh, concatenate, transformed
from eyas.world.materials import material
from eyas.world.shapes import box, cylinder, flat_polygon, quads, walls

__all__ = ["flat_roof", "ledge", "pyramid_rise", "pyramid_roof", "rooftop", "window_wall"]

Outline = NDArray[np.float64]

_TILE = 12.0
"""Metres one repeat of a facade covers: four bays, four storeys."""


def window_wall(
    outline: Outline, bottom: float, top: float, wall: Material, rng: np.random.Generator
) -> Mesh:
    """Return walls whose windows meet corners and storeys in whole bays.

    Each wall starts at a bay and a storey of its own, so that blinds differ from wall to wall;
    walls too short for a window show the pier between two.
    """
    mesh = walls(outline, bottom, top, wall, _TILE)
    length = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1)
    uv = mesh.uvs.reshape(-1, 4, 2)
    short = length < 1.8
    uv[short, 1:3, 0] = 0.012
    uv[short, 0, 0] = uv[short, 3, 0] = -0.012
    uv += rng.integers(0, 4, (len(outline), 1, 2)).astype(np.float32) / 4
    return mesh


def ledge(outline: Outline, z: float, stone: Material) -> Mesh:
    """Return a thin band around a building that stands out from its wall."""
    shape = shapely.Polygon(outline)
    out = _ring(shapely.buffer(shape, 0.22, join_style="mitre"))
    band = walls(out, z - 0.18, z + 0.12, stone, 6.0)
    return concatenate([band, flat_polygon(shapely.Polygon(out) - shape, z + 0.12, stone, 6.0)])


def flat_roof(
    outline: Outline, top: float, parapet: float, stone: Material, cover: Material
) -> Mesh:
    """Return a roof with a parapet around it."""
    shape = shapely.Polygon(outline)
    inside = shapely.buffer(shape, -0.35, join_style="mitre")
    pieces = [walls(outline, top, top + parapet, stone, 6.0)]
    pieces.append(flat_polygon(shape - inside, top + parapet, stone, 6.0))
    pieces += [
        walls(_ring(part)[::-1], top, top + parapet, stone, 6.0)
        for part in shapely.get_parts(inside)
    ]
    pieces.append(flat_polygon(inside, top, cover, 4.0 if "roof" in cover.texture else 8.0))
    return concatenate(pieces)


def pyramid_rise(outline: Outline) -> float:
    """Return how high a pyramid roof rises above its eaves [m]."""
    return float(np.clip(0.3 * _short_side(outline), 2.5, 7.0))


def pyramid_roof(outline: Outline, top: float, stone: Material, tiles: Material) -> Mesh:
    """Return a tiled roof with eaves, rising to a point, or to a ridge over a long rectangle."""
    shape = shapely.Polygon(outline)
    eaves = _ring(shapely.buffer(shape, 0.6, join_style="mitre"))
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
    u = np.einsum("qki,qi->qk", offset[:, :, :2], along)
    up = np.linalg.norm(
        offset - np.concatenate([u[..., None] * along[:, None], 0 * u[..., None]], axis=2), axis=2
    )
    slopes = quads(corners, np.stack([u, up], axis=2) / 4.0, tiles)
    slopes.triangles = slopes.triangles[_areas(slopes) > 1e-6]
    slopes.materials = slopes.materials[: len(slopes.triangles)]
    soffit = flat_polygon(shapely.Polygon(eaves) - shape, top, stone, 6.0)
    soffit.triangles = np.ascontiguousarray(soffit.triangles[:, ::-1])
    soffit.normals = -soffit.normals
    return concatenate([slopes, soffit])


def _areas(mesh: Mesh) -> NDArray[np.float64]:
    """Return the areas of triangles; those of a slope that ends in a point include empty ones."""
    corners = np.asarray(mesh.positions[mesh.triangles], np.float64)
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.linalg.norm(face, axis=1) / 2, np.float64)


def rooftop(outline: Outline, top: float, stone: Material, rng: np.random.Generator) -> Mesh:
    """Return what stands on a flat roof: stair heads, plant rooms, fans, pipes, tanks."""
    shape = shapely.Polygon(outline)
    free = shapely.buffer(shape, -2.2, join_style="mitre")
    axis = outline[1] - outline[0]
    turn = float(np.arctan2(axis[1], axis[0]))
    count = int(np.clip(shape.area / 140, 0, 14))
    metal = material("concrete", (0.82, 0.86, 0.9))
    pieces: list[Mesh] = []
    for k in range(count):
        size = rng.uniform((1.2, 1.2, 0.8), (3.4, 2.6, 1.7))
        if k == 0:
            size = rng.uniform((4.0, 3.0, 2.6), (8.0, 5.5, 3.4))
        spot = _spot(free, float(np.hypot(size[0], size[1]) / 2), rng)
        if spot is None:
            continue
        free = free - shapely.Point(spot).buffer(float(np.hypot(size[0], size[1]) / 2) + 0.8)
        if k > 1 and rng.random() < 0.3:
            tank = cylinder((0.9, 0.9), (0.0, 1.6), 10, metal, cap=True, tile=6.0)
            pieces.append(_set_down(tank, 0.0, spot, top))
        else:
            block = box(size.tolist(), (0, 0, size[2] / 2), stone if k == 0 else metal, 6.0)
            pieces.append(_set_down(block, turn, spot, top))
    return concatenate(pieces)


def _set_down(mesh: Mesh, turn: float, spot: Outline, top: float) -> Mesh:
    c, s = np.cos(turn), np.sin(turn)
    return transformed(mesh, np.array([[c, -s, 0, spot[0]], [s, c, 0, spot[1]], [0, 0, 1, top]]))


def _spot(free: shapely.Geometry, radius: float, rng: np.random.Generator) -> Outline | None:
    """Return a point at least `radius` within a shape, or None if a few tries find none."""
    room = shapely.buffer(free, -radius)
    if room.is_empty:
        return None
    west, south, east, north = room.bounds
    for _ in range(12):
        point = rng.uniform((west, south), (east, north))
        if room.contains(shapely.Point(point)):
            return np.asarray(point, np.float64)
    return None


def _ridge(outline: Outline, centre: Outline) -> Outline:
    """Return the end points of the ridge, one point for anything that is no long rectangle."""
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


def _ring(shape: shapely.Polygon) -> Outline:
    ring = shapely.get_coordinates(shapely.geometry.polygon.orient(shape).exterior)[:-1]
    return np.ascontiguousarray(ring, np.float64)
