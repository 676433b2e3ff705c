"""The roads of the village: a polygonal loop, cut by inner roads into five blocks."""

from itertools import pairwise

import numpy as np

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode

# `network.npz` and `signals.npz` here name the nodes and edges of `road_graph`;
# `traffic*.npz` index the network's edges. Other names or another order make all anew.
NAME = "village"

_NODES: dict[str, tuple[float, float]] = {
    # The loop, counter-clockwise from the south-west.
    "o1": (-228.0, -296.0),
    "o2": (-62.0, -309.0),
    "o3": (108.0, -288.0),
    "o4": (238.0, -232.0),
    "o5": (288.0, -88.0),
    "o6": (270.0, 74.0),
    "o7": (288.0, 204.0),
    "o8": (186.0, 294.0),
    "o9": (36.0, 309.0),
    "o10": (-112.0, 280.0),
    "o11": (-240.0, 252.0),
    "o12": (-294.0, 136.0),
    "o13": (-288.0, -14.0),
    "o14": (-294.0, -176.0),
    # Across the valley from west to east.
    "w1": (-176.0, 34.0),
    "w2": (-40.0, 72.0),
    "w3": (96.0, 44.0),
    # To the south, beside the lake.
    "s1": (-42.0, -72.0),
    "s2": (-76.0, -188.0),
    # To the north.
    "n1": (44.0, 176.0),
    # To the east.
    "e1": (118.0, -116.0),
}
"""Nodes of the canonical village [m]."""

_WAYS = (
    ("o1", "o2", "o3", "o4", "o5", "o6", "o7", "o8", "o9", "o10", "o11", "o12", "o13", "o14", "o1"),
    ("o13", "w1", "w2", "w3", "o6"),
    ("w2", "s1", "s2", "o2"),
    ("w3", "n1", "o9"),
    ("s1", "e1", "o5"),
)
"""The loop, and the inner roads."""

_LANES, _LANE_WIDTH = 2, 3.0
_STRETCH = 0.06  # Most by which another seed is longer or shorter along each axis, as a share
_SHIFT = 13.0  # Most by which a node of another seed is moved along each axis [m]


def road_graph(seed: int) -> RoadGraph:
    """Return the roads: eight T junctions, the rest bends.

    Seed 0 is the canonical village; other seeds move its nodes, and some mirror it.
    """
    rng = stream(seed, "village roads")
    points = np.array(list(_NODES.values()))
    if seed:
        points *= rng.uniform(1 - _STRETCH, 1 + _STRETCH, 2)
        points += rng.uniform(-_SHIFT, _SHIFT, points.shape)
        points[:, 0] *= rng.choice((-1.0, 1.0))
    points = np.round(points, 3)
    nodes = [
        RoadNode(name, float(x), float(y)) for name, (x, y) in zip(_NODES, points, strict=True)
    ]
    links = [link for way in _WAYS for link in pairwise(way)]
    both = sorted(pair for a, b in links for pair in ((a, b), (b, a)))
    edges = [
        RoadEdge(f"{start}-{end}", start, end, lanes=_LANES, lane_width=_LANE_WIDTH)
        for start, end in both
    ]
    return RoadGraph(NAME, seed, tuple(nodes), tuple(edges))
