"""Structured values as JSON and arrays, and back."""

import dataclasses
import json
from dataclasses import dataclass, field
from enum import IntEnum, StrEnum
from typing import Any, NamedTuple, TypeVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from numpy.typing import NDArray
from typing_extensions import TypeAliasType

from eyas.engine.core.cache.flat import FlatError, flatten, restore


class Side(IntEnum):
    LEFT = 1
    RIGHT = 2


class Name(StrEnum):
    NEAR = "near"
    FAR = "far"


class Pair(NamedTuple):
    counts: NDArray[np.int32]
    heights: NDArray[np.float64]
    side: Side


@dataclass(frozen=True, slots=True)
class Leaf:
    tint: tuple[float, float, float]
    name: Name = Name.NEAR
    on: bool = False


@dataclass(slots=True)
class Tree:
    title: str
    size: tuple[int, float]
    leaves: tuple[tuple[Leaf, ...], ...]
    pair: Pair
    images: dict[str, NDArray[np.uint8]]
    any_array: NDArray[np.floating]
    shade: float | None = None
    crown: Leaf | None = None
    masks: tuple[NDArray[np.bool_], ...] = field(default_factory=tuple)


def arrays_of(dtype):
    shapes = npst.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=3)
    return npst.arrays(dtype, shapes)


numbers = st.floats(allow_nan=False)
leaves = st.builds(Leaf, st.tuples(numbers, numbers, numbers), st.sampled_from(Name), st.booleans())
trees = st.builds(
    Tree,
    st.text(),
    st.tuples(st.integers(), numbers),
    st.lists(st.lists(leaves, max_size=2).map(tuple), max_size=3).map(tuple),
    st.builds(Pair, arrays_of(np.int32), arrays_of(np.float64), st.sampled_from(Side)),
    st.dictionaries(st.text(max_size=3), arrays_of(np.uint8), max_size=3),
    st.sampled_from([np.float32, np.float64]).flatmap(arrays_of),
    st.none() | numbers,
    st.none() | leaves,
    st.lists(arrays_of(np.bool_), max_size=2).map(tuple),
)


def assert_same(one, other):
    """Compare values and their types at any depth."""
    assert type(one) is type(other)
    if isinstance(one, np.ndarray):
        assert (one.dtype, one.shape) == (other.dtype, other.shape)
        assert one.tobytes() == other.tobytes()
    elif dataclasses.is_dataclass(one):
        for part in dataclasses.fields(one):
            assert_same(getattr(one, part.name), getattr(other, part.name))
    elif isinstance(one, tuple):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            assert_same(a, b)
    elif isinstance(one, dict):
        assert list(one) == list(other)
        for name in one:
            assert_same(one[name], other[name])
    else:
        assert one == other


@given(trees)
def test_what_was_flattened_comes_back_equal_and_of_the_same_types(tree):
    flat, arrays = flatten(tree)
    assert_same(restore(Tree, json.loads(json.dumps(flat)), arrays), tree)


@pytest.mark.parametrize(
    ("kind", "value"),
    [
        (tuple[Leaf, NDArray[np.uint8]], (Leaf((0.0, 0.5, 1.0)), np.arange(4, dtype=np.uint8))),
        (dict[str, tuple[int, ...]], {"a": (), "b": (1, 2)}),
        (NDArray[np.uint16], np.zeros((0, 3), np.uint16)),
        (float, float("inf")),
        (tuple[()], ()),
        (Side, Side.RIGHT),
    ],
)
def test_a_type_need_not_be_a_class_of_ours(kind, value):
    flat, arrays = flatten(value)
    assert_same(restore(kind, json.loads(json.dumps(flat)), arrays), value)


Number = TypeVar("Number", bound=np.generic)
Numbers = TypeAliasType("Numbers", np.ndarray[Any, np.dtype[Number]], type_params=(Number,))
Counts = TypeAliasType("Counts", Numbers[np.int32])


@pytest.mark.parametrize("kind", [Numbers[np.int32], Counts])
def test_an_alias_of_a_type_is_that_type(kind):
    flat, arrays = flatten(np.arange(3, dtype=np.int32))
    assert restore(kind, flat, arrays) is arrays[0]
    with pytest.raises(FlatError, match="not of int32"):
        restore(kind, flat, [np.zeros(3, np.float32)])


def test_an_array_that_occurs_twice_comes_back_as_one():
    array = np.arange(3.0)
    flat, arrays = flatten((array, array, array.copy()))
    assert len(arrays) == 2
    first, second, third = restore(tuple[NDArray[np.float64], ...], flat, arrays)
    assert first is second
    assert first is not third


LEAF = {"tint": [0.0, 0.5, 1.0], "name": "near", "on": False}


@pytest.mark.parametrize(
    "flat",
    [
        LEAF | {"new": 1},
        {name: LEAF[name] for name in ("tint", "name")},
        LEAF | {"name": "middle"},
        LEAF | {"on": 0},
        LEAF | {"tint": [0.0, 0.5]},
        LEAF | {"tint": [0.0, 0.5, "1"]},
        LEAF | {"tint": [0.0, 0.5, True]},
        LEAF | {"tint": None},
        [],
        None,
    ],
)
def test_other_fields_and_other_types_are_refused(flat):
    restore(Leaf, LEAF, [])
    with pytest.raises(FlatError):
        restore(Leaf, flat, [])


@pytest.mark.parametrize("flat", [{"array": 1}, {"array": -1}, {"array": True}, {"array": None}, 0])
def test_only_arrays_that_are_there_are_restored(flat):
    arrays = [np.zeros(2, np.float32)]
    assert restore(NDArray[np.float32], {"array": 0}, arrays) is arrays[0]
    with pytest.raises(FlatError):
        restore(NDArray[np.float32], flat, arrays)


def test_an_array_of_another_type_of_numbers_is_refused():
    with pytest.raises(FlatError, match="an array of float64, not of float32"):
        restore(NDArray[np.float32], {"array": 0}, [np.zeros(2)])


@pytest.mark.parametrize(
    "value",
    [
        object(),
        [1, 2],
        {1: "a"},
        np.float64(1.0),
        np.array([None]),
        np.zeros(1, [("a", "f4")]),
        {"deep": ({1, 2},)},
        lambda: None,
    ],
)
def test_what_cannot_come_back_is_not_flattened(value):
    with pytest.raises(FlatError):
        flatten(value)
