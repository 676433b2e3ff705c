"""Bundles in memory: as kernels read them."""

from typing import NamedTuple

import numba
import numpy as np
import pytest

from eyas.lanes import PackedBundle, compiled, vector
from eyas.lanes.bundles import flatten
from eyas.lanes.compilation import size_of

f4 = np.float32


class Small(NamedTuple):
    flag: bool
    share: float


class Mixed(NamedTuple):
    """Numbers of all sizes, so that most need padding before them."""

    byte: np.int8
    small: Small
    half: np.uint16
    single: np.float32
    values: np.ndarray
    nothing: tuple[()]
    flag: bool
    inner: tuple[tuple[np.float32, bool], np.int32]
    plane: np.ndarray
    last: np.uint8


def mixed():
    return Mixed(
        np.int8(-3), Small(True, 0.5), np.uint16(40_000), np.float32(1.25),
        np.arange(5.0), (), True, ((np.float32(-2.5), False), np.int32(-7)),
        np.arange(12, dtype=np.int16).reshape(3, 4)[:, ::2], np.uint8(200),
    )  # fmt: skip


@compiled
def read(bundle, row):
    plane, (pair, number) = bundle.plane, bundle.inner
    row[0] = bundle.byte
    row[1] = bundle.small.flag
    row[2] = bundle.small.share
    row[3] = bundle.half
    row[4] = bundle.single
    row[5] = bundle.values[4] + 100 * bundle.values.shape[0]
    row[6] = bundle.flag
    row[7] = pair[0]
    row[8] = pair[1]
    row[9] = number
    row[10] = plane[2, 1] + 100 * plane.shape[1] + 10_000 * plane.size
    row[11] = bundle.last


def test_kernels_read_every_number_where_it_was_written():
    row = np.zeros(12)
    read(mixed(), row)
    expected = [-3, 1, 0.5, 40_000, 1.25, 504, 1, -2.5, 0, -7, 10 + 200 + 60_000, 200]
    np.testing.assert_array_equal(row, expected)


@pytest.mark.parametrize("bundle", [mixed(), (), (True,), (1, True), ((), np.zeros(()))])
def test_a_bundle_is_as_large_as_numba_takes_it_to_be(bundle):
    assert PackedBundle(bundle).size == size_of(numba.typeof(bundle))


def test_bundles_of_the_same_types_are_of_one_kind_and_others_of_another():
    def kind(*values):
        return PackedBundle(values).kind

    array = np.zeros((4, 4))
    still = np.zeros((4, 4))
    still.flags.writeable = False
    assert kind(1, 2.0, array) == kind(3, 4.0, np.ones((2, 7)))
    others = [
        (1,), (1.0,), (True,), (np.float32(1),), ((1,),), (1, 1),
        (array,), (still,), (array[:, 0],), (array[::2],), (array[:, :2],),
        (np.asfortranarray(np.ones((2, 3))),), (array.view("i8"),), (array.view("c16"),),
        (Small(True, 1.0),), ((True, 1.0),),
        (np.zeros(1, [("a", "i4"), ("b", "f4")]),), (np.zeros(1, [("a", "i4"), ("c", "f4")]),),
    ]  # fmt: skip
    kinds = {kind(*values) for values in others}
    assert len(kinds) == len(others) - 1  # both slices are of arrays that are not contiguous


def test_what_kernels_cannot_read_is_refused():
    with pytest.raises(TypeError, match="str"):
        PackedBundle((1, "text"))


def test_arrays_are_read_where_numpy_has_them():
    whole = np.arange(24.0).reshape(4, 6)
    frozen = whole.copy()
    frozen.flags.writeable = False
    for array in (whole, whole[1:, ::2], whole.T, frozen, np.float32([1.0])):
        words = []
        flatten((array,), words, [])
        assert words[4] == array.ctypes.data


def test_lanes_that_are_not_wanted_may_be_read_from_an_empty_array():
    @compiled
    def read_eight(empty, wanted, out):
        found = vector.load(empty, 0)
        vector.store(
            out, 0, vector.select(vector.load(wanted, 0) > f4(0.0), found, found * f4(0.0))
        )

    out = np.ones(8, np.float32)
    read_eight(np.zeros((0, 3), np.float32), np.zeros(8, np.float32), out)
    assert not out.any()
