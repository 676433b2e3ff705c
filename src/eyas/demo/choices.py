"""What the page's menus choose, the settings that it means, and the building of such worlds."""

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from eyas.demo.flight import DemoFlight
from eyas.demo.messages import LIGHTS, Light, WorldMessage
from eyas.demo.offer import Offer
from eyas.engine.core.config import updated
from eyas.engine.core.errors import EyasError, UnknownNameError
from eyas.engine.custom.config import CustomConfig
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.crowd import extras_of
from eyas.engine.targets.config import TargetName
from eyas.engine.trackers.config import TrackerKind
from eyas.engine.world.maps import MAPS

_TRACKERS: dict[str, dict[str, Any]] = {
    "drone": {"kind": TrackerKind.DRONE, "supervised": True},
    "flown": {"kind": TrackerKind.DRONE, "supervised": False},
    "car": {"kind": TrackerKind.CAR},
}
_ROBOTS = (TargetName.AIBO_ERS7, TargetName.CREATE)
"""Each is a fifth of those who walk around; the others are people."""


@dataclass(frozen=True, slots=True)
class WorldChoice:
    """A world to build: settings, at most so many vehicles, what the menu of the light shows."""

    config: EyasConfig
    vehicles: int
    light: Light = "own"

    def build(self) -> DemoFlight:
        """Return a flight in this world.

        Raises:
            EyasError: It cannot be built.
        """
        return DemoFlight(self.config, self.vehicles)


def choice_of(before: WorldChoice, said: WorldMessage, offer: Offer) -> WorldChoice:
    """Return a plan with what a page has chosen.

    Args:
        before: The plan, for what was not chosen.
        offer: What it may choose.

    Raises:
        ConfigError: A setting does not fit to the others, or a map or weather does not exist.
    """
    changes: dict[str, Any] = {
        "world": said.model_dump(include={"map", "weather"}, exclude_none=True)
    }
    now = before.config.world
    # A page must not name code or folders of this machine, which a setting may.
    if said.map is not None and said.map not in (now.map, *offer.maps):
        raise UnknownNameError("world.map", said.map, tuple(offer.maps))
    if said.target is not None and said.target not in offer.targets:
        raise UnknownNameError("target", said.target, tuple(offer.targets))
    recipe = MAPS.get(said.map or now.map)
    if said.weather is not None and said.weather not in (now.weather, *recipe.weathers):
        raise UnknownNameError("world.weather", said.weather, recipe.weathers)
    hour = now.hour if said.hour is None else None if said.hour == "own" else said.hour
    changes["world"]["hour"] = hour
    lighting = recipe.light(said.weather or now.weather, hour, now.moon)
    if said.target is not None:
        changes |= offer.targets[said.target]
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
    return WorldChoice(config, said.vehicles or before.vehicles, light)


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


def world_of(plan: WorldChoice, flight: DemoFlight, offer: Offer) -> dict[str, Any]:
    """Return what is chosen, for the menus."""
    return {"world": chosen_in(plan, offer) | {"parked": flight.world.parked >= 0}}


def chosen_in(plan: WorldChoice, offer: Offer) -> dict[str, Any]:
    """Return what each menu shows of a plan."""
    config = plan.config
    tracker = config.tracker
    flown = tracker.kind is TrackerKind.DRONE and not tracker.supervised
    return {
        "map": config.world.map,
        "weather": config.world.weather,
        "vehicles": plan.vehicles,
        "target": _target_of(config, offer),
        "tracker": "flown" if flown else str(tracker.kind),
        "light": plan.light,
        "hour": "own" if config.world.hour is None else config.world.hour,
        "people": _count(config),
    }


def _target_of(config: EyasConfig, offer: Offer) -> str:
    """Return the name under which the menu has the target."""
    for name, changes in offer.targets.items():
        custom = changes["custom"]
        if custom is not None and config.custom == CustomConfig(**custom):
            return name
    return config.target.value


class Builder:
    """Builds one world at a time; of those that are ordered meanwhile, only the last.

    Attributes:
        plan: What is being built, or was last; choices that follow start from it.
        flown: What was built last.
    """

    def __init__(self, plan: WorldChoice) -> None:
        self.plan = self.flown = plan
        self._threads = ThreadPoolExecutor(1, "eyas-world")
        self._built: Future[DemoFlight] | None = None
        self._building = plan

    @property
    def busy(self) -> bool:
        """Whether a world is being built."""
        return self._built is not None

    def order(self, plan: WorldChoice) -> None:
        """Begin to build a world, or do so when the one before is built."""
        self.plan = plan
        if self._built is None:
            self._begin()

    def _begin(self) -> None:
        self._building = self.plan
        self._built = self._threads.submit(self.plan.build)

    def take(self) -> DemoFlight | None:
        """Return the flight in the world that was ordered last, once, when it is built.

        Raises:
            EyasError: It cannot be built.
        """
        if self._built is None or not self._built.done():
            return None
        built, self._built = self._built, None
        if self._building is not self.plan:
            self._begin()
            return None
        try:
            flight = built.result()
        except EyasError:
            self.plan = self.flown
            raise
        self.flown = self.plan
        return flight

    def stop(self) -> None:
        """Wait for a world that is being built, and drop it."""
        self._threads.shutdown(cancel_futures=True)
        self._threads = ThreadPoolExecutor(1, "eyas-world")  # it may go on after other flights
