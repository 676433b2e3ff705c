"""Protocols: the settings in which all policies fly, with a hash that tells them apart."""

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from eyas.core.clock import PHYSICS_STEP, physics_steps
from eyas.core.config import updated
from eyas.core.errors import UnknownNameError
from eyas.envs.config import EnvConfig
from eyas.evaluation.episode import EpisodeSpec
from eyas.settings.config import EyasConfig
from eyas.settings.file import load_settings
from eyas.settings.preset import preset_file
from eyas.sim.config import SimConfig
from eyas.traffic.config import Demand

__all__ = ["PROTOCOLS", "Protocol", "protocol_named"]

_DIRECTIONS = (0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi)

_NEVER = 2**31 - 1

_FIXED = set(SimConfig.model_fields) - {"seed", "same_target"}
"""Settings that are part of a protocol: all of the simulation, none of its uses. Each drone has a
world of its own, so that none shares its target."""

_PLACED = ("world.map", "world.weather", "target", "start.direction")
"""Settings that the episodes decide, see `Protocol.settings_of`."""

_IDLE: Mapping[str, Callable[[SimConfig], bool]] = {
    "lidar": lambda config: not config.lidar.enabled,
    "tracker.flight": lambda config: config.tracker.supervised,
    "traffic.group_size": lambda config: config.traffic.demand is Demand.KEEP_ALIVE,
    "traffic.group_interval": lambda config: config.traffic.demand is Demand.KEEP_ALIVE,
    "traffic.route_length": lambda config: config.traffic.demand is Demand.KEEP_ALIVE,
    "traffic.route_count": lambda config: config.traffic.demand is Demand.KEEP_ALIVE,
    "traffic.update_routes": lambda config: True,
}
"""When settings have no effect on an episode."""


def _joined(first: Mapping[str, Any], second: Mapping[str, Any]) -> dict[str, Any]:
    """Return nested settings with some changed."""
    both = dict(first)
    for name, value in second.items():
        inner = both.get(name)
        if isinstance(value, Mapping) and isinstance(inner, Mapping):
            value = _joined(inner, value)
        both[name] = value
    return both


@dataclass(frozen=True)
class Protocol:
    """A protocol; its settings are those of the preset `dat-eval`, with changes."""

    name: str
    title: str
    """What it measures, in a few words."""
    changes: Mapping[str, Any] = field(default_factory=dict)
    directions: tuple[float, ...] = _DIRECTIONS
    """Start directions [rad]."""
    episodes: int = 10
    """Default number of episodes for each place and direction."""
    alike: bool = False
    """Whether all vehicles look like the target, and another one is near it at the start."""

    @cached_property
    def settings(self) -> EyasConfig:
        """The settings, without place, direction, seed and `env`."""
        return updated(load_settings(preset_file("dat-eval")), self.changes)

    def changed(self, changes: Mapping[str, Any]) -> "Protocol":
        """Return a protocol with other settings, and so with another hash."""
        return replace(self, changes=_joined(self.changes, changes))

    @property
    def steps(self) -> int:
        """Number of control steps in an episode; actions last one or several of them."""
        return self.settings.done.total_steps // physics_steps(self.settings.control.frequency)

    @property
    def period(self) -> float:
        """Length of a control step [s]."""
        return physics_steps(self.settings.control.frequency) * PHYSICS_STEP

    @cached_property
    def hash(self) -> str:
        """Twelve hexadecimal digits of what the episodes mean: the settings that have an effect and
        are not at their defaults. The world in which they happen has a digest of its own
        (`eyas.core.build.Build.world`).
        """
        settings = self.settings.model_dump(mode="json", include=_FIXED, exclude_defaults=True)
        idle = (path for path, is_idle in _IDLE.items() if is_idle(self.settings))
        for path in (*_PLACED, *idle):
            *groups, name = path.split(".")
            group = settings
            for each in groups:
                group = group.get(each, {})
            group.pop(name, None)
        meaning = {name: value for name, value in settings.items() if value != {}}
        content = [meaning, self.directions, self.alike]
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:12]

    def settings_of(self, episode: EpisodeSpec, env: EnvConfig) -> EyasConfig:
        """Return the settings of an episode.

        Args:
            episode: The episode.
            env: What the policy sees and how it acts.
        """
        place = episode.place
        changes = {
            "world": {"map": place.map, "weather": place.weather},
            "target": place.target,
            "start": {"direction": episode.direction},
        }
        return updated(self.settings, changes).model_copy(update={"env": env})


PROTOCOLS: Mapping[str, Protocol] = {
    protocol.name: protocol
    for protocol in (
        Protocol("paper", "the published test: 3 s, figures CR and TSR"),
        Protocol(
            "long",
            "60 s: when is the target lost, and is it found again?",
            {
                "traffic": {"demand": "keep_alive"},
                "done": {"total_steps": 30_000, "no_reward_steps": _NEVER},
            },
        ),
        Protocol(
            "search",
            "20 s: the target starts out of view, 12 to 25 m beside the middle",
            {
                "traffic": {"demand": "keep_alive"},
                "start": {"horizontal_bias": {"mirrored": [12.0, 25.0]}},
                "done": {"total_steps": 10_000, "no_reward_steps": _NEVER},
            },
        ),
        Protocol(
            "distractor",
            "20 s: all vehicles have the target's model and colour, and one is beside it",
            {
                "traffic": {"demand": "keep_alive"},
                "done": {"total_steps": 10_000, "no_reward_steps": _NEVER},
            },
            alike=True,
        ),
    )
}
"""The protocols by name."""


def protocol_named(name: str, place: str = "--protocol") -> Protocol:
    """Return a protocol.

    Args:
        name: Its name.
        place: Option or setting with the name, for the message.

    Raises:
        UnknownNameError: There is no such protocol.
    """
    if name not in PROTOCOLS:
        raise UnknownNameError(place, name, PROTOCOLS)
    return PROTOCOLS[name]
