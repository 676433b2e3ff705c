"""The program as a graph: its definitions, what each says, and what each refers to.

What is kept on disk, resumed or compared is identified by the code that makes it. A *definition* is
what binds a name of a module: a function, a class with its methods, a constant. The *closure* of a
definition is all that it refers to, directly or not, however late it is imported. It is read from
the sources without running them, because a start that finds everything in the cache imports little
of what once made it.

Comments, docstrings, annotations, and the texts of errors and of the log say nothing. Classes that
annotations name are followed, since their methods are called. A text `package.module:attribute`
refers to what it names, as in tables of what is imported late. A package that
uses `import_module` refers to all its modules. Where a name cannot be found, its whole module is
taken: one dependency too many costs seconds, a missing one a wrong result.
"""

import ast
import functools
import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple, cast

from eyas.core.cache.entries import write_whole
from eyas.core.cache.folder import Kind
from eyas.lanes.folder import cache_folder
from eyas.lanes.identity import language_hash
from eyas.lanes.syntax import tree_of

__all__ = [
    "INDEX",
    "Definition",
    "Place",
    "UnknownCodeError",
    "closure_of",
    "code_of",
    "definitions_of",
    "index_of",
]

INDEX = Path(__file__).with_name("definitions.json")
"""The definitions in the files of the package, by digests of their text: reading them from the text
takes some milliseconds for each file. Those of files that were edited are kept in the cache."""

_APART = ("eyas.core.cache", "eyas.core.errors", "eyas.core.own_code", "eyas.core.program")
"""Modules that keep, refuse or find things, and decide no value; not followed."""

_COMPILER = ("eyas.lanes",)
"""Modules that make code of kernels; not followed, `language_hash` stands for all of them."""

_LIBRARIES = {"numpy": "numpy", "shapely": "shapely", "PIL": "pillow", "trimesh": "trimesh"}
"""Libraries that compute, by the names under which they are imported; their versions count."""

_PATH = re.compile(r"[a-z_]\w*(\.\w+)+:\w+")

Place = tuple[str, str]
"""A definition: its module and its name; a library has no name."""


class Definition(NamedTuple):
    """What a module says about one of its names."""

    digest: str
    """Of what it says; empty: the name is imported."""
    refers: tuple[str, ...]
    """Other names of the module, `name`, and of others, `package.module:name.attribute`."""


class UnknownCodeError(TypeError):
    """It is not known where the code of something lies: it was typed in, or made by `exec`."""


def code_of(what: Callable[..., Any]) -> str:
    """Return what identifies the code of a function, of a `partial` of one, or of a class.

    Raises:
        UnknownCodeError: It is not known where its code lies.
    """
    found: Any = what
    while isinstance(found, functools.partial) or hasattr(found, "__wrapped__"):
        found = found.func if isinstance(found, functools.partial) else found.__wrapped__
    for inner in ("function", "py_func", "__func__"):  # of a kernel, and of a bound method
        found = getattr(found, inner, found)
    if not hasattr(found, "__qualname__"):  # an object that can be called
        found = type(found)
    return _code(found.__module__ or "", found.__qualname__.partition(".")[0])


@cache
def _code(module: str, name: str) -> str:
    said = []
    for at, what in sorted(closure_of(module, name)):
        if not what:
            said.append(_library(at))
        elif what == _LANGUAGE:
            said.append(f"language of kernels {language_hash()}")
        else:
            said.append(f"{at}:{what} {definitions_of(at)[what].digest}")
    return _digest("\n".join(filter(None, said)))


def closure_of(module: str, name: str) -> set[Place]:
    """Return a definition and all that it refers to, in Eyas and in the package that it lies in.

    Raises:
        UnknownCodeError: The module's file is not found.
    """
    package = module.partition(".")[0]
    if package in _LIBRARIES:
        return {(package, "")}
    if not definitions_of(module):
        raise UnknownCodeError(f"{module}: its file is not found, so {name} is not identified")
    known = definitions_of(module)
    left = list(_targets(module, name if name in known else "", package))
    seen = set(left)
    while left:
        for other in _references(left.pop(), package):
            if other not in seen:
                seen.add(other)
                left.append(other)
    return seen


_LANGUAGE = "<language>"


@cache
def _references(place: Place, package: str) -> tuple[Place, ...]:
    """Return the definitions that one refers to.

    Args:
        place: The definition.
        package: The package that is followed beside Eyas.
    """
    module, name = place
    if not name or name == _LANGUAGE:
        return ()
    found: dict[Place, None] = {}
    for reference in definitions_of(module)[name].refers:
        at, colon, chain = reference.rpartition(":")
        at = _absolute(at, module) if colon else module
        found.update(dict.fromkeys(_targets(at, chain, package)))
        if at == "importlib" and chain == "import_module":
            for inner in _modules_in(module):
                found.update(dict.fromkeys(_targets(inner, "", package)))
    return tuple(found)


