"""The language of Webots' `.proto` files, a subset of VRML: text becomes nodes.

Not read: templates (`%< >%`), scripts and routes, which a shape does not need.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NoReturn

__all__ = ["Node", "parsed"]

_TOKEN = re.compile(
    r'\s*(?:,|#[^\n]*|(?P<text>"(?:[^"\\]|\\.)*")|(?P<mark>[\[\]{}])'
    r'|(?P<word>[^\s,#"\[\]{}]+))'
)
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|0[xX][0-9a-fA-F]+")

_DEEPEST = 64
"""Largest nesting of nodes and lists."""
_MOST = 4_000_000
"""Largest number of words and numbers in a file."""

_FIELDS = ("field", "exposedField", "vrmlField", "hiddenField", "unconnectedField", "w3dField")
_WORDS = {"TRUE": True, "FALSE": False, "NULL": None}


@dataclass(slots=True)
class Node:
    """A node: its type, and the fields that are given."""

    kind: str
    fields: dict[str, object] = field(default_factory=dict)
    """Values: nodes, lists of values, numbers as a list of floats, text, truth, or None."""


class _Reader:
    """Reads one file.

    Args:
        text: Its content.
    """

    def __init__(self, text: str) -> None:
        self._tokens = list(_tokens(text))
        self._at = 0
        self._named: dict[str, Node] = {}
        self._defaults: dict[str, object] = {}

    def proto(self) -> Node:
        """Return the node that the PROTO stands for, with its fields at their defaults."""
        while (token := self._next()) != "PROTO":
            if token not in ("EXTERNPROTO", "IMPORTABLE") and not token.startswith('"'):
                self._fail("no PROTO")
        self._next()
        self._expect("[")
        while self._peek() != "]":
            self._interface()
        self._next()
        self._expect("{")
        node = self._node(0)
        self._expect("}")
        return node

    def _interface(self) -> None:
        """Read `field TYPE name value`, which may list allowed values after the type."""
        if self._next() not in _FIELDS:
            self._fail("'field' expected")
        self._next()
        if self._peek() == "{":
            while self._next() != "}":
                pass
        name = self._next()
        self._defaults[name] = self._value(0)

    def _node(self, depth: int) -> Node:
        if depth > _DEEPEST:
            self._fail(f"nested more than {_DEEPEST} deep")
        word = self._next()
        if word == "USE":
            name = self._next()
            if name not in self._named:
                self._fail(f"USE {name}: no such DEF")
            return self._named[name]
        label = self._next() if word == "DEF" else None
        node = Node(self._next() if label is not None else word)
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
            return self._defaults.get(self._next())
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
            numbers.append(float(int(word, 16)) if word[:2] in ("0x", "0X") else float(word))
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


def parsed(text: str) -> Node:
    """Return the node of a PROTO.

    Raises:
        ValueError: It cannot be read; one line.
    """
    if "%<" in text:
        raise ValueError("it is a template (%< ... >%), which only Webots can fill in")
    return _Reader(text).proto()


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
