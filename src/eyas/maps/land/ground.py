"""Level ground: lawn, asphalt, pavements, wide plains, and ground that changes along an edge.

Each is cut out of the others, so nothing overlaps.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.flat import flat_polygons
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import TEXTURES, material
from eyas.engine.world.build.millimetres import rounded, snapped
from eyas.engine.world.roads.areas import polygons_of, split_on_grid
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.plan.plan import Flat

PAVEMENT_WIDTH = 2.6  # Distance from the kerb to the lawn [m]

_VERGE = 1.5  # Width of the pavement along the outer side of the outer streets [m]

_YARDS = (
    material("paving", (0.92, 0.92, 0.93)),
    material("concrete", (0.95, 0.94, 0.92)),
    material("clinker", (1.0, 0.98, 0.96)),
)
_GRASS = ((0.96, 0.97, 0.90), (0.97, 0.93, 0.80), (0.92, 0.96, 0.91), (0.84, 0.91, 0.83))
"""Tints of slightly drier, dry, slightly lusher and lush grass."""
_PATCHES = 34  # Number of dry or lush patches on the floor
_PATCH = (12.0, 48.0)  # Mean radius of a patch [m]
_FADE = 0.7  # Size of the inner part of a patch, whose tint is stronger, as a share of the patch


def pavement_area(
    blocks: Sequence[shapely.Polygon],  # Ground between kerbs [m]
    cut: shapely.Geometry,  # Driveways and other areas that interrupt pavements
) -> shapely.Geometry:
    """Return the pavements along the inner side of the kerbs of blocks."""
    rings = [
        shapely.difference(block, shapely.buffer(block, -PAVEMENT_WIDTH, join_style="mitre"))
        for block in blocks
    ]
    return shapely.difference(shapely.union_all(rings), cut)


def verge_area(
    outside: Sequence[shapely.Polygon],  # Ground outside the outer streets [m]
    paved: shapely.Geometry,  # Asphalt [m]
) -> shapely.Geometry:
    """Return the narrow pavements between outer streets and open land."""
    beside = shapely.buffer(paved, _VERGE, quad_segs=4)
    return shapely.difference(shapely.intersection(shapely.union_all(outside), beside), paved)


def asphalt(area: shapely.Geometry, *, light: bool = False) -> Flat:
    """Return a road surface at z = 0 with its sides down to the floor."""
    cover = material("asphalt_light" if light else "asphalt")
    return Flat(area=area, z=0.0, cover=cover, sides=material("concrete"))


def yards(
    areas: Sequence[shapely.Geometry],  # Paving of each building [m]
    turn: float,  # Direction of the streets [rad]
    rng: np.random.Generator,
) -> list[Flat]:
    """Return the paving around buildings, level with the lawn."""
    kinds = rng.choice(len(_YARDS), len(areas)).tolist()
    return [
        Flat(area=area, cover=_YARDS[kind], turn=turn, cells="whole")
        for area, kind in zip(areas, kinds, strict=True)
    ]


def lawn(
    extent: shapely.Polygon,  # The floor [m]
    covered: shapely.Geometry,  # Area that is not lawn [m]
    rng: np.random.Generator,
    mown: shapely.Geometry,  # Area mown in swaths [m]
    turn: float,  # Direction of the swaths [rad]
) -> list[Flat]:
    """Return the floor where nothing else covers it, with dry and lush patches."""
    rest = only_areas(shapely.difference(extent, covered))
    parts = []
    # Where patches overlap, the stronger tint wins over the edge of a patch.
    for tint, patch in list(zip(_GRASS, _grass_patches(extent, rng), strict=True))[::-1]:
        # Where outlines touch, overlays have lines, too, which the next overlay may not take.
        parts.append((tint, only_areas(shapely.intersection(rest, patch))))
        rest = only_areas(shapely.difference(rest, patch))
    made = []
    for tint, part in [((1.0, 1.0, 1.0), rest), *parts]:
        inside, outside = shapely.intersection(part, mown), shapely.difference(part, mown)
        made.append(Flat(area=inside, cover=material("lawn_mown", tint), turn=turn))
        made.append(Flat(area=outside, cover=material("lawn", tint)))
    return made


def only_areas(shape: shapely.Geometry) -> shapely.Geometry:
    """Return a shape without the lines and points that an overlay has left in it."""
    if shape.geom_type != "GeometryCollection":
        return shape
    return shapely.MultiPolygon(polygons_of(shape))


def _grass_patches(extent: shapely.Polygon, rng: np.random.Generator) -> list[shapely.Geometry]:
    """Return where each of the tints may be: edges of patches and what is inside of them [m]."""
    west, south, east, north = extent.bounds
    angle = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    ring = np.stack([1.5 * exact.cos(angle), 0.8 * exact.sin(angle)], axis=1)
    inner: list[list[shapely.Polygon]] = [[], []]
    outer: list[list[shapely.Polygon]] = [[], []]
    for index in range(_PATCHES):
        middle = rng.uniform([west, south], [east, north])
        phase, size = rng.uniform(0, 2 * np.pi, (3, 1)), rng.uniform(0.06, 0.18, (3, 1))
        waves = (size * exact.sin(angle * [[1], [2], [3]] + phase)).sum(axis=0)
        outline = rng.uniform(*_PATCH) * (1 + waves)[:, None] * ring
        outer[index % 2].append(shapely.Polygon(rounded(middle + outline)))
        inner[index % 2].append(shapely.Polygon(rounded(middle + _FADE * outline)))
    dry, lush = map(shapely.union_all, inner)
    dry_edge, lush_edge = map(shapely.union_all, outer)
    return [dry_edge, dry, lush_edge, lush]


_NEAR_CELL, _WIDE_CELL = 128.0, 1280.0  # Sides of the squares near roads and elsewhere [m]
_FAR, _FAR_CELL = 28_000.0, 1750.0
"""Extent of the ground beyond the floor, and the side of its squares [m]."""
_BELOW = 0.05
"""Depth of that ground below the floor, so that rounding never makes it show through [m]."""
_CORNERS = 24


def plain(
    area: shapely.Geometry,  # The ground [m]
    # Where it is cut into small squares, so that those out of sight are skipped [m]
    near: shapely.Geometry,
    cover: Material,
    z: float = FLOOR_HEIGHT,  # Its height [m]
) -> Mesh:
    """Return level ground."""
    pieces = []
    # First into large squares: cutting small ones out of everything at once takes far longer.
    for piece in split_on_grid(area, _WIDE_CELL):
        pieces += split_on_grid(shapely.intersection(piece, near), _NEAR_CELL)
        pieces += polygons_of(shapely.difference(piece, near))
    return flat_polygons(pieces, z, cover, TEXTURES[cover.texture])


def far_plain(
    floor: tuple[float, float],  # Extent of the floor [m]
    cover: Material,
) -> Mesh:
    """Return the ground beyond a floor, up to the horizon."""
    ring = shapely.difference(rectangle(_FAR, _FAR), rectangle(*floor))
    pieces = split_on_grid(ring, _FAR_CELL)
    return flat_polygons(pieces, FLOOR_HEIGHT - _BELOW, cover, TEXTURES[cover.texture])


def blob(
    middle: NDArray[np.float64],  # Its middle, shape (2,) [m]
    radius: float,  # Its mean radius [m]
    rng: np.random.Generator,
) -> shapely.Polygon:
    """Return a round shape with an uneven outline, such as a lake."""
    angle = np.linspace(0.0, 2 * np.pi, _CORNERS, endpoint=False)
    phase, swing = rng.uniform(0, 2 * np.pi, (3, 1)), rng.uniform(0.05, 0.16, (3, 1))
    waves = 1.0 + (swing * exact.sin(angle * [[1], [2], [3]] + phase)).sum(axis=0)
    ring = np.stack([exact.cos(angle), exact.sin(angle)], axis=1)
    return shapely.Polygon(rounded(middle + radius * waves[:, None] * ring))


def rectangle(width: float, height: float) -> shapely.Polygon:
    """Return a rectangle about the origin [m]."""
    return shapely.box(-width / 2, -height / 2, width / 2, height / 2)


_CELL = 64.0  # Side of the squares into which it is cut [m]
_RINGS = (0.0, 1.2, 3.0, 6.0, 10.0)
_INSETS = (0.0, 0.35)
"""Distances where it is cut too, so that u is right between them [m]: from what it lies beside,
and from its own edge."""


def edged(
    area: shapely.Geometry,  # The ground [m]
    # From what the distance is measured; None: from the edge of the area inwards
    beside: shapely.Geometry | None,
    cover: Material,
    z: float,  # Its height [m]
) -> Mesh:
    """Return level ground of a material whose u is a distance."""
    if beside is None:
        edge, rings = shapely.boundary(area), [shapely.buffer(area, -inset) for inset in _INSETS]
        rings = [*rings, shapely.Polygon()]
    else:
        edge = beside
        rings = [
            shapely.difference(area, shapely.buffer(beside, away)) if away else area
            for away in _RINGS
        ]
    pieces = []
    for outer, inner in pairwise(rings):
        for piece in split_on_grid(snapped(shapely.difference(outer, inner)), _CELL):
            pieces += polygons_of(piece)
    mesh = flat_polygons(pieces, z, cover, 1.0)
    shapely.prepare(edge)
    away = shapely.distance(shapely.points(mesh.positions[:, :2].astype(np.float64)), edge)
    mesh.uvs[:, 0], mesh.uvs[:, 1] = np.round(away, 3), 0.0
    return mesh
