"""Conversion of structured values to plain JSON and a list of arrays, and back.

Values that can be flattened: arrays, dataclasses, named tuples, tuples, dicts with names as keys,
enums, None, truth values, numbers and text, at any depth. A dataclass is restored by its
constructor. An array that occurs twice is stored once and restored as one array.
"""

import dataclasses
import types
from collections.abc import Callable, Sequence
from enum import Enum
from functools import cache
from typing import Any, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.generic]
Json = None | bool | int | float | str | list["Json"] | dict[str, "Json"]
Thing = TypeVar("Thing")

_ARRAY = "array"


class FlatError(ValueError):
    """A value cannot be flattened, or a flattened value is not of the expected type."""


def flatten(value: object) -> tuple[Json, list[Array]]:
    """Return a value as JSON, in which numbers stand for arrays, and the arrays.

    Raises:
        FlatError: The value holds something that cannot be flattened.
    """
    places: dict[int, tuple[int, Array]] = {}
    flat = _flatten(value, places)
    return flat, [array for _, array in places.values()]


def _flatten(value: object, places: dict[int, tuple[int, Array]]) -> Json:
    if isinstance(value, np.ndarray):
        if value.dtype.hasobject or value.dtype.names:
            raise FlatError(f"an array of {value.dtype} cannot be flattened")
        return {_ARRAY: places.setdefault(id(value), (len(places), value))[0]}
    if isinstance(value, Enum):
        return cast("Json", value.value)
    if value is None or type(value) in (bool, int, float, str):
        return cast("Json", value)
    parts = _parts(value)
    if parts is not None:
        return {name: _flatten(part, places) for name, part in parts.items()}
    if type(value) is tuple:
        return [_flatten(part, places) for part in value]
    raise FlatError(f"{type(value).__name__} cannot be flattened")


def restore(expected: type[Thing], flat: Json, arrays: Sequence[Array]) -> Thing:
    """Return a value of the expected type from its flattened form.

    Raises:
        FlatError: It is not of that type: fields are missing, unknown or of other types.
    """
    return cast("Thing", _restore(expected, flat, arrays))


def _restore(expected: Any, flat: Json, arrays: Sequence[Array]) -> object:  # noqa: ANN401  # a type
    expected = _without_alias(expected)
    origin = get_origin(expected) or expected
    if origin in _BY_ORIGIN:
        return _BY_ORIGIN[origin](get_args(expected), flat, arrays)
    if isinstance(origin, type) and issubclass(origin, Enum):
        return _checked(origin, flat)
    fields = _field_types(origin)
    if fields is not None:
        if not isinstance(flat, dict) or flat.keys() != fields.keys():
            raise FlatError(f"{origin.__name__}: other fields than {', '.join(fields)}")
        return origin(**{name: _restore(fields[name], flat[name], arrays) for name in fields})
    if type(flat) is expected or (expected is float and type(flat) is int):
        return flat
    raise FlatError(f"{expected}: not of this type: {flat!r:.40}")


def _without_alias(expected: Any) -> Any:  # noqa: ANN401  # a type
    """Return what an alias by PEP 695 stands for: `NDArray` is one since numpy 2.5."""
    alias = get_origin(expected) or expected
    meaning = getattr(alias, "__value__", None)  # of `typing` or of `typing_extensions`
    if meaning is None:
        return expected
    parameters = get_args(expected)
    return _without_alias(meaning[parameters] if parameters else meaning)


def _array(types_: tuple[Any, ...], flat: Json, arrays: Sequence[Array]) -> Array:
    place = flat.get(_ARRAY) if isinstance(flat, dict) and len(flat) == 1 else None
    if type(place) is not int or not 0 <= place < len(arrays):
        raise FlatError(f"no array: {flat!r:.40}")
    array = arrays[place]
    (kind,) = get_args(types_[1]) if types_ else (np.generic,)
    if kind is not Any and not np.issubdtype(array.dtype, kind):
        raise FlatError(f"an array of {array.dtype}, not of {kind.__name__}")
    return array


def _tuple(types_: tuple[Any, ...], flat: Json, arrays: Sequence[Array]) -> tuple[object, ...]:
    if not isinstance(flat, list):
        raise FlatError(f"no tuple: {flat!r:.40}")
    if len(types_) == 2 and types_[1] is Ellipsis:
        types_ = types_[:1] * len(flat)
    if len(types_) != len(flat):
        raise FlatError(f"a tuple of {len(flat)}, not of {len(types_)}")
    return tuple(_restore(kind, part, arrays) for kind, part in zip(types_, flat, strict=True))


def _dict(types_: tuple[Any, ...], flat: Json, arrays: Sequence[Array]) -> dict[str, object]:
    if not isinstance(flat, dict) or len(types_) != 2 or types_[0] is not str:
        raise FlatError(f"no dict with names as keys: {flat!r:.40}")
    return {name: _restore(types_[1], part, arrays) for name, part in flat.items()}


def _optional(types_: tuple[Any, ...], flat: Json, arrays: Sequence[Array]) -> object:
    kinds = [kind for kind in types_ if kind is not types.NoneType]
    if len(kinds) != 1 or len(kinds) == len(types_):
        raise FlatError(f"{types_}: only one type or None can be restored")
    return None if flat is None else _restore(kinds[0], flat, arrays)


_BY_ORIGIN: dict[Any, Callable[[tuple[Any, ...], Json, Sequence[Array]], object]] = {
    np.ndarray: _array,
    tuple: _tuple,
    dict: _dict,
    Union: _optional,
    types.UnionType: _optional,
}


def _checked(kind: type[Enum], flat: Json) -> Enum:
    try:
        return kind(flat)
    except ValueError as error:
        raise FlatError(str(error)) from None


def _parts(value: object) -> dict[str, object] | None:
    if isinstance(value, dict):
        if not all(type(name) is str for name in value):
            raise FlatError("a dict with keys that are not names cannot be flattened")
        return value
    kind: Any = type(value)
    names = _field_types(kind)
    return None if names is None else {name: getattr(value, name) for name in names}


@cache
def _field_types(kind: type) -> dict[str, Any] | None:
    """Return the types of the fields of a dataclass or named tuple; None for other types."""
    if dataclasses.is_dataclass(kind):
        names = [field.name for field in dataclasses.fields(kind)]
    elif isinstance(kind, type) and issubclass(kind, tuple) and hasattr(kind, "_fields"):
        names = list(kind._fields)
    else:
        return None
    hints = get_type_hints(kind)
    return {name: hints[name] for name in names}
