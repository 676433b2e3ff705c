"""Roads: the graph that a recipe draws, and the network that SUMO's netconvert builds from it."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["RoadEdge", "RoadGraph", "RoadNetwork", "RoadNode"]


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


@dataclass(slots=True)
class RoadNetwork:
    """Roads in the world frame, z = 0. L lanes with P points, J junctions with Q corners."""

    graph_hash: str
    """Hash of the road graph it was built from."""
    builder: str
    """Program and version that built it, for example `netconvert 1.28.0`."""
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
    """0 is the rightmost lane of its edge, shape (L,)."""
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
