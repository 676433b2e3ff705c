"""The syntax of Python files: what they say, without comments, docstrings and annotations.

A digest of it tells whether a change of a file may change what it computes. It is the same in all
versions of Python, which is why it is not made of bytecode.
"""

import ast
import threading
from collections.abc import Iterator
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

from eyas.lanes.text_index import TextIndex

_LEFT_OUT = frozenset(
    ("annotation", "returns", "decorator_list", "ctx", "type_comment", "type_params", "kind")
)


_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)

_PARSING = threading.Lock()


class SourceSyntax(NamedTuple):
    """What is written about a function, or in a whole file; of a file without the names."""

    digest: str
    names: tuple[str, ...]  # The names that it reads, with attributes, `np.float32`.


@cache
def syntax_of(path: Path) -> dict[str, SourceSyntax]:
    """Return what is written in a file: functions by qualified name, and the whole file by "".

    Raises:
        OSError: The file cannot be read.
        SyntaxError: It is no Python.
    """
    known = INDEX.of(path.read_bytes())
    return {name: SourceSyntax(digest, tuple(names)) for name, (digest, names) in known.items()}


def tree_of(text: bytes | str, mode: str = "exec") -> ast.AST:
    """Return the syntax tree of a text; one thread at a time.

    Python 3.11 counts the depth of trees for all threads together, and raises `SystemError` when
    two parse at once.
    """
    with _PARSING:
        return ast.parse(text, mode=mode)


def _parsed(text: bytes) -> dict[str, SourceSyntax]:
    tree = tree_of(text)
    said = _Said([], [], {})
    said.add(tree)
    found = {"": SourceSyntax(_digest("".join(said.words)), ())}
    for name, node in _functions(tree, ""):
        own = said.of(node)
        before = found.get(name)  # defined twice, perhaps under conditions
        if before is not None:
            names = {*before.names, *own.names}
            own = SourceSyntax(_digest(before.digest + own.digest), tuple(sorted(names)))
        found[name] = own
    return found


def _functions(node: ast.AST, inside: str) -> Iterator[tuple[str, ast.AST]]:
    """Yield all functions by their qualified names."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            name = f"{inside}{child.name}"
            if not isinstance(child, ast.ClassDef):
                yield name, child
                name += ".<locals>"
            yield from _functions(child, f"{name}.")
        else:
            yield from _functions(child, inside)


class _Said(NamedTuple):
    """What a tree says, in the same words in all versions of Python; gone through once, since what
    a function says is a part of what its file says.
    """

    words: list[str]
    names: list[str]  # That are read, each with the attribute of it that is read, if it is one
    functions: dict[ast.AST, tuple[slice, slice]]  # The words and the names of each

    def of(self, function: ast.AST) -> SourceSyntax:
        """Return what is written about a function."""
        words, names = self.functions[function]
        read = tuple(sorted(set(self.names[names])))
        return SourceSyntax(_digest("".join(self.words[words])), read)

    def add(self, node: object, *, named: bool = True) -> None:
        """Add a part of a tree.

        Args:
            node: The part.
            named: Whether the names that it reads count; not of one whose attribute is read.
        """
        if isinstance(node, ast.AST):
            self._add_part(node, named=named)
        elif isinstance(node, list):
            self.words.append("[")
            for part in node:
                self.add(part)
            self.words.append("]")
        else:
            self.words.append(repr(node))

    def _add_part(self, node: ast.AST, *, named: bool) -> None:
        words, names = self.words, self.names
        first, first_name, inner = len(words), len(names), True
        if isinstance(node, ast.Name):
            if named and isinstance(node.ctx, ast.Load):
                names.append(node.id)
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            names.append(f"{node.value.id}.{node.attr}")
            inner = False
        words.append(f"({type(node).__name__}")
        for name in node._fields:
            value = None if name in _LEFT_OUT else getattr(node, name, None)
            if value is None or value == []:
                continue
            words.append(f" {name}=")
            said = _without_docstring(node, value) if name == "body" else value
            self.add(said, named=inner)
        words.append(")")
        if isinstance(node, _FUNCTIONS):
            own = slice(first, len(words)), slice(first_name, len(names))
            self.functions[node] = own


def _without_docstring(node: ast.AST, body: object) -> object:
    documented = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Module
    if isinstance(node, documented) and isinstance(body, list) and body:
        first = body[0]
        if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
            return body[1:] if isinstance(first.value.value, str) else body
    return body


def _digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()[:24]


INDEX = TextIndex(Path(__file__), _parsed)  # The syntax of files
