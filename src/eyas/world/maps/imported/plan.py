"""Plan of an imported town: which ground is what, and which buildings stand on it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import shapely

from eyas.state.roads import RoadNetwork
from eyas.world.build.millimetres import snapped
from eyas.world.maps.imported.corners import rounded_corners, sharp_bends
from eyas.world.maps.imported.crosswalks import Crosswalk, crosswalks_of
from eyas.world.maps.imported.looks import Look, is_small, look_of
from eyas.world.osm.features import AREA_KINDS, Features, House
from eyas.world.roads.areas import polygons_of

__all__ = ["CLEARANCE", "Plan", "make_plan"]

CLEARANCE = 4.6
"""What begins higher than this may stand over a street [m]."""

_FROM_ROAD = 0.35
"""From the asphalt to walls [m]."""
_LEFT = 0.35
"""Share of a footprint that must be left beside the streets; otherwise the building is left out."""
_APRON = 0.8
"""Width of the paving at the foot of houses [m]."""
_YARD, _INSET = 9.0, 6.0
"""Gaps between buildings of a town up to twice the first are paved, except beside lawns [m]."""
_STRIP = 3.5
"""Strips between streets and buildings up to twice this wide are paved [m]."""
_BUILT_ON = ("industrial", "commercial", "residential")
"""Kinds of ground that yards are cut out of; the last of `AREA_KINDS`."""
_NEEDLE = 0.02
"""Slivers narrower than twice this are no asphalt [m]."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Positions in plan view."""

    extent: shapely.Polygon
    """The floor [m]."""
    roads: shapely.Geometry
    """Asphalt of the streets [m]."""
    pavement: shapely.Geometry
    """Raised pavements beside the streets [m]."""
    crosswalks: list[Crosswalk]
    """Crossings of the streets."""
    ground: dict[str, shapely.Geometry]
    """Ground of each of `AREA_KINDS`, cut out of each other and of the streets [m]."""
    yards: shapely.Geometry
    """Paved ground between buildings [m]."""
    lawn: shapely.Geometry
    """Everything else [m]."""
    buildings: list[Look]
    """All buildings."""
    gardens: list[shapely.Polygon]
    """Footprints of houses with gardens [m]."""
    built: shapely.Geometry
    """Where buildings stand on the ground [m]."""


def make_plan(
    network: RoadNetwork, features: Features, size: tuple[float, float], seed: int
) -> Plan:
    """Return the plan of a town.

    Args:
        network: The streets.
        features: What the map tells besides.
        size: Extent of the floor [m].
        seed: Seed of what it does not tell.
    """
    extent = shapely.box(-size[0] / 2, -size[1] / 2, size[0] / 2, size[1] / 2)
    lanes, crossings = _lanes(network), _junctions(network)
    walked = shapely.intersection(shapely.difference(features.pavement, lanes), extent)
    sharp = _clean(shapely.union(lanes, shapely.difference(crossings, walked)))
    places = shapely.union(crossings, sharp_bends(network))
    shapes = [house.shape for house in features.houses]
    roads, beside = rounded_corners(sharp, places, walked, shapes)
    roads = _clean(roads)
    walked = shapely.union(walked, shapely.intersection(beside, extent))
    houses = _beside(features.houses, roads)
    built = shapely.union_all([one.shape for one in houses if one.bottom < CLEARANCE])
    crosswalks, islands = crosswalks_of(network, roads, walked, features)
    walked = shapely.union(walked, shapely.intersection(islands, extent))
    pavement = _clean(shapely.difference(walked, shapely.union(roads, built)))
    taken = shapely.union(roads, pavement)
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
    return Plan(
        extent=extent,
        roads=roads,
        pavement=pavement,
        crosswalks=crosswalks,
        ground=ground,
        yards=yards,
        lawn=_whole(shapely.difference(extent, covered)),
        buildings=[look_of(house, seed) for house in houses],
        gardens=[one.shape for one in houses if is_small(one) and one.shape.area > 40.0],
        built=built,
    )


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
        if house.bottom >= CLEARANCE or not shapely.intersects(near, house.shape):
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
    """Return the paving between and around buildings, where no other ground is.

    Args:
        houses: All buildings.
        kerbs: Streets with their pavements [m].
        free: Ground that nothing covers [m].
    """
    town = shapely.union_all([one.shape for one in houses if not is_small(one)])
    closed = shapely.buffer(shapely.buffer(town, _YARD, quad_segs=3), -_INSET, quad_segs=3)
    street = shapely.buffer(shapely.union(town, kerbs), _STRIP, quad_segs=3)
    closed = shapely.union(closed, shapely.buffer(street, -_STRIP, quad_segs=3))
    small = shapely.union_all([one.shape for one in houses if is_small(one)])
    aprons = shapely.buffer(small, _APRON, join_style="mitre")
    paved = shapely.intersection(shapely.union(closed, aprons), free)
    return _whole(shapely.simplify(paved, 0.05))
