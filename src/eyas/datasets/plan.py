"""The plan of a data set: the recordings that a recipe asks for, its *parts*, each with its split.

Nothing leaks: the parts of a split have seeds of their own, and maps of their own unless the recipe
lets splits share them.
"""

import hashlib
import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from eyas.datasets.recipe import Recipe
from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError, EyasError, UnknownNameError
from eyas.engine.exports.registry import chosen_writers
from eyas.engine.recordings.export import formats_needs
from eyas.engine.settings.config import EyasConfig
from eyas.engine.targets.config import TargetName
from eyas.engine.traffic.library import STANDARD_DURATION
from eyas.engine.world.maps import MAPS

_WARM_UP = 310  # Steps before the first episode that can be: those of `start.warm_up_steps` [2 ms].

_UNRECORDED = 30
"""Steps after each reset that are not recorded, as in `video.warm_up_steps` [2 ms]."""

_GRACE = 100  # Steps after a reset in which no episode ends, as in `done.grace_steps` [2 ms].


@dataclass(frozen=True, slots=True)
class DatasetPart:
    """One recording of a data set."""

    name: str
    """Name of its folder, `00012-citystreet-day`; with variants `00012-citystreet-day-clean`."""
    number: int  # Number among all parts; its variants have the same
    split: str
    variant: str  # Name of its variant; empty without
    config: EyasConfig
    frames: int  # Frames that it has if no target leaves the world early
    choices: dict[str, Any]  # What was chosen for it from the lists of the recipe

    @property
    def folder(self) -> str:
        """Its folder in the data set, with `/`."""
        return f"parts/{self.split}/{self.name}"


def planned(recipe: Recipe) -> list[DatasetPart]:
    """Return the parts of a recipe, in their order.

    Raises:
        EyasError: The recipe cannot be met; one line.
    """
    _check_names(recipe)
    _check_places(recipe)
    sizes = {
        split: _sizes(episodes, recipe.trackers, recipe.episodes)
        for split, episodes in _episodes(recipe).items()
    }
    counts = Counter(name for split in sizes for name in _maps(recipe, split, len(sizes[split])))
    before = Counter[str]()  # Parts of each map until now
    parts: list[DatasetPart] = []
    for split, own in sizes.items():
        first = parts[-1].number + 1 if parts else 0
        parts += _parts(recipe, split, first, own, before, counts)
    return parts


def sample_of(recipe: Recipe) -> Recipe:
    """Return the recipe of a hundredth: most kinds of parts, few frames each, all maps."""
    frames = min(recipe.episode_frames, 10)
    unit = frames * max(1, len(recipe.variants))
    episodes = max(1, math.ceil(recipe.frames / 100 / unit))
    needed = (len(split.maps) / split.share for split in recipe.splits.given.values())
    episodes = max(episodes, math.ceil(max(needed) - 1e-9))
    while any(
        count < len(recipe.splits.given[name].maps)
        for name, count in _shared_out(recipe, episodes).items()
    ):
        episodes += 1
    small = {"frames": episodes * unit, "episode_frames": frames, "trackers": 1, "episodes": 1}
    return updated(recipe, small)


def in_order_of_work(parts: Sequence[DatasetPart]) -> list[DatasetPart]:
    """Return parts so that those that share a map follow each other, and in it a weather."""
    return sorted(parts, key=lambda part: (*place_of(part), part.number, part.variant))


def place_of(part: DatasetPart) -> tuple[str, str]:
    """Return map and weather of a part."""
    return part.config.world.map, part.config.world.weather


