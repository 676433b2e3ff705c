"""What the page's menus choose, and the settings that it means."""

from dataclasses import dataclass
from typing import Any

from eyas.core.config import updated
from eyas.core.errors import UnknownNameError
from eyas.modes.demo.flight import Flight
from eyas.modes.demo.messages import LIGHTS, Light, World
from eyas.settings.config import EyasConfig
from eyas.sim.crowd import extras_of
from eyas.targets.config import TargetName
from eyas.trackers.config import TrackerKind
from eyas.world.maps import MAPS

__all__ = ["Plan", "plan_of", "world_of"]

_TRACKERS: dict[str, dict[str, Any]] = {
    "drone": {"kind": TrackerKind.DRONE, "supervised": True},
    "flown": {"kind": TrackerKind.DRONE, "supervised": False},
    "car": {"kind": TrackerKind.CAR},
}
_ROBOTS = (TargetName.AIBO_ERS7, TargetName.CREATE)
"""Each is a fifth of those who walk around; the others are people."""


@dataclass(frozen=True, slots=True)
class Plan:
    """A world to build.

    Attributes:
        config: The settings.
        vehicles: Largest number of vehicles that drive.
        light: What the menu of the light shows.
    """

    config: EyasConfig
    vehicles: int
    light: Light = "own"

    def build(self) -> Flight:
        """Return a flight in this world.

        Raises:
            EyasError: It cannot be built.
        """
        return Flight(self.config, self.vehicles)


def plan_of(before: Plan, said: World) -> Plan:
    """Return a plan with what a page has chosen.

    Args:
        before: The plan, for what was not chosen.
        said: The choices.

    Raises:
        ConfigError: A setting does not fit to the others, or a map or weather does not exist.
    """
    changes: dict[str, Any] = {
        "world": said.model_dump(include={"map", "weather"}, exclude_none=True)
    }
    now = before.config.world
    if said.map is not None and said.map not in (now.map, *MAPS.names()):
        # A page must not name code or folders of this machine, which a setting may.
        raise UnknownNameError("world.map", said.map, MAPS.names())
    recipe = MAPS.get(said.map or now.map)
    if said.weather is not None and said.weather not in (now.weather, *recipe.weathers):
        raise UnknownNameError("world.weather", said.weather, recipe.weathers)
    hour = now.hour if said.hour is None else None if said.hour == "own" else said.hour
    changes["world"]["hour"] = hour
    lighting = recipe.light(said.weather or now.weather, hour)
    if said.target is not None:
        changes["target"] = said.target
    if said.tracker is not None:
        changes["tracker"] = _TRACKERS[said.tracker]
    light = said.light or before.light
    if said.light is not None or light != "own":
        own = lighting.luminosity
        sun, sky = LIGHTS[light]
        changes["light"] = {
            **{"sun": own * sun, "background": own * sky},
            **{"sun_replaces": light != "own", "background_replaces": light != "own"},
        }
    people = said.people
    if people is None and said.map not in (None, now.map) and before.config.extras:
        people = _count(before.config)  # as many walk there, in the map's own way
    if people is None:
        config = updated(before.config, changes)
    else:
        config = updated(before.config, changes | {"extras": None})
        config = updated(config, {"extras": _passers_by(people, config)})
    return Plan(config, said.vehicles or before.vehicles, light)


def _passers_by(count: int, config: EyasConfig) -> list[dict[str, Any]]:
    """Return `count` people and robots; people walk as those of the map do."""
    each, own = count // 5, extras_of(config)
    groups: list[dict[str, Any]] = [
        {
            "kind": TargetName.PEDESTRIAN,
            "count": count - each * len(_ROBOTS),
            "behaviour": own[0].behaviour if own else None,
        },
        *({"kind": kind, "count": each} for kind in _ROBOTS),
    ]
    return [group for group in groups if group["count"]]


def _count(config: EyasConfig) -> int:
    return sum(extra.count for extra in extras_of(config))


def world_of(plan: Plan, flight: Flight) -> dict[str, Any]:
    """Return what is chosen, for the menus."""
    config = plan.config
    tracker = config.tracker
    flown = tracker.kind is TrackerKind.DRONE and not tracker.supervised
    chosen = {
        "map": config.world.map,
        "weather": config.world.weather,
        "vehicles": plan.vehicles,
        "target": config.target.value,
        "tracker": "flown" if flown else str(tracker.kind),
        "light": plan.light,
        "hour": "own" if config.world.hour is None else config.world.hour,
        "people": _count(config),
        "parked": flight.world.parked >= 0,
    }
    return {"world": chosen}
