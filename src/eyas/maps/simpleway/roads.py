"""The roads of the simple maps: sixteen side by side, with a turning loop at each end."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode
from eyas.engine.world.build.millimetres import rounded, unit
from eyas.lanes import exact

# `network.npz` here names the nodes and edges of `road_graph`;
# `traffic*.npz` index the network's edges. Other names or another order make all anew.
NAME = "simpleway"

ROADS = 16
ROAD_WIDTH = 12.0  # Four lanes of 3 m

_APART = (340.0, 400.0)  # Least and largest distance from one road to the next [m]
_LENGTH = (2576.0, 2612.0)
_LEAN = 14.0  # Largest distance of a road's ends from its mean line [m]

_LOOP, _HALF = 42.0, 9.0
"""Length of a turning loop up to its round end, and half its inner width [m]."""
_LOOP_SPEED = 7.5  # [m/s]

Points = NDArray[np.float64]


def road_lines(seed: int) -> Points:
    """Return the south and the north end of each road, from the west, shape (16, 2, 2) [m]."""
    rng = stream(seed, "simpleway roads")
    gaps = rng.uniform(*_APART, ROADS - 1)
    middle = np.append(0.0, gaps.cumsum()) - gaps.sum() / 2
    length, shift = rng.uniform(*_LENGTH, ROADS), rng.uniform(-20.0, 20.0, ROADS)
    x = middle[:, None] + rng.uniform(-_LEAN, _LEAN, (ROADS, 2))
    y = shift[:, None] + length[:, None] * [-0.5, 0.5]
    return rounded(np.stack([x, y], axis=2))


def road_graph(seed: int) -> RoadGraph:
    """Return the roads, which never meet: at each end a loop leads back."""
    nodes: list[RoadNode] = []
    edges: list[RoadEdge] = []
    for index, (south, north) in enumerate(road_lines(seed)):
        low, high = f"{index:02d}S", f"{index:02d}N"
        edges += [_edge(low, high), _edge(high, low)]
        for name, end, other in ((low, south, north), (high, north, south)):
            far, top, there, back = name, f"{name}T", *_loop(end, unit(end - other))
            nodes += [RoadNode(far, *end.tolist()), RoadNode(top, *there[-1].tolist())]
            edges += [_edge(far, top, there), _edge(top, far, back)]
    return RoadGraph(NAME, seed, tuple(nodes), tuple(edges))


def is_loop(edge: str) -> bool:
    """Return whether an edge, by its name, is half of a turning loop."""
    return "T" in edge


def _edge(start: str, end: str, shape: Points | None = None) -> RoadEdge:
    points = () if shape is None else tuple((float(x), float(y)) for x, y in shape)
    speed = 13.89 if shape is None else _LOOP_SPEED
    name = f"{start}-{end}"
    return RoadEdge(name, start, end, lane_width=ROAD_WIDTH / 4, speed=speed, shape=points)


def _loop(end: Points, onwards: Points) -> tuple[Points, Points]:
    """Return the inner edge of a loop: from the end of a road to its top, and back [m]."""
    share = np.linspace(0.0, 1.0, 13)
    side = np.stack([_LOOP * share, _HALF * np.square(share) * (3.0 - 2.0 * share)], axis=1)
    angle = np.linspace(0.0, np.pi / 2, 9)[1:]
    top = np.stack([_LOOP + _HALF * exact.sin(angle), _HALF * exact.cos(angle)], axis=1)
    right = np.concatenate([side, top])
    rightwards = np.array([onwards[1], -onwards[0]])
    there, back = (
        rounded(end + along[:, :1] * onwards + sign * along[:, 1:] * rightwards)
        for along, sign in ((right, 1.0), (right[::-1], -1.0))
    )
    return there, back
