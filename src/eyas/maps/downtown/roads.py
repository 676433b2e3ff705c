"""The roads of downtown: long blocks between one-way avenues, narrow streets and wide ones."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode
from eyas.lanes import exact

# `network.npz` and `signals.npz` here name the nodes and edges of `road_graph`;
# `traffic*.npz` index the network's edges. Other names or another order make all anew.
NAME = "downtown"

_ROTATION = math.radians(-29.0)
"""Direction of the streets; avenues run at a right angle to it, towards north-north-east."""
_COLUMNS = (197.0, 125.0, 178.0, 279.0, 144.0, 183.0)
"""Distances between the middles of the avenues, from west to east [m]."""
_ROWS = (83.0, 76.0, 85.0, 79.0, 75.0, 83.0, 78.0, 86.0, 77.0, 81.0, 77.0)
"""Distances between the middles of the streets, from south to north [m]."""
_MASK = """
....#.
....#.
....#.
....##
######
######
######
#####.
####..
.##...
.##...
"""
"""The blocks, north on top: what lies within the original's rectangle, without the park."""
_TWO_WAY = 3
"""Avenue with traffic both ways all along; the others have it where they are outer roads."""
_NARROW_AVENUE = (2, 5)  # Avenues of three lanes instead of four
_WIDE_STREETS = (2, 4, 7)  # Inner streets of two lanes each way; the others have one
_LANE = 3.5

Cell = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Grid:
    """The grid in its own frame: u along the streets, v along the avenues."""

    turn: float  # Direction of u [rad]
    avenues: tuple[float, ...]  # u of the middle of each avenue [m]
    streets: tuple[float, ...]  # v of the middle of each street [m]
    blocks: frozenset[Cell]  # Column and row of each block that has streets all round

    def world(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points (u, v) in the world frame, in whole millimetres, shape (K, 2) [m]."""
        cosine, sine = exact.cos(self.turn), exact.sin(self.turn)
        u, v = np.asarray(points, np.float64).T
        return np.round(np.column_stack([cosine * u - sine * v, sine * u + cosine * v]), 3)


def grid(seed: int) -> Grid:
    """Return the grid of a seed; 0 is the canonical city, others change distances and rotation."""
    rng = stream(seed, "downtown roads")
    columns, rows, turn = np.array(_COLUMNS), np.array(_ROWS), _ROTATION
    if seed:
        columns = np.round(np.clip(columns * rng.uniform(0.85, 1.15, len(columns)), 112, 304), 1)
        rows = np.round(np.clip(rows * rng.uniform(0.92, 1.06, len(rows)), 71, 90), 1)
        turn += math.radians(round(rng.uniform(-6.0, 6.0), 1))
    lines = _MASK.split()[::-1]
    blocks = frozenset(
        (i, j) for j, line in enumerate(lines) for i, c in enumerate(line) if c == "#"
    )
    plain = Grid(turn, _lines(columns), _lines(rows), blocks)
    # The net, not the grid, is centred on the floor.
    nodes = {corner for cell in blocks for corner in _corners(cell)}
    at = plain.world(np.array([[plain.avenues[i], plain.streets[j]] for i, j in sorted(nodes)]))
    x, y = (at.min(axis=0) + at.max(axis=0)) / 2
    u = round(exact.cos(turn) * x + exact.sin(turn) * y, 3)
    v = round(exact.cos(turn) * y - exact.sin(turn) * x, 3)
    avenues = tuple(round(float(a - u), 3) for a in plain.avenues)
    return Grid(turn, avenues, tuple(round(float(s - v), 3) for s in plain.streets), blocks)


def road_graph(seed: int) -> RoadGraph:
    """Return the roads around all blocks."""
    plan = grid(seed)
    links: dict[tuple[Cell, Cell], int] = {}
    for cell in plan.blocks:
        west_south, east_south, west_north, east_north = _corners(cell)
        for link in (
            (west_south, east_south),
            (west_north, east_north),
            (west_south, west_north),
            (east_south, east_north),
        ):
            links[link] = links.get(link, 0) + 1
    places = sorted({corner for link in links for corner in link})
    at = plan.world(np.array([[plan.avenues[i], plan.streets[j]] for i, j in places]))
    nodes = [RoadNode(_name(p), float(x), float(y)) for p, (x, y) in zip(places, at, strict=True)]
    edges = [edge for (a, b), sides in sorted(links.items()) for edge in _edges(plan, a, b, sides)]
    return RoadGraph(NAME, seed, tuple(nodes), tuple(edges))


def _edges(plan: Grid, start: Cell, end: Cell, sides: int) -> list[RoadEdge]:
    """Return the directions of the road between two crossings, with blocks on `sides` sides."""
    avenue = start[0] == end[0]
    if not avenue or sides == 1 or start[0] == _TWO_WAY:
        # Outer roads are wide, so that no lane ends at a corner.
        lanes = 2 if avenue or sides == 1 or start[1] in _WIDE_STREETS else 1
        return [_edge(pair, lanes) for pair in ((start, end), (end, start))]
    lanes = 3 if start[0] in _NARROW_AVENUE else 4
    # Every other one leads south. SUMO puts lanes on the right of an edge's line; this one runs
    # along the left kerb, so that the asphalt lies evenly about the middle of the avenue.
    ends = (start, end) if start[0] % 2 == 0 else (end, start)
    aside = (-0.5 if ends[0] == start else 0.5) * lanes * _LANE
    kerb = np.array([[plan.avenues[i] + aside, plan.streets[j]] for i, j in ends])
    points = tuple((float(x), float(y)) for x, y in plan.world(kerb))
    return [_edge(ends, lanes, points)]


def _edge(
    ends: tuple[Cell, Cell], lanes: int, shape: tuple[tuple[float, float], ...] = ()
) -> RoadEdge:
    start, end = (_name(place) for place in ends)
    return RoadEdge(f"{start}-{end}", start, end, lanes=lanes, lane_width=_LANE, shape=shape)


def _lines(steps: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(float(at) for at in np.round(np.append(0.0, np.cumsum(steps)), 3))


def _corners(cell: Cell) -> tuple[Cell, Cell, Cell, Cell]:
    """Return the crossings around a block: south-west, south-east, north-west, north-east."""
    i, j = cell
    return (i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)


def _name(place: Cell) -> str:
    return f"{'ABCDEFG'[place[0]]}{place[1] + 1}"
