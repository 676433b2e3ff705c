"""The language of Webots' `.proto` files, a subset of VRML: text becomes nodes.

Templates (`%< >%`, `%{ }%`) are filled in by `eyas.dat.proto_template`. Not read: routes, which a
shape does not need.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NoReturn

from eyas.dat.proto_script import Limits
from eyas.dat.proto_template import filled_in

_TOKEN = re.compile(
    r'\s*(?:,|#[^\n]*|(?P<text>"(?:[^"\\]|\\.)*")|(?P<mark>[\[\]{}])'
    r'|(?P<word>[^\s,#"\[\]{}]+))'
)
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|0[xX][0-9a-fA-F]+")

_DEEPEST = 64  # Largest nesting of nodes and lists
_LARGEST = 1e30  # Largest number; motors that know no bounds have large ones
_MOST = 4_000_000  # Largest number of words and numbers in a file

_FIELDS = ("field", "exposedField", "vrmlField", "hiddenField", "unconnectedField", "w3dField")
_WORDS = {"TRUE": True, "FALSE": False, "NULL": None}


@dataclass(slots=True)
class ProtoNode:
    """A node: its type, and the fields that are given."""

    kind: str
    fields: dict[str, object] = field(default_factory=dict)
    """Values: nodes, lists of values, numbers as a list of floats, text, truth, or None."""


@dataclass(frozen=True, slots=True)
class Proto:
    """What a file tells."""

    body: ProtoNode  # The node that the PROTO stands for
    externs: dict[str, str]  # Addresses of other PROTOs, by their names
    year: int  # Of the Webots for which it is made


class _Reader:
    """Reads one file, with values of the PROTO's fields that are not their defaults."""

    def __init__(self, text: str, given: Mapping[str, object]) -> None:
        self._tokens = list(_tokens(text))
        self._at = 0
        self._named: dict[str, ProtoNode] = {}
        self._values: dict[str, object] = {}
        self._usual: dict[str, tuple[str, object]] = {}  # Types and defaults of the fields
        self._given = given

    def head(self) -> dict[str, str]:
        """Read up to the brace before the body; return the addresses of other PROTOs."""
        externs = {}
        while (token := self._next()) != "PROTO":
            if token.startswith('"'):
                address = token[1:-1]
                externs[address.rpartition("/")[2].removesuffix(".proto")] = address
            elif token not in ("EXTERNPROTO", "IMPORTABLE"):
                self._fail("no PROTO of Webots")
        self._next()
        self._expect("[")
        while self._peek() != "]":
            self._interface()
        self._next()
        self._expect("{")
        return externs

    def body(self) -> ProtoNode:
        """Return the node, with the values of the PROTO's fields in their places."""
        node = self._node(0)
        self._expect("}")
        return node

    def fields(self) -> dict[str, object]:
        """Return the PROTO's fields as templates see them."""
        return {
            name: {"value": _plain(kind, self._values[name]), "defaultValue": _plain(kind, usual)}
            for name, (kind, usual) in self._usual.items()
        }

    def _interface(self) -> None:
        """Read `field TYPE name value`, which may list allowed values after the type."""
        if self._next() not in _FIELDS:
            self._fail("'field' expected")
        kind = self._next()
        if self._peek() == "{":
            while self._next() != "}":
                pass
        name = self._next()
        usual = self._value(0)
        self._usual[name] = kind, usual
        self._values[name] = self._given.get(name, usual)

    def _node(self, depth: int) -> ProtoNode:
        if depth > _DEEPEST:
            self._fail(f"nested more than {_DEEPEST} deep")
        word = self._next()
        if word == "USE":
            name = self._next()
            if name not in self._named:
                self._fail(f"USE {name}: no such DEF")
            return self._named[name]
        label = self._next() if word == "DEF" else None
        node = ProtoNode(self._next() if label is not None else word)
        if label is not None:
            self._named[label] = node  # a USE inside itself shows nothing more
        self._expect("{")
        while self._peek() != "}":
            name = self._next()
            if name in ("[", "]", "{"):
                self._fail(f"a field's name expected, not '{name}'")
            node.fields[name] = self._value(depth + 1)
        self._next()
        return node

    def _value(self, depth: int) -> object:
        token = self._peek()
        if depth > _DEEPEST:
            self._fail(f"nested more than {_DEEPEST} deep")
        if token == "[":
            return self._list(depth)
        if token == "IS":
            self._next()
            return self._values.get(self._next())
        if token.startswith('"'):
            return self._next()[1:-1]
        if token in _WORDS:
            return _WORDS[self._next()]
        if _NUMBER.fullmatch(token):
            return self._numbers()
        return self._node(depth + 1)

    def _list(self, depth: int) -> object:
        self._next()
        if _NUMBER.fullmatch(self._peek()):
            numbers = self._numbers()
            self._expect("]")
            return numbers
        items = []
        while self._peek() != "]":
            items.append(self._value(depth + 1))
        self._next()
        return items

    def _numbers(self) -> list[float]:
        numbers = []
        while self._at < len(self._tokens) and _NUMBER.fullmatch(self._tokens[self._at]):
            word = self._next()
            number = float(int(word, 16)) if word[:2] in ("0x", "0X") else float(word)
            if not abs(number) <= _LARGEST:
                self._fail(f"the number {word[:30]} is not allowed: up to {_LARGEST:g}")
            numbers.append(number)
        return numbers

    def _peek(self) -> str:
        if self._at >= len(self._tokens):
            self._fail("cut off")
        return self._tokens[self._at]

    def _next(self) -> str:
        token = self._peek()
        self._at += 1
        return token

    def _expect(self, mark: str) -> None:
        if (token := self._next()) != mark:
            self._fail(f"'{mark}' expected, not {token[:30]!r}")

    def _fail(self, what: str) -> NoReturn:
        raise ValueError(f"{what} (word {self._at})")


