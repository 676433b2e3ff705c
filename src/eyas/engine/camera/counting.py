"""Counts of few electrons, whose distribution is far from normal."""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.scalars import f4, i4, u4
from eyas.lanes import exact, kernel
from eyas.lanes.vector import any_of, gather, root, select, to_f4, to_i4

FEW = 12.0
"""Up to so many electrons in the mean they are counted. Of more, a normal number is near enough:
it is below 0 in less than one of a thousand."""

_ROWS = 64
"""Means of which there are tables, evenly spread over the root of the mean, beside 0. Means in
between take one of their neighbours at random, which makes the variance at most 0.3 % too large."""

_STEP = math.sqrt(FEW / (_ROWS * _ROWS))

_MOST = 32  # Counts are below this: of the mean `FEW`, all but two in a million

_BITS = 24  # Of the random number that is looked up

_PART_BITS = 17  # Lower bits of it, within one of the parts of a table

_PARTS = 1 << (_BITS - _PART_BITS)

_OFTEN = 1 << 24  # Set in a part in which the count changes more than once, as at the ends


class Counts(NamedTuple):
    """Tables of Poisson's distribution for `_ROWS` + 1 means."""

    parts: NDArray[np.int32]
    """For each part of the random numbers its lowest count, from bit 25 on, `_OFTEN`, and from
    where on in the part it is one more, shape (rows, parts)."""
    below: NDArray[np.int32]  # Random numbers up to each count, shape (rows, `_MOST`)


@cache
def tables_of_counts() -> Counts:
    """Return the tables."""
    means = np.square(np.arange(_ROWS + 1) * _STEP)
    chance = exact.exp(-means)
    total, below = chance.copy(), np.empty((_ROWS + 1, _MOST))
    for count in range(_MOST):
        below[:, count] = total
        chance = chance * (means / (count + 1))
        total = total + chance
    below[:, -1] = 1.0
    ends = np.rint(below * (1 << _BITS)).astype(np.int32)
    first = np.arange(_PARTS, dtype=np.int32) << _PART_BITS
    lowest = (ends[:, None] <= first[:, None]).sum(axis=-1)
    after = (ends[:, None] < first[:, None] + (1 << _PART_BITS)).sum(axis=-1)
    change = np.minimum(np.take_along_axis(ends, lowest, axis=1) - first, 1 << _PART_BITS)
    often = np.where(after - lowest > 1, _OFTEN, 0)
    return Counts((lowest << 25 | often | change).astype(np.int32), ends)


@kernel(inline=True)
def counted(counts: Counts, mean: float, word: int) -> float:
    """Return a Poisson-distributed count, by inversion with a guide table (Devroye, 1986, III.2.4).

    Args:
        counts: The tables.
        mean: 0 to `FEW`.
        word: 32 random bits.
    """
    scaled = mean * f4(1.0 / (_STEP * _STEP))
    row = to_i4(root(scaled))
    number = to_f4(row)
    share = scaled - number * number  # of the way to the next mean, times 2 number + 1
    drawn = (to_f4(to_i4(word & u4(255))) + f4(0.5)) * f4(1.0 / 256.0)
    row += select(drawn * (number + number + f4(1.0)) < share, i4(1), i4(0))
    uniform = to_i4(word >> u4(8))
    part = gather(counts.parts, row * i4(_PARTS) + (uniform >> i4(_PART_BITS)))
    within = uniform & i4((1 << _PART_BITS) - 1)
    count = (part >> i4(25)) + select(within >= (part & i4(_OFTEN - 1)), i4(1), i4(0))
    more = (part & i4(_OFTEN)) != i4(0)
    if any_of(more):
        row = row * i4(_MOST)
        more = more & (gather(counts.below, row + count) <= uniform)
        while any_of(more):
            count += select(more, i4(1), i4(0))
            more = more & (gather(counts.below, row + count) <= uniform)
    electrons: float = to_f4(count)
    return electrons
