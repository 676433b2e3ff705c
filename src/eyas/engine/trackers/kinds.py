"""The kinds of trackers: the built-in ones by name, and a user's own by path."""

from collections.abc import Callable
from typing import Any

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.own_code import running, takes
from eyas.engine.core.registry import Registry
from eyas.engine.trackers.airframes import AIRFRAMES
from eyas.engine.trackers.car import CAR
from eyas.engine.trackers.config import TrackerConfig, TrackerKind
from eyas.engine.trackers.drone import DRONE
from eyas.engine.trackers.equipped import equipped_drone, is_equipped
from eyas.engine.trackers.flown import flown_drone
from eyas.engine.trackers.tracker import Tracker


def drone(config: TrackerConfig) -> Tracker:
    """Return the drone: supervised, or flown by its controller."""
    if config.supervised:
        return DRONE
    model = AIRFRAMES[config.airframe]
    if is_equipped(config):
        return equipped_drone(config, model)
    return flown_drone(config, model.frame)


def car(config: TrackerConfig) -> Tracker:
    """Return the car."""
    return CAR


TRACKERS: Registry[Callable[[TrackerConfig], Any]] = Registry(
    "tracker.kind",
    Callable,  # type: ignore[arg-type]  # a class to `isinstance`
    {TrackerKind.DRONE.value: f"{__name__}:drone", TrackerKind.CAR.value: f"{__name__}:car"},
)
"""Functions, or classes, that return a `Tracker` for its settings."""


def tracker_of(config: TrackerConfig) -> Tracker:
    """Return the kind of tracker of some settings.

    Raises:
        ConfigError: There is no such tracker, or what the path names does not make one.
    """
    make = TRACKERS.get(config.kind)
    if why := takes(make, config):
        raise _refused(config, f"cannot be called with it ({why})")
    with running("tracker.kind", config.kind):
        made = make(config)
    if not isinstance(made, Tracker):
        raise _refused(config, f"gave a {type(made).__name__}")
    return made


def _refused(config: TrackerConfig, why: str) -> ConfigError:
    return ConfigError(
        f"tracker.kind: {config.kind!r} {why}; allowed: a class or function that takes a "
        "TrackerConfig and gives an eyas.engine.trackers.tracker.Tracker"
    )
