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


_PARSING = threading.Lock()


class Written(NamedTuple):
    """What is written about a function, or in a whole file; of a file without the names."""

    digest: str
    names: tuple[str, ...]  # The names that it reads, with attributes, `np.float32`.


@cache
def syntax_of(path: Path) -> dict[str, Written]:
    """Return what is written in a file: functions by qualified name, and the whole file by "".

    Raises:
        OSError: The file cannot be read.
        SyntaxError: It is no Python.
    """
    known = INDEX.of(path.read_bytes())
    return {name: Written(digest, tuple(names)) for name, (digest, names) in known.items()}


def tree_of(text: bytes | str, mode: str = "exec") -> ast.AST:
    """Return the syntax tree of a text; one thread at a time.

    Python 3.11 counts the depth of trees for all threads together, and raises `SystemError` when
    two parse at once.
    """
    with _PARSING:
        return ast.parse(text, mode=mode)


def _parsed(text: bytes) -> dict[str, Written]:
    tree = tree_of(text)
    found = {"": Written(_digest("".join(_said(tree)).encode()), ())}
    for name, node in _functions(tree, ""):
        own = _written(node)
        before = found.get(name)  # defined twice, perhaps under conditions
        if before is not None:
            names = {*before.names, *own.names}
            own = Written(_digest((before.digest + own.digest).encode()), tuple(sorted(names)))
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


def _written(node: ast.AST) -> Written:
    return Written(_digest("".join(_said(node)).encode()), tuple(sorted(set(_names(node)))))


def _names(node: ast.AST) -> Iterator[str]:
    """Yield the names that are read, each with the attribute of it that is read, if it is one."""
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
        yield node.id
    elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        yield f"{node.value.id}.{node.attr}"
    else:
        for field, value in ast.iter_fields(node):
            if field not in _LEFT_OUT:
                for part in value if isinstance(value, list) else [value]:
                    if isinstance(part, ast.AST):
                        yield from _names(part)


def _said(node: object) -> Iterator[str]:
    """Yield what a part of a tree says, in the same words in all versions of Python."""
    if isinstance(node, list):
        yield "["
        for part in node:
            yield from _said(part)
        yield "]"
    elif isinstance(node, ast.AST):
        yield f"({type(node).__name__}"
        for name, value in ast.iter_fields(node):
            if name in _LEFT_OUT or value is None or value == []:
                continue
            yield f" {name}="
            yield from _said(_without_docstring(node, value) if name == "body" else value)
        yield ")"
    else:
        yield repr(node)


def _without_docstring(node: ast.AST, body: object) -> object:
    documented = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Module
    if isinstance(node, documented) and isinstance(body, list) and body:
        first = body[0]
        if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
            return body[1:] if isinstance(first.value.value, str) else body
    return body


def _digest(text: bytes) -> str:
    return sha256(text).hexdigest()[:24]


INDEX = TextIndex(Path(__file__), _parsed)  # The syntax of files