def _modules_in(package: str) -> list[str]:
    """Return the modules in the folder of a package, which it imports by names it has found."""
    path = _path(package)
    if path is None or path.name != "__init__.py":
        return []
    return [f"{package}.{file.stem}" for file in sorted(path.parent.glob("*.py")) if file != path]


@cache
def _targets(module: str, chain: str, package: str) -> tuple[Place, ...]:
    """Return the definitions that a name of a module stands for; all of the module's for "".

    Args:
        module: The module.
        chain: Name and attributes, `exact.length`.
        package: See `_references`.
    """
    if module.partition(".")[0] not in ("eyas", package):
        return ((module.partition(".")[0], ""),)
    if _lies_in(module, _COMPILER):
        return (("eyas", _LANGUAGE),)
    first, _, rest = chain.partition(".")
    inner = f"{module}.{first}"
    known = definitions_of(module)
    if _lies_in(module, _APART):
        return ()
    if first in known:
        if known[first].digest:
            return ((module, first),)
        at, _, name = known[first].refers[0].rpartition(":")
        return _targets(_absolute(at, module), ".".join(filter(None, (name, rest))), package)
    if first and _path(inner) is not None:
        return _targets(inner, rest, package)
    return tuple((module, name) for name, said in known.items() if said.digest)


def _lies_in(module: str, rooms: tuple[str, ...]) -> bool:
    return any(module == room or module.startswith(f"{room}.") for room in rooms)


def _absolute(module: str, inside: str) -> str:
    """Return the whole name of a module that is named from inside another, perhaps with dots."""
    name = module.lstrip(".")
    up = len(module) - len(name)
    if not up:
        return module
    path = _path(inside)
    parts = inside.split(".")
    parts = parts[: len(parts) - up + (path is not None and path.name == "__init__.py")]
    return ".".join(filter(None, (*parts, name)))


@cache
def _library(name: str) -> str:
    if name not in _LIBRARIES:
        return ""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return f"{name} {version(_LIBRARIES[name])}"
    except PackageNotFoundError:
        return ""


@cache
def _path(module: str) -> Path | None:
    """Return the file of a module, which need not be imported; None: there is none."""
    first, _, rest = module.partition(".")
    loaded = sys.modules.get(first)
    if not rest:
        own = getattr(loaded, "__file__", None)
        return Path(own) if own and own.endswith(".py") else None
    for folder in getattr(loaded, "__path__", ()):
        path = Path(folder, *rest.split("."))
        for file in (path / "__init__.py", path.with_suffix(".py")):
            if file.is_file():
                return file
    return None


@cache
def definitions_of(module: str) -> dict[str, Definition]:
    """Return the definitions in a module by name; empty if its file cannot be read."""
    path = _path(module)
    try:
        return {} if path is None else definitions_in(path.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return {}


def definitions_in(text: bytes) -> dict[str, Definition]:
    """Return the definitions in the text of a file, from the package or the cache if possible."""
    digest = _digest(text)
    known = _index().get(digest)
    if known is None:
        kept = cache_folder() / Kind.DEFINITIONS / f"eyas-{digest}.json"
        try:
            known = json.loads(kept.read_bytes())
            return _as_definitions(known)
        except (OSError, ValueError, TypeError, AttributeError):
            found = dict(sorted(_Reader(text).read().items()))
        with suppress(OSError):  # whoever keeps what was made tells of it
            write_whole(kept, [json.dumps(found).encode()])
        return found
    return _as_definitions(known)


def _as_definitions(known: Any) -> dict[str, Definition]:  # noqa: ANN401  # JSON
    # In the same order wherever they come from: builds are digests of them.
    ordered = sorted(known.items())
    return {name: Definition(digest, tuple(refers)) for name, (digest, refers) in ordered}


def index_of(paths: Iterable[Path]) -> str:
    """Return the content of `INDEX` for some files."""
    texts = [path.read_bytes() for path in paths]
    found = {_digest(text): _Reader(text).read() for text in texts}
    return json.dumps(found, separators=(",", ":"), sort_keys=True) + "\n"


@cache
def _index() -> dict[str, Any]:
    try:
        known: dict[str, Any] = json.loads(INDEX.read_bytes())
    except (OSError, ValueError):
        return {}
    return known


class _Reader:
    """Reads the definitions in the text of one file."""

    def __init__(self, text: bytes) -> None:
        self._body = cast("ast.Module", tree_of(text)).body
        self._imports = dict(_imported(self._body))
        self._said: dict[str, list[str]] = {}
        self._refers: dict[str, set[str]] = {}

    def read(self) -> dict[str, Definition]:
        """Return the definitions by name."""
        bound = [(node, sorted(set(_bound(node)))) for node in self._body]
        own = {name for _, names in bound for name in names}
        for node, names in bound:
            refers = self._references(node, own) if names else set()
            said = _said(node) if names else ""
            for name in names:
                self._said.setdefault(name, []).append(said)
                self._refers.setdefault(name, set()).update(refers)
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                for changed in set(_changed(node)) & own:  # a table that it fills
                    self._refers.setdefault(changed, set()).add(node.name)
        imported = {name: Definition("", (at,)) for name, at in sorted(self._imports.items())}
        return imported | {
            name: Definition(_digest("".join(said)), tuple(sorted(self._refers[name] - {name})))
            for name, said in sorted(self._said.items())
        }

    def _references(self, node: ast.stmt, own: set[str]) -> set[str]:
        """Return what a statement refers to, by its own imports and those of the module."""
        inside = [one for one in ast.walk(node) if isinstance(one, ast.Import | ast.ImportFrom)]
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
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield from _names_of(node)
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
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
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield node.name
        for decorator in node.decorator_list:  # `TABLE.add` may put it into a table
            yield from (chain.partition(".")[0] for chain in _read(decorator) if "." in chain)
    elif isinstance(node, ast.Expr):
        if not _is_message(node):  # a call of a method, or with what it changes
            yield from (chain.partition(".")[0] for chain in _read(node))
    elif not isinstance(node, ast.Import | ast.ImportFrom):
        yield from _changed(node)
        for part in ast.walk(node):
            if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store | ast.Del):
                yield part.id
        for part in ast.iter_child_nodes(node):
            if isinstance(part, ast.stmt | ast.excepthandler):
                yield from _bound(part)


