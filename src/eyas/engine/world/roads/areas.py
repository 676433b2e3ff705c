"""Plan shapes of a road network: asphalt, streets with their lines, blocks between them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate, of_one_material
from eyas.engine.mesh.flat import flat_polygons, wall_along
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import dot, rounded, snapped
from eyas.engine.world.roads.curves import rounded_kerbs
from eyas.lanes import exact

GRID = 32.0
"""Side of the squares into which large surfaces are cut, so that unseen ones are skipped [m]."""

_FEW, _AT_ONCE = 400, 8.0
"""Shapes with more corners than this are first cut into squares larger by this factor."""

_AT_CORNER = 5.0  # Distance of buildings from the centre of the asphalt of a round corner [m]

Line = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Street:
    """One direction of a road between two junctions. Lines run with the traffic, shape (K, 2).

    Left and right are as where traffic keeps right; where it keeps left, everything is mirrored.
    """

    start: str  # Node it leaves
    end: str  # Node it reaches
    left: Line  # Middle of the road, where the other direction begins [m]
    dividers: tuple[Line, ...]  # Between its lanes, the rightmost first [m]
    right: Line  # Kerb [m]
    side: float = 1.0  # -1 where traffic keeps left, so that the kerb is on its left

    def inwards(self, onwards: Line) -> Line:
        """Return the direction from the kerb to the middle of the road, of one along it."""
        return self.side * np.array([-onwards[1], onwards[0]])

    @property
    def lines(self) -> tuple[Line, ...]:
        """Lines of the road from left to right."""
        return (self.left, *self.dividers[::-1], self.right)


def streets(network: RoadNetwork) -> list[Street]:
    """Return all directions of all roads, in the order of `network.edges`."""
    count = len(network.lane_width)
    lines = shapely.linestrings(
        network.lane_points, indices=np.repeat(np.arange(count), np.diff(network.lane_first))
    )
    side = -1.0 if network.left_hand else 1.0
    half = side * network.lane_width / 2
    left, right = _beside(lines, half), _beside(lines, -half)
    made = []
    for edge in range(len(network.edges)):
        lanes = np.flatnonzero(network.lane_edge == edge)
        lanes = lanes[np.argsort(network.lane_index[lanes], kind="stable")]
        made.append(
            Street(
                start=network.edge_start[edge],
                end=network.edge_end[edge],
                left=left[lanes[-1]],
                dividers=tuple(left[lane] for lane in lanes[:-1]),
                right=right[lanes[0]],
                side=side,
            )
        )
    return made


def joints(network: RoadNetwork) -> dict[str, int]:
    """Return for each node how many roads meet there: 2 for a bend, 3 for a T junction."""
    neighbours: dict[str, set[str]] = {name: set() for name in network.junctions}
    for start, end in zip(network.edge_start, network.edge_end, strict=True):
        neighbours[start].add(end)
        neighbours[end].add(start)
    return {name: len(others) for name, others in neighbours.items()}


def road_area(network: RoadNetwork) -> shapely.MultiPolygon:
    """Return the asphalt for cars: all lanes and junctions, with room to turn at corners."""
    rounded = rounded_kerbs(corridors(network), _bends(network))
    return shapely.MultiPolygon(polygons_of(snapped(shapely.simplify(rounded, 0.035))))


def corridors(network: RoadNetwork) -> shapely.MultiPolygon:
    """Return all lanes and junctions with sharp corners; lots are laid out around them."""
    shapes: list[shapely.Geometry] = [
        shapely.buffer(
            shapely.LineString(_lane(network, lane)),
            network.lane_width[lane] / 2,
            cap_style="flat",
            join_style="mitre",
        )
        for lane in range(len(network.lane_width))
    ]
    first = network.junction_first
    for low, high in pairwise(first):
        if high - low >= 3:
            shapes.append(shapely.make_valid(shapely.Polygon(network.junction_points[low:high])))
    # Closes gaps of millimetres between lanes and junctions; corners stay where they are.
    closed = shapely.buffer(shapely.union_all(shapes), 0.05, join_style="mitre")
    opened = shapely.buffer(closed, -0.05, join_style="mitre")
    return shapely.MultiPolygon(polygons_of(snapped(shapely.simplify(opened, 0.01))))


def corners(roads: shapely.Geometry, sharp: shapely.Geometry) -> list[shapely.Polygon]:
    """Return the surroundings of the asphalt's round corners, which lots do not take into account.

    Args:
        roads: From `road_area` [m].
        sharp: From `corridors` [m].
    """
    # Both are rounded to millimetres; the 2 cm remove slivers, which would join two corners.
    added = polygons_of(shapely.difference(roads, shapely.buffer(sharp, 0.02, join_style="mitre")))
    return [shapely.buffer(part.centroid, _AT_CORNER) for part in added if part.area > 2.0]


def blocks(
    roads: shapely.Geometry,  # Asphalt [m]
    extent: shapely.Polygon,  # The whole floor [m]
) -> tuple[list[shapely.Polygon], list[shapely.Polygon]]:
    """Return the ground between roads.

    Returns:
        Blocks with roads all round, and the ground outside the outer roads.
    """
    left_over = polygons_of(shapely.difference(extent, roads))
    closed = [part for part in left_over if not part.exterior.intersects(extent.exterior)]
    return closed, [part for part in left_over if part.exterior.intersects(extent.exterior)]


def split_on_grid(
    shape: shapely.Geometry,  # Polygons [m]
    cell: float = GRID,  # Distance between the lines [m]
) -> list[shapely.Polygon]:
    """Return a shape cut along the lines of a square grid through the origin."""
    if shapely.get_num_coordinates(shape) < _FEW:
        return _split(shape, cell)
    # First into large squares: cutting small ones out of everything at once takes far longer.
    return [piece for large in _split(shape, _AT_ONCE * cell) for piece in _split(large, cell)]


def _split(shape: shapely.Geometry, cell: float) -> list[shapely.Polygon]:
    if shape.is_empty:
        return []
    shapely.prepare(shape)
    west, south, east, north = np.array(shape.bounds) / cell
    columns = np.arange(np.floor(west), np.ceil(east)) * cell
    rows = np.arange(np.floor(south), np.ceil(north)) * cell
    x, y = (axis.ravel() for axis in np.meshgrid(columns, rows, indexing="ij"))
    squares = shapely.box(x, y, x + cell, y + cell)
    squares = squares[shapely.intersects(shape, squares)]
    cut = ~shapely.contains_properly(shape, squares)
    try:
        squares[cut] = shapely.intersection(shape, squares[cut])
    except shapely.GEOSException:  # outlines of real places may touch themselves once rounded
        squares[cut] = shapely.intersection(shapely.make_valid(shape), squares[cut])
    return polygons_of(squares)


def surface(
    shape: shapely.Geometry, z: float, material: Material, tile: float, turn: float = 0.0
) -> Mesh:
    """Return a large horizontal surface, cut along the grid.

    Args:
        shape: Polygons [m].
        z: Height [m].
        material: Material of the whole surface.
        tile: Size of one repeat of the texture [m].
        turn: Angle of the texture, counter-clockwise [rad].
    """
    return flat_polygons(split_on_grid(shape), z, material, tile, turn)


def kerbstones(
    shape: shapely.Geometry,  # Polygons beside the road [m]
    z: float,  # Height [m]
    road: shapely.Geometry,  # Asphalt [m]
    material: Material,  # Material of the stones, whose rows run along the edge
    tile: float,  # Size of one repeat of the texture [m]
) -> Mesh:
    """Return the tops of kerbs: their stones follow the edge of the road, joints across it."""
    flat = surface(shape, z, material, tile)
    corners = flat.positions[flat.triangles].astype(np.float64)
    if len(corners) == 0:
        return flat
    edges = shapely.get_parts(shapely.get_parts(shapely.boundary(road)))
    middles = shapely.points(rounded(corners[..., :2].mean(axis=1)))
    (_, nearest) = shapely.STRtree(edges).query_nearest(middles, all_matches=False)
    edge, points = edges[nearest][:, None], shapely.points(corners[..., :2])
    along = rounded(shapely.line_locate_point(edge, points))
    # Of a triangle over the point where a ring begins, all corners lie beyond it.
    around = rounded(shapely.length(edge))
    far = along.max(axis=1, keepdims=True) - along > 0.5 * around
    along = np.where(far, along + around, along)
    away = rounded(shapely.distance(edge, points))
    uvs = np.stack([along, away], axis=-1).reshape(-1, 2) / tile
    triangles = np.arange(3 * len(corners)).reshape(-1, 3)
    up = np.tile([0.0, 0.0, 1.0], (3 * len(corners), 1))
    return of_one_material(corners.reshape(-1, 3), up, uvs, triangles, material)


def skirt(
    shape: shapely.Geometry, bottom: float, top: float, material: Material, tile: float
) -> Mesh:
    """Return the vertical sides of a slab, round its outlines and its holes."""
    pieces = []
    for part in polygons_of(shape):
        solid = shapely.geometry.polygon.orient(part)
        for ring in (solid.exterior, *solid.interiors):
            outline = shapely.get_coordinates(
                shapely.segmentize(shapely.simplify(ring, 1e-3), GRID)
            )
            pieces.append(wall_along(outline, bottom, top, material, tile))
    return concatenate(pieces)


def polygons_of(shape: shapely.Geometry | Sequence[shapely.Geometry]) -> list[shapely.Polygon]:
    """Return the polygons within any shape, without slivers below a square centimetre."""
    parts = shapely.get_parts(shapely.get_parts(shape))
    polygons = shapely.get_type_id(parts) == shapely.GeometryType.POLYGON
    return list(parts[polygons & (shapely.area(parts) > 1e-4)])


def _bends(network: RoadNetwork) -> list[tuple[Line, float]]:
    """Return the middle [m] and the angle [rad] of each bend, where two roads meet."""
    arriving: dict[str, list[Line]] = {}
    for lane in np.flatnonzero(network.lane_index == 0):
        end = network.edge_end[network.lane_edge[lane]]
        arriving.setdefault(end, []).append(_lane(network, int(lane))[-2:])
    bends, meeting = [], joints(network)
    for node, (one, *others) in arriving.items():
        # Where a one-way road leaves another, two roads arrive, but three meet.
        if len(others) == 1 and meeting[node] == 2:
            onwards, back = np.diff(one, axis=0)[0], np.diff(others[0], axis=0)[0]
            sine = onwards[0] * back[1] - onwards[1] * back[0]
            angle = np.pi - abs(exact.atan2(sine, dot(onwards, back)))
            bends.append(((one[1] + others[0][1]) / 2, float(angle)))
    return bends


def _lane(network: RoadNetwork, lane: int) -> Line:
    return network.lane_points[network.lane_first[lane] : network.lane_first[lane + 1]]


def _beside(lines: NDArray[np.object_], distance: Line) -> list[Line]:
    """Return a line that runs beside each of some, on its left for a positive distance [m]."""
    moved = shapely.offset_curve(lines, distance, join_style="mitre")
    points, owner = shapely.get_coordinates(moved, return_index=True)
    return np.split(points, np.searchsorted(owner, np.arange(1, len(lines))))
