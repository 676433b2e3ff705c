"""Settings that name code of a user's, by its path `package.module:attribute`, and calls of it."""

import inspect
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from traceback import extract_tb

from eyas.core.config import Config
from eyas.core.errors import ConfigError, nearest

__all__ = ["NAMES_CODE", "NamesCode", "code_named", "ended", "imported", "running", "takes"]


@dataclass(frozen=True, slots=True)
class NamesCode:
    """Marks a field, in `Annotated`, whose texts or keys with a colon are imported and called."""


NAMES_CODE = NamesCode()


def code_named(config: Config, path: str = "") -> Iterator[tuple[str, str]]:
    """Yield each piece of code that settings name: path of the setting, and what it names.

    Args:
        config: The settings.
        path: Their own path, to put before each.
    """
    for name, field in type(config).model_fields.items():
        value, inner = getattr(config, name), f"{path}.{name}".lstrip(".")
        if NAMES_CODE in field.metadata:
            for text in _texts(value):
                if ":" in text:
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
    if module in sys.modules:
        return True
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:  # one of its parents is missing
        return False


def _where(module: str) -> str:
    """Return what to do about a module that Python does not find."""
    here = module.partition(".")[0]
    if not (os.path.isdir(here) or os.path.isfile(f"{here}.py")):
        return ""
    return (
        "; it lies in the current folder, where Python looks only if the environment variable "
        "PYTHONPATH=. is set"
    )


@contextmanager
def running(setting: str, name: str) -> Iterator[None]:
    """Run code of a user's; whatever it raises to end the program is an error of that code.

    Ordinary errors pass through with their traceback, and `KeyboardInterrupt`, which is the user's.

    Args:
        setting: The setting that names the code.
        name: Its name.

    Raises:
        ConfigError: It raised `SystemExit`, or something else that is no `Exception`.
    """
    try:
        yield
    except (Exception, KeyboardInterrupt):
        raise
    except BaseException as error:
        raise ConfigError(f"{setting}: {name!r}: {ended(error)}") from error


def ended(error: BaseException) -> str:
    """Return in words what raised, and where; for exceptions that are no `Exception`."""
    last = extract_tb(error.__traceback__)[-1]
    said = f"{type(error).__name__}({error})"
    return f"its code tried to end the program: {said} in {last.filename}, line {last.lineno}"


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
