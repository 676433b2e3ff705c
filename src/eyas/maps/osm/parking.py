"""Where cars may park along kerbs, as the tags of OpenStreetMap say, or as is usual."""

from collections.abc import Mapping, Sequence
from typing import Final, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.roads.areas import streets
from eyas.lanes import exact
from eyas.maps.osm.features import Survey
from eyas.maps.osm.reader import Tags
from eyas.maps.osm.rings import OsmShapes
from eyas.maps.osm.streets import is_street

Points = NDArray[np.float64]
Lines = NDArray[np.object_]

Parking = Literal["yes", "no", "mapped", ""]
"""Whether cars park at a side of a street: where areas of the map say so; empty: not known."""

_USUAL: Final = ("residential", "unclassified", "tertiary", "living_street")
_FASTEST: Final = 14.2  # Streets with a higher limit have no cars at the kerb unless tagged [m/s]
_HOUSES: Final = 30.0  # Distance to a building up to which untagged streets have them [m]

_ALLOWED: Final = ("lane", "street_side", "on_kerb", "half_on_kerb", "shoulder", "yes", "on_street",
                   "parallel", "diagonal", "perpendicular", "marked")  # fmt: skip
"""Values of `parking:SIDE`, and of `parking:lane:SIDE` as it was tagged until 2022."""

_RESTRICTED: Final = ("no_parking", "no_stopping", "no_standing", "loading_only", "charging_only")

_STEP: Final = 2.0  # Distance of the points along a kerb that are tested [m]
_SHORTEST: Final = 6.0  # Shorter parts of a kerb are left out [m]
_REACH: Final = 14.0  # Farthest kerb from the middle line of its street [m]
_ALIKE: Final = 0.75  # Least cosine of the angle between a kerb and its street
_AT_AREA: Final = 4.0  # Farthest kerb from an area of `parking=street_side` beside it [m]

_STOPS: Final = {"highway": ("bus_stop",), "public_transport": ("platform", "stop_position")}
_FROM_STOP, _FROM_CROSSING, _FROM_HYDRANT = 14.0, 8.0, 5.0
"""Distances from bus stops, crossings and hydrants within which nothing parks [m]."""
_DRIVEWAY: Final = 3.0  # The same from the middle of a driveway [m]
_NO_DRIVEWAYS: Final = ("parking_aisle",)


def add_parking(survey: Survey, shapes: OsmShapes, network: RoadNetwork) -> None:
    """Add the parts of kerbs along which cars park, and bus stops.

    Args:
        survey: Has buildings and crossings.
        shapes: Points and lines of the file.
        network: What SUMO has made of the streets.
    """
    survey.stops = [place for _, place in shapes.points(_is_stop)]
    every = streets(network)
    kerbs = np.array([_line(street.right) for street in every], object)
    count = np.maximum(np.ceil(shapely.length(kerbs) / _STEP - 0.5), 0).astype(int)
    owner = np.repeat(np.arange(len(every)), count)
    at = _STEP * (np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count) + 0.5)
    if not len(owner):
        return
    points = shapely.line_interpolate_point(kerbs[owner], at)
    onwards = _directions(kerbs[owner], at)
    known = shapes.lines(is_street)
    said = _said(points, onwards, [line for _, line in known], [_sides(tags) for tags, _ in known])
    slow = np.array([speed <= _FASTEST for speed in _speeds(network)])[owner]
    usual = np.zeros(len(owner), np.bool_)
    houses = shapely.STRtree([house.shape for house in survey.houses])
    usual[houses.query(points, predicate="dwithin", distance=_HOUSES)[0]] = True
    areas = shapely.union_all([shape for _, shape in shapes.areas(_is_street_side)])
    mapped = shapely.dwithin(areas, points, _AT_AREA)
    parked = (said == "yes") | ((said == "") & usual & slow) | ((said != "no") & mapped)
    kept_free = shapely.STRtree(_kept_free(survey, shapes))
    parked[kept_free.query(points, predicate="intersects")[0]] = False
    for street in np.unique(owner[parked]).tolist():
        inside = np.concatenate([[False], parked[owner == street], [False]])
        ends = (np.flatnonzero(np.diff(inside.astype(int))) * _STEP).clip(0.0, kerbs[street].length)
        spans = [(low, high) for low, high in np.round(ends, 1).reshape(-1, 2).tolist()
                 if high - low >= _SHORTEST]  # fmt: skip
        if spans:
            survey.parking[network.edges[street]] = spans


def everywhere(network: RoadNetwork) -> dict[str, list[tuple[float, float]]]:
    """Return the whole kerbs of all slow streets, of roads of which nothing else is known."""
    every = zip(network.edges, streets(network), _speeds(network), strict=True)
    return {
        name: [(0.0, round(length, 1))]
        for name, street, speed in every
        if speed <= _FASTEST and (length := _line(street.right).length) >= _SHORTEST
    }


