"""Has numba make kernels that print each index outside of its array, by `NUMBA_BOUNDSCHECK=1`.

Its own check also refuses a row of an empty array that is never read, and knows no lanes.
"""

import sys

from numba.core import cgutils, types
from numba.np import arrayobj

import eyas.lanes.vector.loads
import eyas.lanes.vector.stores
from eyas.lanes.vector import places

item, pointer_to = arrayobj._getitem_array_generic, places.pointer_to
only_a_row = [False]


def report(context, builder, index, length, axis=None):
    if only_a_row[0]:
        return
    below = builder.icmp_signed("<", index, index.type(0))
    outside = builder.or_(builder.icmp_signed(">=", index, length), below)
    with cgutils.if_unlikely(builder, outside):
        text = f"OUTSIDE {builder.function.name}: index %ld of %ld\n"
        cgutils.printf(builder, text, index, length)


def item_or_row(context, builder, kind, *rest):
    before, only_a_row[0] = only_a_row[0], isinstance(kind, types.Buffer)
    try:
        return item(context, builder, kind, *rest)
    finally:
        only_a_row[0] = before


def place_of_lane(context, builder, array, value, at):
    asked_ahead = "prefetch" in sys._getframe(1).f_code.co_qualname
    if not asked_ahead:
        count = context.make_array(array)(context, builder, value).nitems
        report(context, builder, at, count)
    return pointer_to(context, builder, array, value, at)


cgutils.do_boundscheck, arrayobj._getitem_array_generic = report, item_or_row
for module in (places, eyas.lanes.vector.loads, eyas.lanes.vector.stores):
    module.pointer_to = place_of_lane
