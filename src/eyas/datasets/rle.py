"""Run-length codes of masks, as COCO's own tools write them: column by column, in printable text.

The code is specified by maskApi.c of https://github.com/cocodataset/cocoapi: runs of zeros and ones
in turn; from the third run on the difference to the one before the last; each number in groups of
five bits, the lowest first, bit 6 says that another follows, 48 is added.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

__all__ = ["encoded_masks"]

_MOST_GROUPS = 7
"""More than enough for 32 bits with their sign."""


def encoded_masks(masks: NDArray[np.int32]) -> dict[int, tuple[str, int]]:
    """Return for each object its code, and its area [pixels].

    Args:
        masks: The id of each pixel, 0 for none, shape (H, W).
    """
    flat = np.ascontiguousarray(masks.T).ravel()
    starts = np.concatenate([[0], np.flatnonzero(flat[1:] != flat[:-1]) + 1])
    ends = np.append(starts[1:], flat.size)
    ids = flat[starts]
    order = np.argsort(ids, kind="stable")
    ids, starts, ends = ids[order], starts[order], ends[order]
    chosen = ids != 0
    ids, starts, ends = ids[chosen], starts[chosen], ends[chosen]
    objects, first = np.unique(ids, return_index=True)
    bounds = [*first.tolist(), len(ids)]
    return {
        number: _encoded(starts[low:high], ends[low:high], flat.size)
        for number, (low, high) in zip(objects.tolist(), pairwise(bounds), strict=True)
    }


def _encoded(starts: NDArray[np.int64], ends: NDArray[np.int64], size: int) -> tuple[str, int]:
    edges = np.concatenate([[0], np.column_stack([starts, ends]).ravel(), [size]])
    counts = np.diff(edges)
    if counts[-1] == 0:
        counts = counts[:-1]
    numbers = counts.copy()
    numbers[3:] -= counts[1:-2]
    return _text(numbers), int((ends - starts).sum())


def _text(numbers: NDArray[np.int64]) -> str:
    groups = numbers[:, None] >> (5 * np.arange(_MOST_GROUPS))
    low = groups & 31
    # The last group is the one after which only the sign is left, and whose bit 5 tells it.
    rest, sign = groups >> 5, (low & 16) != 0
    more = np.where(sign, rest != -1, rest != 0)
    last = np.argmax(~more, axis=1)
    used = np.arange(_MOST_GROUPS) <= last[:, None]
    letters = (low | np.where(np.arange(_MOST_GROUPS) < last[:, None], 32, 0)) + 48
    code: bytes = letters[used].astype(np.uint8).tobytes()
    return code.decode()
