"""Lanes: eight numbers at once, in kernels that also run on one number.

A kernel written with these functions handles eight pixels, triangles, boxes or vertices where its
arguments are lanes, and one where they are numbers, as in a thread of a graphics processor: every
function here takes either. `docs/lanes.md` tells how to write such a kernel.

What the functions do is written in `loads`, `stores` and `values` of this package; those import
numba, so they are loaded only when a kernel is compiled.
"""

from eyas.lanes.intrinsics import Intrinsic

__all__ = [
    "BLOCK",
    "WIDTH",
    "agree",
    "all_of",
    "any_bits",
    "any_of",
    "bit_pattern",
    "bits_of",
    "ceiling",
    "claim_some",
    "count_bits",
    "first_bit",
    "from_bits",
    "gather",
    "gather_column",
    "gather_pair",
    "gather_pair_after",
    "gather_square",
    "greater",
    "lane",
    "lane_numbers",
    "lesser",
    "like",
    "load",
    "load_two",
    "load_words",
    "load_words_two",
    "magnitude",
    "own",
    "prefetch",
    "root",
    "scatter",
    "select",
    "splat",
    "store",
    "store_greater",
    "store_largest",
    "store_triples",
    "store_triples_two",
    "store_words",
    "to_f4",
    "to_f8",
    "to_i4",
    "to_i8",
    "to_u4",
    "transposed",
    "whole",
]

WIDTH = 8  # Numbers in lanes

BLOCK = 32
"""Threads that a graphics processor starts together of a kernel on lanes: one warp, so that none
waits for others to end. What the lanes of a worker share is laid out for so many."""

_LOADS, _STORES = "eyas.lanes.vector.loads", "eyas.lanes.vector.stores"
_VALUES = "eyas.lanes.vector.values"

agree = Intrinsic(_STORES, "agree")
claim_some = Intrinsic(_STORES, "claim_some")
gather = Intrinsic(_LOADS, "gather")
gather_column = Intrinsic(_LOADS, "gather_column")
gather_pair = Intrinsic(_LOADS, "gather_pair")
gather_pair_after = Intrinsic(_LOADS, "gather_pair_after")
gather_square = Intrinsic(_LOADS, "gather_square")
load = Intrinsic(_LOADS, "load")
load_two = Intrinsic(_LOADS, "load_two")
load_words = Intrinsic(_LOADS, "load_words")
load_words_two = Intrinsic(_LOADS, "load_words_two")
prefetch = Intrinsic(_LOADS, "prefetch")
scatter = Intrinsic(_STORES, "scatter")
store = Intrinsic(_STORES, "store")
store_greater = Intrinsic(_STORES, "store_greater")
store_largest = Intrinsic(_STORES, "store_largest")
store_triples = Intrinsic(_STORES, "store_triples")
store_triples_two = Intrinsic(_STORES, "store_triples_two")
store_words = Intrinsic(_STORES, "store_words")
transposed = Intrinsic(_LOADS, "transposed")

all_of = Intrinsic(_VALUES, "all_of")
any_bits = Intrinsic(_VALUES, "any_bits")
any_of = Intrinsic(_VALUES, "any_of")
bit_pattern = Intrinsic(_VALUES, "bit_pattern")
bits_of = Intrinsic(_VALUES, "bits_of")
ceiling = Intrinsic(_VALUES, "ceiling")
count_bits = Intrinsic(_VALUES, "count_bits")
first_bit = Intrinsic(_VALUES, "first_bit")
from_bits = Intrinsic(_VALUES, "from_bits")
greater = Intrinsic(_VALUES, "greater")
lane = Intrinsic(_VALUES, "lane")
lane_numbers = Intrinsic(_VALUES, "lane_numbers")
lesser = Intrinsic(_VALUES, "lesser")
like = Intrinsic(_VALUES, "like")
magnitude = Intrinsic(_VALUES, "magnitude")
own = Intrinsic(_VALUES, "own")
root = Intrinsic(_VALUES, "root")
select = Intrinsic(_VALUES, "select")
splat = Intrinsic(_VALUES, "splat")
to_f4 = Intrinsic(_VALUES, "to_f4")
to_f8 = Intrinsic(_VALUES, "to_f8")
to_i4 = Intrinsic(_VALUES, "to_i4")
to_i8 = Intrinsic(_VALUES, "to_i8")
to_u4 = Intrinsic(_VALUES, "to_u4")
whole = Intrinsic(_VALUES, "whole")
