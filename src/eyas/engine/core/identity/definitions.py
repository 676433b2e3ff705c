"""Definitions in the text of a file of Python: each name of the module, what it says, and what it
refers to; see `eyas.engine.core.identity.program`.

Comments, docstrings, annotations, and the texts of errors and of the log say nothing. Classes that
annotations name are referred to, since their methods are called. A text `package.module:attribute`
refers to what it names, as in tables of what is imported late.
"""

import ast
import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple, cast

from eyas.lanes.syntax import tree_of
from eyas.lanes.text_index import TextIndex, digest_of

_PATH = re.compile(r"[a-z_]\w*(\.\w+)+:\w+")  # Texts that name code, `package.module:attribute`


# Tuples: to make unions anew for each part of each tree takes a tenth of the time.
_NAMED = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_IMPORTS = (ast.Import, ast.ImportFrom)
_PLACES = (ast.Subscript, ast.Attribute)
_WRITES = (ast.Store, ast.Del)
_LEAVES = (ast.Name, ast.Constant, ast.expr_context, ast.operator)


class Definition(NamedTuple):
    """A definition: what a module says about one of its names."""

    digest: str  # Digest of what it says; empty: the name is imported
    refers: tuple[str, ...]
    """Other names of the module, `name`, and of others, `package.module:name.attribute`."""


def read_definitions(text: bytes) -> dict[str, Definition]:
    """Return the definitions in the text of a file, by name.

    Raises:
        SyntaxError: The text is not of Python.
        ValueError: It has a null byte.
    """
    return _Reader(text).read()


class _Reader:
    """Reads the definitions in the text of one file."""

    def __init__(self, text: bytes) -> None:
        self._body = cast("ast.Module", tree_of(text)).body
        self._imports = dict(_imported(self._body))
        self._texts: dict[str, list[str]] = {}
        self._refers: dict[str, set[str]] = {}

    def read(self) -> dict[str, Definition]:
        """Return the definitions by name."""
        bound = [(node, sorted(set(_bound(node)))) for node in self._body]
        own = {name for _, names in bound for name in names}
        for node, names in bound:
            refers = self._references(node, own) if names else set()
            text = _texts(node) if names else ""
            for name in names:
                self._texts.setdefault(name, []).append(text)
                self._refers.setdefault(name, set()).update(refers)
            if isinstance(node, _NAMED):
                for changed in set(_changed(node)) & own:  # a table that it fills
                    self._refers.setdefault(changed, set()).add(node.name)
        imported = {name: Definition("", (at,)) for name, at in sorted(self._imports.items())}
        return imported | {
            name: Definition(digest_of("".join(text)), tuple(sorted(self._refers[name] - {name})))
            for name, text in sorted(self._texts.items())
        }

    def _references(self, node: ast.stmt, own: set[str]) -> set[str]:
        """Return what a statement refers to, by its own imports and those of the module."""
        inside = [one for one in _walked(node) if isinstance(one, _IMPORTS)]
        imports = self._imports | dict(pair for one in inside for pair in _names_of(one))
        found = set()
        for chain in _read(node):
            root, _, rest = chain.partition(".")
            if ":" in chain:
                found.add(chain)
            elif root in imports:
                at = imports[root]
                found.add(f"{at}{'' if at.endswith(':') or not rest else '.'}{rest}")
            if root in own:
                found.add(root)
        return found


def _imported(nodes: Iterable[ast.AST]) -> Iterator[tuple[str, str]]:
    """Yield the names that a module imports, and where from; not those inside functions."""
    for node in nodes:
        if isinstance(node, _IMPORTS):
            yield from _names_of(node)
        elif not isinstance(node, _NAMED):
            yield from _imported(ast.iter_child_nodes(node))


def _names_of(node: ast.Import | ast.ImportFrom) -> Iterator[tuple[str, str]]:
    for one in node.names:
        if isinstance(node, ast.Import):
            at = one.name if one.asname else one.name.partition(".")[0]
            yield one.asname or at, f"{at}:"
        else:
            yield one.asname or one.name, f"{'.' * node.level}{node.module or ''}:{one.name}"


def _bound(node: ast.stmt | ast.excepthandler) -> Iterator[str]:
    """Yield the names of a module that a statement of it binds or may change."""
    if isinstance(node, _NAMED):
        yield node.name
        for decorator in node.decorator_list:  # `TABLE.add` may put it into a table
            yield from (chain.partition(".")[0] for chain in _read(decorator) if "." in chain)
    elif isinstance(node, ast.Expr):
        if not _is_message(node):  # a call of a method, or with what it changes
            yield from (chain.partition(".")[0] for chain in _read(node))
    elif not isinstance(node, _IMPORTS):
        yield from _changed(node)
        for part in _walked(node):
            if isinstance(part, ast.Name) and isinstance(part.ctx, _WRITES):
                yield part.id
        for part in ast.iter_child_nodes(node):
            if isinstance(part, ast.stmt | ast.excepthandler):
                yield from _bound(part)


