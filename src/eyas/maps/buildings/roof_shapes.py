"""Sloping roofs over footprints of any shape: gabled, hipped, pyramids, single slopes, domes.

A roof is the lowest of a few planes. Each plane is drawn over the part of the footprint where it is
the lowest; where the footprint's edge lies higher than the eaves, the wall goes up to it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import flat_polygon, quads
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import TEXTURES
from eyas.engine.world.build.millimetres import rounded
from eyas.lanes import exact

SHAPES = ("gabled", "hipped", "pyramidal", "skillion", "dome")

_EAVES = 0.35  # By how much a roof stands out from the walls [m]
_FULL = 0.78  # Share of its tightest rectangle that a footprint must fill to have ridges along it
_STEPS = 5  # Steps of a roof whose ridges follow an irregular outline, and rings of a dome
_TILE = 6.0  # Size of one repeat of the walls below a roof [m]

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class _Plane:
    """A slope: z = `level` + `rise` . (x, y), over the area where it is the lowest."""

    level: float
    rise: Points  # Change of z for each metre east and north, shape (2,)
    cell: shapely.Polygon

    def at(self, points: Points) -> Points:
        """Return z above points, shape (K,) [m]."""
        height: Points = self.level + points[:, 0] * self.rise[0] + points[:, 1] * self.rise[1]
        return height


def fullness(shape: shapely.Polygon) -> float:
    """Return the share of its tightest rectangle that a footprint fills."""
    box = shapely.minimum_rotated_rectangle(shape).area
    return float(shape.area / box) if box > 0 else 0.0


def sloping_roof(
    shape: shapely.Polygon,  # Footprint, with courtyards as holes [m]
    kind: str,  # One of `SHAPES`
    eaves: float,  # z of the eaves [m]
    rise: float,  # Height of the roof [m]
    covers: tuple[Material, Material],  # Materials of the slopes and of the walls below them
    *,
    across: bool = False,  # Whether the ridge runs across the longer side
) -> Mesh:
    """Return a roof with the walls between its eaves and its slopes."""
    tiles, wall = covers
    if kind == "dome":
        return _dome(shape, eaves, rise, tiles)
    if kind != "skillion" and (fullness(shape) < _FULL or shape.interiors):
        return _irregular(shape, eaves, rise, tiles)
    planes = _planes(shape, kind, eaves, rise, across=across)
    over = shapely.buffer(shape, _EAVES, join_style="mitre")
    slopes = [_slope(plane, shapely.intersection(over, plane.cell), tiles) for plane in planes]
    return concatenate([*slopes, _walls_below(shape, planes, eaves, wall)])


def _planes(
    shape: shapely.Polygon, kind: str, eaves: float, rise: float, *, across: bool
) -> list[_Plane]:
    centre, along, half, side = _frame(shape)
    if across:
        along, half, side = np.array([-along[1], along[0]]), side, half
    aside = np.array([-along[1], along[0]])
    origin = float(centre[0]), float(centre[1])

    def cell(*corners: tuple[float, float]) -> shapely.Polygon:
        frame = np.stack([along, aside])
        return shapely.Polygon(rounded(exact.product(np.array(corners), frame) + origin))

    def plane(direction: Points, reach: float, run: float, area: shapely.Polygon) -> _Plane:
        """Return the slope that falls in a direction, to the eaves at a distance [m]."""
        fall = -rise / run * direction
        level = eaves + rise / run * reach - float(fall[0] * origin[0] + fall[1] * origin[1])
        return _Plane(level, fall, area)

    wide, far = half + 2.0, side + 2.0
    if kind == "skillion":
        whole = cell((-wide, -far), (wide, -far), (wide, far), (-wide, far))
        return [plane(aside, side, 2.0 * side, whole)]
    if kind == "gabled":
        return [
            plane(-aside, side, side, cell((-wide, -far), (wide, -far), (wide, 0), (-wide, 0))),
            plane(aside, side, side, cell((-wide, 0), (wide, 0), (wide, far), (-wide, far))),
        ]
    run = half if kind == "pyramidal" else min(side, half)
    ridge = half - run
    # Beyond the corners of the rectangle, hips go on in the same direction.
    x, y = ridge + 1.5 * run, 1.5 * side
    return [
        plane(-aside, side, side, cell((-ridge, 0), (-x, -y), (x, -y), (ridge, 0))),
        plane(aside, side, side, cell((ridge, 0), (x, y), (-x, y), (-ridge, 0))),
        plane(along, half, run, cell((ridge, 0), (x, -y), (x, y))),
        plane(-along, half, run, cell((-ridge, 0), (-x, y), (-x, -y))),
    ]


def _frame(shape: shapely.Polygon) -> tuple[Points, Points, float, float]:
    """Return centre, direction and half sides of the tightest rectangle, the longer side first."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(shape))[:4]
    centre = corners.mean(axis=0)
    sides = np.diff(corners[:3], axis=0)
    lengths = exact.hypot(sides[:, 0], sides[:, 1])
    longer = int(np.round(lengths[1], 3) > np.round(lengths[0], 3))
    along = sides[longer] / lengths[longer]
    return centre, along, float(lengths[longer]) / 2, float(lengths[1 - longer]) / 2


