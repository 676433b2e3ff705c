"""A finished network of SUMO, read once: lanes for cars, pavements, crossings, traffic lights."""

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, TypeVar
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.state.roads import LEFT_HAND, RoadNetwork, network_problems

if TYPE_CHECKING:
    import shapely


_SHORTEST = 0.05  # Points nearer to each other are one [m]

_LARGEST = 1e9  # Largest number that is read

Line = NDArray[np.float64]
T = TypeVar("T")


class NetLane(NamedTuple):
    """A lane, sidewalk or path."""

    shape: str  # Its points, as the file tells them
    width: float  # [m]
    speed: float  # [m/s]
    walked: bool  # Whether it is a sidewalk or a path, no part of the asphalt

    @property
    def points(self) -> Line:
        """Middle of the lane [m], shape (K, 2)."""
        return points_of(self.shape)


class NetEdge(NamedTuple):
    """A street in one direction, or, with a function, a part of a junction."""

    name: str
    function: str | None  # None for a street; "internal", "crossing" or "walkingarea"
    start: str  # Junction where a street begins
    end: str
    lanes: tuple[NetLane, ...]  # From the right
    crossed: tuple[str, ...]  # Streets that a crossing crosses


class NetConnection(NamedTuple):
    """A way through a junction."""

    start: str  # Its edges
    end: str
    light: str  # The program that controls it; empty: none does
    link: int  # Place in the states of the program; -1 without one
    direction: str


class NetPhase(NamedTuple):
    """A phase of a traffic light."""

    seconds: float
    state: str  # What each link shows


class NetProgram(NamedTuple):
    """The program of a traffic light."""

    name: str
    kind: str  # "static" if it depends on the time alone
    offset: float  # [s]
    phases: tuple[NetPhase, ...]


class SumoNet:
    """What is read of a network, in the order of the file, as far as it is asked for.

    Args:
        xml: SUMO's network file, perhaps someone else's.
        source: What it is called in messages.

    Raises:
        DataFileError: It is not a network of SUMO, which may be noticed late.
    """

    def __init__(self, xml: bytes, source: str = "roads") -> None:
        self.source = source
        try:
            self._root = ElementTree.fromstring(xml)
        except (ElementTree.ParseError, ValueError, LookupError) as error:
            raise self.error(error) from None
        if self._root.tag != "net":
            raise self.error(f"its content is <{self._root.tag}>")
        self.version = self._root.get("version", "?")
        self.left_hand = self._root.get("lefthand") == "true"

    @cached_property
    def edges(self) -> tuple[NetEdge, ...]:
        """Streets, and parts of junctions."""
        return self._read("edge", _edge)

    @cached_property
    def junctions(self) -> dict[str, str]:
        """Shape of each junction, as the file tells it."""
        return dict(self._read("junction", lambda one: (one.attrib["id"], one.get("shape", ""))))

    @cached_property
    def connections(self) -> tuple[NetConnection, ...]:
        """Ways through junctions."""
        found = self._read("connection", _connection)
        links = {
            one.name: min((len(phase.state) for phase in one.phases), default=0)
            for one in self.programs
        }
        for one in found:
            if one.light in links and not 0 <= one.link < links[one.light]:
                raise self.error(f"<connection>: linkIndex {one.link}: no such link")
        return found

    @cached_property
    def programs(self) -> tuple[NetProgram, ...]:
        """Programs of traffic lights."""
        return self._read("tlLogic", _program)

    def error(self, problem: object) -> DataFileError:
        """Return the error to raise for a file that is not as SUMO writes it."""
        return DataFileError(f"{self.source}: not a network of SUMO: {problem}")

    def _read(self, tag: str, make: Callable[[ElementTree.Element], T]) -> tuple[T, ...]:
        try:
            return tuple(map(make, self._root.iter(tag)))
        except KeyError as error:
            raise self.error(f"<{tag}> without {error}") from None
        except ValueError as error:
            raise self.error(f"<{tag}>: {error}") from None


def _number(text: str) -> float:
    value = float(text)
    if not abs(value) <= _LARGEST:  # also not a number: it is not
        raise ValueError(f"{text:.30} is not allowed: up to {_LARGEST:g}")
    return value


def _connection(one: ElementTree.Element) -> NetConnection:
    told = one.attrib
    link = int(told.get("linkIndex", "-1"))
    return NetConnection(told["from"], told["to"], told.get("tl", ""), link, told.get("dir", "s"))


def _program(logic: ElementTree.Element) -> NetProgram:
    phases = (
        NetPhase(_number(one.attrib["duration"]), one.attrib["state"])
        for one in logic.iter("phase")
    )
    offset = _number(logic.get("offset", "0"))
    return NetProgram(logic.attrib["id"], logic.get("type", "static"), offset, tuple(phases))


def _edge(edge: ElementTree.Element) -> NetEdge:
    return NetEdge(
        name=edge.attrib["id"],
        function=edge.get("function"),
        start=edge.get("from", ""),
        end=edge.get("to", ""),
        lanes=tuple(map(_lane, edge.iter("lane"))),
        crossed=tuple(edge.get("crossingEdges", "").split()),
    )


