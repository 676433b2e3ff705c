"""The adapter between our settings and the original's `env_config.json`."""

import json
import logging
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from eyas.core.config import Problem, updated
from eyas.core.errors import ConfigError
from eyas.core.files import write_atomic
from eyas.settings.config import EyasConfig
from eyas.settings.legacy.entries import Entry, Values
from eyas.settings.legacy.keys import ENTRIES, GROUP_KEYS, KEEP_ALIVE

__all__ = [
    "from_legacy",
    "is_legacy",
    "legacy_defaults",
    "legacy_keys_of",
    "save_legacy",
    "to_legacy",
    "with_legacy",
]

_LOG = logging.getLogger("eyas")

Nested = Mapping[str, Any]
"""The content of a JSON object."""


def is_legacy(values: Nested) -> bool:
    """Return whether settings are the original's, whose keys begin with a capital letter."""
    capitals = sum(key[:1].isupper() for key in values)
    return 2 * capitals > len(values)


def from_legacy(values: Nested, base: EyasConfig | None = None) -> EyasConfig:
    """Return the settings of an `env_config.json`.

    Args:
        values: Its content; groups and keys that are missing have the manual's defaults, or, where
            the manual leaves them out, the values that the original ships with.
        base: Settings that it cannot express (camera, seed, ...); None: our defaults.

    Raises:
        ConfigError: An unknown key, a wrong type or a value that is not allowed: one line with the
            original's path.
    """
    said = _flat(values)
    return _with(base or EyasConfig(), {**_flat(legacy_defaults()), **said}, ENTRIES)


def with_legacy(config: EyasConfig, changes: Nested, inactive: Nested | None = None) -> EyasConfig:
    """Return settings with some of the original's keys changed.

    Args:
        config: The settings.
        changes: The keys that change.
        inactive: An `env_config.json` with values for keys that had no effect so far and may have
            one now; None: the manual's defaults.

    Raises:
        ConfigError: As from `from_legacy`.
    """
    said = _flat(changes)
    if not GROUP_KEYS.isdisjoint(said):
        said = {KEEP_ALIVE: False} | said  # who says how groups come means that they do
    touched = [entry for entry in ENTRIES if not said.keys().isdisjoint(entry.keys)]
    values = {**_flat(legacy_defaults()), **_flat(inactive or {})}
    for entry in touched:
        try:
            values |= entry.write(_fields(config, entry))
        except ConfigError:
            continue  # a value that these keys cannot express is replaced by theirs
    return _with(config, values | said, touched)


def to_legacy(config: EyasConfig) -> dict[str, Any]:
    """Return settings as an `env_config.json` with all groups and keys.

    Raises:
        ConfigError: The original's keys cannot express a value, such as a choice among values.
    """
    values = dict(_flat(legacy_defaults()))
    for entry in ENTRIES:
        values |= entry.write(_fields(config, entry))
    return _nested(values)


def save_legacy(config: EyasConfig, path: Path) -> bool:
    """Write an `env_config.json` if it can express the settings; return whether it is written.

    Raises:
        OutputError: The file cannot be written.
    """
    try:
        text = json.dumps(to_legacy(config), indent=4)
    except ConfigError as error:
        _LOG.warning("%s: not written: %s", path, error)
        return False
    write_atomic(path, f"{text}\n".encode())
    return True


def legacy_keys_of(path: str) -> tuple[str, ...]:
    """Return the original's keys for a field of ours; empty if there are none."""
    return next((entry.keys for entry in ENTRIES if path in entry.paths), ())


@cache
def legacy_defaults() -> Nested:
    """Return the values that keys have if a file does not contain them."""
    values: dict[str, Any] = json.loads(
        files("eyas.settings.legacy").joinpath("defaults.json").read_text()
    )
    return values


def _with(config: EyasConfig, values: Values, entries: Iterable[Entry]) -> EyasConfig:
    changes: dict[str, object] = {}
    for entry in entries:
        _check_kinds(entry, values)
        changes |= entry.read(values)
    return updated(config, _nested(changes), lambda problem: _retold(problem, values))


def _check_kinds(entry: Entry, values: Values) -> None:
    """Refuse switches and numbers of a wrong type; a key for one field is checked by that field."""
    if len(entry.keys) == 1:
        return
    for key in entry.keys:
        value, default = values[key], _flat(legacy_defaults())[key]
        if isinstance(default, bool):
            fits, allowed = isinstance(value, bool), "true or false"
        elif isinstance(default, int | float):
            number = isinstance(value, int | float) and not isinstance(value, bool)
            fits, allowed = number, "a number"
        else:
            continue
        if not fits:
            raise Problem((key,), value, allowed).error()


def _retold(problem: Problem, values: Values) -> Problem:
    """Return the problem of one of our fields as a problem of the original's key."""
    path = ".".join(problem.path)
    entry = next(entry for entry in ENTRIES if path in entry.paths)
    for guess in entry.blame(values):
        key, allowed = guess.key, guess.allowed or problem.allowed.removeprefix("null or ")
        if guess.trial is None or _is_refused(path, guess.trial):
            break
    names = tuple(str(entry.write({path: name})[key]) for name in problem.names)
    if names:
        allowed = " or ".join(f"'{name}'" for name in names)
    return replace(problem, path=(key,), value=values[key], allowed=allowed, names=names)


def _is_refused(path: str, value: object) -> bool:
    try:
        updated(EyasConfig(), _nested({path: value}))
    except ConfigError:
        return True
    return False


def _fields(config: EyasConfig, entry: Entry) -> Values:
    fields = {}
    for path in entry.paths:
        value: object = config
        for name in path.split("."):
            value = getattr(value, name)
        fields[path] = value
    return fields


def _flat(values: Nested) -> dict[str, object]:
    """Return values by dotted path.

    Raises:
        ConfigError: A key that the original does not have, or a value that should be a group.
    """
    defaults = legacy_defaults()
    flat: dict[str, object] = {}
    for key, value in values.items():
        if key not in defaults:
            raise Problem((key,), value, "", tuple(defaults), unknown_key=True).error()
        known = defaults[key]
        if not isinstance(known, Mapping):
            flat[key] = value
            continue
        if not isinstance(value, Mapping):
            raise Problem((key,), value, f"an object with {', '.join(known)}").error()
        for inner, inner_value in value.items():
            if inner not in known:
                raise Problem((key, inner), value, "", tuple(known), unknown_key=True).error()
            flat[f"{key}.{inner}"] = inner_value
    return flat


def _nested(flat: Values) -> dict[str, Any]:
    nested: dict[str, Any] = {}
    for path, value in flat.items():
        *groups, name = path.split(".")
        inner = nested
        for group in groups:
            inner = inner.setdefault(group, {})
        inner[name] = value
    return nested
