"""Code of users: settings that name it by its path `package.module:attribute`, how it is found,
looked at and run, and its identity (package, version, hash) for results that depend on it.
"""

import inspect
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from importlib import import_module, invalidate_caches
from importlib.util import find_spec
from pathlib import Path
from traceback import extract_tb

from eyas.engine.core.config import Config
from eyas.engine.core.errors import ConfigError, nearest

__all__ = [
    "NAMES_CODE",
    "Origin",
    "code_named",
    "ended",
    "imported",
    "left_out",
    "origin_of",
    "running",
    "takes",
]


def imported(path: str, setting: str) -> object:
    """Return the object at a path; ordinary errors raised by its module pass through.

    Args:
        path: `package.module:attribute`.
        setting: The setting that names it, for messages.

    Raises:
        ConfigError: There is no such object, or its module tries to end the program.
    """
    name, _, attribute = path.partition(":")
    if not all(part.isidentifier() for part in (*name.split("."), attribute)):
        raise ConfigError(f"{setting}: {path!r} is not a path; allowed: package.module:attribute")
    with running(setting, path):
        if not _exists(name):
            raise ConfigError(f"{setting}: {path!r}: there is no module '{name}'{_where(name)}")
        module = import_module(name)
    if not hasattr(module, attribute):
        raise ConfigError(
            f"{setting}: {path!r}: the module '{name}' has no '{attribute}'"
            f"{nearest(attribute, vars(module))}"
        )
    return getattr(module, attribute)


def _exists(module: str) -> bool:
    """Return whether Python finds a module; in the current folder, it does from now on.

    That folder is looked into last, and only for what is nowhere else: no file in it takes the
    place of a module of Python or of a package.
    """
    if _found(module):
        return True
    if sys.flags.safe_path or not _lies_here(module):
        return False
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    invalidate_caches()
    return _found(module)


def _found(module: str) -> bool:
    if module in sys.modules:
        return True
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:  # one of its parents is missing
        return False


def _lies_here(module: str) -> bool:
    here = module.partition(".")[0]
    return os.path.isdir(here) or os.path.isfile(f"{here}.py")


def _where(module: str) -> str:
    """Return why a module is not found that seems to be there."""
    if not sys.flags.safe_path or not _lies_here(module):
        return ""
    return "; it lies in the current folder, where Python does not look because of PYTHONSAFEPATH"


@contextmanager
def running(setting: str, name: str) -> Iterator[None]:
    """Run code of a user's; whatever it raises to end the program is an error of that code.

    Ordinary errors pass through with their traceback, and `KeyboardInterrupt`, which is the user's.

    Raises:
        ConfigError: It raised `SystemExit`, or something else that is no `Exception`.
    """
    try:
        yield
    except (Exception, KeyboardInterrupt):
        raise
    except BaseException as error:
        raise ConfigError(f"{setting}: {name!r}: its code {ended(error)}") from error


def ended(error: BaseException) -> str:
    """Return in words what raised, and where; for exceptions that are no `Exception`."""
    last = extract_tb(error.__traceback__)[-1]
    raised = f"{type(error).__name__}({error})"
    return f"tried to end the program: {raised} in {last.filename}, line {last.lineno}"


def left_out(kind: object, members: Iterable[str]) -> list[str]:
    """Return the members that a class of a user's does not have, or only as abstract ones."""
    abstract = getattr(kind, "__abstractmethods__", ())
    return [name for name in members if not hasattr(kind, name) or name in abstract]


def takes(what: Callable[..., object], *arguments: object) -> str | None:
    """Return why something cannot be called with these arguments; None: it can.

    Functions of Python itself and of extensions are refused: many take anything, and none was
    written for this.
    """
    if inspect.isbuiltin(what):
        return "it is a built-in function"
    try:
        inspect.signature(what).bind(*arguments)
    except (TypeError, ValueError) as error:
        return f"it cannot be called so: {error}"
    return None


PICKLED = (".zip", ".pt", ".pth", ".pt2")
"""Endings of files of networks that may run code when they are read."""


@dataclass(frozen=True, slots=True)
class NamesCode:
    """Marks a field, in `Annotated`, whose texts or keys with a colon are imported and called, and
    whose files in Python's own format run what is in them.
    """


NAMES_CODE = NamesCode()


def code_named(config: Config, path: str = "") -> Iterator[tuple[str, str]]:
    """Yield each piece of code that settings name: path of the setting, and what it names."""
    for name, field in type(config).model_fields.items():
        value, inner = getattr(config, name), f"{path}.{name}".lstrip(".")
        if NAMES_CODE in field.metadata:
            for text in _texts(value):
                if ":" in text or text.endswith(PICKLED):
                    yield inner, text
        elif isinstance(value, Config):
            yield from code_named(value, inner)
        elif isinstance(value, tuple):
            for number, part in enumerate(value):
                if isinstance(part, Config):
                    yield from code_named(part, f"{inner}.{number}")


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | tuple):
        yield from (part for part in value if isinstance(part, str))


class Origin(Config):
    """Identity of code of a user, for results that depend on it."""

    path: str
    """`package.module:attribute`."""
    package: str | None
    """The installed package that has it; None: a module that belongs to none."""
    version: str | None
    """Version of that package."""
    code: str
    """Twelve hexadecimal digits of all Python files of the package, or of the one module."""

    def __str__(self) -> str:
        """Return it in words."""
        return " ".join(filter(None, (self.package or self.path, self.version, self.code)))


def origin_of(path: str) -> Origin:
    """Return what the code at a path is, which is imported."""
    from importlib.metadata import packages_distributions, version  # slow to import

    top = path.partition(":")[0].partition(".")[0]
    module = import_module(top)
    files = sorted(
        file for folder in getattr(module, "__path__", ()) for file in Path(folder).rglob("*.py")
    )
    if not files and (alone := getattr(module, "__file__", None)) is not None:
        files = [Path(alone)]
    digest = sha256()
    for file in files:
        content = file.read_bytes()
        digest.update(f"{file.name} {len(content)} ".encode() + content)
    packages = packages_distributions().get(top)
    package = packages[0] if packages else None
    return Origin(
        path=path,
        package=package,
        version=version(package) if package else None,
        code=digest.hexdigest()[:12],
    )
