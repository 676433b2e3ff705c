"""Reading of a finished network of SUMO: lanes for cars, pavements, traffic lights."""

from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core.errors import ConfigError
from eyas.state.roads import RoadNetwork

__all__ = [
    "Pavements",
    "crossings_of",
    "pavements_of",
    "road_network",
    "signal_programs",
    "signalled_edges",
]

_SHORTEST = 0.05
"""Points nearer to each other are one [m]."""

Line = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Pavements:
    """Where people walk, in plan view."""

    area: shapely.Geometry
    """Sidewalks and the corners between them [m]."""


def road_network(xml: bytes, graph_hash: str) -> RoadNetwork:
    """Return the lanes and junctions of a finished network, without sidewalks.

    Args:
        xml: SUMO's network file.
        graph_hash: Hash of the graph that holds it.

    Raises:
        ConfigError: No car may drive anywhere in it.
    """
    root = ElementTree.fromstring(xml)
    edges: list[ElementTree.Element] = []
    lanes: list[tuple[int, int, ElementTree.Element]] = []
    for edge in root.iter("edge"):
        found = [lane for lane in edge.iter("lane") if not _only_walked(lane)]
        if edge.get("function") is None and found:
            lanes += [(len(edges), index, lane) for index, lane in enumerate(found)]
            edges.append(edge)
    if not lanes:
        raise ConfigError("the network has no street on which a car may drive")
    used = {name for edge in edges for name in (edge.attrib["from"], edge.attrib["to"])}
    junctions = [one for one in root.iter("junction") if one.get("id") in used]
    lane_points, lane_first = _joined([_line(lane.attrib["shape"]) for _, _, lane in lanes])
    corners, corner_first = _joined([_points(one.get("shape", "")) for one in junctions])
    return RoadNetwork(
        graph_hash=graph_hash,
        builder=f"network of SUMO's format {root.get('version', '?')}",
        lane_points=lane_points,
        lane_first=lane_first,
        lane_width=np.array([_width(lane) for _, _, lane in lanes]),
        lane_speed=np.array([float(lane.get("speed", "13.89")) for _, _, lane in lanes]),
        lane_edge=np.array([edge for edge, _, _ in lanes], np.int32),
        lane_index=np.array([index for _, index, _ in lanes], np.int32),
        edges=tuple(edge.attrib["id"] for edge in edges),
        edge_start=tuple(edge.attrib["from"] for edge in edges),
        edge_end=tuple(edge.attrib["to"] for edge in edges),
        junction_points=corners,
        junction_first=corner_first,
        junctions=tuple(one.attrib["id"] for one in junctions),
    )


def pavements_of(xml: bytes) -> Pavements:
    """Return the sidewalks of a finished network, without what is driven on within junctions.

    SUMO joins the sidewalks on both sides of a street that has none across its mouth.
    """
    root = ElementTree.fromstring(xml)
    shapes: list[shapely.Geometry] = []
    driven: list[shapely.Geometry] = []
    for edge in root.iter("edge"):
        kind = edge.get("function")
        for lane in edge.iter("lane"):
            points = _points(lane.get("shape", ""))
            if kind == "walkingarea" and len(points) >= 3:
                shapes.append(shapely.make_valid(shapely.Polygon(points)))
            elif kind == "internal" and len(points) >= 2 and not _only_walked(lane):
                driven.append(
                    shapely.buffer(shapely.LineString(points), _width(lane) / 2, cap_style="flat")
                )
            elif kind is None and _only_walked(lane) and len(points) >= 2:
                half = _width(lane) / 2
                line = shapely.LineString(points)
                shapes.append(
                    shapely.buffer(line, half, cap_style="flat", join_style="mitre", quad_segs=3)
                )
    return Pavements(shapely.difference(shapely.union_all(shapes), shapely.union_all(driven)))


def crossings_of(xml: bytes) -> dict[str, Line]:
    """Return the middle of each crossing for people at a junction [m], shape (K, 2), by name."""
    root = ElementTree.fromstring(xml)
    return {
        edge.attrib["id"]: _points(lane.attrib["shape"])
        for edge in root.iter("edge")
        if edge.get("function") == "crossing"
        for lane in edge.iter("lane")
    }


def signalled_edges(xml: bytes) -> tuple[str, ...]:
    """Return the streets that end at a traffic light, in the order of the file."""
    root = ElementTree.fromstring(xml)
    lit = [one.attrib["from"] for one in root.iter("connection") if one.get("tl")]
    return tuple(name for name in dict.fromkeys(lit) if not name.startswith(":"))


def signal_programs(xml: bytes) -> int:
    """Return the number of programs of traffic lights."""
    return len(ElementTree.fromstring(xml).findall("tlLogic"))


def _only_walked(lane: ElementTree.Element) -> bool:
    """Return whether a lane is a sidewalk or a path, no part of the asphalt."""
    allowed = set(lane.get("allow", "").split())
    return bool(allowed) and allowed <= {"pedestrian", "wheelchair"}


def _width(lane: ElementTree.Element) -> float:
    return float(lane.get("width", "3.2"))


def _points(shape: str) -> Line:
    pairs = [[float(v) for v in pair.split(",")[:2]] for pair in shape.split()]
    return np.array(pairs, np.float64).reshape(-1, 2)


def _line(shape: str) -> Line:
    """Return the points of a lane, at least two, without those that lie on their neighbours."""
    points = _points(shape)
    kept = [points[0]]
    for point in points[1:]:
        if np.abs(point - kept[-1]).max() > _SHORTEST:
            kept.append(point)
    if len(kept) == 1:
        kept.append(points[-1] + [_SHORTEST, 0.0])
    return np.array(kept, np.float64)


def _joined(parts: list[Line]) -> tuple[Line, NDArray[np.int32]]:
    first = np.cumsum([0, *(len(part) for part in parts)]).astype(np.int32)
    return np.concatenate([np.zeros((0, 2)), *parts]), first
