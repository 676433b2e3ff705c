"""Each operation of the dialect against numpy, for eight numbers at once and for single numbers."""

import re
from pathlib import Path

import numpy as np
import pytest
from numba.core.errors import TypingError

from eyas.lanes import kernel
from eyas.lanes import vector as lanes
from eyas.lanes.vector import (
    WIDTH,
    all_of,
    any_bits,
    any_of,
    bit_pattern,
    bits_of,
    ceiling,
    first_bit,
    from_bits,
    gather,
    gather_column,
    gather_pair,
    gather_pair_after,
    gather_square,
    greater,
    lane,
    lane_numbers,
    lesser,
    like,
    load,
    load_two,
    load_words,
    load_words_two,
    magnitude,
    prefetch,
    root,
    select,
    splat,
    store,
    store_greater,
    store_triples,
    store_triples_two,
    store_words,
    to_f4,
    to_f8,
    to_i4,
    to_i8,
    to_u4,
    transposed,
    whole,
)

f4, i4, u4, i8 = np.float32, np.int32, np.uint32, np.int64
COUNT = 8 * WIDTH
RNG = np.random.default_rng(0)
A = RNG.uniform(-50, 50, COUNT).astype(f4)
B = np.where(np.arange(COUNT) % 5 == 0, A, RNG.uniform(-50, 50, COUNT)).astype(f4)
I = RNG.integers(-(2**31), 2**31, COUNT).astype(i4)  # noqa: E741  # beside J
J = RNG.integers(-(2**31), 2**31, COUNT).astype(i4)
S = (np.arange(COUNT) % 31).astype(i4)
U, V = I.view(u4), J.view(u4)


@kernel
def floats(a, b):
    total, product = a, a
    total += b
    product *= b
    return (
        a + b, a - b, a * b, a / b, -a, f4(3.0) - a, a * f4(0.1), lesser(a, b), greater(a, b),
        lesser(a, f4(0.5)), root(magnitude(a)), magnitude(a), ceiling(a), whole(a),
        select(a < b, a, b), select(a >= b, f4(1.0), b), like(a, f4(7.0)) + b, total, product,
        from_bits(bit_pattern(a)), to_f4(to_f8(a)), to_f4(to_i4(a)), a * b + a,
    )  # fmt: skip


def floats_expected(a, b):
    half, cut = f4(0.5), np.trunc(a)
    return [
        a + b, a - b, a * b, a / b, -a, f4(3.0) - a, a * f4(0.1), np.minimum(a, b),
        np.maximum(a, b), np.minimum(a, half), np.sqrt(np.abs(a)), np.abs(a), np.ceil(a),
        np.floor(a), np.where(a < b, a, b), np.where(a >= b, f4(1.0), b), f4(7.0) + b, a + b,
        a * b, a, a, cut, a * b + a,  # in two steps: never fused into one
    ]  # fmt: skip


@kernel
def integers(i, j, s):
    return (
        to_i4(i + j), to_i4(i - j), to_i4(i * j), to_i4(i & j), to_i4(i | j), to_i4(i ^ j),
        to_i4(~i), to_i4(-i), to_i4(i << s), to_i4(i >> s), to_i4(lesser(i, j)),
        to_i4(greater(i, j)), to_i4(select(i < j, i, j)), to_i4(like(i, i4(7))),
        to_i4(to_i8(i) << i8(20) >> i8(30)), to_i4(i & i4(255)), to_i4(to_u4(i)),
    )  # fmt: skip


def integers_expected(i, j, s):
    return [
        i + j, i - j, i * j, i & j, i | j, i ^ j, ~i, -i, i << s, i >> s, np.minimum(i, j),
        np.maximum(i, j), np.minimum(i, j), np.full_like(i, 7),
        (i.astype(i8) << 20 >> 30).astype(i4), i & 255, i,
    ]  # fmt: skip


@kernel
def naturals(u, v, s):
    return (
        to_u4(u + v), to_u4(u * v), to_u4(u >> to_u4(s)), to_u4(u << to_u4(s)),
        to_u4(lesser(u, v)), to_u4(select(u <= v, u, v)), to_u4(u ^ v), to_u4(u & u4(0xFFFF)),
    )  # fmt: skip


def naturals_expected(u, v, s):
    s = s.astype(u4)
    return [
        u + v, u * v, u >> s, u << s, np.minimum(u, v), np.minimum(u, v), u ^ v, u & u4(0xFFFF)
    ]  # fmt: skip


@kernel
def masks(a, b):
    one, zero = like(a, f4(1.0)), f4(0.0)
    low, high = a < b, a > f4(0.0)
    both = low
    both &= high
    return (
        select(low & high, one, zero), select(low | high, one, zero), select(low ^ high, one, zero),
        select(~low, one, zero), select(a == b, one, zero), select(a != b, one, zero),
        select(a <= b, one, zero), select(both, one, zero),
    )  # fmt: skip


def masks_expected(a, b):
    low, high = a < b, a > 0
    every = [low & high, low | high, low ^ high, ~low, a == b, a != b, a <= b, low & high]
    return [mask.astype(f4) for mask in every]


