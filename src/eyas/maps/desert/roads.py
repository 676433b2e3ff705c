"""The roads of the desert: a rounded square, and two S-curved roads that meet in its middle."""

import math

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode
from eyas.engine.world.build.millimetres import rounded
from eyas.engine.world.roads.curves import arc
from eyas.lanes import exact

# `network.npz` and `signals.npz` here name the nodes and edges of `road_graph`;
# `traffic*.npz` index the network's edges. Other names or another order make all anew.
NAME = "desert"

CORNER = 50.0  # Radius of the rounded corners [m]

_SIZE = (543.0, 626.0)  # Extent of the middle of the outer road [m]
_JUNCTIONS = {"W": (-1.0, 0.36), "S": (-0.36, -1.0), "E": (1.0, -0.36), "N": (0.36, 1.0)}
"""Where the inner roads leave the outer one, as shares of half its extent."""
_CROSSING = math.radians(-52.0)
"""Direction of the road from west to east where it crosses the other at right angles [rad]."""
_REACH = (0.42, 0.36)
"""How far an inner road keeps its direction at its outer end and in the middle, as a share of the
distance between the two."""
_STEP = 9.0  # Distance between two points of a curve [m]

_LANES, _LANE_WIDTH = 2, 4.0
_STRETCH, _SLIDE, _TURN = 0.07, 0.14, math.radians(14.0)
"""Most by which another seed stretches the square and slides the junctions, as shares, and turns
the crossing [rad]."""

Points = NDArray[np.float64]


def road_graph(seed: int) -> RoadGraph:
    """Return the roads: four T junctions on the outer road, and a crossing in the middle.

    Seed 0 is the canonical desert; other seeds have other proportions, and some are mirrored.
    """
    rng = stream(seed, "desert roads")
    half, crossing, mirror = 0.5 * np.array(_SIZE), _CROSSING, 1.0
    share = {name: np.array(place) for name, place in _JUNCTIONS.items()}
    if seed:
        half = half * rng.uniform(1 - _STRETCH, 1 + _STRETCH, 2)
        crossing += rng.uniform(-_TURN, _TURN)
        mirror = float(rng.choice((-1.0, 1.0)))
        for place in share.values():
            place += np.where(np.abs(place) < 1.0, rng.uniform(-_SLIDE, _SLIDE), 0.0)
    at = {name: place * half for name, place in share.items()} | {"C": np.zeros(2)}
    roads = {(a, b): _outer(at[a], at[b], half) for a, b in ("WS", "SE", "EN", "NW")}
    for name, inwards in (("W", (1.0, 0.0)), ("S", (0.0, 1.0)), ("E", (-1.0, 0.0)), ("N", (0, -1))):
        onwards = crossing + {"W": 0.0, "S": 0.5, "E": 1.0, "N": 1.5}[name] * math.pi
        roads[name, "C"] = _inner(at[name], np.array(inwards, np.float64), onwards)
    return _graph(seed, at, roads, np.array([mirror, 1.0]))


def _outer(start: Points, end: Points, half: Points) -> Points:
    """Return the outer road from one junction to the next around a corner, without its ends."""
    level = abs(abs(start[1]) - half[1]) < 1e-9
    corner = np.array([end[0], start[1]] if level else [start[0], end[1]])
    line = shapely.LineString(np.concatenate([[start], arc(start, corner, end, CORNER), [end]]))
    # netconvert cuts a road off at the last point before a junction, so points must be close.
    return rounded(shapely.get_coordinates(shapely.segmentize(line, 2 * _STEP)))[1:-1]


def _inner(start: Points, inwards: Points, onwards: float) -> Points:
    """Return a road from a junction to the middle, without its ends."""
    reach = math.sqrt(np.square(start[0]) + np.square(start[1]))
    arrive = np.array([exact.cos(onwards), exact.sin(onwards)])
    one, other = start + _REACH[0] * reach * inwards, -_REACH[1] * reach * arrive
    t = np.linspace(0.0, 1.0, int(reach / _STEP) + 1)[1:-1, None]
    return rounded(
        exact.power(1 - t, 3) * start
        + 3 * t * np.square(1 - t) * one
        + 3 * np.square(t) * (1 - t) * other
    )


def _graph(
    seed: int, at: dict[str, Points], roads: dict[tuple[str, str], Points], mirror: Points
) -> RoadGraph:
    nodes = [
        RoadNode(name, *(round(float(v), 3) for v in mirror * place)) for name, place in at.items()
    ]
    edges = []
    for (a, b), line in roads.items():
        there = [(float(x), float(y)) for x, y in mirror * line]
        for start, end, shape in ((a, b, there), (b, a, there[::-1])):
            name = f"{start}-{end}"
            edges.append(
                RoadEdge(name, start, end, _LANES, lane_width=_LANE_WIDTH, shape=tuple(shape))
            )
    return RoadGraph(NAME, seed, tuple(nodes), tuple(edges))
