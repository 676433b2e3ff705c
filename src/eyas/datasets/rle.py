"""Run-length codes of masks, as COCO's own tools write them: column by column, in printable text.

The code is specified by maskApi.c of https://github.com/cocodataset/cocoapi: runs of zeros and ones
in turn; from the fourth run on the difference to the one before the last; each number in groups of
five bits, the lowest first, bit 6 says that another follows, 48 is added.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

_MOST_GROUPS = 7  # More than enough for 32 bits with their sign

Ints = NDArray[np.int64]


class _Runs(NamedTuple):
    """Runs of pixels of one object, column by column; those of an object follow each other."""

    ids: Ints  # The object of each, shape (R,)
    starts: Ints  # Number of the first pixel, shape (R,)
    ends: Ints  # Number of the pixel after the last, shape (R,)


def encoded_masks(
    masks: NDArray[np.int32],  # The id of each pixel, 0 for none, shape (H, W)
) -> dict[int, tuple[str, int]]:
    """Return for each object its code, and its area [pixels]."""
    if not masks.any():
        return {}
    runs = _runs(masks)
    lengths = runs.ends - runs.starts
    objects, first = np.unique(runs.ids, return_index=True)
    areas = np.add.reduceat(lengths, first)
    # The runs of zeros before each run, and after the last one of an object.
    gaps = runs.starts - np.concatenate([[0], runs.ends[:-1]])
    gaps[first] = runs.starts[first]
    bounds = np.append(first, len(lengths))
    tails = masks.size - runs.ends[bounds[1:] - 1]
    counts = np.insert(np.column_stack([gaps, lengths]).ravel(), 2 * bounds[1:], tails)
    begins = 2 * bounds + np.arange(len(bounds))
    number = np.arange(len(counts)) - np.repeat(begins[:-1], np.diff(begins))
    differences = counts.copy()
    differences[2:] -= np.where(number[2:] >= 3, counts[:-2], 0)
    kept = np.ones(len(counts), bool)
    kept[begins[1:] - 1] = tails > 0
    begins = np.concatenate([[0], np.cumsum(kept)])[begins]
    text, ends = _text(differences[kept])
    cuts = np.concatenate([[0], ends])[begins].tolist()
    codes = [text[low:high] for low, high in pairwise(cuts)]
    rows = zip(objects.tolist(), codes, areas.tolist(), strict=True)
    return {number: (code, area) for number, code, area in rows}


def _runs(masks: NDArray[np.int32]) -> _Runs:
    """Return the runs of all objects, found in the part of the picture in which there are some."""
    height = len(masks)
    rows, columns = (np.flatnonzero(masks.any(axis=axis)) for axis in (1, 0))
    left, top, bottom = columns[0], rows[0], rows[-1] + 1
    # A row of zeros parts the columns, unless the objects reach from the top to the bottom.
    bottom, top = (bottom + 1, top) if bottom < height else (bottom, max(top - 1, 0))
    part = np.ascontiguousarray(masks[top:bottom, left : columns[-1] + 1].T)
    flat = part.ravel()
    starts = np.concatenate([[0], np.flatnonzero(flat[1:] != flat[:-1]) + 1])
    lengths = np.diff(starts, append=flat.size)
    ids = flat[starts]
    order = np.argsort(ids, kind="stable")
    order = order[ids[order] != 0]
    column, row = np.divmod(starts[order], part.shape[1])
    begins = (column + left) * height + row + top
    return _Runs(ids[order], begins, begins + lengths[order])


def _text(numbers: Ints) -> tuple[str, Ints]:
    """Return the code of numbers, and where that of each ends in it."""
    groups = numbers[:, None] >> (5 * np.arange(_MOST_GROUPS))
    low = groups & 31
    # The last group is the one after which only the sign is left, and whose bit 5 tells it.
    rest, sign = groups >> 5, (low & 16) != 0
    more = np.where(sign, rest != -1, rest != 0)
    last = np.argmax(~more, axis=1)
    used = np.arange(_MOST_GROUPS) <= last[:, None]
    letters = (low | np.where(np.arange(_MOST_GROUPS) < last[:, None], 32, 0)) + 48
    code: bytes = letters[used].astype(np.uint8).tobytes()
    return code.decode(), np.cumsum(last + 1)
