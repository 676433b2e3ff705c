"""The first episodes of consecutive seeds in which something happens that a protocol asks for."""

from collections.abc import Callable, Sequence

from eyas.core.errors import SpawnError
from eyas.evaluation.episode import EpisodeSpec, Place, episodes_of
from eyas.evaluation.protocol import Protocol

__all__ = ["Fits", "first_fitting"]

Fits = Callable[[Sequence[EpisodeSpec], Protocol], Sequence[object]]
"""Returns for each episode what it has of what is asked for; nothing (`bool` is false): it does not
fit."""

_TRIED = 50
"""Number of seeds that are tried for each episode."""


def first_fitting(
    places: Sequence[Place],
    protocol: Protocol,
    count: int,
    first_seed: int,
    *,
    fits: Fits,
    wanted: str,
) -> list[EpisodeSpec]:
    """Return the first episodes of each place and direction that fit, in all variants.

    Args:
        places: The places.
        protocol: The protocol.
        count: Number of episodes for each place and direction.
        first_seed: Seed of the first one that is tried.
        fits: Tells which fit.
        wanted: What they must have, for the message.

    Raises:
        SpawnError: There are too few.
    """
    turns, chosen = len(protocol.directions), []
    for place in places:
        tried = episodes_of([place], protocol.directions, count * _TRIED, first_seed)
        found: dict[float, list[EpisodeSpec]] = {turn: [] for turn in protocol.directions}
        for begin in range(0, len(tried), 2 * count * turns):
            part = tried[begin : begin + 2 * count * turns]
            for episode, own in zip(part, fits(part, protocol), strict=True):
                if own and len(found[episode.direction]) < count:
                    found[episode.direction].append(episode)
            if all(len(own) == count for own in found.values()):
                break
        else:
            raise SpawnError(
                f"protocol '{protocol.name}': of {len(tried)} starts in '{place.map}' too few have "
                f"{wanted}; {count} are needed for each direction"
            )
        chosen += [
            found[turn][number]._replace(variant=variant)
            for number in range(count)
            for turn in protocol.directions
            for variant in protocol.variants or ("",)
        ]
    return chosen
