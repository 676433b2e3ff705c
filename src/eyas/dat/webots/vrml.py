"""Text of Webots' worlds and PROTOs: nodes with fields, after VRML97.

The notation is that of https://cyberbotics.com/doc/reference/nodes-and-api-functions (R2023b): a
node is `Type { field value ... }`, lists stand in brackets, `DEF name` names a node, which `USE
name` shows again, and a field of a PROTO is taken over with `IS`.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

HEADER = "#VRML_SIM R2023b utf8\n"

_STEP = 1e4
"""Numbers are written to a tenth of a millimetre; angles and directions to as many digits."""


class Use(NamedTuple):
    """A node that was named before, once more."""

    name: str


class Is(NamedTuple):
    """The value of a field of the PROTO."""

    name: str


class _Raw(NamedTuple):
    text: str


@dataclass(slots=True)
class Node:
    """A node: its type, its fields, and the name by which it is shown again."""

    kind: str
    fields: "Mapping[str, Value]" = field(default_factory=dict)
    """Numbers, text, truth, vectors as tuples, several values as lists, nodes, None for NULL."""
    name: str = ""  # After DEF; empty: none


Value = (
    float | int | str | bool | tuple[float, ...] | Node | Use | Is | _Raw | Sequence["Value"] | None
)


def floats(values: NDArray[np.floating]) -> _Raw:
    """Return a list of vectors, shape (K, parts), or of numbers, shape (K,)."""
    rounded = np.rint(np.asarray(values, np.float64) * _STEP) / _STEP + 0.0
    if rounded.ndim == 1:
        return _Raw(f"[ {' '.join(map(_number, rounded.tolist()))} ]")
    rows = [" ".join(map(_number, row)) for row in rounded.tolist()]
    return _Raw(f"[ {', '.join(rows)} ]")


def indices(faces: NDArray[np.integer]) -> _Raw:
    """Return the indices of triangles, shape (T, 3), as faces that end with -1."""
    rows = [f"{a} {b} {c} -1" for a, b, c in faces.tolist()]
    return _Raw(f"[ {' '.join(rows)} ]")


def label(name: str) -> str:
    """Return a name that DEF allows."""
    text = re.sub(r"\W+", "_", name, flags=re.ASCII)
    return text if text[:1].isalpha() else f"n{text}"


def world(protos: Sequence[str], importable: Sequence[str], nodes: Sequence[Node]) -> str:
    """Return a world file; paths of the PROTO files of its nodes are relative to it."""
    heads = [f'EXTERNPROTO "{path}"' for path in protos]
    heads += [f'IMPORTABLE EXTERNPROTO "{path}"' for path in importable]
    return "\n".join([HEADER, *heads, "", *map(_told, nodes)]) + "\n"


def proto(name: str, comment: str, interface: Sequence[tuple[str, str, Value]], body: Node) -> str:
    """Return a PROTO file.

    Args:
        name: Of the PROTO and its file.
        comment: What it is.
        interface: Type, name and default of each field. One that no node of the body takes is told
            to be `unconnectedField`, as only controllers read it.
    """
    text = _told(body, 1)
    lines = [HEADER.rstrip(), f"# {comment}", "", f"PROTO {name} ["]
    for kind, field_name, default in interface:
        used = re.search(rf"\bIS {field_name}\b", text) is not None
        word = "field" if used else "unconnectedField"
        lines.append(f"  {word} {kind} {field_name} {_value(default, 1)}")
    return "\n".join([*lines, "]", "{", text, "}"]) + "\n"


def _told(node: Node, depth: int = 0) -> str:
    pad = "  " * depth
    named = f"DEF {node.name} " if node.name else ""
    lines = list(_fields(node, depth + 1))
    return "\n".join([f"{pad}{named}{node.kind} {{", *lines, f"{pad}}}"])


def _fields(node: Node, depth: int) -> Iterator[str]:
    for name, value in node.fields.items():
        taken = f"IS {value.name}" if isinstance(value, Is) else _value(value, depth)
        yield f"{'  ' * depth}{name} {taken}"


def _value(value: Value, depth: int) -> str:
    if value is None:
        return "NULL"
    if isinstance(value, _Raw):
        return value.text
    if isinstance(value, Node):
        return _told(value, depth).lstrip()
    if isinstance(value, Use):
        return f"USE {value.name}"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, tuple):
        return " ".join(_plain(part) for part in value)
    if isinstance(value, Sequence):
        return _list(value, depth)
    return _plain(value)


def _list(values: Sequence[Value], depth: int) -> str:
    if not values:
        return "[]"
    pad = "  " * (depth + 1)
    inner = [f"{pad}{_value(value, depth + 1)}" for value in values]
    return "\n".join(["[", *inner, f"{'  ' * depth}]"])


def _plain(value: float) -> str:
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, int):
        return str(value)
    return _number(float(f"{value:.9g}") + 0.0)


def _number(value: float) -> str:
    text = repr(value)
    return text.removesuffix(".0")
