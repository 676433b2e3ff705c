"""Where cars may park along kerbs, as the tags of OpenStreetMap say, or as is usual."""

from collections.abc import Mapping, Sequence
from typing import Final, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.roads.areas import Street, polygons_of, streets
from eyas.lanes import exact
from eyas.maps.osm.features import Survey
from eyas.maps.osm.reader import Tags
from eyas.maps.osm.rings import OsmShapes
from eyas.maps.osm.streets import is_street

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
    known = shapes.lines(is_street)
    lines = np.array([line for _, line in known], object)
    sides = [_sides(tags) for tags, _ in known]
    survey.stops = [place for _, place in shapes.points(_is_stop)]
    kept_free = _kept_free(survey, shapes)
    areas = shapely.union_all([shape for _, shape in shapes.areas(_is_street_side)])
    allowed = _Allowed(lines, sides, kept_free, areas, [house.shape for house in survey.houses])
    speeds = {int(edge): network.lane_speed[k] for k, edge in enumerate(network.lane_edge)}
    for number, street in enumerate(streets(network)):
        spans = allowed.spans(street, slow=speeds[number] <= _FASTEST)
        if spans:
            survey.parking[network.edges[number]] = spans


def everywhere(network: RoadNetwork) -> dict[str, list[tuple[float, float]]]:
    """Return the whole kerbs of all slow streets, of roads of which nothing else is known."""
    speeds = {int(edge): network.lane_speed[k] for k, edge in enumerate(network.lane_edge)}
    return {
        name: [(0.0, round(length, 1))]
        for number, (name, street) in enumerate(zip(network.edges, streets(network), strict=True))
        if speeds[number] <= _FASTEST
        and (length := shapely.LineString(street.right).length) >= _SHORTEST
    }


class _Allowed:
    """Decides where along a kerb cars park."""

    def __init__(
        self,
        lines: NDArray[np.object_],  # Middle lines of the streets [m]
        sides: Sequence[Mapping[str, Parking]],  # What the tags of each say
        kept_free: shapely.Geometry,  # Where nothing parks [m]
        areas: shapely.Geometry,  # Mapped areas of parking at streets [m]
        houses: Sequence[shapely.Polygon],
    ) -> None:
        self._lines, self._sides, self._free, self._areas = lines, sides, kept_free, areas
        self._tree, self._houses = shapely.STRtree(lines), shapely.STRtree(houses)
        shapely.prepare(self._free)
        shapely.prepare(self._areas)

    def spans(self, street: Street, *, slow: bool) -> list[tuple[float, float]]:
        """Return the parts of a kerb along which cars park, from and to [m]."""
        if len(street.right) < 2:
            return []
        kerb = shapely.LineString(street.right)
        at = np.arange(0.5 * _STEP, kerb.length, _STEP)
        if not len(at):
            return []
        points = shapely.line_interpolate_point(kerb, at)
        ahead = shapely.get_coordinates(shapely.line_interpolate_point(kerb, at + 0.2))
        places = shapely.get_coordinates(points)
        onwards = ahead - places
        onwards /= np.maximum(exact.hypot(onwards[:, 0], onwards[:, 1]), 1e-9)[:, None]
        said = self._said(points, places, onwards)
        usual = np.zeros(len(at), np.bool_)
        if slow:
            near = self._houses.query(points, predicate="dwithin", distance=_HOUSES)[0]
            usual[near] = True
        mapped = shapely.dwithin(self._areas, points, _AT_AREA)
        parked = (said == "yes") | ((said == "") & usual) | ((said != "no") & mapped)
        parked &= ~shapely.intersects(self._free, points)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], parked, [False]]).astype(int)))
        ends = np.round((edges.reshape(-1, 2) * _STEP).clip(0.0, kerb.length), 1)
        return [(low, high) for low, high in ends.tolist() if high - low >= _SHORTEST]

    def _said(
        self, points: NDArray[np.object_], places: NDArray[np.float64], onwards: NDArray[np.float64]
    ) -> NDArray[np.str_]:
        """Return what the nearest street that runs along says of the side at each point."""
        said = np.full(len(points), "no", "<U6")
        best = np.full(len(points), np.inf)
        which, line = self._tree.query(points, predicate="dwithin", distance=_REACH)
        if not len(which):
            return said
        lines = self._lines[line]
        along = shapely.line_locate_point(lines, points[which])
        length = shapely.length(lines)
        low = shapely.get_coordinates(
            shapely.line_interpolate_point(lines, np.clip(along - 0.5, 0.0, length))
        )
        high = shapely.get_coordinates(
            shapely.line_interpolate_point(lines, np.clip(along + 0.5, 0.0, length))
        )
        way = high - low
        way /= np.maximum(exact.hypot(way[:, 0], way[:, 1]), 1e-9)[:, None]
        away = places[which] - 0.5 * (low + high)
        left = way[:, 0] * away[:, 1] - way[:, 1] * away[:, 0] > 0.0
        alike = np.abs((way * onwards[which]).sum(axis=1)) > _ALIKE
        distance = np.round(exact.hypot(away[:, 0], away[:, 1]), 3)
        for k in np.flatnonzero(alike).tolist():
            if distance[k] < best[which[k]]:
                best[which[k]] = distance[k]
                said[which[k]] = self._sides[line[k]]["left" if left[k] else "right"]
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


def _kept_free(survey: Survey, shapes: OsmShapes) -> shapely.Geometry:
    """Return where nothing parks [m]: bus stops, crossings, hydrants, driveways."""

    def is_kept(tags: Tags) -> bool:
        return any(tags.get(key) in values for key, values in _STOPS.items())

    stops = [place for _, place in shapes.points(is_kept)]
    hydrants = shapes.points(lambda tags: tags.get("emergency") == "fire_hydrant")
    parts = [
        *shapely.buffer(shapely.points(np.reshape(stops, (-1, 2))), _FROM_STOP),
        *shapely.buffer(shapely.points(np.reshape(survey.crossings, (-1, 2))), _FROM_CROSSING),
        *shapely.buffer(
            shapely.points(np.reshape([place for _, place in hydrants], (-1, 2))), _FROM_HYDRANT
        ),
        *shapely.buffer(
            [line for _, line in shapes.lines(_is_driveway)], _DRIVEWAY, cap_style="flat"
        ),
    ]
    return shapely.MultiPolygon(polygons_of(shapely.union_all(parts)))