def drivers(function, inputs: int):
    """Return kernels that call a function for eight elements at a time, and for one at a time."""
    if inputs == 2:

        @kernel
        def wide(a, b, out):
            for at in range(0, len(a), WIDTH):
                for k, value in enumerate(function(load(a, at), load(b, at))):
                    store(out, k * len(a) + at, value)

        @kernel
        def one(a, b, out):
            for at in range(len(a)):
                for k, value in enumerate(function(a[at], b[at])):
                    out[k, at] = value

    else:

        @kernel
        def wide(a, b, c, out):
            for at in range(0, len(a), WIDTH):
                for k, value in enumerate(function(load(a, at), load(b, at), load(c, at))):
                    store(out, k * len(a) + at, value)

        @kernel
        def one(a, b, c, out):
            for at in range(len(a)):
                for k, value in enumerate(function(a[at], b[at], c[at])):
                    out[k, at] = value

    return wide, one


@pytest.mark.parametrize("width", ["wide", "one"])
@pytest.mark.parametrize(
    ("function", "expected", "inputs"),
    [
        (floats, floats_expected, (A, B)),
        (integers, integers_expected, (I, J, S)),
        (naturals, naturals_expected, (U, V, S)),
        (masks, masks_expected, (A, B)),
    ],
)
def test_operations_give_what_numpy_gives(function, expected, inputs, width):
    with np.errstate(over="ignore"):
        wanted = np.array(expected(*inputs))
    out = np.zeros_like(wanted)
    drivers(function, len(inputs))[width == "one"](*inputs, out)
    for k, row in enumerate(wanted):
        np.testing.assert_array_equal(out[k], row, f"result {k} of {function.__name__}")


@kernel
def counted(a, out):
    for at in range(0, len(a), WIDTH):
        mask = load(a, at) > f4(0.0)
        bits = bits_of(mask)
        out[at, 0], out[at, 1], out[at, 2] = bits, any_of(mask), all_of(mask)
        out[at, 3] = first_bit(bits) if bits else -1
        out[at, 4] = lane(lane_numbers(), 5)
        out[at, 5] = i8(lane(splat(f4(2.5)), 3) * f4(2.0))
        out[at, 6] = any_bits(lane_numbers() & to_i4(load(a, at)))
        out[at, 7] = any_bits(lane(lane_numbers(), 6))


def test_masks_are_counted():
    signs = np.where(RNG.random(COUNT) < 0.5, 1, -1).astype(f4)
    signs[:WIDTH], signs[WIDTH : 2 * WIDTH] = 1, -1
    out = np.zeros((COUNT, 8), i8)
    counted(signs, out)
    for at in range(0, COUNT, WIDTH):
        mask = signs[at : at + WIDTH] > 0
        bits = int((mask << np.arange(WIDTH)).sum())
        first = int(np.argmax(mask)) if bits else -1
        joined = np.bitwise_or.reduce(np.where(mask, np.arange(WIDTH) & 1, np.arange(WIDTH)))
        assert out[at].tolist() == [bits, mask.any(), mask.all(), first, 5, 5, joined, 6]


@kernel
def fetched(table, bytes_, halves, index, width, wide, single):
    for at in range(0, len(index), WIDTH):
        places = load(index, at)
        store(wide, at, gather(table, places))
        store(wide, len(index) + at, gather_column(table, places, 3, width))
        store(wide, 2 * len(index) + at, to_f4(gather(bytes_, places)))
        store(wide, 3 * len(index) + at, to_f4(gather_pair(halves, places) >> u4(16)))
        after = gather_pair_after(halves, places, width)
        store(wide, 12 * len(index) + at, to_f4(after >> u4(16)))
        for k, column in enumerate(transposed(table, places, 2, width, places)):
            store(wide, (4 + k) * len(index) + at, column)
    for at in range(len(index)):
        place = index[at]
        single[0, at] = gather(table, place)
        single[1, at] = gather_column(table, place, 3, width)
        single[2, at] = to_f4(gather(bytes_, place))
        single[3, at] = to_f4(gather_pair(halves, place) >> u4(16))
        single[12, at] = to_f4(gather_pair_after(halves, place, width) >> u4(16))
        for k, column in enumerate(transposed(table, place, 2, width, place)):
            single[4 + k, at] = column


def test_gathers_fetch_what_indices_name():
    width = 11
    table = RNG.normal(size=(COUNT, width)).astype(f4)
    bytes_ = RNG.integers(0, 256, COUNT * width).astype(np.uint8)
    halves = RNG.integers(0, 65536, COUNT * width).astype(np.uint16)
    index = RNG.permutation(COUNT).astype(i4)
    wide, single = np.zeros((13, COUNT), f4), np.zeros((13, COUNT), f4)
    fetched(table, bytes_, halves, index, width, wide, single)
    rows = [table.ravel()[index], table[index, 3], bytes_[index], halves[index + 1]]
    columns = [table[index, 2 + k] for k in range(8)]
    expected = np.array([*rows, *columns, halves[index + width + 1]], f4)
    np.testing.assert_array_equal(wide, expected)
    np.testing.assert_array_equal(single, expected)


