"""The rig of people and robots, and the box in which one of them fits at a moment."""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.shipped import Block, read_block
from eyas.engine.targets.jointed.pose import BODY, PART, CycleTable, pose_figure
from eyas.engine.targets.shapes import FILE, Columns, Shapes, ShippedRig, records

_SHEARED = 1.25  # Factor by which what stays upright on a slope may be farther from its origin

Floats = NDArray[np.float64]


class JointedArrays(NamedTuple):
    """A `CycleTable` as it ships: many parts of people move alike, but for their sizes."""

    slot: Columns
    body: Columns
    scale: Floats  # Factor on the lengths of each model, shape (M,)
    track: NDArray[np.int32]  # Index into `tracks` of each slot, -1 for none, shape (M, S)
    tracks: Floats
    """Frames of a part that stands, and then through a cycle, as in `CycleTable`, shape
    (., K + 2, 4, 3)."""

    def table(self) -> CycleTable:
        """Return what the kernel reads."""
        frames = self.tracks[np.maximum(self.track, 0)] * self.scale[:, None, None, None, None]
        frames[self.track < 0] = 0.0
        cycle = np.moveaxis(frames[:, :, 1:], 1, 2)
        return CycleTable(
            slot=records(self.slot, PART),
            body=records(self.body, BODY),
            rest=frames[:, :, 0].astype(np.float32),
            cycle=np.ascontiguousarray(cycle, np.float32),
        )


class JointedRig(ShippedRig):
    """The rig of the models of one kind."""

    def __init__(self, shapes: Shapes) -> None:
        table = _table_of(shapes.table)
        super().__init__(shapes, table, pose_figure)
        self._table = table

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point of an actor may be from its reference point, see `Rig` [m]."""
        slot = self._table.slot["part"]
        size = np.linalg.norm(self._table.rest[:, :, 0].astype(np.float64), axis=-1)
        away = _farthest(self._table) + size * parts[slot]
        return float(away[slot >= 0].max())


@cache  # all rigs of a kind have the same
def _table_of(block: Block) -> CycleTable:
    return read_block(FILE, block, JointedArrays).table()


def _farthest(table: CycleTable) -> Floats:
    """Return how far the origins of parts are from the actor's, at most [m], shape (M, S)."""
    away = np.linalg.norm(table.cycle[..., 3, :].astype(np.float64), axis=-1).max(axis=1)
    still = np.linalg.norm(table.rest[..., 3, :].astype(np.float64), axis=-1)
    return np.asarray(_SHEARED * np.maximum(away, still), np.float64)


class Extents(NamedTuple):
    """The boxes of a figure: least and largest x, y and z in the model frame [m]."""

    rest: Floats  # While it stands, shape (2, 3)
    cycle: Floats
    """While it moves, at the beginnings of K intervals of a cycle and at its end,
    shape (K + 1, 2, 3)."""
    stride: float  # Distance travelled in a cycle [m]
    slowest: float  # Speed from which it moves fully [m/s]

    def at(self, travelled: float, speed: float) -> Floats:
        """Return the box at a moment, shape (2, 3).

        Parts move along straight lines within an interval, and so between standing and moving, so
        boxes that are blended like them contain them.

        Args:
            travelled: Way since it entered the world, along the ground [m].
            speed: [m/s]
        """
        cycles, intervals = travelled / self.stride, len(self.cycle) - 1
        place = (cycles - math.floor(cycles)) * intervals
        row = min(int(place), intervals - 1)
        first, second = self.cycle[row], self.cycle[row + 1]
        moving = first + (place - row) * (second - first)
        blended: Floats = self.rest + min(speed / self.slowest, 1.0) * (moving - self.rest)
        return blended


def extent_at(block: Block, name: str, travelled: float, speed: float) -> Floats:
    """Return the box of a model at a moment, see `Kind.extent`."""
    return _extents_of(block)[name].at(travelled, speed)


@cache
def _extents_of(block: Block) -> dict[str, Extents]:
    return read_block(FILE, block, dict[str, Extents])