def _lane(lane: ElementTree.Element) -> NetLane:
    told = lane.attrib
    allowed = told.get("allow", "").split()
    return NetLane(
        told.get("shape", ""),
        _number(told.get("width", "3.2")),
        _number(told.get("speed", "13.89")),
        bool(allowed) and {"pedestrian", "wheelchair"}.issuperset(allowed),
    )


def road_network(
    net: SumoNet,  # The network
    graph_hash: str,  # Hash of the graph that holds it
) -> RoadNetwork:
    """Return the lanes and junctions of a finished network, without sidewalks.

    Raises:
        ConfigError: No car may drive anywhere in it.
        DataFileError: It is not a network of SUMO, or not one of a city's size.
    """
    edges: list[NetEdge] = []
    lanes: list[tuple[int, int, NetLane]] = []
    for edge in net.edges:
        found = [lane for lane in edge.lanes if not lane.walked]
        if edge.function is None and found:
            lanes += [(len(edges), index, lane) for index, lane in enumerate(found)]
            edges.append(edge)
    if not lanes:
        raise ConfigError("the network has no street on which a car may drive")
    used = {name for edge in edges for name in (edge.start, edge.end)}
    junctions = {name: shape for name, shape in net.junctions.items() if name in used}
    try:
        lane_points, lane_first = joined([_line(lane.points) for _, _, lane in lanes])
        corners, corner_first = joined(list(map(points_of, junctions.values())))
    except (ValueError, IndexError) as error:
        raise net.error(f"a shape: {error}") from None
    network = RoadNetwork(
        graph_hash=graph_hash,
        builder=f"network of SUMO's format {net.version}" + (LEFT_HAND if net.left_hand else ""),
        lane_points=lane_points,
        lane_first=lane_first,
        lane_width=np.array([lane.width for _, _, lane in lanes]),
        lane_speed=np.array([lane.speed for _, _, lane in lanes]),
        lane_edge=np.array([edge for edge, _, _ in lanes], np.int32),
        lane_index=np.array([index for _, index, _ in lanes], np.int32),
        edges=tuple(edge.name for edge in edges),
        edge_start=tuple(edge.start for edge in edges),
        edge_end=tuple(edge.end for edge in edges),
        junction_points=corners,
        junction_first=corner_first,
        junctions=tuple(junctions),
    )
    for problem in network_problems(network):
        raise net.error(problem)
    return network


def pavement_area(net: SumoNet) -> "shapely.Geometry":
    """Return the sidewalks of a finished network and the corners between them [m].

    What is driven on within junctions is left out: SUMO joins the sidewalks on both sides of a
    street that has none across its mouth.
    """
    import shapely  # which few starts need

    shapes: list[shapely.Geometry] = []
    driven: list[shapely.Geometry] = []
    for edge in net.edges:
        kind = edge.function
        for lane in edge.lanes:
            points, half = lane.points, lane.width / 2
            if kind == "walkingarea" and len(points) >= 3:
                shapes.append(shapely.make_valid(shapely.Polygon(points)))
            elif kind == "internal" and len(points) >= 2 and not lane.walked:
                line = shapely.LineString(points)
                driven.append(shapely.buffer(line, half, cap_style="flat"))
            elif kind is None and lane.walked and len(points) >= 2:
                line = shapely.LineString(points)
                shapes.append(
                    shapely.buffer(line, half, cap_style="flat", join_style="mitre", quad_segs=3)
                )
    return shapely.difference(shapely.union_all(shapes), shapely.union_all(driven))


def crossing_lines(net: SumoNet) -> dict[str, Line]:
    """Return the middle of each crossing for people at a junction [m], shape (K, 2), by name."""
    return {
        edge.name: lane.points
        for edge in net.edges
        if edge.function == "crossing"
        for lane in edge.lanes
    }


def signalled_edges(net: SumoNet) -> tuple[str, ...]:
    """Return the streets that end at a traffic light, in the order of the file."""
    lit = dict.fromkeys(one.start for one in net.connections if one.light)
    return tuple(name for name in lit if not name.startswith(":"))


def points_of(shape: str) -> Line:
    """Return the points of a shape in a file of SUMO [m], shape (K, 2)."""
    pairs = [[float(v) for v in pair.split(",")[:2]] for pair in shape.split()]
    return np.array(pairs, np.float64).reshape(-1, 2)


def _line(points: Line) -> Line:
    """Return the points of a lane, at least two, without those that lie on their neighbours."""
    kept = [points[0]]
    for point in points[1:]:
        if np.abs(point - kept[-1]).max() > _SHORTEST:
            kept.append(point)
    if len(kept) == 1:
        kept.append(points[-1] + [_SHORTEST, 0.0])
    return np.array(kept, np.float64)


def joined(parts: list[Line]) -> tuple[Line, NDArray[np.int32]]:
    """Return lines one after the other, and where each begins, and at last their number."""
    first = np.cumsum([0, *(len(part) for part in parts)]).astype(np.int32)
    return np.concatenate([np.zeros((0, 2)), *parts]), first
