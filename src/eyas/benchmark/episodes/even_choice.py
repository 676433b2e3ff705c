"""Chooses episodes evenly: over the map, over recordings, over vehicles, over directions.

Starts are those that the simulator samples; of several for each episode, one is kept. Only starts
count in which the target is at least half visible in the first picture: where it is hidden from the
start, nobody can know it.
"""

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.starts import VISIBLE, starts_of
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.errors import SpawnError
from eyas.engine.world.maps import MAPS

TRIED = 16  # Starts of which one is kept
_ROUNDS = 9  # Rounds of all directions that are looked at together

Floats = NDArray[np.float64]


def evenly_in(
    recordings: Sequence[int],
    places: Sequence[Place],
    protocol: Protocol,
    count: int,
    first_seed: int,
) -> list[EpisodeSpec]:
    """Choose episodes in several recordings of traffic; a `Chooser` but for its first argument.

    Seeds depend on map and target, not on the weather. Each start is the one, of `TRIED`, in the
    square of the map that has been visited least, and of these the one whose vehicle has been
    followed least.

    Raises:
        SpawnError: None of the starts for an episode will do.
    """
    chosen: dict[tuple[str, str], list[EpisodeSpec]] = {}
    for place in places:
        # The weather hides nothing that the season does not; one of them decides for all.
        alike = place._replace(weather=MAPS.get(place.town[0]).weathers[0])
        if alike[::2] not in chosen:
            chosen[alike[::2]] = list(_chosen_at(alike, recordings, protocol, count, first_seed))
    return [episode._replace(place=place) for place in places for episode in chosen[place[::2]]]


def _chosen_at(
    place: Place, recordings: Sequence[int], protocol: Protocol, count: int, first_seed: int
) -> Iterator[EpisodeSpec]:
    visits, followed = Counter[tuple[float, float]](), Counter[tuple[int, float]]()
    turns = len(protocol.directions)
    for first in range(0, count, _ROUNDS):
        numbers = range(first * turns, (first + _ROUNDS) * turns)
        tried = [
            EpisodeSpec(
                place,
                protocol.directions[number % turns],
                first_seed + number * TRIED + each,
                recordings[(number // turns + number % turns) % len(recordings)],
            )
            for number in numbers
            for each in range(TRIED)
        ]
        starts = starts_of(tried, protocol)
        for begin in range(0, min(count - first, _ROUNDS) * turns * TRIED, TRIED):
            best = _best(starts[begin : begin + TRIED], tried[begin], visits, followed)
            if best is None:
                raise SpawnError(
                    f"protocol '{protocol.name}': in '{place.map}', none of {TRIED} starts shows "
                    f"half of the target '{place.target}' (seed {tried[begin].seed})"
                )
            _, east, north, actor = starts[begin + best]
            visits[east, north] += 1
            followed[tried[begin].traffic or 0, actor] += 1
            yield tried[begin + best]


def _best(
    starts: Floats,
    episode: EpisodeSpec,
    visits: Counter[tuple[float, float]],
    followed: Counter[tuple[int, float]],
) -> int | None:
    """Return which of some starts is kept; None: in none the target is visible enough."""
    ranked = [
        (visits[east, north], followed[episode.traffic or 0, actor], number)
        for number, (share, east, north, actor) in enumerate(starts.tolist())
        if share >= VISIBLE
    ]
    return min(ranked)[-1] if ranked else None