def shard_of(parts: Sequence[DatasetPart], number: int, count: int) -> list[DatasetPart]:
    """Return the parts of one shard: of few maps, and all variants of a part together.

    Raises:
        ConfigError: There are fewer parts than shards.
    """
    groups = list(dict.fromkeys(part.number for part in in_order_of_work(parts)))
    if not 1 <= number <= count <= len(groups):
        raise ConfigError(
            f"--shard: '{number}/{count}' is not allowed: I/N, I from 1 to N, and N at most "
            f"{len(groups)}, the number of parts"
        )
    low, high = (len(groups) * at // count for at in (number - 1, number))
    chosen = set(groups[low:high])
    return [part for part in parts if part.number in chosen]


def _check_names(recipe: Recipe) -> None:
    """Refuse names that are unknown, and formats that cannot be made of what is recorded."""
    chosen_writers(recipe.writers)
    for name in recipe.formats:
        for needed in formats_needs([name]):
            pictures = needed == "jpeg" and "png" in recipe.writers
            if needed not in recipe.writers and not pictures:
                raise ConfigError(
                    f"writers: the format {name!r} needs {needed!r}, which is not among "
                    f"{', '.join(recipe.writers)}"
                )
    maps = [name for split in recipe.splits.given.values() for name in split.maps]
    for name in recipe.places:
        if name not in maps:
            raise UnknownNameError("places", name, maps, "in the splits")
    for name, split in recipe.splits.given.items():
        for at, place in enumerate(split.maps):
            try:
                for weather in recipe.weathers:
                    MAPS.get(place).light(weather)
            except EyasError as error:
                raise ConfigError(f"splits.{name}.maps.{at}: {error}") from None


def _check_places(recipe: Recipe) -> None:
    """Refuse a place in two splits."""
    seen: dict[object, tuple[str, str]] = {}
    for name, split in recipe.splits.given.items():
        for place in () if recipe.shared_places else split.maps:
            other, where = seen.setdefault(_roads_of(place), (place, name))
            if where != name:
                told = "is" if other == place else f"has the roads of {other!r}, which is"
                raise ConfigError(
                    f"splits.{name}.maps: {place!r} {told} in the split '{where}', too; no place "
                    "may be in two splits, unless shared_places is true"
                )


def _roads_of(name: str) -> object:
    """Return what tells whether two maps have the same roads."""
    roads = MAPS.get(name).roads
    return (roads.func, roads.args) if isinstance(roads, partial) else roads


def _episodes(recipe: Recipe) -> dict[str, int]:
    """Return how many episodes, without variants, each split has."""
    variants = max(1, len(recipe.variants))
    unit = recipe.episode_frames * variants
    if recipe.frames % unit:
        low = recipe.frames - recipe.frames % unit
        near = f"{low} or {low + unit}" if low else f"{unit}"
        told = f"episode_frames, {recipe.episode_frames}"
        told += f", times {variants} variants" if recipe.variants else ""
        raise ConfigError(
            f"frames: {recipe.frames} is not allowed: a multiple of {told}, such as {near}"
        )
    shared = _shared_out(recipe, recipe.frames // unit)
    for name, split in recipe.splits.given.items():
        parts = len(_sizes(shared[name], recipe.trackers, recipe.episodes))
        if parts < len(split.maps):
            raise ConfigError(
                f"splits.{name}: {shared[name]} episodes make {parts} parts of "
                f"{recipe.trackers} x {recipe.episodes} episodes, fewer than its "
                f"{len(split.maps)} maps; allowed: more frames, or fewer trackers, episodes or "
                "maps"
            )
    return shared


def _shared_out(recipe: Recipe, episodes: int) -> dict[str, int]:
    """Return how many of the episodes each split gets, by the largest remainders."""
    exact = {name: split.share * episodes for name, split in recipe.splits.given.items()}
    shared = {name: math.floor(share + 1e-9) for name, share in exact.items()}
    by_rest = sorted(exact, key=lambda name: shared[name] - exact[name])
    for name in by_rest[: episodes - sum(shared.values())]:
        shared[name] += 1
    return shared


def _sizes(episodes: int, trackers: int, each: int) -> list[tuple[int, int]]:
    """Return for each part its trackers, and the episodes of each of them."""
    sizes = [(trackers, each)] * (episodes // (trackers * each))
    left = episodes % (trackers * each)
    while left:
        flown = min(left, trackers)
        sizes.append((flown, left // flown))
        left -= flown * (left // flown)
    return sizes


def _parts(
    recipe: Recipe,
    split: str,
    first: int,
    sizes: Sequence[tuple[int, int]],
    before: Counter[str],
    counts: Mapping[str, int],
) -> list[DatasetPart]:
    """Return the parts of a split, the first of which has the number `first`.

    Args:
        before: How many parts of each map come before; those of the split are added.
        counts: How many parts of each map there are in all splits.
    """
    count = len(sizes)
    columns = {"map": _maps(recipe, split, count)} | {
        name: _spread(values, count, f"{recipe.seed} {split} {name}")
        for name, values in _lists(recipe).items()
    }
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    parts = []
    for at, (chosen, size) in enumerate(zip(rows, sizes, strict=True)):
        share = before[chosen["map"]] / counts[chosen["map"]]
        before[chosen["map"]] += 1
        for variant, changes in (recipe.variants or {"": {}}).items():
            config = _settings(recipe, chosen, changes, first + at)
            config = _timed(config, recipe, size, share)
            parts.append(_part(recipe, split, first + at, variant, config, chosen))
    return parts


def _maps(recipe: Recipe, split: str, count: int) -> list[str]:
    """Return the maps of the parts of a split."""
    return _spread(recipe.splits.given[split].maps, count, f"{recipe.seed} {split} map")


def _part(
    recipe: Recipe,
    split: str,
    number: int,
    variant: str,
    config: EyasConfig,
    chosen: dict[str, Any],
) -> DatasetPart:
    words = (f"{number:05d}", config.world.map, config.world.weather, variant)
    name = "-".join(re.sub(r"[^\w.]+", "-", word).strip("-.") for word in words if word)
    episodes = round(config.video.total_time * PHYSICS_RATE) // config.done.total_steps
    frames = config.video.channels * episodes * recipe.episode_frames
    told = {name: value for name, value in chosen.items() if len(_lists(recipe).get(name, ())) > 1}
    return DatasetPart(name, number, split, variant, config, frames, told)


def _lists(recipe: Recipe) -> dict[str, tuple[Any, ...]]:
    """Return the lists of which each part takes one value, by name."""
    return {
        "weather": recipe.weathers,
        "hour": recipe.hours,
        "target": recipe.targets,
        "height": recipe.heights,
        "pitch": recipe.pitches,
        "camera": recipe.cameras,
        "flight": recipe.flights,
        "extras": recipe.extras,
        **{f"factors.{name}": values for name, values in recipe.factors.items()},
    }


def _spread(values: Sequence[Any], count: int, key: str) -> list[Any]:
    """Return `count` of the values, each equally often but for one, shuffled by the key.

    By digests, which are the same everywhere.
    """
    order = sorted(range(count), key=lambda at: hashlib.sha256(f"{key} {at}".encode()).digest())
    turns = sorted(values, key=lambda value: hashlib.sha256(f"{key} {value}".encode()).digest())
    spread: list[Any] = [None] * count
    for turn, at in enumerate(order):
        spread[at] = turns[turn % len(turns)]
    return spread


def _settings(
    recipe: Recipe, chosen: Mapping[str, Any], variant: Mapping[str, Any], number: int
) -> EyasConfig:
    """Return the settings of a part, but for when it records."""
    changes: dict[str, Any] = {
        "seed": recipe.seed + number,
        "target": chosen["target"],
        "world": {"map": chosen["map"], "weather": chosen["weather"], "hour": chosen["hour"]},
        "camera": chosen["camera"].model_dump(),
        "start": {"height": chosen["height"], "pitch": chosen["pitch"]},
        "extras": chosen["extras"],
        "video": {"fps": recipe.fps, "flight": chosen["flight"], "writers": recipe.writers},
    }
    config = updated(EyasConfig(), changes)
    named: list[tuple[str, Mapping[str, Any]]] = [("settings", recipe.settings)]
    if chosen["map"] in recipe.places:
        named += [(f"places.{chosen['map']}", recipe.places[chosen["map"]])]
    named += [(name, chosen[name]) for name in chosen if name.startswith("factors.")]
    named += [("variants", variant)]
    for path, more in named:
        try:
            config = updated(config, more)
        except ConfigError as error:
            raise ConfigError(f"{path}.{error}") from None
    return config


def _timed(config: EyasConfig, recipe: Recipe, size: tuple[int, int], share: float) -> EyasConfig:
    """Return settings that record so many trackers and episodes, all frames of each.

    Args:
        share: Where in the traffic's recording it begins, 0 to 1; the parts of a map begin at
            different times.
    """
    trackers, episodes = size
    spacing = PHYSICS_RATE / recipe.fps
    # The grid of frames begins with the first step after those that are not recorded.
    steps = _UNRECORDED + 1 + math.floor((recipe.episode_frames - 1) * spacing + 0.5)
    known, needed = round(STANDARD_DURATION * PHYSICS_RATE), _WARM_UP + episodes * steps
    if needed > known:
        raise ConfigError(
            f"episode_frames: {episodes} episodes of {recipe.episode_frames} frames at "
            f"{recipe.fps:g} Hz take {needed / PHYSICS_RATE:.0f} s of traffic, which has "
            f"{STANDARD_DURATION:g} s; allowed: fewer episodes or frames, or a higher fps"
        )
    most, vehicles = config.traffic.max_vehicles, TargetName.SUMO_VEHICLE
    follows = config.custom is None and config.target is vehicles and not config.same_target
    if follows and trackers > most:
        raise ConfigError(
            f"trackers: {trackers} is not allowed: at most one for each of the {most} vehicles "
            "(traffic.max_vehicles), or same_target"
        )
    begin = _WARM_UP + math.floor((known - needed) * share)
    changes = {
        "start": {"warm_up_steps": begin},
        "done": {"total_steps": steps, "grace_steps": min(_GRACE, steps)},
        "video": {
            "channels": trackers,
            "start_time": begin / PHYSICS_RATE,
            "total_time": episodes * steps / PHYSICS_RATE,
            "warm_up_steps": _UNRECORDED,
        },
    }
    return updated(config, changes)
