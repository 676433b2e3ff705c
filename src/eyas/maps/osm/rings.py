"""Areas of OpenStreetMap as polygons: closed ways, and relations of outer and inner outlines."""

from collections.abc import Callable

import numpy as np
import shapely

from eyas.engine.world.build.millimetres import snapped
from eyas.engine.world.projection import Projection
from eyas.engine.world.roads.areas import polygons_of
from eyas.maps.osm.reader import OsmData, Relation, Tags, Way

_LEAST = 0.5  # Areas below this are left out [m^2]


class OsmShapes:
    """Polygons and lines of a file, in metres."""

    def __init__(
        self,
        data: OsmData,
        projection: Projection,  # From degrees to metres
        extent: shapely.Polygon,  # The area of the map; everything is cut to it [m]
        broken: Callable[[str], None],  # Called with a word for each area that has no valid outline
    ) -> None:
        self._data, self._extent, self._broken = data, extent, broken
        names = list(data.places)
        points = projection.metres(np.array([data.places[name] for name in names]))
        self.at = dict(zip(names, map(tuple, points.tolist()), strict=True))

    def areas(self, wanted: Callable[[Tags], bool]) -> list[tuple[Tags, shapely.Polygon]]:
        """Return all areas whose tags are wanted, each as simple polygons, in the file's order."""
        found: list[tuple[Tags, shapely.Polygon]] = []
        outlines: set[int] = set()
        for relation in self._data.relations:
            if relation.tags.get("type") not in ("multipolygon", "boundary"):
                continue
            tags = self._tags_of(relation)
            if wanted(tags):
                # Old files tag the outer way instead of the relation, or both.
                outlines |= {ref for kind, ref, role in relation.members if role != "inner"}
                found += [(tags, part) for part in self._cut(self._joined(relation))]
        for way in self._data.ways.values():
            closed = len(way.nodes) >= 4 and way.nodes[0] == way.nodes[-1]
            if way.id not in outlines and wanted(way.tags):
                if closed:
                    found += [(way.tags, part) for part in self._cut(self._ring(way))]
                else:
                    self._broken("open outline")
        return found

    def lines(self, wanted: Callable[[Tags], bool]) -> list[tuple[Tags, shapely.LineString]]:
        """Return all lines whose tags are wanted, cut to the map."""
        found = []
        for way in self._data.ways.values():
            points = [self.at[node] for node in way.nodes if node in self.at]
            if wanted(way.tags) and len(points) >= 2:
                line = shapely.intersection(shapely.LineString(points), self._extent)
                parts = shapely.get_parts(line)
                found += [(way.tags, part) for part in parts if part.geom_type == "LineString"]
        return found

    def points(self, wanted: Callable[[Tags], bool]) -> list[tuple[Tags, tuple[float, float]]]:
        """Return all nodes within the map whose tags are wanted [m]."""
        return [
            (tags, self.at[node])
            for node, tags in self._data.nodes.items()
            if node in self.at and wanted(tags) and self._extent.contains(_point(self.at[node]))
        ]

    def _tags_of(self, relation: Relation) -> Tags:
        tags = {key: text for key, text in relation.tags.items() if key != "type"}
        if tags:
            return tags
        outer = [ref for kind, ref, role in relation.members if kind == "way" and role != "inner"]
        way = self._data.ways.get(outer[0]) if outer else None
        return way.tags if way else {}

    def _ring(self, way: Way) -> shapely.Geometry:
        points = [self.at[node] for node in way.nodes if node in self.at]
        if len(points) < 4 or points[0] != points[-1]:
            self._broken("outline with missing nodes")
            return shapely.Polygon()
        return shapely.Polygon(points)

    def _joined(self, relation: Relation) -> shapely.Geometry:
        """Return the area between the outer and the inner outlines of a relation."""
        lines: dict[bool, list[shapely.LineString]] = {True: [], False: []}
        for kind, ref, role in relation.members:
            way = self._data.ways.get(ref) if kind == "way" else None
            points = [self.at[n] for n in way.nodes if n in self.at] if way else []
            if len(points) >= 2:
                lines[role == "inner"].append(shapely.LineString(points))
            elif kind == "way":
                self._broken("relation with missing ways")
        outer, inner = (_closed(lines[inside]) for inside in (False, True))
        if outer.is_empty:
            self._broken("relation without a closed outline")
        return shapely.difference(outer, inner)

    def _cut(self, shape: shapely.Geometry) -> list[shapely.Polygon]:
        if not shape.is_valid:
            self._broken("outline that crosses itself")
            shape = shapely.make_valid(shape, method="structure", keep_collapsed=False)
        whole = snapped(shapely.intersection(shape, self._extent))
        return [part for part in polygons_of(whole) if part.area > _LEAST]


def _closed(lines: list[shapely.LineString]) -> shapely.Geometry:
    """Return the union of all rings that lines form together."""
    if not lines:
        return shapely.Polygon()
    # Not `polygonize` of all at once: rings within each other would be holes of the outer one.
    merged = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(lines)))
    rings = [shapely.Polygon(line) for line in merged if line.is_closed and len(line.coords) >= 4]
    return shapely.union_all([shapely.make_valid(ring) for ring in rings])


def _point(place: tuple[float, float]) -> shapely.Point:
    return shapely.Point(place)
