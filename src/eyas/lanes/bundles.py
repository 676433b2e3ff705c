"""Bundles in the memory format of compiled kernels: tuples of numbers, arrays and other tuples.

The format is that of C structures, with an array described by a structure of its own. Kernels
count no references, so they do not need the two words about the owner of an array's memory.
"""

import ctypes
import operator
import struct
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

Bundle = TypeVar("Bundle")

_SPARE = np.zeros(512)
NOTHING = _SPARE.ctypes.data
"""Address of empty arrays: lanes that are not wanted are read from where the first elements are."""

_DATA = object.__basicsize__
"""Bytes from the beginning of an array to the address of its elements: numpy's C interface has that
first (`PyArrayObject.data`). Its own `ctypes.data` takes seven times as long, half of a short call.
"""

_FORMATS = {bool: "?", int: "q", float: "d"}  # Formats of numbers, in the language of `struct`


class PackedBundle(Generic[Bundle]):
    """A bundle, laid out in the kernels' memory format."""

    __slots__ = ("_memory", "address", "bundle", "kind", "size")

    def __init__(
        self,
        bundle: Bundle,  # The tuple. Its arrays are not copied: kernels see later changes
    ) -> None:
        words: list[Any] = []
        key: list[object] = []
        flatten(bundle, words, key)
        layout = LAYOUTS.get(tuple(key)) or LAYOUTS.setdefault(tuple(key), layout_of(bundle))
        self._memory = bytearray(layout.format.pack(*words))
        self.bundle = bundle
        self.kind = layout.kind  # Identifies the type of the bundle, the same in every process
        self.size = layout.size  # [bytes]
        self.address = ctypes.addressof(ctypes.c_char.from_buffer(self._memory))

    def again(self, bundle: Bundle) -> "PackedBundle[Bundle]":
        """Return this if a bundle has the very same parts, else the other bundle laid out."""
        same = all(map(operator.is_, self.bundle, bundle))  # type: ignore[call-overload]
        return self if same else PackedBundle(bundle)


class _Layout(NamedTuple):
    """How a bundle lies in memory."""

    kind: str
    size: int  # [bytes]
    format: struct.Struct


LAYOUTS: dict[tuple[object, ...], _Layout] = {}  # Layouts by the types in a bundle


def flatten(value: Any, words: list[Any], key: list[object]) -> None:  # noqa: ANN401  # anything
    """Append the words of a value in memory, and the types that determine its layout."""
    if isinstance(value, tuple):
        key += (type(value), len(value))
        for part in value:
            flatten(part, words, key)
    elif isinstance(value, np.ndarray):
        key += (value.dtype, value.ndim, value.flags.num)
        address = ctypes.c_ssize_t.from_address(id(value) + _DATA).value if value.size else NOTHING
        words += (0, 0, value.size, value.itemsize, address)
        words += value.shape
        words += value.strides
    else:
        key.append(type(value))
        words.append(value)


def layout_of(bundle: object) -> _Layout:
    """Return how a bundle lies in memory."""
    kind, code, size, _ = _part(bundle)
    return _Layout(kind, size, struct.Struct(f"={code}" if size else "x"))


class _Part(NamedTuple):
    """How a value lies in memory."""

    kind: str
    code: str  # Format of its words, in the language of `struct`, with all padding
    size: int  # [bytes]
    alignment: int  # [bytes]


def _part(value: object) -> _Part:
    if isinstance(value, np.ndarray):
        words = 5 + 2 * value.ndim
        return _Part(_array_kind(value), f"{words}q", 8 * words, 8)
    if not isinstance(value, tuple):
        code = _format(value)
        size = struct.calcsize(f"={code}")
        return _Part(code, code, size, size)
    kinds, codes, size, alignment = [], [], 0, 1
    for part in map(_part, value):
        codes.append(f"{-size % part.alignment}x{part.code}")
        kinds.append(part.kind)
        size += -size % part.alignment + part.size
        alignment = max(alignment, part.alignment)
    codes.append(f"{-size % alignment}x")
    return _Part(
        _tuple_kind(type(value), kinds), "".join(codes), size + -size % alignment, alignment
    )


def _tuple_kind(cls: Any, kinds: list[str]) -> str:  # noqa: ANN401  # named tuples have no class
    names = getattr(cls, "_fields", None)
    if names is None:
        return f"({', '.join(kinds)})"
    fields = (f"{name}: {kind}" for name, kind in zip(names, kinds, strict=True))
    return f"{cls.__module__}.{cls.__qualname__}({', '.join(fields)})"


def _array_kind(array: NDArray[Any]) -> str:
    flags = array.flags
    order = "C" if flags.c_contiguous else "F" if flags.f_contiguous else "A"
    marks = ("" if flags.writeable else " read-only") + ("" if flags.aligned else " unaligned")
    return f"{array.dtype}[{array.ndim}{order}{marks}]"


def _format(number: object) -> str:
    """Return the format of a number, in the language of `struct`."""
    code = _FORMATS.get(type(number))
    if code is None and isinstance(number, np.generic) and number.dtype.kind in "biuf":
        code = number.dtype.char
    if code is None:
        raise TypeError(f"kernels cannot read a {type(number).__name__}")
    return code.replace("l", "q").replace("L", "Q")
