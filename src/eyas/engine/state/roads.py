"""Roads: the graph that a recipe draws, and the network that SUMO's netconvert builds from it."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

FARTHEST = 1e5
"""Largest coordinate on a map [m]."""


@dataclass(frozen=True, slots=True)
class RoadNode:
    """A place where roads meet or end."""

    name: str
    x: float
    """East [m]."""
    y: float
    """North [m]."""


@dataclass(frozen=True, slots=True)
class RoadEdge:
    """One direction of a road."""

    name: str
    start: str
    """Name of the node it leaves."""
    end: str
    """Name of the node it reaches."""
    lanes: int = 2
    lane_width: float = 3.5
    """[m]"""
    speed: float = 13.89
    """Speed limit [m/s]."""
    shape: tuple[tuple[float, float], ...] = ()
    """Points between the nodes (x, y) [m]; empty for a straight road."""


@dataclass(frozen=True, slots=True)
class RoadGraph:
    """The road graph that a map recipe draws: the input of SUMO's netconvert."""

    map_name: str
    seed: int
    nodes: tuple[RoadNode, ...]
    edges: tuple[RoadEdge, ...]
    finished: bytes = field(default=b"", repr=False)
    """SUMO's network file, for roads that no recipe has drawn; nodes and edges are empty then."""
    left_hand: bool = False
    """Whether traffic keeps left, so that the lanes of an edge are on the left of its line; of
    finished roads their file says it."""


def kept_left(graph: RoadGraph) -> RoadGraph:
    """Return the drawn roads of a graph with traffic that keeps left.

    Each edge runs the other way: so the asphalt stays where it is, also that of one-way roads,
    whose line is a kerb, and a ring is driven round clockwise.
    """
    edges = []
    for edge in graph.edges:
        usual = edge.name == f"{edge.start}-{edge.end}"
        name = f"{edge.end}-{edge.start}" if usual else edge.name
        edges.append(
            replace(edge, name=name, start=edge.end, end=edge.start, shape=edge.shape[::-1])
        )
    name = f"{graph.map_name}{LEFT_ENDING}"
    return replace(graph, map_name=name, edges=tuple(edges), left_hand=True)


@dataclass(slots=True)
class RoadNetwork:
    """Roads in the world frame, z = 0. L lanes with P points, J junctions with Q corners."""

    graph_hash: str
    """Hash of the road graph it was built from."""
    builder: str
    """Program and version that built it, for example `netconvert 1.28.0`; ends with `LEFT_HAND`
    where traffic keeps left."""
    lane_points: NDArray[np.float64]
    """Centre lines of the lanes, concatenated [m], shape (P, 2)."""
    lane_first: NDArray[np.int32]
    """Start of each lane in `lane_points`, shape (L + 1,)."""
    lane_width: NDArray[np.float64]
    """[m], shape (L,)."""
    lane_speed: NDArray[np.float64]
    """Speed limit [m/s], shape (L,)."""
    lane_edge: NDArray[np.int32]
    """Index into `edges` of each lane, shape (L,)."""
    lane_index: NDArray[np.int32]
    """0 is the lane of its edge at the kerb, shape (L,)."""
    edges: tuple[str, ...]
    """Names of the edges, as in the graph."""
    edge_start: tuple[str, ...]
    """Node each edge leaves."""
    edge_end: tuple[str, ...]
    """Node each edge reaches."""
    junction_points: NDArray[np.float64]
    """Corners of the junction polygons, concatenated [m], shape (Q, 2)."""
    junction_first: NDArray[np.int32]
    """Start of each polygon in `junction_points`, shape (J + 1,)."""
    junctions: tuple[str, ...]
    """Names of the junctions: the graph's nodes."""

    @property
    def left_hand(self) -> bool:
        """Whether traffic keeps left."""
        return self.builder.endswith(LEFT_HAND)


LEFT_ENDING = "-left"
"""End of the name of a generated map on which traffic keeps left."""

LEFT_HAND = ", left-hand"
"""End of `RoadNetwork.builder`: a field of its own would change the files of all networks."""

_WIDEST, _FASTEST, _MOST_LANES = 100.0, 200.0, 100  # [m], [m/s]: larger ones are mistakes


def network_problems(network: RoadNetwork) -> Iterator[str]:
    """Yield what is wrong with a network that someone else has made; the indices of one without
    problems can be used.
    """
    lanes, edges = len(network.lane_width), len(network.edges)
    counts = {
        "lane_speed": lanes, "lane_edge": lanes, "lane_index": lanes,
        "edge_start": edges, "edge_end": edges,
    }  # fmt: skip
    for name, count in counts.items():
        if len(getattr(network, name)) != count:
            yield f"'{name}' has {len(getattr(network, name))} rows, not {count}"
    for kind, count, fewest in (("lane", lanes, 2), ("junction", len(network.junctions), 0)):
        points = getattr(network, f"{kind}_points")
        first = getattr(network, f"{kind}_first").astype(np.int64)
        if points.shape[1] != 2 or not (np.abs(points) <= FARTHEST).all():
            yield f"'{kind}_points' are not all within {FARTHEST / 1000:g} km of the middle"
        whole = len(first) == count + 1 and first[0] == 0 and first[-1] == len(points)
        if not whole or (np.diff(first) < fewest).any():
            yield f"'{kind}_first' does not divide the {len(points)} points"
    for name, low, high in (
        ("lane_width", 0.01, _WIDEST), ("lane_speed", 0.0, _FASTEST),
        ("lane_edge", 0, edges - 1), ("lane_index", 0, _MOST_LANES),
    ):  # fmt: skip
        wrong = getattr(network, name)
        wrong = wrong[~((wrong >= low) & (wrong <= high))]
        if len(wrong):
            yield f"'{name}': {wrong[0]:.6g} is not allowed: {low:g} to {high:g}"
    lost = {*network.edge_start, *network.edge_end} - set(network.junctions)
    if lost:
        yield f"the junction {min(lost)!r:.80} is not there"
