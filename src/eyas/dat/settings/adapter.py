"""The adapter between our settings and the original's `env_config.json`."""

import json
import logging
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from eyas.dat.settings.entries import Optional, OriginalEntry, Values
from eyas.dat.settings.keys import ENTRIES, GROUP_KEYS, KEEP_ALIVE
from eyas.dat.settings.layout import CUSTOM, Nested, check_kinds, every_key, flat, nested, renewed
from eyas.engine.core.config import Problem, updated
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.files import write_atomic
from eyas.engine.settings.config import EyasConfig
from eyas.engine.targets.config import TargetName
from eyas.engine.task.config import StartConfig, StartVelocity
from eyas.engine.trackers.config import Flight
from eyas.engine.traffic.config import Lamps, Signals

_LOG = logging.getLogger("eyas")

LIKE_THE_ORIGINAL = updated(
    EyasConfig(start=StartConfig(velocity=StartVelocity.REST), extras=()),
    {
        "video": {"jpeg_quality": 100, "flight": "exact"},
        "tracker": {"flight": Flight.ORIGINAL.value, "off_centre": True},
        "traffic": {
            **{"signals": Signals.AMBER.value, "lamps": Lamps.DARK.value},
            "update_routes": False,  # so that a file that is written of it means the same traffic
        },
    },
)
"""Our defaults, but for what its file cannot express and the original does in another way."""


def is_original(values: Nested) -> bool:
    """Return whether settings are the original's, whose keys begin with a capital letter."""
    keys = [key for key in values if key != CUSTOM]
    return 2 * sum(key[:1].isupper() for key in keys) > len(keys)


def from_original(values: Nested, base: EyasConfig | None = None) -> EyasConfig:
    """Return the settings of an `env_config.json`.

    Args:
        values: Its content; groups and keys that are missing have the manual's defaults, or, where
            the manual leaves them out, the values that the original ships with.
        base: Settings that it cannot express (camera, seed, ...); None: our defaults, and what the
            original does.

    Raises:
        ConfigError: An unknown key, a wrong type or a value that is not allowed: one line with the
            original's path.
    """
    config = (base or LIKE_THE_ORIGINAL).model_copy(update={"original": {}})
    return _with(config, every_key() | flat(renewed(values)), ENTRIES)


def with_original(config: EyasConfig, changes: Nested) -> EyasConfig:
    """Return settings with some of the original's keys changed.

    Args:
        changes: The keys that change; keys that had no effect so far, but have one now, have their
            values of `config.original`, or else the manual's defaults.

    Raises:
        ConfigError: As from `from_original`.
    """
    said = flat(renewed(changes))
    if not GROUP_KEYS.isdisjoint(said):
        said = {KEEP_ALIVE: False} | said  # who says how groups come means that they do
    touched = [entry for entry in ENTRIES if not said.keys().isdisjoint(entry.keys)]
    values = {**every_key(), **_kept(config), "Tracking_Object": config.target.value}
    for entry in touched:
        try:
            values |= entry.write(_fields(config, entry))
        except ConfigError:
            continue  # a value that these keys cannot express is replaced by theirs
    return _with(config, values | said, touched)


def to_original(config: EyasConfig) -> dict[str, Any]:
    """Return settings as an `env_config.json` with all groups and keys.

    A key that changes no setting has its value of `config.original`, or else the manual's default.

    Raises:
        ConfigError: The original's keys cannot express a value, such as a choice among values.
    """
    values: dict[str, object] = {}
    for entry in ENTRIES:
        values |= _written(entry, config)
    return nested(values)


def check_original(config: EyasConfig) -> None:
    """Refuse values in `config.original` that no `env_config.json` can hold.

    Raises:
        ConfigError: An unknown key or a wrong type: one line.
    """
    every = every_key()
    for key, value in _kept(config).items():
        if key not in every:
            raise Problem(("original", key), value, "", tuple(every), unknown_key=True).error()
    for entry in ENTRIES:
        idle = _is_idle(entry, config.target.value)
        check_kinds(entry, {**every, **_kept(config)}, idle=idle)


def save_original(config: EyasConfig, path: Path) -> bool:
    """Write an `env_config.json` if it can express the settings; return whether it is written.

    Raises:
        OutputError: The file cannot be written.
    """
    try:
        text = json.dumps(to_original(config), indent=4)
    except ConfigError as error:
        _LOG.warning("%s: not written: %s", path, error)
        return False
    write_atomic(path, f"{text}\n".encode())
    return True


def original_key_of(path: str) -> str:
    """Return the original's key for a field of ours, for messages; empty if there is none."""
    entry = next((entry for entry in ENTRIES if path in entry.paths), None)
    if entry is None:
        return ""
    return entry.key if isinstance(entry, Optional) else entry.keys[0]


def _with(config: EyasConfig, values: Values, entries: Iterable[OriginalEntry]) -> EyasConfig:
    """Return settings in which the fields of these entries have these values of their keys."""
    changes: dict[str, object] = {}
    for entry in entries:
        idle = _is_idle(entry, values["Tracking_Object"])
        check_kinds(entry, values, idle=idle)
        fields = entry.read(values)
        if idle and any(_is_refused(path, value) for path, value in fields.items()):
            continue
        changes |= fields
        for remark in entry.remarks(values):
            _LOG.warning("%s", remark)
    new = updated(config, nested(changes), lambda problem: _retold(problem, values))
    kept = dict(_kept(new))
    for entry in entries:
        written = _told(entry, new)
        for key in entry.keys:
            kept.pop(key, None)
            if key not in written or written[key] != values[key]:
                kept[key] = values[key]
    defaults = every_key()
    kept = {key: value for key, value in kept.items() if value != defaults[key]}
    original = kept if kept or new.original is not None else None
    return updated(new, {"original": original})


def _is_idle(entry: OriginalEntry, target: object) -> bool:
    """Return whether an entry has no effect for a target, whatever its values."""
    vehicle = target == TargetName.SUMO_VEHICLE
    return vehicle and all(path.startswith("objects.") for path in entry.paths)


def _kept(config: EyasConfig) -> Values:
    """Return the original's values that no setting holds."""
    kept = config.original or {}
    return {key: list(value) if isinstance(value, tuple) else value for key, value in kept.items()}


def _told(entry: OriginalEntry, config: EyasConfig) -> Values:
    """Return the keys of an entry that have an effect; none if they cannot express the settings."""
    try:
        return entry.write(_fields(config, entry))
    except ConfigError:
        return {}


def _written(entry: OriginalEntry, config: EyasConfig) -> Values:
    """Return all keys of an entry, as in the file that was read where that means the same."""
    said = entry.write(_fields(config, entry))
    before = {key: value for key, value in _kept(config).items() if key in entry.keys}
    defaults = {key: every_key()[key] for key in entry.keys}
    if _is_idle(entry, config.target.value):
        return {**defaults, **said, **before}
    values = {**defaults, **before, **said}
    for key in before.keys() & said.keys():
        trial = {**values, key: before[key]}
        with suppress(ConfigError):
            values = trial if updated(config, nested(entry.read(trial))) == config else values
    return values


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
        updated(EyasConfig(), nested({path: value}))
    except ConfigError:
        return True
    return False


def _fields(config: EyasConfig, entry: OriginalEntry) -> Values:
    fields = {}
    for path in entry.paths:
        value: object = config
        for name in path.split("."):
            value = getattr(value, name)
        fields[path] = value
    return fields
