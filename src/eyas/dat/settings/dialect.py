"""The original's `env_config.json` as a dialect of the settings."""

from pathlib import Path
from typing import Any

from eyas.dat.settings.adapter import (
    check_original,
    from_original,
    is_original,
    original_key_of,
    save_original,
    to_original,
    with_original,
)
from eyas.dat.settings.own_target import CUSTOM, own_target_folders, with_own_target
from eyas.dat.settings.runs import CHANNEL_STEPS, of_a_run, started_later
from eyas.engine.core.config import updated
from eyas.engine.core.errors import DataFileError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import Nested

_CLIENT_KEY = "Benchmark"  # the one group of the `config.json` of the original's client


class _Dat:
    """See `Dialect`."""

    file = "env_config.json"

    def is_spoken(self, values: Nested) -> bool:
        return is_original(dict(values))

    def read(self, values: Nested, path: Path) -> EyasConfig:
        if _CLIENT_KEY in values:
            raise DataFileError(
                f"{path}: the settings of the original's client, not of its simulator; give its "
                "Webots_Simulation/traffic_project/config/env_config.json (the speeds of actions "
                "are env.speeds here)"
            )
        keys, own = with_own_target(dict(values), own_target_folders(path))
        return _with_custom(from_original(keys), own)

    def changed(self, config: EyasConfig, changes: Nested, path: Path | None) -> EyasConfig:
        keys, own = with_own_target(dict(changes), own_target_folders(path))
        return _with_custom(with_original(config, keys), own)

    def check(self, config: EyasConfig) -> None:
        check_original(config)

    def key_of(self, path: str) -> str:
        return original_key_of(path)

    def save(self, config: EyasConfig, path: Path) -> bool:
        return save_original(config, path)

    def content_of(self, config: EyasConfig) -> dict[str, Any]:
        return to_original(config)

    def of_a_run(self, config: EyasConfig, seed: int | None = None) -> EyasConfig:
        return of_a_run(config, seed)

    def started(self, config: EyasConfig, channels: int) -> EyasConfig:
        return started_later(config, CHANNEL_STEPS * channels)


def _with_custom(config: EyasConfig, custom: dict[str, Any] | None) -> EyasConfig:
    return config if custom is None else updated(config, {CUSTOM: custom})


DAT = _Dat()