def parsed(
    text: str, given: Mapping[str, object] = MappingProxyType({}), limits: Limits | None = None
) -> Proto:
    """Return what the text of a PROTO tells.

    Args:
        given: Values of its fields that are not their defaults.
        limits: Counts what its template does.

    Raises:
        ValueError: It cannot be read; one line.
    """
    template = re.search("%[<{]", text)
    if template is not None:
        reader = _Reader(text[: template.start()], given)
        reader.head()
        text = filled_in(text, reader.fields(), limits or Limits())
    reader = _Reader(text, given)
    externs = reader.head()
    year = re.match(r"#VRML_SIM\s+[RV](20\d\d)", text)
    return Proto(reader.body(), externs, int(year[1]) if year else _NEWEST)


_NEWEST = 2025  # Year of a file that does not say for which Webots it is

_PARTS = {"SFVec2f": "xy", "SFVec3f": "xyz", "SFRotation": "xyza", "SFColor": "rgb"}
"""Names of the numbers of a value in templates, by its type."""


def _plain(kind: str, value: object) -> object:
    """Return a field's value as templates see it."""
    if isinstance(value, ProtoNode):
        inside = {name: {"value": _plain("", one)} for name, one in value.fields.items()}
        return {"node_name": value.kind, "fields": inside}
    if not isinstance(value, list):
        return [value] if kind.startswith("MF") else value
    if value and isinstance(value[0], float):
        parts = _PARTS.get(kind.replace("MF", "SF", 1), "")
        if not parts:
            return [*value] if kind.startswith("MF") or len(value) > 1 else value[0]
        size = len(parts)
        rows = [
            dict(zip(parts, value[k : k + size], strict=False)) for k in range(0, len(value), size)
        ]
        return rows if kind.startswith("MF") else rows[0]
    return [_plain("", one) for one in value]


def _tokens(text: str) -> Iterator[str]:
    place, count = 0, 0
    while found := _TOKEN.match(text, place):
        place = found.end()
        token = found["text"] or found["mark"] or found["word"]
        if token is not None:
            count += 1
            if count > _MOST:
                raise ValueError(f"more than {_MOST} words")
            yield token
    if text[place:].strip():
        raise ValueError("a text without its end")
