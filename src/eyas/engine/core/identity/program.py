"""The program as a graph: its definitions, what each says, and what each refers to.

What is kept on disk, resumed or compared is identified by the code that makes it. A *definition* is
what binds a name of a module: a function, a class with its methods, a constant. The *closure* of a
definition is all that it refers to, directly or not, however late it is imported. It is read from
the sources without running them, because a start that finds everything in the cache imports little
of what once made it.

What a definition says and refers to is read by `definitions.py`. A package that uses
`import_module` refers to all its modules. Where a name cannot be found, its whole module is taken:
one dependency too many costs seconds, a missing one a wrong result.
"""

import functools
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from eyas.engine.core.identity.definitions import INDEX, Definition
from eyas.lanes.identity import language_hash
from eyas.lanes.text_index import digest_of

_OWN = __name__.partition(".")[0]  # The package, which is followed from everywhere
_ROOM = __name__.rpartition(".")[0]
_APART = (f"{_ROOM}.cache", f"{_ROOM}.errors", f"{_ROOM}.own_code", __name__)
"""Modules that keep, refuse or find things, and decide no value; not followed."""

_COMPILER = (language_hash.__module__.rpartition(".")[0],)
"""Modules that make code of kernels; not followed, `language_hash` stands for all of them."""

_COMPUTING = tuple(f"{_COMPILER[0]}.{name}" for name in ("exact", "pcg64"))
"""Modules among them that compute values, and are followed as all others."""

_LIBRARIES = {"numpy": "numpy", "shapely": "shapely", "PIL": "pillow", "trimesh": "trimesh"}
"""Libraries that compute, by the names under which they are imported; their versions count."""

Place = tuple[str, str]  # A definition: its module and its name; a library has no name


class UnknownCodeError(TypeError):
    """It is not known where the code of something lies: it was typed in, or made by `exec`."""


def code_of(what: Callable[..., Any], *, libraries: bool = True) -> str:
    """Return what identifies the code of a function, of a `partial` of one, or of a class.

    The versions of `libraries` count, too, unless it is for what is the same with all that are
    allowed, on another machine.

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
    return _code(found.__module__ or "", found.__qualname__.partition(".")[0], libraries)


@cache
def _code(module: str, name: str, libraries: bool) -> str:
    texts = []
    for at, what in sorted(closure_of(module, name)):
        if not what:
            texts.append(_library(at) if libraries else "")
        elif what == _LANGUAGE:
            texts.append(f"language of kernels {language_hash()}")
        else:
            texts.append(f"{at}:{what} {definitions_of(at)[what].digest}")
    INDEX.keep()
    return digest_of("\n".join(filter(None, texts)))


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
    """Return the definitions that one refers to."""
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
    """Return the definitions that a name with attributes, `exact.length`, stands for; "": all."""
    if module.partition(".")[0] not in (_OWN, package):
        return ((module.partition(".")[0], ""),)
    first, _, rest = chain.partition(".")
    inner = f"{module}.{first}"
    if _lies_in(inner, _COMPUTING) and not _lies_in(module, _COMPUTING):
        return _targets(inner, rest, package)
    if _lies_in(module, _COMPILER) and not _lies_in(module, _COMPUTING):
        return ((_OWN, _LANGUAGE),)
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
    return tuple((module, name) for name, texts in known.items() if texts.digest)


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
    """Return the definitions in the text of a file, by name.

    Raises:
        SyntaxError: The text is not of Python.
        ValueError: It has a null byte.
    """
    known = INDEX.of(text)
    return {name: Definition(digest, tuple(refers)) for name, (digest, refers) in known.items()}
