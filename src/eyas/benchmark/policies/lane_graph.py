"""The lanes of a map as points with successors, on which hidden vehicles are followed."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.lanes import exact

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

SPACING = 2.0  # Distance of neighbouring points [m]
_ALIKE = 0.8  # Largest angle between the heading of a vehicle and that of its lane [rad]


class LaneGraph(NamedTuple):
    """Points along the lanes, and along the ways over junctions from lane to lane; P points."""

    place: Floats  # East and north [m], shape (P, 2)
    heading: Floats  # Heading of the lane [rad], shape (P,)
    speed: Floats  # Speed limit [m/s], shape (P,)
    after: Integers
    """Points that follow, the straightest first; each row is filled up by repeating them, shape
    (P, S)."""


class Lanes:
    """The lanes of the maps of N drones, joined into one graph, so that one index tells a point.

    Attributes:
        graph: All lanes.

    Args:
        networks: The roads around each drone, N; the same object where they share a map.
    """

    def __init__(self, networks: Sequence[RoadNetwork]) -> None:
        maps = {id(roads): roads for roads in networks}
        parts, begin = list(map(lane_graph, maps.values())), 0
        width = max(part.after.shape[1] for part in parts)
        spans, after = {}, []
        for key, part in zip(maps, parts, strict=True):
            spans[key] = slice(begin, begin + len(part.place))
            missing = ((0, 0), (0, width - part.after.shape[1]))
            after.append(np.pad(part.after + begin, missing, "wrap"))
            begin = spans[key].stop
        place, heading, speed = (
            np.concatenate(each) for each in list(zip(*parts, strict=True))[:3]
        )
        self.graph = LaneGraph(place, heading, speed, np.concatenate(after))
        self._spans = [spans[id(roads)] for roads in networks]

    def evaluated(self, tell: Callable[[int, Floats], NDArray[np.bool_]]) -> NDArray[np.bool_]:
        """Return the values of a function at all points, shape (P,).

        Args:
            tell: Function of the number of a drone and of places around it, shape (M, 2).
        """
        answer = np.zeros(len(self.graph.place), np.bool_)
        for span, row in {(one.start, one.stop): k for k, one in enumerate(self._spans)}.items():
            answer[slice(*span)] = tell(row, self.graph.place[slice(*span)])
        return answer

    def near(self, row: int, place: Floats, heading: float | None, reach: float = 8.0) -> Integers:
        """Return the points of lanes where a vehicle may be, the nearest first; maybe none.

        Args:
            place: East and north [m], shape (2,).
            heading: Of the vehicle [rad]; None: nobody knows.
            reach: Largest distance [m].
        """
        span = self._spans[row]
        offset = self.graph.place[span] - place
        distance = exact.hypot(offset[:, 0], offset[:, 1])
        fits = distance < reach
        if heading is not None:
            turned = np.abs(self.graph.heading[span] - heading) % (2.0 * np.pi)
            fits &= np.minimum(turned, 2.0 * np.pi - turned) < _ALIKE
        found = np.flatnonzero(fits)
        order: Integers = found[np.argsort(distance[found], kind="stable")] + span.start
        return order


def lane_graph(network: RoadNetwork) -> LaneGraph:
    """Return the lanes of a map, joined at the junctions: a lane goes on in the lane with the same
    number of each edge that leaves the junction, and turns back only in a dead end.
    """
    lanes = [
        _spaced(network.lane_points[first:last])
        for first, last in zip(network.lane_first[:-1], network.lane_first[1:], strict=True)
    ]
    first = np.cumsum([0, *map(len, lanes)])
    pieces = list(lanes)
    speeds = [np.full(len(own), v) for own, v in zip(lanes, network.lane_speed, strict=True)]
    follows: dict[int, list[int]] = {}
    count = int(first[-1])
    for lane, own in enumerate(lanes):
        ends, ways = int(first[lane + 1]) - 1, []
        for other in _next_lanes(network, lane):
            way = _spaced(np.stack((own[-1], lanes[other][0])))[1:-1]
            begin, target = int(first[other]), int(first[other])
            if len(way):
                begin = count
                follows[count + len(way) - 1] = [target]
                pieces.append(way)
                speeds.append(np.full(len(way), network.lane_speed[lane]))
                count += len(way)
            ways.append((_turn(own, lanes[other]), begin))
        follows[ends] = [begin for _, begin in sorted(ways)] or [ends]
    place = np.concatenate(pieces)
    width = max(map(len, follows.values()))
    after = np.repeat(np.arange(1, count + 1)[:, None], width, axis=1)
    for point, found in follows.items():
        after[point] = np.resize(found, width)
    along = place[after[:, 0]] - place
    heading = exact.atan2(along[:, 1], along[:, 0])
    dead = after[:, 0] == np.arange(count)
    heading[dead] = heading[np.maximum(np.flatnonzero(dead) - 1, 0)]
    return LaneGraph(place, heading, np.concatenate(speeds), after)


def _spaced(line: Floats) -> Floats:
    """Return points along a line, its ends among them, about `SPACING` apart."""
    step = np.diff(line, axis=0)
    way = np.concatenate(([0.0], np.cumsum(exact.hypot(step[:, 0], step[:, 1]))))
    number = max(round(float(way[-1]) / SPACING), 1) + 1
    at = np.linspace(0.0, way[-1], number)
    return np.stack((np.interp(at, way, line[:, 0]), np.interp(at, way, line[:, 1])), axis=1)


def _next_lanes(network: RoadNetwork, lane: int) -> list[int]:
    edge = int(network.lane_edge[lane])
    node, back = network.edge_end[edge], network.edge_start[edge]
    leaving = [each for each, start in enumerate(network.edge_start) if start == node]
    onward = [each for each in leaving if network.edge_end[each] != back] or leaving
    found = []
    for each in onward:
        own = np.flatnonzero(network.lane_edge == each)
        number = min(int(network.lane_index[lane]), int(network.lane_index[own].max()))
        found.append(int(own[network.lane_index[own] == number][0]))
    return found


def _turn(one: Floats, other: Floats) -> float:
    """Return the angle between the end of a line and the begin of another [rad]."""
    out, back = one[-1] - one[-2], other[1] - other[0]
    cross = out[0] * back[1] - out[1] * back[0]
    return abs(float(exact.atan2(cross, exact.dot(out, back))))
