"""A town of which only some is known: which ground is what, and which buildings stand on it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import snapped
from eyas.engine.world.roads.areas import polygons_of
from eyas.engine.world.roads.curves import TURN
from eyas.lanes import exact
from eyas.maps.osm.features import AREA_KINDS, House, Survey
from eyas.maps.towns.buildings import is_small
from eyas.maps.towns.crossings import Crosswalk, crosswalks_of, kept_free
from eyas.maps.towns.kerbs import Kerbside, kerbside

_CLEARANCE = 4.6  # What begins higher than this may stand over a street [m]

_FROM_ROAD = 0.35  # Distance from the asphalt to walls [m]
_LEFT = 0.35
"""Share of a footprint that must be left beside the streets; otherwise the building is left out."""
_APRON = 0.8  # Width of the paving at the foot of houses [m]
_YARD, _INSET = 9.0, 6.0
"""Gaps between buildings of a town up to twice the first are paved, except beside lawns [m]."""
_STRIP = 3.5  # Strips between streets and buildings up to twice this wide are paved [m]
_BUILT_ON = ("industrial", "commercial", "residential")
"""Kinds of ground that yards are cut out of; the last of `AREA_KINDS`."""
_REACH = 6.0  # From junctions and bends to where the rounding of their corners begins, at most [m]
_CORNER_WALK = 2.0  # Width of the pavement round a corner [m]
_SHARP = 0.5  # Angle of a sharp bend of a street, at least [rad]
_BEND = 7.0  # Radius of the surroundings of a bend [m]
_SLIVER = 0.3  # Smaller additions are left out [m^2]
_TREE, _LAMP = 0.8, 0.4  # Distance from parking bays to trunks and lamps [m]
_NEEDLE = 0.02  # Slivers narrower than twice this do not count as asphalt [m]


@dataclass(frozen=True, slots=True)
class Occupied:
    """What layers of a plan have already put somewhere."""

    built: shapely.Geometry  # Footprints of the buildings [m]
    covered: shapely.Geometry  # Ground that has its cover [m]


@dataclass(frozen=True, slots=True)
class Town:
    """Positions in plan view."""

    extent: shapely.Polygon  # The floor [m]
    roads: shapely.Geometry  # Asphalt of the streets [m]
    pavement: shapely.Geometry  # Raised pavements beside the streets [m]
    crosswalks: list[Crosswalk]  # Crossings of the streets
    ground: dict[str, shapely.Geometry]
    """Ground of each of `AREA_KINDS`, cut out of each other and of the streets [m]."""
    yards: shapely.Geometry  # Paved ground between buildings [m]
    lawn: shapely.Geometry  # Everything else [m]
    houses: list[House]  # All buildings, without what would stand on streets
    gardens: list[shapely.Polygon]  # Footprints of houses with gardens [m]
    built: shapely.Geometry  # Footprints of the buildings [m]
    kerbside: Kerbside  # Parking along the kerbs


def lay_out(
    network: RoadNetwork,
    features: Survey,  # What the map tells besides
    size: tuple[float, float],  # Extent of the floor [m]
    given: Occupied,  # What is there already
    rng: np.random.Generator,  # Of the parking along kerbs
) -> Town:
    """Return which ground of a town is what."""
    extent = shapely.box(-size[0] / 2, -size[1] / 2, size[0] / 2, size[1] / 2)
    lanes, crossings = _lanes(network), _junctions(network)
    beside = shapely.buffer(lanes, features.sidewalks, join_style="mitre", mitre_limit=2.0)
    told = shapely.make_valid(features.pavement)
    told = shapely.union(told, beside) if features.sidewalks else told
    walked = shapely.intersection(shapely.difference(told, lanes), extent)
    sharp = _clean(shapely.union(lanes, shapely.difference(crossings, walked)))
    places = shapely.union(crossings, _sharp_bends(network))
    shapes = [house.shape for house in features.houses]
    roads, beside = _rounded_corners(sharp, places, walked, shapes)
    roads = _clean(roads)
    walked = shapely.union(walked, shapely.intersection(beside, extent))
    houses = _beside(features.houses, roads)
    stand = [one.shape for one in houses if one.bottom < _CLEARANCE]
    built = shapely.union_all([*stand, given.built])
    crosswalks, islands = crosswalks_of(network, roads, walked, features)
    walked = shapely.union(walked, shapely.intersection(islands, extent))
    pavement = _clean(shapely.difference(walked, shapely.union(roads, built)))
    parked = _kerbside(network, features, roads, pavement, crosswalks, extent, given, built, rng)
    if not parked.bays.is_empty:
        walked = shapely.union(walked, parked.walks)
        pavement = _clean(
            shapely.difference(walked, shapely.union_all([roads, parked.bays, built]))
        )
    taken = shapely.union_all([roads, parked.bays, pavement, given.covered])
    covered = taken
    ground: dict[str, shapely.Geometry] = {}
    for kind in AREA_KINDS:
        shapes = [area.shape for area in features.areas if area.kind == kind]
        whole = shapely.intersection(shapely.union_all(shapes), extent)
        ground[kind] = _whole(shapely.difference(whole, covered))
        covered = shapely.union(covered, ground[kind])
        if kind not in _BUILT_ON:
            taken = covered
    yards = _yards(houses, shapely.union(roads, pavement), shapely.difference(extent, taken))
    for kind in _BUILT_ON:
        ground[kind] = _whole(shapely.difference(ground[kind], yards))
    covered = shapely.union(covered, yards)
    return Town(
        extent=extent,
        roads=roads,
        pavement=pavement,
        crosswalks=crosswalks,
        ground=ground,
        yards=yards,
        lawn=_whole(shapely.difference(extent, covered)),
        houses=houses,
        gardens=[one.shape for one in houses if is_small(one) and one.shape.area > 40.0],
        built=built,
        kerbside=parked,
    )


def _kerbside(
    network: RoadNetwork,
    features: Survey,
    roads: shapely.Geometry,
    pavement: shapely.Geometry,
    crosswalks: Sequence[Crosswalk],
    extent: shapely.Polygon,
    given: Occupied,
    built: shapely.Geometry,
    rng: np.random.Generator,
) -> Kerbside:
    """Return the parking along kerbs, clear of all that is known to be beside them."""
    solid = [area.shape for area in features.areas if area.kind in ("water", "rail", "parking")]
    trees = shapely.points(np.reshape([tree[:2] for tree in features.trees], (-1, 2)))
    lamps = shapely.points(np.reshape(features.lamps, (-1, 2)))
    kept = shapely.union_all(
        [
            *(built, given.built, given.covered, kept_free(crosswalks), *solid),
            *(*shapely.buffer(trees, _TREE), *shapely.buffer(lamps, _LAMP)),
        ]
    )
    return kerbside(network, features.parking, roads, pavement, kept, extent, rng)


def _lanes(network: RoadNetwork) -> shapely.Geometry:
    first = network.lane_first
    lines = [shapely.LineString(network.lane_points[a:b]) for a, b in pairwise(first)]
    strips = shapely.buffer(
        lines, network.lane_width / 2 + 0.02, cap_style="flat", join_style="mitre", mitre_limit=2.0
    )
    return shapely.union_all(strips)


def _junctions(network: RoadNetwork) -> shapely.Geometry:
    rings = [network.junction_points[a:b] for a, b in pairwise(network.junction_first)]
    shapes = [shapely.make_valid(shapely.Polygon(ring)) for ring in rings if len(ring) >= 3]
    return shapely.union_all(shapes)


def _clean(shape: shapely.Geometry) -> shapely.Geometry:
    """Return a shape at whole millimetres, without gaps and needles of centimetres."""
    closed = shapely.buffer(shape, 0.15, join_style="mitre")
    opened = shapely.buffer(closed, -0.15 - _NEEDLE, join_style="mitre")
    again = shapely.buffer(opened, _NEEDLE, join_style="mitre")
    return _whole(shapely.simplify(again, 0.03))


def _beside(houses: Sequence[House], roads: shapely.Geometry) -> list[House]:
    """Return the buildings without what stands on a street; one that mostly does is left out."""
    near = shapely.buffer(roads, _FROM_ROAD, quad_segs=3)
    shapely.prepare(near)
    kept: list[House] = []
    for house in houses:
        if house.bottom >= _CLEARANCE or not shapely.intersects(near, house.shape):
            kept.append(house)
            continue
        rest = [part for part in polygons_of(shapely.difference(house.shape, near))
                if part.area > 4.0]  # fmt: skip
        if sum(part.area for part in rest) > _LEFT * house.shape.area:
            kept += [replace(house, shape=_largest(part)) for part in rest]
    return [house for house in kept if not house.shape.is_empty]


def _whole(shape: shapely.Geometry) -> shapely.MultiPolygon:
    """Return the polygons of a shape at whole millimetres, without lines and points."""
    return shapely.MultiPolygon(polygons_of(snapped(shape)))


def _largest(shape: shapely.Polygon) -> shapely.Polygon:
    """Return the largest polygon of a shape at whole millimetres."""
    return max(polygons_of(snapped(shape)), key=shapely.area, default=shapely.Polygon())


def _yards(
    houses: Sequence[House], kerbs: shapely.Geometry, free: shapely.Geometry
) -> shapely.Geometry:
    """Return the paving between and around buildings, where no other ground is."""
    town = shapely.union_all([one.shape for one in houses if not is_small(one)])
    closed = shapely.buffer(shapely.buffer(town, _YARD, quad_segs=3), -_INSET, quad_segs=3)
    street = shapely.buffer(shapely.union(town, kerbs), _STRIP, quad_segs=3)
    closed = shapely.union(closed, shapely.buffer(street, -_STRIP, quad_segs=3))
    small = shapely.union_all([one.shape for one in houses if is_small(one)])
    aprons = shapely.buffer(small, _APRON, join_style="mitre")
    paved = shapely.intersection(shapely.union(closed, aprons), free)
    return _whole(shapely.simplify(paved, 0.05))


def _rounded_corners(
    roads: shapely.Geometry,
    places: shapely.Geometry,
    walked: shapely.Geometry,
    houses: Sequence[shapely.Polygon],
) -> tuple[shapely.Geometry, shapely.Geometry]:
    """Return streets with rounder corners, where houses leave room for them and a pavement.

    Returns:
        The asphalt, and the pavements round those corners that have one [m].
    """
    closed = shapely.buffer(shapely.buffer(roads, TURN, quad_segs=8), -TURN, quad_segs=8)
    near = shapely.buffer(places, _REACH, quad_segs=4)
    added = shapely.difference(shapely.intersection(closed, near), roads)
    tree = shapely.STRtree(houses)
    kept = [
        part
        for part in polygons_of(added)
        if part.area > _SLIVER
        and not len(tree.query(part, predicate="dwithin", distance=_CORNER_WALK))
    ]
    round_ones = shapely.union_all([roads, *kept])
    paved = [part for part in kept if shapely.intersection(part, walked).area > _SLIVER]
    beside = shapely.buffer(shapely.union_all(paved), _CORNER_WALK, quad_segs=4)
    return round_ones, shapely.difference(beside, round_ones)


def _sharp_bends(network: RoadNetwork) -> shapely.Geometry:
    """Return the surroundings of the bends of streets between junctions [m]."""
    lane = np.repeat(np.arange(len(network.lane_width)), np.diff(network.lane_first))
    step = np.diff(network.lane_points, axis=0)
    heading = exact.atan2(step[:, 1], step[:, 0])
    turn = np.abs(np.remainder(np.diff(heading) + np.pi, 2.0 * np.pi) - np.pi)
    bent = (turn > _SHARP) & (lane[2:] == lane[:-2])
    return shapely.union_all(
        shapely.buffer(shapely.points(network.lane_points[1:-1][bent]), _BEND, quad_segs=4)
    )
