"""The roads of the farmland: three by three cells between straight roads."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode

# `network.npz` here names the nodes and edges of `road_graph`;
# `traffic*.npz` index the network's edges. Other names or another order make all anew.
NAME = "farmland"

ROAD_WIDTH = 16.0  # Four lanes [m]

_COLUMNS = (178.0, 158.0, 261.0)  # Distances between the roads that run north [m]
_ROWS = (214.0, 203.0, 209.0)  # Distances between the roads that run east [m]
_LEAST, _MOST = 150.0, 285.0


def road_graph(seed: int) -> RoadGraph:
    """Return the roads: 16 nodes, 24 straight links, two lanes in each direction.

    Seed 0 is the canonical farmland; other seeds change distances.
    """
    columns, rows = np.array(_COLUMNS), np.array(_ROWS)
    if seed:
        rng = stream(seed, "farmland roads")
        columns, rows = rng.permutation(columns), rng.permutation(rows)
        columns = np.clip(columns * rng.uniform(0.85, 1.15, 3), _LEAST, _MOST)
        rows = np.clip(rows * rng.uniform(0.85, 1.15, 3), _LEAST, _MOST)
    x, y = (_centred(np.round(gaps)) for gaps in (columns, rows))
    nodes = [
        RoadNode(f"{'ABCD'[i]}{j + 1}", float(x[i]), float(y[j]))
        for i in range(4)
        for j in range(4)
    ]
    ends = [(f"{'ABCD'[i]}{j}", f"{'ABCD'[i + 1]}{j}") for i in range(3) for j in range(1, 5)]
    ends += [(f"{letter}{j}", f"{letter}{j + 1}") for letter in "ABCD" for j in range(1, 4)]
    both = sorted(pair for a, b in ends for pair in ((a, b), (b, a)))
    edges = [
        RoadEdge(name=f"{start}-{end}", start=start, end=end, lane_width=ROAD_WIDTH / 4)
        for start, end in both
    ]
    return RoadGraph(NAME, seed, tuple(nodes), tuple(edges))


def _centred(gaps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the positions of roads with these distances, about the origin [m]."""
    return np.asarray(np.append(0.0, gaps.cumsum()) - gaps.sum() / 2, np.float64)
