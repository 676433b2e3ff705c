"""The first episodes of consecutive seeds in which something happens that a protocol asks for."""

from collections.abc import Callable, Sequence

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.starts import visible_at_start
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.errors import SpawnError

Fits = Callable[[Sequence[EpisodeSpec], Protocol], Sequence[object]]
"""Returns for each episode what it has of what is asked for; nothing (`bool` is false): it does not
fit."""

_TRIED = 50  # Number of seeds that are tried for each episode
_CONDITION = 10_000  # From the first seed of a condition to that of the next
_HOPELESS = 1_000  # Number of starts after which no more are tried if none of them fits
_PARTS = 25  # Groups in which starts are tried: a few together cost less than each alone


def with_visible_targets(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the first episodes of each place and direction whose target is visible at the start.

    Raises:
        SpawnError: There are too few.
    """
    wanted = "a target that is visible at the start"
    return first_fitting(places, protocol, count, first_seed, fits=_all, wanted=wanted)


def visible_and_independent(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the same, with other seeds in each condition of the protocol.

    Few long flights would else be one observation in all conditions, as those of one seed are.
    """
    known = [(name, weather) for name in protocol.maps for weather in protocol.weathers]
    chosen = []
    for place in places:
        number = known.index(place[:2]) if place[:2] in known else len(known)
        first = first_seed + number * _CONDITION
        chosen += with_visible_targets([place], protocol, count, first)
    return chosen


def _all(episodes: Sequence[EpisodeSpec], _: Protocol) -> list[bool]:
    return [True] * len(episodes)


def first_fitting(
    places: Sequence[Place],
    protocol: Protocol,
    count: int,
    first_seed: int,
    *,
    fits: Fits,
    wanted: str,
    tried: int = _TRIED,
) -> list[EpisodeSpec]:
    """Return the first episodes of each place and direction that fit, in all variants.

    Of their targets at least half is visible at the start: none can know one that is hidden, or
    that a crown around the camera hides.

    Raises:
        SpawnError: There are too few.
    """
    chosen = []
    for place in places:
        starts = protocol.starts([place], count * tried, first_seed)
        found: dict[float, list[EpisodeSpec]] = {turn: [] for turn in protocol.directions}
        together = max(len(starts) // _PARTS, 1)
        for begin in range(0, len(starts), together):
            part = starts[begin : begin + together]
            fitting = [
                episode
                for episode, own in zip(part, fits(part, protocol), strict=True)
                if own and len(found[episode.direction]) < count
            ]
            for episode, shown in zip(fitting, visible_at_start(fitting, protocol), strict=True):
                if shown and len(found[episode.direction]) < count:
                    found[episode.direction].append(episode)
            tested, full = begin + len(part), all(len(own) == count for own in found.values())
            if full or (tested >= _HOPELESS and not any(found.values())):
                break
        if not full:
            raise SpawnError(
                f"protocol '{protocol.name}': of {tested} starts in '{place.map}' too few have "
                f"{wanted}; {count} are needed for each direction"
            )
        chosen += [
            found[turn][number]._replace(variant=variant)
            for number in range(count)
            for turn in protocol.directions
            for variant in protocol.variants or ("",)
        ]
    return chosen
