"""The roads of the lake district: a grid of long blocks, two main roads, winding streets."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode
from eyas.engine.world.build.millimetres import rounded
from eyas.lanes import exact

# `network.npz` here names the nodes and edges of `road_graph`;
# `traffic*.npz` index the network's edges. Other names or another order make all anew.
NAME = "lake"

COLUMNS, ROWS = 11, 3  # Blocks of the grid, from west to east and from south to north

_COLUMN, _ROW = 78.0, 215.0  # Mean distances between the streets of the grid [m]
_SOUTH_WEST = (-420.0, -640.0)  # Corner of the grid [m]
_WEST, _EAST, _NORTH = -620.0, 870.0, 815.0
"""The main road, and the outer roads in the east and north [m]."""
_MIDDLE = 400.0  # Height of the road through the north [m]
_STEPS = 9  # Points of a winding street

_MAIN, _STREET, _LANE = (2, 3.5), (1, 4.0), (1, 3.5)
"""Lanes in each direction and their width: main roads, streets, winding streets [m]."""

Kind = tuple[int, float]


@dataclass(frozen=True, slots=True)
class Lattice:
    """The streets of the grid."""

    x: NDArray[np.float64]  # Roads that run north, from the west, shape (COLUMNS + 1,) [m]
    y: NDArray[np.float64]  # Roads that run east, from the south, shape (ROWS + 1,) [m]
    double: tuple[int, int]  # Column and row of the western half of the block that is twice as wide


def lattice(seed: int) -> Lattice:
    """Return the grid of a seed; seed 0 is the canonical one."""
    columns, rows, double = np.full(COLUMNS, _COLUMN), np.full(ROWS, _ROW), (8, 1)
    if seed:
        rng = stream(seed, "lake grid")
        columns = np.round(rng.uniform(72.0, 84.0, COLUMNS))
        rows = np.round(rng.uniform(204.0, 226.0, ROWS))
        double = (int(rng.integers(1, COLUMNS - 2)), int(rng.integers(ROWS)))
    west, south = _SOUTH_WEST
    return Lattice(
        west + np.append(0.0, columns.cumsum()), south + np.append(0.0, rows.cumsum()), double
    )


@dataclass(slots=True)
class _Draft:
    """Nodes and links so far."""

    at: dict[str, tuple[float, float]] = field(default_factory=dict)
    edges: list[RoadEdge] = field(default_factory=list)

    def link(self, one: str, other: str, kind: Kind, bends: tuple[float, ...] = ()) -> None:
        """Add both directions of a road; `bends` is how far it swings left and right [m]."""
        line = _winding(np.array(self.at[one]), np.array(self.at[other]), bends)
        for start, end, points in ((one, other, line), (other, one, line[::-1])):
            shape = tuple((float(x), float(y)) for x, y in points)
            lanes, width = kind
            self.edges.append(
                RoadEdge(f"{start}-{end}", start, end, lanes, width, shape=shape if bends else ())
            )


def _winding(
    start: NDArray[np.float64], end: NDArray[np.float64], bends: tuple[float, ...]
) -> NDArray[np.float64]:
    """Return a line that swings aside by each of the bends in turn, shape (K, 2) [m]."""
    if not bends:
        return np.stack([start, end])
    along = end - start
    left = np.array([-along[1], along[0]]) / exact.hypot(*along)
    share = np.linspace(0.0, 1.0, _STEPS * len(bends))
    part = np.minimum((share * len(bends)).astype(int), len(bends) - 1)
    swing = np.array(bends)[part] * np.square(exact.sin(np.pi * (share * len(bends) - part)))
    return rounded(start + share[:, None] * along + swing[:, None] * left)


def road_graph(seed: int) -> RoadGraph:
    """Return the roads, all of them two-way and none of them a dead end."""
    draft, grid = _Draft(), lattice(seed)
    _add_grid(draft, grid)
    _add_north(draft, grid, stream(seed, "lake roads"))
    nodes = tuple(RoadNode(name, *place) for name, place in sorted(draft.at.items()))
    return RoadGraph(NAME, seed, nodes, tuple(sorted(draft.edges, key=lambda edge: edge.name)))


def _crossing(column: int, row: int) -> str:
    return f"{'ABCDEFGHIJKL'[column]}{row + 1}"


def _add_grid(draft: _Draft, grid: Lattice) -> None:
    """Add the grid and the main road on its west side."""
    for j, y in enumerate(grid.y):
        draft.at[f"W{j + 1}"] = (_WEST, float(y))
        for i, x in enumerate(grid.x):
            draft.at[_crossing(i, j)] = (float(x), float(y))
    hidden = (grid.double[0] + 1, grid.double[1])
    for j in range(ROWS + 1):
        # Where a road only turns, its lanes go on.
        draft.link(f"W{j + 1}", _crossing(0, j), _STREET if j else _MAIN)
        for i in range(COLUMNS):
            draft.link(_crossing(i, j), _crossing(i + 1, j), _STREET)
    for j in range(ROWS):
        draft.link(f"W{j + 1}", f"W{j + 2}", _MAIN)
        for i in range(COLUMNS + 1):
            if (i, j) != hidden:
                draft.link(_crossing(i, j), _crossing(i, j + 1), _STREET)


def _add_north(draft: _Draft, grid: Lattice, rng: np.random.Generator) -> None:
    """Add the diagonal, the outer roads and, in the north-west, the winding streets."""
    top = float(grid.y[-1])
    x = grid.x
    across = float(x[9]) + (_MIDDLE - top) / (_NORTH - top) * (_EAST - 90.0 - float(x[9]))
    draft.at |= {
        "WM": (_WEST, _MIDDLE), "WN": (_WEST, _NORTH), "FM": (float(x[5]), _MIDDLE),
        "FN": (float(x[5]), _NORTH), "IM": (float(x[8]) - 40.0, _MIDDLE),
        "IN": (float(x[8]) - 40.0, _NORTH), "DM": (round(across, 3), _MIDDLE),
        "DN": (_EAST - 90.0, _NORTH), "XN": (_EAST, _NORTH), "XM": (_EAST, _MIDDLE),
        "X4": (_EAST, top),
        "V1": (-440.0, 205.0), "V2": (-235.0, 190.0), "V3": (-250.0, 560.0), "V4": (-450.0, 610.0),
        "VA": (-420.0, _MIDDLE), "VB": (-250.0, _MIDDLE),
    }  # fmt: skip
    last = ROWS + 1
    mains = [("W4", "WM"), ("WM", "WN"), ("WN", "FN"), (f"J{last}", "DM"), ("DM", "DN")]
    for pair in mains:
        draft.link(*pair, _MAIN)
    straight = [("FN", "IN"), ("IN", "DN"), ("DN", "XN"), ("XN", "XM"), ("XM", "X4"),
                (f"L{last}", "X4"),
                ("WM", "VA"), ("VA", "VB"), ("VB", "FM"), ("FM", "IM"), ("IM", "DM"), ("DM", "XM"),
                ("FM", "FN"), ("IM", "IN"), (f"F{last}", "FM")]  # fmt: skip
    for pair in straight:
        draft.link(*pair, _STREET)
    winding = [(f"A{last}", "V1"), ("V1", "VA"), ("V1", "V2"), (f"C{last}", "V2"), ("V2", "VB"),
               ("VA", "V4"), ("V4", "V3"), ("VB", "V3"), (f"I{last}", "IM")]  # fmt: skip
    for pair in winding:
        swings = rng.uniform(9.0, 17.0, 2) * rng.choice([-1.0, 1.0])
        draft.link(*pair, _LANE, (float(swings[0]), -float(swings[1])))