def _changed(node: ast.AST) -> Iterator[str]:
    """Yield names whose things are changed: `NAME.append(...)`, `NAME[...] = `, `global NAME`."""
    for part in ast.walk(node):
        if isinstance(part, ast.Global):
            yield from part.names
            continue
        inner: ast.AST | None = None
        if isinstance(part, ast.Expr) and isinstance(part.value, ast.Call):
            inner = part.value.func if not _is_message(part) else None
        elif isinstance(part, ast.Subscript | ast.Attribute):
            inner = part if isinstance(part.ctx, ast.Store | ast.Del) else None
        if isinstance(inner, ast.Subscript | ast.Attribute):
            while isinstance(inner, ast.Subscript | ast.Attribute):
                inner = inner.value
            if isinstance(inner, ast.Name):
                yield inner.id


def _is_message(node: object) -> bool:
    """Return whether a statement only tells something: documentation, or a line for the log."""
    if not isinstance(node, ast.Expr):
        return False
    value = node.value
    if isinstance(value, ast.Constant):
        return isinstance(value.value, str)
    told = value.func if isinstance(value, ast.Call) else None
    return (
        isinstance(told, ast.Attribute)
        and isinstance(told.value, ast.Name)
        and told.value.id == "_LOG"
    )


def _parts(node: ast.AST) -> Iterator[tuple[str, object]]:
    """Yield what counts of a part of a tree, field by field."""
    if isinstance(node, ast.Raise):  # what is raised, not the text
        yield "exc", node.exc.func if isinstance(node.exc, ast.Call) else node.exc
    elif isinstance(node, ast.Assert):
        yield "test", node.test
    else:
        for name in node._fields:
            value = getattr(node, name, None)
            if isinstance(value, list):
                value = [part for part in value if not _is_message(part)]
            if value is not None and value != [] and name not in _SILENT:
                yield name, value


_SILENT = frozenset(("ctx", "type_comment", "type_params", "kind"))


def _read(node: ast.AST, *, annotation: bool = False) -> Iterator[str]:
    """Yield the names that are read, each with the attributes that are read, and texts of paths."""
    if isinstance(node, ast.Name):
        # What a class or a function binds is its own.
        yield from (node.id,) if isinstance(node.ctx, ast.Load) else ()
    elif isinstance(node, ast.Attribute):
        names: list[str] = []
        inner: ast.AST = node
        while isinstance(inner, ast.Attribute):
            names.append(inner.attr)
            inner = inner.value
        if isinstance(inner, ast.Name):
            yield ".".join([inner.id, *reversed(names)])
        else:
            yield from _read(inner, annotation=annotation)
    elif isinstance(node, ast.Constant):
        if isinstance(node.value, str):
            yield from _read_text(node.value, annotation=annotation)
    else:
        for name, value in _parts(node):
            typed = annotation or name in ("annotation", "returns")
            for part in value if isinstance(value, list) else [value]:
                if isinstance(part, ast.AST):
                    yield from _read(part, annotation=typed)


def _read_text(text: str, *, annotation: bool) -> Iterator[str]:
    if annotation:
        try:
            yield from _read(tree_of(text, mode="eval"), annotation=True)
        except SyntaxError:  # a text among the arguments of `Literal` or `Annotated`
            return
    elif _PATH.fullmatch(text):
        yield text


def _said(node: ast.AST) -> str:
    """Return what a statement says, in the same words in all versions of Python."""
    words: list[str] = []
    _say(node, words, fields=False)
    return "".join(words)


def _say(node: object, words: list[str], *, fields: bool) -> None:
    """Add what a part of a tree says; of annotations only those of fields of classes."""
    if isinstance(node, list):
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


def _digest(text: str | bytes) -> str:
    return sha256(text.encode() if isinstance(text, str) else text).hexdigest()[:32]
