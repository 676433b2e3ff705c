"""A recipe with what a command line asks for instead: classes, weathers, maps, frames, settings."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from eyas.datasets.recipe import Recipe, Split, Splits
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.settings.file import nested_overrides
from eyas.engine.targets.config import TargetName, vehicle_class
from eyas.engine.traffic.config import TrafficConfig, VehicleType
from eyas.engine.traffic.fleet import vehicle_types
from eyas.engine.traffic.library import CANONICAL_MIX, is_shipped
from eyas.engine.world.maps import MAPS

SHARED = "No map is left for val, which has other episodes of the maps of train."
_PEOPLE = ("person", "people", "pedestrian")


class Asked(NamedTuple):
    """What replaces parts of a recipe; what is empty or None leaves it as it is."""

    frames: int | None = None  # Number of all frames
    classes: tuple[str, ...] = ()  # What is followed: car, bus, truck, motorcycle, person, ...
    weathers: tuple[str, ...] = ()
    maps: tuple[str, ...] = ()  # The only maps, each in the split that the recipe puts it in
    formats: tuple[str, ...] = ()  # Further formats of `eyas export`
    settings: tuple[str, ...] = ()  # Changes of settings in all parts, each as KEY=VALUE

    def of(self, recipe: Recipe) -> Recipe:
        """Return a recipe with what is asked for.

        Raises:
            EyasError: A name is unknown, or no map is left; one line.
        """
        changes: dict[str, Any] = {}
        if self.frames is not None:
            changes["frames"] = self.frames
        if self.weathers:
            changes["weathers"] = self.weathers
        if self.formats:
            changes["formats"] = tuple(dict.fromkeys((*recipe.formats, *self.formats)))
        factors = dict(recipe.factors)
        if self.settings:
            factors["set"] = (nested_overrides(self.settings),)
        maps = _only(recipe, self.maps)
        if self.classes:
            followed, vehicles = _followed(self.classes)
            factors["classes"] = followed
            changes["targets"] = (TargetName.SUMO_VEHICLE,)
            if vehicles:
                maps = _with_recordings(maps, vehicles)
                changes["trackers"] = min(recipe.trackers, _most(vehicles))
        if maps != _only(recipe, ()):
            if maps.get("train") and not maps.get("val", True):
                maps["val"] = maps["train"]
                changes["shared_places"] = True
            changes["splits"] = _shared(recipe.splits, maps)
        told = {name: value for name, value in self._asdict().items() if value and name != "frames"}
        if told:  # the words of the recipe describe what it was
            words = "; ".join(f"{name} {', '.join(value)}" for name, value in told.items())
            changes["about"] = f"Made by the recipe {recipe.name}, but with {words}."
            if "shared_places" in changes:
                changes["about"] += f" {SHARED}"
        return updated(recipe, changes | {"factors": factors})


def _only(recipe: Recipe, maps: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Return the maps of each split, of those that are asked for; all without."""
    every = {name: split.maps for name, split in recipe.splits.given.items()}
    known = [name for names in every.values() for name in names]
    for name in maps:
        if name not in known:
            raise UnknownNameError("--map", name, known, "in the splits")
    return {
        split: tuple(name for name in names if not maps or name in maps)
        for split, names in every.items()
    }


def _followed(classes: Sequence[str]) -> tuple[tuple[dict[str, Any], ...], list[VehicleType]]:
    """Return the changes of settings that follow classes, and those that are vehicles."""
    people = [name for name in classes if name.lower() in _PEOPLE]
    vehicles = [vehicle_class(name) for name in classes if name not in people]
    followed: list[dict[str, Any]] = []
    if vehicles:
        mix = CANONICAL_MIX.model_dump()
        followed += [{"start": {"vehicles": vehicles}, "traffic": {"vehicle_type": mix}}]
    if people:
        followed += [{"target": str(TargetName.PEDESTRIAN)}]
    return tuple(followed), vehicles


def _with_recordings(
    maps: Mapping[str, tuple[str, ...]], vehicles: Sequence[VehicleType]
) -> dict[str, tuple[str, ...]]:
    """Return the maps on which recorded traffic of a mixed fleet ships: the others need SUMO."""
    if set(vehicles) == {VehicleType.PASSENGER}:
        return dict(maps)
    mixed = TrafficConfig(vehicle_type=CANONICAL_MIX)
    ships = partial(_ships, mixed)
    left = {split: tuple(filter(ships, names)) for split, names in maps.items()}
    if not any(left.values()):
        able = ", ".join(filter(ships, MAPS.built_in))
        raise ConfigError(
            f"--classes: on {', '.join(name for names in maps.values() for name in names)} no "
            f"recorded traffic has {' or '.join(vehicles)}; it ships with {able}"
        )
    return left


def _ships(config: TrafficConfig, name: str) -> bool:
    recipe = MAPS.get(name)
    return is_shipped(recipe.roads(0), config, recipe.shipped_traffic())


def _most(vehicles: Sequence[VehicleType]) -> int:
    """Return how many vehicles of some classes the shipped mixed fleets have."""
    fleet = vehicle_types(TrafficConfig(vehicle_type=CANONICAL_MIX))
    return sum(kind in vehicles for kind in fleet)


def _shared(splits: Splits, maps: Mapping[str, tuple[str, ...]]) -> Splits:
    """Return the splits with these maps; those without any leave their share to the others."""
    left = {name: split for name, split in splits.given.items() if maps[name]}
    whole = sum(split.share for split in left.values())
    return Splits(
        **{name: Split(share=split.share / whole, maps=maps[name]) for name, split in left.items()}
    )
