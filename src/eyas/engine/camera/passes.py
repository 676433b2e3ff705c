"""Division of an exposure into passes and bands, and the mean of the light of the passes."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import kernel, parallel, thread_count
from eyas.lanes.vector import WIDTH, load, store

Integers = NDArray[np.int64]
Floats = NDArray[np.float64]
Single = NDArray[np.float32]


class Pieces(NamedTuple):
    """P passes of V exposures, and the K bands in which they are drawn, pass by pass."""

    view: Integers  # Exposure of each pass, shape (P,)
    share: Single  # Share of each in the mean of its exposure, shape (P,)
    passed: Integers  # Pass of each band, shape (K,)
    rows: NDArray[np.int32]  # First row of each band, and the row after the last, shape (K, 2)
    later: Floats  # Time of each band after the instant of its exposure [s], shape (K,)

    def some(self, begin: int, end: int) -> "Pieces":
        """Return some of the passes, numbered from 0."""
        first, last = np.searchsorted(self.passed, (begin, end))
        return Pieces(
            self.view[begin:end],
            self.share[begin:end],
            self.passed[first:last] - begin,
            self.rows[first:last],
            self.later[first:last],
        )


def pieces_of(
    samples: Integers,  # Passes of each, shape (V,)
    bands: Integers,  # Bands of each, shape (V,), at most `height`
    exposure: Floats,  # How long each shutter is open [s], shape (V,)
    readout: Floats,  # Time from the exposure of the first row to that of the last [s], shape (V,)
    height: int,  # Rows of a picture
) -> Pieces:
    """Return the passes of V exposures: instants in the middle of equal parts of each, and bands of
    rows, each at the instant of its middle.
    """
    view = np.repeat(np.arange(len(samples)), samples)
    passed = np.repeat(np.arange(len(view)), bands[view])
    of, number, part = view[passed], _numbered(bands[view]), bands[view[passed]]
    ends = np.stack([number, number + 1])
    rows = ((2 * height * ends + part) // (2 * part)).T  # rounded, so that they lie evenly
    place = rows.sum(axis=1) / (2.0 * height) - 0.5
    instant = (_numbered(samples) + 0.5) / samples[view] - 0.5
    later = readout[of] * place + exposure[of] * instant[passed]
    share = (1.0 / samples[view]).astype(np.float32)
    return Pieces(view, share, passed, rows.astype(np.int32), later)


def _numbered(counts: Integers) -> Integers:
    """Return 0 to n - 1 for each count n, one after the other."""
    total = int(counts.sum())
    return np.arange(total) - np.repeat(np.cumsum(counts) - counts, counts)


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    radiance: Single  # Of P passes, shape (P, numbers)
    into: Integers  # Exposure of each
    share: Single
    out: Single  # Of V exposures, shape (V, numbers); added to


def add_passes(radiance: Single, pieces: Pieces, out: Single) -> None:
    """Add the light of passes to the means of their exposures, in the order of the passes, so that
    how many are added at once changes no byte.

    Args:
        radiance: Shape (P, 3, H, W).
        pieces: The P passes.
        out: Shape (V, 3, H, W).
    """
    flat = radiance.reshape(len(radiance), -1), out.reshape(len(out), -1)
    work = _Work(flat[0], pieces.view, pieces.share, flat[1])
    _add(min(thread_count(), -(-flat[0].shape[1] // _PIECE)), work)


_PIECE = 4096  # Numbers that a worker adds in a row: they stay in its cache from pass to pass


@parallel
def _add(worker: int, workers: int, work: _Work) -> None:
    numbers = work.radiance.shape[1]
    for begin in range(worker * _PIECE, numbers, workers * _PIECE):
        end = min(begin + _PIECE, numbers)
        for p in range(work.into.shape[0]):
            _add_piece(work.radiance[p], f4(work.share[p]), work.out[work.into[p]], begin, end)


@kernel(inline=True)
def _add_piece(radiance: Single, share: float, out: Single, begin: int, end: int) -> None:
    for at in range(begin, end - WIDTH + 1, WIDTH):
        store(out, at, load(out, at) + share * load(radiance, at))
    for at in range(end - (end - begin) % WIDTH, end):
        out[at] += share * radiance[at]
