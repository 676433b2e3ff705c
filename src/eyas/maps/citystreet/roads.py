"""The roads of the street city: a turned grid of avenues with nine blocks."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode
from eyas.lanes import exact

# `network.npz` and `signals.npz` here name the nodes and edges of `road_graph`;
# `traffic*.npz` index the network's edges. Other names or another order make all anew.
NAME = "citystreet"

_ROTATION = math.radians(40.0)
_COLUMNS = (188.0, 126.0, 184.0)  # Width of the blocks, along the streets that run north-east [m]
_ROWS = (126.0, 190.0, 178.0, 108.0)
"""Depth of the blocks, along the streets that run north-west [m]."""
_CORNERS = ((0, 0), (2, 0), (2, 3), (0, 3))
"""Blocks at the corners of the grid: one is built; the outer streets leave the others out."""
_BENDS = 7  # Number of outer streets that bend slightly in the middle
_BEND = (4.0, 9.0)  # Distance of that bend from the straight line, outwards [m]

Point = NDArray[np.float64]
Link = tuple[str, str]


def road_graph(seed: int) -> RoadGraph:
    """Return the roads: nine blocks, six crossings, four T junctions, the rest corners and bends.

    Seed 0 is the canonical city; other seeds change distances, rotation and outline.
    """
    rng = stream(seed, "citystreet roads")
    columns, rows, rotation, kept = np.array(_COLUMNS), np.array(_ROWS), _ROTATION, 0
    if seed:
        columns = np.clip(columns * rng.uniform(0.88, 1.12, 3), 105, 192)
        rows = np.clip(rows * rng.uniform(0.88, 1.12, 4), 105, 192)
        rotation += math.radians(rng.uniform(-7.0, 7.0))
        kept = int(rng.integers(4))
    missing = {corner for index, corner in enumerate(_CORNERS) if index != kept}
    blocks = [(i, j) for i in range(3) for j in range(4) if (i, j) not in missing]
    at = {
        _name(i, j): np.array([columns[:i].sum(), rows[:j].sum()])
        for i in range(4)
        for j in range(5)
    }
    links = _bent(_links(blocks), at, rng)
    return _graph(seed, at, links, rotation)


def _name(column: int, row: int) -> str:
    return f"{'ABCD'[column]}{row + 1}"


def _links(blocks: list[tuple[int, int]]) -> dict[Link, int]:
    """Return the streets around all blocks, and the number of blocks at each."""
    sides: dict[Link, int] = {}
    for i, j in blocks:
        south, north = (_name(i, j), _name(i + 1, j)), (_name(i, j + 1), _name(i + 1, j + 1))
        west, east = (_name(i, j), _name(i, j + 1)), (_name(i + 1, j), _name(i + 1, j + 1))
        for side in (south, north, west, east):
            sides[side] = sides.get(side, 0) + 1
    return sides


def _bent(sides: dict[Link, int], at: dict[str, Point], rng: np.random.Generator) -> list[Link]:
    """Return the links with an extra node in the middle of some outer streets; add it to `at`."""
    middle = np.mean([at[name] for link in sides for name in link], axis=0)
    outer = [link for link in sides if sides[link] == 1]
    bent = {outer[int(i)] for i in rng.permutation(len(outer))[:_BENDS]}
    links: list[Link] = []
    for start, end in sides:
        if (start, end) not in bent:
            links.append((start, end))
            continue
        along = at[end] - at[start]
        outwards = np.array([-along[1], along[0]]) / exact.length(along)
        half = at[start] + rng.uniform(0.42, 0.58) * along
        outwards *= np.sign(exact.product(outwards, half - middle))
        name = f"{start}{end}"
        at[name] = half + rng.uniform(*_BEND) * outwards
        links += [(start, name), (name, end)]
    return links


def _graph(seed: int, at: dict[str, Point], links: list[Link], rotation: float) -> RoadGraph:
    names = sorted({name for link in links for name in link})
    turn = np.array(
        [[exact.cos(rotation), -exact.sin(rotation)], [exact.sin(rotation), exact.cos(rotation)]]
    )
    points = exact.product(np.array([at[name] for name in names]), turn.T)
    points -= (points.min(axis=0) + points.max(axis=0)) / 2
    # In millimetres: the last bits of sines differ between processors.
    nodes = [
        RoadNode(name, round(float(x), 3), round(float(y), 3))
        for name, (x, y) in zip(names, points, strict=True)
    ]
    both = sorted(pair for a, b in links for pair in ((a, b), (b, a)))
    edges = [RoadEdge(name=f"{start}-{end}", start=start, end=end) for start, end in both]
    return RoadGraph(NAME, seed, tuple(nodes), tuple(edges))
