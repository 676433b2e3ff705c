"""The errors that a user can cause. Each is one line: what, where, value, what is allowed."""

import difflib
from collections.abc import Iterable

__all__ = [
    "ConfigError",
    "DataFileError",
    "EyasError",
    "MissingExtraError",
    "NotInThisVersionError",
    "OutputError",
    "SpawnError",
    "UnknownNameError",
    "nearest",
]


class EyasError(Exception):
    """Base of every error that Eyas raises on purpose; the command line prints it, exit code 2."""


class ConfigError(EyasError):
    """A configuration value is missing, unknown, of the wrong type or out of range."""


class NotInThisVersionError(ConfigError):
    """A valid setting asks for a part that this version does not have yet."""


class DataFileError(EyasError):
    """A file that should be read is unreadable, cut off, or belongs to something else."""


class OutputError(EyasError):
    """Output cannot be written where it was asked for."""


class SpawnError(EyasError):
    """No start pose could be found."""


class MissingExtraError(EyasError):
    """An optional part is needed and not installed.

    Args:
        purpose: What needed it, as a noun phrase.
        extra: Name of the extra of the `eyas` package.
        detail: What else is needed, for example system packages.
    """

    def __init__(self, purpose: str, extra: str, detail: str = "") -> None:
        line = f"{purpose} needs the extra '{extra}': pip install 'eyas[{extra}]'"
        super().__init__(f"{line} {detail}".rstrip())


class UnknownNameError(ConfigError):
    """A name is not one of the known ones.

    Args:
        path: Where the name stands, for example `world.map`.
        name: The unknown name.
        known: The names that exist.
        where: What knows them, for example `on the map 'lake'`, where others know others.
    """

    def __init__(self, path: str, name: str, known: Iterable[str], where: str = "") -> None:
        names = sorted(known)
        refused = f"{path}: {name!r} is not allowed {where}".rstrip()
        super().__init__(f"{refused}{nearest(name, names)}; known: {', '.join(names)}")


def nearest(name: str, known: Iterable[str]) -> str:
    """Return `; did you mean 'x'?` for the nearest known name, or nothing."""
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=0.6)
    return f"; did you mean '{close[0]}'?" if close else ""
