"""Defocus: each point is a disc, the circle of confusion, as wide as the lens is out of focus."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import parallel, thread_count
from eyas.lanes.vector import WIDTH, load, splat, store

LARGEST = 64.0  # Largest diameter of the disc [pixels]

_FINE = 16  # Points along a side of a pixel by which the disc's share of it is counted


def disc(
    diameter: float,  # Of the circle of confusion [pixels]
) -> NDArray[np.float32]:
    """Return the share of a point's light in each pixel around it, shape (K, K), K odd; sum 1."""
    reach = math.ceil(0.5 * diameter - 0.5) if diameter > 1.0 else 0
    side = 2 * reach + 1
    places = (np.arange(side * _FINE) + 0.5) / _FINE - 0.5 * side
    square = places * places
    inside = square[:, None] + square[None, :] <= 0.25 * diameter * diameter
    share = inside.reshape(side, _FINE, side, _FINE).sum(axis=(1, 3)).astype(np.float64)
    if not share.any():
        share[reach, reach] = 1.0
    return np.asarray(share / share.sum(), np.float32)


def defocused(
    radiance: NDArray[np.float32],  # Shape (V, 3, H, W)
    # Of the circle of confusion of each picture [pixels], shape (V,)
    diameter: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Return pictures out of focus; beyond the border lies what is at the border."""
    blurred = radiance.copy()
    for size in np.unique(diameter[diameter > 1.0]).tolist():
        same = np.flatnonzero(diameter == size)
        weight = disc(size)
        reach, height = len(weight) // 2, radiance.shape[2]
        # As many columns more as a load of eight may reach.
        sides = ((0, 0), (0, 0), (reach, reach), (reach, reach + WIDTH))
        padded = np.pad(radiance[same], sides, mode="edge")
        columns = padded.shape[3]
        out = np.empty((len(same), 3, height, columns), np.float32)
        flat = padded.reshape(len(same), 3, -1), out.reshape(len(same), 3, -1)
        work = _Work(*flat, weight, height, radiance.shape[3], columns)
        _blur(min(thread_count(), len(same)), work)
        blurred[same] = out[..., : radiance.shape[3]]
    return blurred


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    padded: NDArray[np.float32]  # Shape (V, 3, rows * columns)
    out: NDArray[np.float32]  # Shape (V, 3, height * columns)
    weight: NDArray[np.float32]
    height: int
    width: int
    columns: int


@parallel
def _blur(worker: int, workers: int, work: _Work) -> None:
    """Blur the pictures whose turn is this worker's."""
    weight, columns, side = work.weight, work.columns, work.weight.shape[0]
    for view in range(worker, work.padded.shape[0], workers):
        for channel in range(3):
            plane, out = work.padded[view, channel], work.out[view, channel]
            for row in range(work.height):
                for first in range(0, work.width, WIDTH):
                    total = splat(f4(0.0))
                    for down in range(side):
                        at = (row + down) * columns + first
                        for right in range(side):
                            share = weight[down, right]
                            if share > f4(0.0):
                                total += share * load(plane, at + right)
                    store(out, row * columns + first, total)
