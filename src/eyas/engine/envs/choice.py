"""The settings of environments: a file, a preset, keywords, and the kinds in a mixture."""

import os
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np

from eyas.engine.behaviours.evader import EvaderDriver
from eyas.engine.core.clock import physics_steps
from eyas.engine.core.config import updated, validated
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.rng import fresh_seed
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.env import (
    ActionKind,
    EnvSpeeds,
    GimbalConfig,
    ObservationConfig,
    ObservationPart,
)
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import preset_file

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
    gimbal: GimbalConfig | Mapping[str, float]
    """`env.gimbal`"""
    observation: ObservationConfig | Mapping[str, Any]
    """`env.observation`"""
    mixture: list[Mapping[str, Any]]
    """`env.mixture`"""
    max_episode_steps: int
    """`done.total_steps`, counted in actions"""


class EpisodeChoices(TypedDict, total=False):
    """Settings that the options of a reset may change for its episode."""

    map: str
    """`world.map`"""
    weather: str
    """`world.weather`"""
    target: str
    """`target`"""
    start: Mapping[str, Any]
    """`start`"""


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


def targets_act(agents: str) -> bool:
    """Return whether targets are agents beside the trackers.

    Raises:
        ConfigError: There are no such agents.
    """
    if agents not in ("tracker", "tracker+target"):
        raise ConfigError(f"agents: {agents!r} is not allowed: 'tracker' or 'tracker+target'")
    return agents == "tracker+target"


def evading_settings(config: EyasConfig) -> EyasConfig:
    """Return the settings of an environment whose targets are agents.

    Raises:
        ConfigError: A fixed driver moves them.
    """
    driver = config.evader.driver
    if driver not in (None, EvaderDriver.AGENT):
        raise ConfigError(
            f"evader.driver: '{driver}' is not allowed with agents='tracker+target': 'agent', or "
            "null"
        )
    return updated(config, {"evader": {"driver": EvaderDriver.AGENT.value}})


def episode_settings(config: EyasConfig, options: Mapping[str, Any] | None) -> EyasConfig:
    """Return the settings of an episode: those of its environment, changed by options of a reset.

    Raises:
        EyasError: A setting is wrong, or there is no such option; one line.
    """
    changes: dict[str, Any] = {}
    for name, value in checked_options(options, EpisodeChoices.__annotations__).items():
        group = changes
        *groups, key = _PLACES.get(name, (name,))
        for part in groups:
            group = group.setdefault(part, {})
        group[key] = value
    return updated(config, changes) if changes else config


def checked_options(
    options: Mapping[str, Any] | None,  # What a caller gives; None: none
    allowed: Collection[str],  # The names of those that there are
    advice: str = "",  # What to use in the place of others
) -> Mapping[str, Any]:
    """Return the options of a reset.

    Raises:
        EyasError: They are no dictionary, or there is no such option; one line.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise ConfigError(f"options: {options!r} is not allowed: a dictionary or None")
    for name in options:
        if name not in allowed:
            raise ConfigError(f"{UnknownNameError('options', str(name), allowed)}{advice}")
    return options


def first_seed(config: EyasConfig) -> int:
    """Return the seed with which an environment begins that is given none: that of its settings if
    they set one, otherwise a fresh one, as in Gymnasium, so that none is a copy of another.
    """
    return config.seed if "seed" in config.model_fields_set else fresh_seed()


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
        case str() | os.PathLike():
            return load_settings(Path(source))
        case _:
            raise ConfigError(
                f"config: {source!r} is not allowed: an EyasConfig, a dictionary of settings, the "
                "name of a preset, or the path of a file"
            )


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
