"""Moving things: the slots of a draw list that belong together, and the samples that show them."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band
from eyas.engine.render.kernels.scalars import i4
from eyas.engine.render.kernels.visibility.key import drawn_of
from eyas.lanes import kernel
from eyas.lanes.vector import any_of, gather_column, select


@kernel(inline=True)
def next_thing(band: Band, slot: int) -> int:
    """Return the first slot from `slot` on that is not empty, or the number of slots."""
    parts = band.movers.part[band.world]
    while slot < len(parts) and parts[slot] < 0:
        slot += 1
    return slot


@kernel(inline=True)
def end_of_thing(band: Band, first: int) -> int:
    """Return the slot after those in a row with the object id of slot `first`.

    Some between them may be empty.
    """
    object_ids = band.movers.object_id[band.world]
    last = first + 1
    while last < len(object_ids) and object_ids[last] == object_ids[first]:
        last += 1
    return last


@kernel(inline=True)
def belongs_to(
    tag: int,  # Tags of the samples
    drawn: NDArray[np.int32],  # See `Scratch`, shape (I, 2)
    first: int,  # First instance
    last: int,  # Last instance + 1
) -> bool:
    """Return which samples show instances `first` to `last`."""
    moved = tag < i4(0)
    if not any_of(moved):
        return moved
    # The others look at row 0.
    instance = gather_column(drawn, select(moved, drawn_of(tag), i4(0)), 1, 2)
    return moved & (instance >= i4(first)) & (instance < i4(last))
