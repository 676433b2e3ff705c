"""Settings in files and on the command line, and those that come with Eyas, by name."""

import json
import logging
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from eyas.engine.core.clock import PHYSICS_RATE, physics_steps
from eyas.engine.core.config import group_of, updated, validated
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.files import write_atomic
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import dialect, named_path, spoken
from eyas.engine.settings.trust import refuse_code

_LOG = logging.getLogger("eyas")

Nested = dict[str, Any]

SCHEMA_KEY = "$schema"
"""Key by which editors find the schema of a file (`eyas config schema`); it changes nothing."""

_LARGEST = 16 << 20  # Largest file of settings [bytes]


def load_settings(
    path: Path | None,
    overrides: Sequence[str] = (),
    base: EyasConfig | None = None,
    *,
    trust: bool = False,
) -> EyasConfig:
    """Return the settings of a file, with some of them changed.

    Allowed settings that may have an unexpected effect (a control frequency that does not divide
    500, a pitch that is limited) give a warning in Python's logger `eyas`.

    Args:
        path: JSON, native or the original's `env_config.json`; None: there is none.
        overrides: `key=value`; a later one wins; keys are dotted paths, native (`video.fps`) or the
            original's (`Out_Video.fps`); values are JSON, or else text.
        base: The settings where there is no file; None: the defaults.
        trust: Whether the file may name code, see `eyas.engine.settings.trust`.

    Raises:
        DataFileError: The file cannot be read, or is not a JSON object.
        ConfigError: A key or a value is wrong, or the file names code without being trusted.
    """
    config = (base or EyasConfig()) if path is None else _loaded(path)
    pairs = [parsed_override(override) for override in overrides]
    for capital, group in groupby(pairs, key=lambda pair: pair[0][0][:1].isupper()):
        changes = _nested(group)
        if capital:
            config = spoken(f"--set {next(iter(changes))}").changed(config, changes, path)
        else:
            config = updated(config, changes)
    if config.original is not None:
        spoken("original").check(config)
    if path is not None and not trust:
        refuse_code(path, config, {text for _, value in pairs for text in _texts(value)})
    _tell_surprises(config)
    return config


def _loaded(path: Path) -> EyasConfig:
    """Return the settings of a file; errors as from `load_settings`."""
    values = read_settings(path)
    other = dialect()
    if other is not None and other.is_spoken(values):
        return other.read(values, path)
    config = validated(EyasConfig, values)
    try:
        "".join(_texts(values)).encode()
    except UnicodeEncodeError as error:
        raise DataFileError(f"{path}: half a character of UTF-16: {error}") from error
    return config


def save_settings(config: EyasConfig, path: Path) -> None:
    """Write settings that load back to an equal value.

    Raises:
        OutputError: The file cannot be written.
    """
    write_atomic(path, (config.model_dump_json(indent=2) + "\n").encode())