def _changed(node: ast.AST) -> Iterator[str]:
    """Yield names whose things are changed: `NAME.append(...)`, `NAME[...] = `, `global NAME`."""
    for part in _walked(node):
        if isinstance(part, ast.Global):
            yield from part.names
            continue
        inner: ast.AST | None = None
        if isinstance(part, ast.Expr) and isinstance(part.value, ast.Call):
            inner = part.value.func if not _is_message(part) else None
        elif isinstance(part, _PLACES):
            inner = part if isinstance(part.ctx, _WRITES) else None
        if isinstance(inner, _PLACES):
            while isinstance(inner, _PLACES):
                inner = inner.value
            if isinstance(inner, ast.Name):
                yield inner.id


@lru_cache(maxsize=1)  # asked for twice of each statement
def _walked(node: ast.AST) -> list[ast.AST]:
    """Return the parts of a tree in the order of `ast.walk`, which takes four times as long."""
    found = [node]
    for part in found:  # which grows meanwhile
        for name in () if isinstance(part, _LEAVES) else part._fields:
            value = getattr(part, name, None)
            if isinstance(value, list):
                found += [one for one in value if isinstance(one, ast.AST)]
            elif isinstance(value, ast.AST):
                found.append(value)
    return found


def _is_message(node: object) -> bool:
    """Return whether a statement only tells something: documentation, or a line for the log."""
    if not isinstance(node, ast.Expr):
        return False
    value = node.value
    if isinstance(value, ast.Constant):
        return isinstance(value.value, str)
    called = value.func if isinstance(value, ast.Call) else None
    return (
        isinstance(called, ast.Attribute)
        and isinstance(called.value, ast.Name)
        and called.value.id == "_LOG"
    )


def _parts(node: ast.AST) -> list[tuple[str, object]]:
    """Return what counts of a part of a tree, field by field."""
    if isinstance(node, ast.Raise):  # what is raised, not the text
        return [("exc", node.exc.func if isinstance(node.exc, ast.Call) else node.exc)]
    if isinstance(node, ast.Assert):
        return [("test", node.test)]
    found: list[tuple[str, object]] = []
    for name in node._fields:
        value = None if name in _SILENT else getattr(node, name, None)
        if isinstance(value, list):
            value = [part for part in value if not _is_message(part)]
        if value is not None and value != []:
            found.append((name, value))
    return found


_SILENT = frozenset(("ctx", "type_comment", "type_params", "kind"))


def _read(node: ast.AST) -> list[str]:
    """Return the names that are read, each with attributes that are read, and texts of paths."""
    found: list[str] = []
    _add_read(node, found, annotation=False)
    return found


def _add_read(node: ast.AST, found: list[str], *, annotation: bool) -> None:
    """Add what `_read` returns."""
    if isinstance(node, ast.Name):
        if isinstance(node.ctx, ast.Load):  # what a class or a function binds is its own
            found.append(node.id)
    elif isinstance(node, ast.Attribute):
        names: list[str] = []
        inner: ast.AST = node
        while isinstance(inner, ast.Attribute):
            names.append(inner.attr)
            inner = inner.value
        if isinstance(inner, ast.Name):
            found.append(".".join([inner.id, *reversed(names)]))
        else:
            _add_read(inner, found, annotation=annotation)
    elif isinstance(node, ast.Constant):
        if isinstance(node.value, str):
            _add_read_text(node.value, found, annotation=annotation)
    else:
        for name, value in _parts(node):
            typed = annotation or name in ("annotation", "returns")
            for part in value if isinstance(value, list) else [value]:
                if isinstance(part, ast.AST):
                    _add_read(part, found, annotation=typed)


def _add_read_text(text: str, found: list[str], *, annotation: bool) -> None:
    if annotation:
        try:
            tree = tree_of(text, mode="eval")
        except SyntaxError:  # a text among the arguments of `Literal` or `Annotated`
            return
        _add_read(tree, found, annotation=True)
    elif _PATH.fullmatch(text):
        found.append(text)


def _texts(node: ast.AST) -> str:
    """Return what a statement says, in the same words in all versions of Python."""
    words: list[str] = []
    _say(node, words, fields=False)
    return "".join(words)


def _say(node: object, words: list[str], *, fields: bool) -> None:
    """Add what a part of a tree says; of annotations only those of fields of classes."""
    if isinstance(node, ast.Name):  # half of all parts
        words.append(f"(Name id={node.id!r})")
    elif isinstance(node, list):
        words.append("[")
        for part in node:
            _say(part, words, fields=fields)
        words.append("]")
    elif isinstance(node, ast.AST):
        words.append(f"({type(node).__name__}")
        for name, value in _parts(node):
            if name != "returns" and (name != "annotation" or fields):
                words.append(f" {name}=")
                _say(value, words, fields=isinstance(node, ast.ClassDef) and name == "body")
        words.append(")")
    else:
        words.append(repr(node))


INDEX = TextIndex(Path(__file__), read_definitions)  # The definitions in files
