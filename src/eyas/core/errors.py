"""Errors that a user can cause. Each is one line: what, where, value, allowed values."""

import difflib
from collections.abc import Iterable

__all__ = [
    "ActionError",
    "ConfigError",
    "DataFileError",
    "EyasError",
    "MissingExtraError",
    "OutputError",
    "SpawnError",
    "UnknownNameError",
    "nearest",
]


_LONGEST = 4000
"""Largest number of characters of a message."""


class EyasError(Exception):
    """Base of all errors of Eyas; the command line prints the message and exits with code 2.

    Its text is one line, whatever the names in it contain: other characters than printable ones are
    written as in Python, and what is too long is cut out of the middle.
    """

    def __str__(self) -> str:
        line = super().__str__()
        if len(line) > _LONGEST:
            line = f"{line[: _LONGEST // 2]} ... {line[-_LONGEST // 4 :]}"
        return "".join(char if char.isprintable() else repr(char)[1:-1] for char in line)


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
        from eyas.core.installed import install_command  # rarely needed

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
        more = f", or {others}" if others else ""
        super().__init__(f"{refused}{nearest(name, names)}; known: {', '.join(names)}{more}")


def nearest(name: str, known: Iterable[str]) -> str:
    """Return `; did you mean 'x'?` for the nearest known name, or an empty string."""
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=0.6)
    return f"; did you mean '{close[0]}'?" if close else ""