def _line(points: Points) -> shapely.LineString:
    return shapely.LineString(points) if len(points) >= 2 else shapely.LineString()


def _speeds(network: RoadNetwork) -> list[float]:
    """Return the speed limit of each edge [m/s]."""
    speeds = {int(edge): network.lane_speed[k] for k, edge in enumerate(network.lane_edge)}
    return [float(speeds[edge]) for edge in range(len(network.edges))]


def _directions(lines: Lines, at: Points) -> Points:
    """Return the unit vectors along lines at places on them [m], shape (K, 2)."""
    ends = np.minimum(at + 0.5, shapely.length(lines)), np.maximum(at - 0.5, 0.0)
    high, low = (shapely.get_coordinates(shapely.line_interpolate_point(lines, s)) for s in ends)
    way = high - low
    unit: Points = way / np.maximum(exact.hypot(way[:, 0], way[:, 1]), 1e-9)[:, None]
    return unit


def _said(
    points: Lines,  # On kerbs, shape (K,)
    onwards: Points,  # Direction of the kerb there, shape (K, 2)
    lines: Sequence[shapely.LineString],  # Middle lines of the streets
    sides: Sequence[Mapping[str, Parking]],  # What the tags of each say
) -> NDArray[np.str_]:
    """Return what the nearest street that runs along says of the side at each point."""
    said = np.full(len(points), "no", "<U6")
    tree = shapely.STRtree(lines)
    which, line = tree.query(points, predicate="dwithin", distance=_REACH)
    near = tree.geometries[line]
    along = shapely.line_locate_point(near, points[which])
    way = _directions(near, along)
    foot = shapely.get_coordinates(shapely.line_interpolate_point(near, along))
    away = shapely.get_coordinates(points[which]) - foot
    left = way[:, 0] * away[:, 1] - way[:, 1] * away[:, 0] > 0.0
    alike = np.flatnonzero(np.abs((way * onwards[which]).sum(axis=1)) > _ALIKE)
    distance = np.round(exact.hypot(away[alike, 0], away[alike, 1]), 3)
    order = alike[np.lexsort((line[alike], distance, which[alike]))]
    _, first = np.unique(which[order], return_index=True)
    for pair in order[first].tolist():
        said[which[pair]] = sides[line[pair]]["left" if left[pair] else "right"]
    return said


def _sides(tags: Tags) -> dict[str, Parking]:
    """Return what the tags of a street say of its sides."""
    return {side: _side(tags, side) for side in ("left", "right")}


def _side(tags: Tags, side: str) -> Parking:
    for where in (side, "both"):
        for key in (f"parking:{where}", f"parking:lane:{where}"):
            said = tags.get(key)
            if said is None:
                continue
            limits = (f"{key}:restriction", f"{key}:access", f"parking:condition:{where}")
            if any(tags.get(limit) in (*_RESTRICTED, "no", "private") for limit in limits):
                return "no"
            return "mapped" if said == "separate" else "yes" if said in _ALLOWED else "no"
    usual = tags.get("highway") in _USUAL and tags.get("junction") != "roundabout"
    return "" if usual and "no" == tags.get("bridge", "no") == tags.get("tunnel", "no") else "no"


def _is_stop(tags: Tags) -> bool:
    return tags.get("highway") == "bus_stop" or (
        tags.get("public_transport") == "platform" and tags.get("bus") == "yes"
    )


def _is_street_side(tags: Tags) -> bool:
    return tags.get("amenity") == "parking" and tags.get("parking") in ("street_side", "lane")


def _is_driveway(tags: Tags) -> bool:
    return tags.get("highway") == "service" and tags.get("service") not in _NO_DRIVEWAYS


def _kept_free(survey: Survey, shapes: OsmShapes) -> list[shapely.Geometry]:
    """Return where nothing parks [m]: bus stops, crossings, hydrants, driveways."""

    def is_kept(tags: Tags) -> bool:
        return any(tags.get(key) in values for key, values in _STOPS.items())

    stops = [place for _, place in shapes.points(is_kept)]
    hydrants = shapes.points(lambda tags: tags.get("emergency") == "fire_hydrant")
    return [
        *shapely.buffer(shapely.points(np.reshape(stops, (-1, 2))), _FROM_STOP),
        *shapely.buffer(shapely.points(np.reshape(survey.crossings, (-1, 2))), _FROM_CROSSING),
        *shapely.buffer(
            shapely.points(np.reshape([place for _, place in hydrants], (-1, 2))), _FROM_HYDRANT
        ),
        *shapely.buffer(
            [line for _, line in shapes.lines(_is_driveway)], _DRIVEWAY, cap_style="flat"
        ),
    ]
