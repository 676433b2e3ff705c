"""Street lamps that may light a point: a list for each square of a grid."""

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.render.kernels.bundles import LampFrame
from eyas.state.scene import Lamps

__all__ = ["lamp_grid"]

CELL = 8.0
"""Side of a square [m]."""

REACH = 32.0
"""Distance beyond which a lamp's light is negligible [m]: below 1/400 of that under it."""

MOST = 8
"""Length of the longest list."""


def lamp_grid(
    lamps: Lamps, cell: float = CELL
) -> tuple[NDArray[np.float32], NDArray[np.int32], LampFrame]:
    """Return `Light.lamp`, `Light.lamp_cell` and `Light.lamp_frame`.

    Args:
        lamps: L lamps.
        cell: Side of a square [m].
    """
    count = len(lamps.position)
    strength = np.full((count, 1), lamps.intensity / PAPER, np.float32)
    nothing = np.zeros((count, 1), np.float32)  # eight numbers, so that lanes can be loaded
    lamp = np.concatenate([lamps.position, lamps.axis, strength, nothing], axis=1)
    lamp = lamp.astype(np.float32)
    cut_off = float(exact.cos(lamps.cut_off))
    if count == 0:
        return lamp, np.full((0, 0, 1), -1, np.int32), _frame(0.0, 0.0, cell, cut_off)
    low = lamps.position[:, :2].min(axis=0).astype(np.float64) - REACH
    high = lamps.position[:, :2].max(axis=0).astype(np.float64) + REACH
    columns, rows = np.ceil((high - low) / cell).astype(int)
    middle = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1) + 0.5
    apart = np.linalg.norm((low + cell * middle)[:, :, None] - lamps.position[:, :2], axis=3)
    order = np.argsort(apart, axis=2, kind="stable")[:, :, :MOST]
    near = np.take_along_axis(apart, order, axis=2) < REACH + cell * np.sqrt(0.5)
    cells = np.where(near, order, -1).astype(np.int32)
    return lamp, np.ascontiguousarray(cells), _frame(low[0], low[1], cell, cut_off)


def _frame(west: float, south: float, cell: float, cut_off: float) -> LampFrame:
    numbers = np.array([west, south, 1 / cell, cut_off], np.float32)
    return LampFrame(numbers[0], numbers[1], numbers[2], numbers[3])


PAPER = 1.05
"""Intensity over squared distance [m] that lights paper as the sun does: the original's lamps of
intensity 30 then give the road below about half the light of the sun."""
