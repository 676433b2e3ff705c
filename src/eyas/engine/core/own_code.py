"""Code of users: settings that name it by its path `package.module:attribute`, how it is found,
looked at and run, and its identity (package, version, hash) for results that depend on it.
"""

import inspect
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from importlib import import_module, invalidate_caches
from importlib.util import find_spec
from traceback import extract_tb

from eyas.engine.core.errors import ConfigError, nearest


def imported(
    path: str,  # `package.module:attribute`
    setting: str,  # The setting that names it, for messages
) -> object:
    """Return the object at a path; ordinary errors raised by its module pass through.

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
