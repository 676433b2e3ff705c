"""Which lane is at a place: a picture of the lanes from above."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.traffic.network import crossings
from eyas.lanes import exact

_CELL = 0.5  # Side of a cell [m]

_SHARE = 0.85  # Share of its width for which a lane is painted: its border belongs to none


class LaneMap:
    """The lanes of a network, painted into cells.

    Attributes:
        edge: Edge of each lane, see `RoadNetwork.lane_edge`, shape (L,).
        index: See `RoadNetwork.lane_index`, shape (L,).
    """

    def __init__(self, network: RoadNetwork) -> None:
        self.edge: Final = network.lane_edge
        self.index: Final = network.lane_index
        self._network = network
        self._crossings = crossings(zip(network.edge_start, network.edge_end, strict=True))
        points = network.lane_points
        self._low = points.min(axis=0) - 10.0
        columns, rows = ((points.max(axis=0) + 10.0 - self._low) / _CELL).astype(int) + 1
        self._cells = np.full((int(rows), int(columns)), -1, np.int32)
        for lane in range(len(network.lane_width)):
            span = slice(*network.lane_first[lane : lane + 2].tolist())
            row, column = self._cell(*_strip(points[span], float(network.lane_width[lane])).T)
            self._cells[row, column] = lane

    def at(self, x: NDArray[np.floating], y: NDArray[np.floating]) -> NDArray[np.int32]:
        """Return the lane at places [m], -1 where there is none, as within junctions."""
        row, column = self._cell(x.astype(np.float64), y.astype(np.float64))
        rows, columns = self._cells.shape
        inside = (row >= 0) & (column >= 0) & (row < rows) & (column < columns)
        found: NDArray[np.int32] = self._cells[
            np.where(inside, row, 0), np.where(inside, column, 0)
        ]
        return np.where(inside, found, -1).astype(np.int32)

    def meets(self, lane: int, following: int) -> bool:
        """Return whether there is a choice of ways where one lane leads on to another."""
        edges = self._network
        node = edges.edge_end[self.edge[lane]]
        return node == edges.edge_start[self.edge[following]] and node in self._crossings

    def _cell(
        self, x: NDArray[np.float64], y: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the rows and columns of places [m]."""
        return (
            np.floor((y - self._low[1]) / _CELL).astype(np.int64),
            np.floor((x - self._low[0]) / _CELL).astype(np.int64),
        )


def _strip(line: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """Return points all over a strip along a line, shape (K, 2), closer than cells are."""
    along = np.diff(line, axis=0)
    length = exact.hypot(*along.T)
    pieces = np.maximum(np.ceil(length / (0.8 * _CELL)), 1).astype(np.int64)
    which = np.repeat(np.arange(len(along)), pieces)
    part = np.arange(len(which)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    middle = line[which] + along[which] * ((part + 0.5) / pieces[which])[:, None]
    left = np.stack([-along[:, 1], along[:, 0]], axis=-1) / np.maximum(length, 1e-9)[:, None]
    half = 0.5 * _SHARE * width
    aside = np.linspace(-half, half, int(width / (0.8 * _CELL)) + 2)
    spread: NDArray[np.float64] = middle[:, None] + aside[:, None] * left[which][:, None]
    return spread.reshape(-1, 2)