def _slope(plane: _Plane, area: shapely.Geometry, tiles: Material) -> Mesh:
    tile = TEXTURES[tiles.texture]
    mesh = flat_polygon(area, 0.0, tiles, tile)
    flat = mesh.positions[:, :2].astype(np.float64)
    mesh.positions[:, 2] = plane.at(flat)
    steep = float(exact.hypot(*plane.rise))
    up = np.array([-plane.rise[0], -plane.rise[1], 1.0]) / np.sqrt(1.0 + np.square(steep))
    mesh.normals[:] = up
    climb = plane.rise / max(steep, 1e-9)
    level = np.array([climb[1], -climb[0]])
    stretch = np.sqrt(1.0 + np.square(steep))
    mesh.uvs[:] = (
        np.stack([exact.product(flat, level), (exact.product(flat, climb)) * stretch], axis=1)
        / tile
    )
    return mesh


def _walls_below(
    shape: shapely.Polygon, planes: Sequence[_Plane], eaves: float, wall: Material
) -> Mesh:
    """Return the walls from the eaves up to the slopes."""
    seams = shapely.union_all([shapely.boundary(plane.cell) for plane in planes])
    faces: list[Points] = []
    solid = shapely.geometry.polygon.orient(shape)
    for ring in (solid.exterior, *solid.interiors):
        corners = shapely.get_coordinates(ring)
        for start, end in pairwise(corners):
            stops = shapely.get_coordinates(
                shapely.intersection(shapely.LineString([start, end]), seams)
            )
            points = np.concatenate([start[None], stops, end[None]])
            size = max(float(exact.hypot(*(end - start))), 1e-9)
            order = np.argsort(exact.product(points - start, end - start) / size, kind="stable")
            line = points[order]
            top = np.min([plane.at(line) for plane in planes], axis=0)
            faces += [
                _upright(line[k : k + 2], eaves, np.maximum(top[k : k + 2], eaves))
                for k in range(len(line) - 1)
                if max(top[k], top[k + 1]) > eaves + 0.02
            ]
    if not faces:
        return Mesh.none()
    upright = np.array(faces)
    along = exact.hypot(*(upright[:, :, :2] - upright[:, :1, :2]).transpose(2, 0, 1))
    uvs = np.stack([along, upright[:, :, 2] - eaves], axis=2) / _TILE
    return quads(upright, uvs, wall)


def _upright(line: Points, low: float, high: Points) -> Points:
    (ax, ay), (bx, by) = line
    return np.array([(ax, ay, low), (bx, by, low), (bx, by, high[1]), (ax, ay, high[0])])


def _irregular(shape: shapely.Polygon, eaves: float, rise: float, tiles: Material) -> Mesh:
    """Return a roof that slopes inwards from all sides, in steps of its outline."""
    reach = 0.97 * float(shapely.length(shapely.maximum_inscribed_circle(shape, tolerance=0.2)))
    over = shapely.buffer(shape, _EAVES, join_style="mitre")
    steep = rise / max(reach, 0.5)
    made: list[Mesh] = []
    outer, depth = over, -_EAVES
    for step in range(1, _STEPS + 1):
        further = reach * step / _STEPS
        inner = shapely.buffer(shape, -further, join_style="mitre")
        mesh = flat_polygon(shapely.difference(outer, inner), 0.0, tiles, TEXTURES[tiles.texture])
        flat = mesh.positions[:, :2].astype(np.float64)
        inside = shapely.distance(shapely.boundary(outer), shapely.points(flat)) > 1e-3
        mesh.positions[:, 2] = eaves + steep * np.where(inside, further, depth)
        made.append(_shaded(mesh))
        outer, depth = inner, further
    top = flat_polygon(outer, eaves + steep * depth, tiles, TEXTURES[tiles.texture])
    return concatenate([*made, top])


def _shaded(mesh: Mesh) -> Mesh:
    """Return a mesh whose triangles have their own corners and normals."""
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normals, axis=1, keepdims=True)
    kept = size[:, 0] > 1e-9
    normals = (normals[kept] / size[kept]).repeat(3, axis=0)
    return Mesh(
        positions=corners[kept].reshape(-1, 3).astype(np.float32),
        normals=normals.astype(np.float32),
        uvs=mesh.uvs[mesh.triangles[kept]].reshape(-1, 2),
        triangles=np.arange(3 * int(kept.sum()), dtype=np.int32).reshape(-1, 3),
        materials=mesh.materials[kept],
        palette=mesh.palette,
    )


def _dome(shape: shapely.Polygon, eaves: float, rise: float, cover: Material) -> Mesh:
    outline = shapely.get_coordinates(shapely.geometry.polygon.orient(shape).exterior)
    centre = shapely.get_coordinates(shape.centroid)[0]
    angle = np.linspace(0.0, np.pi / 2, _STEPS + 1)
    rings = [
        np.column_stack(
            [
                centre + max(exact.cos(a), 0.0) * (outline - centre),
                np.full(len(outline), eaves + rise * exact.sin(a)),
            ]
        )
        for a in angle
    ]
    grid = np.array(rings)
    panels = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2)
    flat = panels.reshape(-1, 4, 3)
    return _shaded(quads(flat, flat[..., :2] / TEXTURES[cover.texture], cover))
