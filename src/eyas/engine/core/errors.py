"""Errors that a user can cause. Each is one line: what, where, value, allowed values."""

import difflib
import re
from collections.abc import Iterable

_LONGEST = 1200  # Largest number of characters of a message
_LONG = re.compile(r"""(?<!\w)(b?(['"]))((?:(?!\2(?!\w)).){201,})\2(?!\w)|\S{401,}""", re.DOTALL)
"""A quoted text, or anything without spaces, that is too long to be shown whole."""


def one_line(text: str) -> str:
    """Return a message as one line, whatever the values in it: other characters than printable ones
    are written as in Python, and what is too long is cut out of the middle.
    """
    line = _LONG.sub(lambda found: _cut(found[0], 200), text) if len(text) > 200 else text
    line = _cut(line, _LONGEST)
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in line)


def _cut(text: str, longest: int) -> str:
    if len(text) <= longest:
        return text
    return f"{text[: longest * 3 // 4]} ... {text[-longest // 4 :]}"


class EyasError(Exception):
    """Base of all errors of Eyas; the command line prints the message and exits with code 2.

    Its text is one line, see `one_line`.
    """

    def __str__(self) -> str:
        return one_line(super().__str__())


class ConfigError(EyasError):
    """A configuration value is missing, unknown, of the wrong type or out of range."""


class ActionError(EyasError, ValueError):
    """An agent's action is not in the space of actions."""


class DataFileError(EyasError):
    """An input file is unreadable, truncated, or not the file that was expected."""


class OutputError(EyasError):
    """Output cannot be written to the given place."""


class SpawnError(EyasError):
    """No start pose could be found."""


class MissingExtraError(EyasError):
    """An optional dependency is needed but not installed.

    Args:
        purpose: The feature that needs it, as a noun phrase.
        extra: Name of the extra of the `eyas` package.
        detail: Other requirements, for example system packages.
    """

    def __init__(self, purpose: str, extra: str, detail: str = "") -> None:
        from eyas.engine.core.installed import install_command  # rarely needed

        line = f"{purpose} needs the extra '{extra}': {install_command(extra)}"
        super().__init__(f"{line} {detail}".rstrip())


class UnknownNameError(ConfigError):
    """A name is not one of the known ones.

    Args:
        path: Path of the setting, for example `world.map`.
        name: The unknown name.
        known: The names that exist.
        where: Where these names are the known ones, for example `on the map 'lake'`.
        others: What else is allowed, for example `package.module:attribute`.
    """

    def __init__(
        self, path: str, name: str, known: Iterable[str], where: str = "", others: str = ""
    ) -> None:
        names = sorted(known)
        refused = f"{path}: {name!r:.200} is not allowed {where}".rstrip()
        listed = ", ".join(names) or "none"
        more = f", or {others}" if others else ""
        super().__init__(f"{refused}{nearest(name, names)}; known: {listed}{more}")


def nearest(name: str, known: Iterable[str]) -> str:
    """Return `; did you mean 'x'?` for the nearest known name, or an empty string."""
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=0.6)
    return f"; did you mean '{close[0]}'?" if close else ""