@kernel
def squares(words, index, step, wide, single):
    for at in range(0, len(index), WIDTH):
        for k, found in enumerate(gather_square(words, load(index, at), step)):
            store(wide, k * len(index) + at, found)
    for at in range(len(index)):
        for k, found in enumerate(gather_square(words, index[at], step)):
            single[k, at] = found


def test_squares_are_the_elements_after_each_other_and_a_step_on():
    step = 11
    words = RNG.integers(0, 2**32, COUNT + step + 1).astype(u4)
    index = RNG.permutation(COUNT).astype(i4)
    wide, single = np.zeros((4, COUNT), u4), np.zeros((4, COUNT), u4)
    squares(words, index, step, wide, single)
    expected = [words[index + after] for after in (0, 1, step, step + 1)]
    np.testing.assert_array_equal(wide, expected)
    np.testing.assert_array_equal(single, expected)


@kernel
def greatest(numbers, new):
    for at in range(0, len(numbers), WIDTH):
        store_greater(numbers, at, load(new, at), load(numbers, at))


def test_the_greater_of_keys_is_kept():
    distances = RNG.uniform(0.01, 1e5, (2, 1000 * WIDTH)).astype(f4)
    tags = RNG.integers(0, 2**32, distances.shape)
    old, new = (distances.view(i4).astype(i8) << 32) | tags
    new[1::7] = (old[1::7] >> 32 << 32) | (new[1::7] & 0xFFFFFFFF)  # as far away: the tag decides
    old[2::7] = 0  # the sky
    new[3::7] |= i8(-(2**63))  # not wanted
    expected = np.maximum(old, new)
    greatest(old, new)
    np.testing.assert_array_equal(old, expected)


@kernel
def fetching(numbers, index):
    for at in range(0, len(index), WIDTH):
        prefetch(numbers, load(index, at))
        prefetch(numbers, index[at])


def test_prefetching_changes_nothing_and_may_reach_beyond_the_end():
    numbers = A.copy()
    fetching(numbers, np.array([0, 1, 2**30, 2**31 - 1] * WIDTH, i4))
    np.testing.assert_array_equal(numbers, A)


def test_a_row_that_all_lanes_want_is_in_all_of_them():
    width = 11
    table = RNG.normal(size=(COUNT, width)).astype(f4)
    bytes_, halves = np.zeros(COUNT * width, np.uint8), np.zeros(COUNT * width, np.uint16)
    index = np.repeat(RNG.permutation(COUNT)[: COUNT // WIDTH], WIDTH).astype(i4)
    wide, single = np.zeros((13, COUNT), f4), np.zeros((13, COUNT), f4)
    fetched(table, bytes_, halves, index, width, wide, single)
    np.testing.assert_array_equal(wide[4:12], table[index, 2:10].T)
    np.testing.assert_array_equal(single, wide)


@kernel
def moved_in_tiles(words, long, bytes_, out, into):
    for at in range(0, 16, WIDTH // 2):
        store(out, 2 * at, load_two(long, at, 16))
        store_words(words, 8 * at, load_words_two(bytes_, 4 * at, 64))
        store_triples_two(into, 3 * at, 48, load_words_two(bytes_, 4 * at, 64))


def test_tiles_lie_in_two_rows():
    long, bytes_ = np.arange(32, dtype=i8) << 33, RNG.integers(0, 256, 128).astype(np.uint8)
    words, out, into = np.zeros(128, np.uint8), np.zeros(32, i8), np.zeros(96, np.uint8)
    moved_in_tiles(words, long, bytes_, out, into)
    order = np.arange(32).reshape(2, 4, 4).swapaxes(0, 1).ravel()
    np.testing.assert_array_equal(out, long[order])
    np.testing.assert_array_equal(words.view(np.uint32), bytes_.view(np.uint32)[order])
    np.testing.assert_array_equal(into.reshape(-1, 3), bytes_.reshape(-1, 4)[:, :3])


@kernel
def written(bytes_, words):
    store_triples(bytes_, 2, to_u4(lane_numbers()) * u4(0x030201))
    store_words(words, 5, load_words(bytes_, 2))


def test_stores_touch_nothing_else():
    bytes_, words = np.full(64, 200, np.uint8), np.zeros(64, np.uint8)
    written(bytes_, words)
    triples = [k * factor for k in range(8) for factor in (1, 2, 3)]
    assert bytes_.tolist() == [200] * 2 + triples + [200] * 38
    assert words.tolist() == [0] * 5 + bytes_.tolist()[2:34] + [0] * 27


def test_a_number_of_another_precision_is_refused():
    @kernel
    def widened(a, out):
        store(out, 0, load(a, 0) * 0.5)

    with pytest.raises(TypingError):
        widened(A, np.zeros(WIDTH, f4))


def test_every_public_operation_is_documented():
    page = (Path(__file__).parents[2] / "docs" / "lanes.md").read_text()
    named = set(re.findall(r"`(\w+)", page))
    assert {name for name in lanes.__all__ if name not in named} == set()
