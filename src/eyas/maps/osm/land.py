"""Ground of OpenStreetMap: water, parks, paths, land use, and the trees and lamps on it."""

import numpy as np
import shapely

from eyas.engine.world.build.millimetres import snapped
from eyas.engine.world.roads.areas import polygons_of
from eyas.maps.osm.features import Area, Survey
from eyas.maps.osm.measures import Odd, length
from eyas.maps.osm.reader import Tags
from eyas.maps.osm.rings import OsmShapes
from eyas.maps.osm.streets import is_street

_KINDS: dict[tuple[str, str], str] = {
    **{("natural", kind): "water" for kind in ("water", "bay")},
    **{("landuse", kind): "water" for kind in ("basin", "reservoir")},
    ("waterway", "riverbank"): "water",
    ("waterway", "dock"): "water",
    ("leisure", "swimming_pool"): "water",
    ("amenity", "fountain"): "water",
    ("amenity", "parking"): "parking",
    ("highway", "pedestrian"): "plaza",
    ("highway", "footway"): "plaza",
    ("place", "square"): "plaza",
    ("man_made", "pier"): "plaza",
    ("leisure", "pitch"): "pitch",
    ("leisure", "track"): "pitch",
    ("leisure", "playground"): "playground",
    ("natural", "beach"): "sand",
    ("natural", "sand"): "sand",
    ("landuse", "railway"): "rail",
    **{("leisure", kind): "park" for kind in ("park", "garden", "dog_park", "golf_course")},
    **{("landuse", kind): "park" for kind in ("cemetery", "recreation_ground", "allotments")},
    ("landuse", "forest"): "forest",
    ("natural", "wood"): "forest",
    ("natural", "scrub"): "scrub",
    ("natural", "heath"): "scrub",
    **{("landuse", kind): "grass" for kind in ("grass", "meadow", "village_green", "flowerbed")},
    ("natural", "grassland"): "grass",
    **{("landuse", kind): "farmland" for kind in ("farmland", "orchard", "vineyard", "farmyard")},
    **{("landuse", kind): "soil" for kind in ("construction", "brownfield", "quarry")},
    **{("landuse", kind): "industrial" for kind in ("industrial", "port", "garages", "depot")},
    **{("landuse", kind): "commercial" for kind in ("commercial", "retail")},
    ("landuse", "residential"): "residential",
}
"""Kind of ground for a tag of an area."""

_PATHS = {"footway": 2.0, "path": 1.6, "pedestrian": 4.0, "cycleway": 2.2, "steps": 2.2,
          "bridleway": 1.8, "track": 2.6}  # fmt: skip
"""Width of the ways on which no cars drive [m]."""
_STREAMS = {"river": 18.0, "canal": 12.0, "stream": 2.5, "ditch": 1.2, "drain": 1.2}
"""Width of flowing water whose banks are not drawn [m]."""
_TRACKS = ("rail", "light_rail", "tram", "narrow_gauge", "subway")
_BALLAST = 1.9  # Distance from the middle of a track to the edge of its ballast [m]
_APART = (8.0, 12.0)  # Distances between the trees of a row [m]


def add_land(features: Survey, shapes: OsmShapes, odd: Odd, rng: np.random.Generator) -> None:
    """Add ground, trees, lamps, crossings and railways.

    Args:
        shapes: Polygons and lines of the file.
        odd: Told of tags whose values make no sense.
    """
    for tags, shape in shapes.areas(lambda tags: bool(_kind(tags))):
        features.areas.append(Area(_kind(tags), shape))
    for kind, tags, line in _strips(shapes):
        width = length(tags, "width", (0.5, 300.0), odd) or _width(tags)
        strip = shapely.buffer(line, width / 2, cap_style="flat", quad_segs=3)
        features.areas += [Area(kind, part) for part in polygons_of(snapped(strip))]
    for _, line in shapes.lines(_is_rail):
        features.rails.append(line)
        ballast = shapely.buffer(line, _BALLAST, cap_style="flat", quad_segs=3)
        features.areas += [Area("rail", part) for part in polygons_of(snapped(ballast))]
    for tags, place in shapes.points(lambda tags: tags.get("natural") == "tree"):
        features.trees.append((*place, length(tags, "height", (1.5, 60.0), odd) or 0.0))
    for tags, line in shapes.lines(lambda tags: tags.get("natural") == "tree_row"):
        tall = length(tags, "height", (1.5, 60.0), odd) or 0.0
        along = np.cumsum(rng.uniform(*_APART, int(line.length / _APART[0]) + 1)) - _APART[0]
        spots = shapely.line_interpolate_point(line, along[along < line.length])
        features.trees += [(round(p.x, 3), round(p.y, 3), tall) for p in spots]
    lamps = shapes.points(lambda tags: tags.get("highway") == "street_lamp")
    features.lamps += [place for _, place in lamps]
    features.crossings += _crossings(shapes)


def _crossings(shapes: OsmShapes) -> list[tuple[float, float]]:
    """Return where streets are crossed: at points, and where a way for people leads over one."""
    found = [place for _, place in shapes.points(lambda tags: _is_crossing(tags, "highway"))]
    streets = [line for _, line in shapes.lines(is_street)]
    tree = shapely.STRtree(streets)
    for _, line in shapes.lines(lambda tags: _is_crossing(tags, "footway")):
        for k in np.sort(tree.query(line, predicate="intersects")).tolist():
            met = shapely.get_coordinates(shapely.intersection(line, streets[k]))
            found += [(round(float(x), 3), round(float(y), 3)) for x, y in met]
    return found


def _is_crossing(tags: Tags, key: str) -> bool:
    return tags.get(key) == "crossing" and tags.get("crossing") not in ("unmarked", "no")


def _kind(tags: Tags) -> str:
    if "building" in tags or tags.get("location") == "underground" or _below(tags):
        return ""
    if tags.get("amenity") == "parking" and tags.get("parking", "surface") != "surface":
        return ""
    if tags.get("highway") in ("pedestrian", "footway") and tags.get("area") != "yes":
        return ""
    return next((_KINDS[pair] for pair in tags.items() if pair in _KINDS), "")


def _strips(shapes: OsmShapes) -> list[tuple[str, Tags, shapely.LineString]]:
    paths = shapes.lines(lambda tags: _is_path(tags) and not _below(tags))
    streams = shapes.lines(lambda tags: tags.get("waterway") in _STREAMS and not _below(tags))
    return [("path", *one) for one in paths] + [("water", *one) for one in streams]


def _is_path(tags: Tags) -> bool:
    # Sidewalks beside streets are made with the streets.
    beside = tags.get("footway") in ("sidewalk", "crossing", "link")
    return tags.get("highway") in _PATHS and tags.get("area") != "yes" and not beside


def _is_rail(tags: Tags) -> bool:
    return tags.get("railway") in _TRACKS and not _below(tags)


def _below(tags: Tags) -> bool:
    return tags.get("tunnel", "no") != "no" or tags.get("layer", "").startswith("-")


def _width(tags: Tags) -> float:
    return _PATHS.get(tags.get("highway", ""), 0.0) or _STREAMS[tags["waterway"]]
