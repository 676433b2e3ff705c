"""The settings of environments: a file, a preset, keywords, and the kinds in a mixture."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np

from eyas.core.clock import physics_steps
from eyas.core.config import updated, validated
from eyas.core.errors import ConfigError, UnknownNameError
from eyas.envs.config import ActionKind, EnvSpeeds, ObservationConfig, ObservationPart
from eyas.settings.config import EyasConfig
from eyas.settings.file import load_settings
from eyas.settings.preset import preset_file

__all__ = [
    "EnvChoices",
    "Source",
    "chosen_settings",
    "kinds_of",
    "settings_of_kinds",
    "steps_per_action",
]

Source = EyasConfig | Mapping[str, Any] | str | Path | None
"""Settings: whole ones, nested dictionaries of native settings, the name of a preset (`dat-train`,
`dat-eval`, `easy`), or the path of a JSON file (native or the original's `env_config.json`)."""


class EnvChoices(TypedDict, total=False):
    """Settings that environments take by keyword; each overrides the configuration."""

    map: str
    """`world.map`"""
    weather: str
    """`world.weather`"""
    target: str
    """`target`"""
    actions: ActionKind | str
    """`env.actions`"""
    action_repeat: int
    """`env.action_repeat`"""
    speeds: EnvSpeeds | Mapping[str, float]
    """`env.speeds`"""
    observation: ObservationConfig | Mapping[str, Any]
    """`env.observation`"""
    mixture: list[Mapping[str, Any]]
    """`env.mixture`"""
    max_episode_steps: int
    """`done.total_steps`, counted in actions"""


_PLACES = {"map": ("world", "map"), "weather": ("world", "weather"), "target": ("target",)}


def chosen_settings(source: Source, **choices: Unpack[EnvChoices]) -> EyasConfig:
    """Return the settings of environments.

    Raises:
        EyasError: A setting is wrong, or the file, or there is no such keyword; one line.
    """
    changes: dict[str, Any] = {}
    for name, value in choices.items():
        if name not in EnvChoices.__annotations__:
            raise UnknownNameError("keyword", name, tuple(EnvChoices.__annotations__))
        if value is not None and name != "max_episode_steps":
            *groups, key = _PLACES.get(name, ("env", name))
            group = changes
            for part in groups:
                group = group.setdefault(part, {})
            group[key] = value
    config = updated(_settings(source), changes) if changes else _settings(source)
    if (limit := choices.get("max_episode_steps")) is None:
        return config
    return updated(config, {"done": {"total_steps": limit * steps_per_action(config)}})


def steps_per_action(config: EyasConfig) -> int:
    """Return the physics steps that an action lasts."""
    return physics_steps(config.control.frequency) * config.env.action_repeat


def _settings(source: Source) -> EyasConfig:
    match source:
        case None:
            return EyasConfig()
        case EyasConfig():
            return source
        case Mapping():
            return validated(EyasConfig, dict(source))
        case str() if "." not in source and not os.path.exists(source):
            return load_settings(preset_file(source))
        case _:
            return load_settings(Path(source))


def settings_of_kinds(config: EyasConfig) -> list[EyasConfig]:
    """Return the settings of each kind in a mixture, without that mixture; of one if there is none.

    Raises:
        ConfigError: Settings of a kind are wrong, or change what all have in common.
    """
    kinds, alone = [], config.env.model_copy(update={"mixture": ()})
    for number, part in enumerate(config.env.mixture):
        try:
            kind = updated(config, part.settings)
        except ConfigError as error:
            raise ConfigError(f"env.mixture.{number}.settings.{error}") from None
        if kind.env != config.env:
            raise ConfigError(
                f"env.mixture.{number}.settings.env: not allowed: all environments have the same "
                "actions and observations"
            )
        if kind.lidar != config.lidar and ObservationPart.LIDAR in config.env.observation.parts:
            raise ConfigError(
                f"env.mixture.{number}.settings.lidar: not allowed: all environments have the same "
                "observations"
            )
        kinds.append(kind.model_copy(update={"env": alone}))
    return kinds or [config]


def kinds_of(config: EyasConfig, count: int) -> list[int]:
    """Return the kind of each of `count` environments, an index into `settings_of_kinds`.

    Each environment in turn is of the kind that is furthest behind its share, so that the kind does
    not depend on the number of environments.
    """
    weights = np.array([part.weight for part in config.env.mixture] or [1.0])
    shares, given, kinds = weights / weights.sum(), np.zeros(len(weights)), []
    for number in range(1, count + 1):
        kind = int(np.argmax(shares * number - given))
        given[kind] += 1.0
        kinds.append(kind)
    return kinds