def read_settings(path: Path) -> Nested:
    """Return the JSON object that a file holds.

    Comments, commas after a last value, and UTF-16 are read, too, with a warning.

    Raises:
        DataFileError: The file is missing, unreadable, cut off, or not a JSON object.
    """
    try:
        with path.open("rb") as file:  # which may be a pipe of a shell, as in --config <(...)
            content = file.read(_LARGEST + 1)
        if len(content) > _LARGEST:
            raise DataFileError(f"{path}: cannot read: larger than {_LARGEST >> 20} MiB")
        encoding = json.detect_encoding(content)
        values = _parsed(content.decode(encoding), path)
    except OSError as error:
        raise DataFileError(f"{path}: cannot read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise DataFileError(f"{path}: not a text file in UTF-8") from error
    except json.JSONDecodeError as error:
        raise DataFileError(
            f"{path}: line {error.lineno}, column {error.colno}: not valid JSON: {error.msg}"
        ) from error
    except (ValueError, RecursionError) as error:
        raise DataFileError(f"{path}: not valid settings: {error}") from error
    if not isinstance(values, dict):
        raise DataFileError(f"{path}: line 1: not a JSON object")
    if encoding not in ("utf-8", "utf-8-sig"):
        _LOG.warning("%s: read as %s; JSON is UTF-8", path, encoding.upper())
    if isinstance(values.get(SCHEMA_KEY), str):
        del values[SCHEMA_KEY]
    return values


_STRING = r'"(?:\\.|[^"\\])*(?:"|\Z)'
_COMMENT = re.compile(rf"({_STRING})|//[^\n]*|/\*.*?(?:\*/|\Z)", re.DOTALL)
_LAST_COMMA = re.compile(rf"((?:{_STRING}|[^\s\[{{,:\"])\s*),(?=\s*[}}\]])|({_STRING})", re.DOTALL)
"""Comments, and the commas before closing brackets, that are left out; groups stay."""


def _parsed(text: str, path: Path) -> Any:  # noqa: ANN401  # JSON
    """Return what JSON says, without comments and commas after a last value."""
    try:
        return json.loads(text, object_pairs_hook=_without_doubles)
    except json.JSONDecodeError:
        plain = _LAST_COMMA.sub(_blank, _COMMENT.sub(_blank, text))
        if plain == text:
            raise
        values = json.loads(plain, object_pairs_hook=_without_doubles)
    _LOG.warning("%s: not strictly JSON: comments and commas after a last value are left out", path)
    return values


def _blank(found: re.Match[str]) -> str:
    """Return what stays and spaces for the rest, so that messages name the right place."""
    kept = "".join(part or "" for part in found.groups())
    return kept + re.sub(r"[^\n]", " ", found[0][len(kept) :])


def _tell_surprises(config: EyasConfig) -> None:
    frequency = config.control.frequency
    steps = physics_steps(frequency)
    if abs(steps * frequency - PHYSICS_RATE) > 1e-6:
        _LOG.warning(
            "%s: %g does not divide %d; an action lasts %d steps of 2 ms, "
            "so the effective rate is %.4g Hz",
            named_path(config, "control.frequency"),
            frequency,
            PHYSICS_RATE,
            steps,
            PHYSICS_RATE / steps,
        )


def _without_doubles(pairs: list[tuple[str, Any]]) -> Nested:
    values = dict(pairs)
    if len(values) < len(pairs):
        keys = [key for key, _ in pairs]
        double = next(key for key in keys if keys.count(key) > 1)
        raise ValueError(f"the key '{double}' appears twice in one object")
    return values


def parsed_override(override: str) -> tuple[list[str], Any]:
    """Return the keys and the value of a change of settings, `key=value`.

    Raises:
        ConfigError: It is of another form.
    """
    key, equals, text = override.partition("=")
    keys = key.strip().split(".")
    if not equals or not all(keys):
        raise ConfigError(f"--set {override!r}: not of the form key=value, such as video.fps=30")
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        value = text.strip()
    group = group_of(EyasConfig.model_fields.get(keys[0]))
    if len(keys) == 1 and group and group.named_by and isinstance(value, str):
        keys.append(group.named_by)
    return keys, value


def nested_overrides(overrides: Sequence[str]) -> Nested:
    """Return changes of settings, each `key=value`, as nested dictionaries; a later one wins.

    Raises:
        ConfigError: One is of another form.
    """
    return _nested(map(parsed_override, overrides))


def _nested(pairs: Iterable[tuple[list[str], Any]]) -> Nested:
    changes: Nested = {}
    for keys, value in pairs:
        _put(changes, keys, value)
    return changes


def _texts(value: object) -> Iterator[str]:
    """Yield all texts and keys in a value of JSON."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield key
            yield from _texts(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _texts(inner)


def _put(values: Nested, keys: Sequence[str], value: Any) -> None:  # noqa: ANN401  # JSON
    for key in keys[:-1]:
        if not isinstance(values.get(key), dict):
            values[key] = {}
        values = values[key]
    values[keys[-1]] = value
