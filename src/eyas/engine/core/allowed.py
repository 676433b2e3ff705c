"""Descriptions in words of the values a setting allows, made from its type and its limits."""

import types
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import (
    Annotated,
    ClassVar,
    Literal,
    Protocol,
    Union,
    get_args,
    get_origin,
    runtime_checkable,
)

import annotated_types
from pydantic.fields import FieldInfo


@runtime_checkable
class JsonNotation(Protocol):
    """A type that describes how its values are written in JSON."""

    notation: ClassVar[str]  # For example `{"uniform": [low, high]}`


@dataclass(frozen=True, slots=True)
class TextForm:
    """The texts that a pattern allows, in words; stands in `Annotated`."""

    words: str


@dataclass(frozen=True, slots=True)
class _Limits:
    low: float | None = None
    above: float | None = None
    high: float | None = None
    below: float | None = None


def describe(
    annotation: object,  # The type, as in `FieldInfo.annotation`
    metadata: Sequence[object] = (),  # Its limits, as in `FieldInfo.metadata`
) -> str:
    """Describe the values a field of this type takes, such as `a whole number from 1 to 500`."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return describe(parts[0], parts[1:])
    if origin in (Union, types.UnionType):
        return _either([describe(part) for part in parts])
    if origin is Literal:
        return _either([_quoted(value) for value in parts])
    if origin is tuple:
        return _list(parts)
    if isinstance(annotation, type) and issubclass(annotation, Enum):
        return _either([_quoted(member.value) for member in annotation])
    if isinstance(annotation, type) and isinstance(annotation, JsonNotation):
        return annotation.notation
    simple = {bool: "true or false", str: _text(metadata), types.NoneType: "null"}
    if annotation in simple:
        return simple[annotation]
    if annotation in (int, float):
        return _number(annotation, _limits(metadata))
    return "an object"


def _text(metadata: Sequence[object]) -> str:
    words = [entry.words for entry in metadata if isinstance(entry, TextForm)]
    empty = any(isinstance(entry, annotated_types.MinLen) for entry in metadata)
    return words[0] if words else "text, not empty" if empty else "text"


def names_of(annotation: object) -> tuple[str, ...]:
    """Return the names a field can choose from; empty if it is not a choice of names."""
    if get_origin(annotation) in (Union, types.UnionType):
        return tuple(name for part in get_args(annotation) for name in names_of(part))
    if isinstance(annotation, type) and issubclass(annotation, Enum):
        return tuple(str(member.value) for member in annotation)
    return ()


def _quoted(value: object) -> str:
    return f"'{value}'" if isinstance(value, str) else str(value)


def _either(parts: list[str]) -> str:
    parts = sorted(
        parts, key=lambda part: part != "null"
    )  # null comes first, so that it does not read as part of a list
    return " or ".join([", ".join(parts[:-1]), parts[-1]]) if len(parts) > 1 else parts[0]


def _list(parts: tuple[object, ...]) -> str:
    if len(parts) == 2 and parts[1] is ...:
        return f"a list, each {describe(parts[0])}"
    items = [describe(part) for part in parts]
    if len(set(items)) == 1:
        return f"a list of {len(items)}, each {items[0]}"
    return f"[{', '.join(items)}]"


def _limits(metadata: Sequence[object]) -> _Limits:
    low = above = high = below = None
    for entry in metadata:
        match entry:
            case FieldInfo(metadata=inner):
                return _limits(inner)
            case annotated_types.Ge(ge=limit):
                low = limit
            case annotated_types.Gt(gt=limit):
                above = limit
            case annotated_types.Le(le=limit):
                high = limit
            case annotated_types.Lt(lt=limit):
                below = limit
    return _Limits(low, above, high, below)  # type: ignore[arg-type]  # limits of settings are numbers


def _number(kind: object, limits: _Limits) -> str:
    word = "a whole number" if kind is int else "a number"
    low, high = limits.low, limits.high
    if low is not None and high is not None:
        return f"{word} from {_digits(low)} to {_digits(high)}"
    bounds = (
        ("of at least", low),
        ("above", limits.above),
        ("up to", high),
        ("below", limits.below),
    )
    words = [f"{phrase} {_digits(limit)}" for phrase, limit in bounds if limit is not None]
    return f"{word} {' and '.join(words)}".rstrip()


def _digits(limit: float) -> str:
    return str(limit) if isinstance(limit, int) else f"{limit:.12g}"
