"""Settings in files and on the command line."""

import json
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from eyas.core.clock import PHYSICS_RATE
from eyas.core.config import validated
from eyas.core.errors import ConfigError, DataFileError
from eyas.core.files import write_atomic
from eyas.sim.config import EyasConfig
from eyas.sim.legacy import from_legacy, is_legacy, to_legacy
from eyas.sim.legacy_model import LegacyConfig

__all__ = ["load_settings", "save_settings"]

Values = dict[str, Any]


def load_settings(path: Path | None, overrides: Sequence[str] = ()) -> EyasConfig:
    """Return the settings of a file with some changed.

    Args:
        path: JSON, native or the original's `env_config.json`; None: the defaults.
        overrides: `key=value`, in this order; keys are dotted paths, native (`video.fps`) or the
            original's (`Out_Video.fps`); values are JSON, or words as they stand.

    Raises:
        DataFileError: The file cannot be read as JSON.
        ConfigError: A key or value is wrong.
    """
    config = EyasConfig() if path is None else _config_of(_read(path))
    for override in overrides:
        config = _changed(config, override)
    _warn_of_rate(config)
    return config


def save_settings(config: EyasConfig, path: Path) -> None:
    """Write settings that load back to an equal value.

    Raises:
        OutputError: The file system refused.
    """
    write_atomic(path, (config.model_dump_json(indent=2) + "\n").encode())


def _read(path: Path) -> Values:
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataFileError(f"{path}: cannot read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise DataFileError(f"{path}: not a text file in UTF-8") from error
    except json.JSONDecodeError as error:
        raise DataFileError(f"{path}: line {error.lineno}: not JSON: {error.msg}") from error
    if not isinstance(values, dict):
        raise DataFileError(f"{path}: a {type(values).__name__}, not an object of settings")
    return values


def _config_of(values: Values) -> EyasConfig:
    return from_legacy(values) if is_legacy(values) else validated(EyasConfig, values)


def _changed(config: EyasConfig, override: str) -> EyasConfig:
    key, equals, text = override.partition("=")
    if not equals or not key:
        raise ConfigError(f"--set {override}: not of the form key=value")
    path = key.strip().split(".")
    value = _value_of(text)
    if path[0] in LegacyConfig.model_fields:
        values = to_legacy(config)
        _put(values, path, value)
        return from_legacy(values, config)
    values = config.model_dump(mode="json")
    _put(values, path, value)
    return validated(EyasConfig, values)


def _value_of(text: str) -> Any:  # noqa: ANN401  # JSON
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text


def _put(values: Values, path: Sequence[str], value: Any) -> None:  # noqa: ANN401  # JSON
    """Set a value; an unknown key is set too, and refused with its path when validated."""
    for group in path[:-1]:
        inner = values.setdefault(group, {})
        if not isinstance(inner, dict):
            raise ConfigError(f"{'.'.join(path)}: unknown key; '{group}' has no keys of its own")
        values = inner
    values[path[-1]] = value


def _warn_of_rate(config: EyasConfig) -> None:
    frequency = config.control.frequency
    if PHYSICS_RATE % frequency:
        steps = PHYSICS_RATE // frequency
        warnings.warn(
            f"control.frequency: {frequency} does not divide {PHYSICS_RATE}: actions last {steps} "
            f"steps of 2 ms, so there are {PHYSICS_RATE / steps:.4g} in a second",
            stacklevel=3,
        )
