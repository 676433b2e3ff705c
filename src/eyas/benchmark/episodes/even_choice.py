"""Chooses episodes evenly: over the map, over recordings, over vehicles, over directions.

Starts are those that the simulator samples; of several for each episode, one is kept. Only starts
count in which the target is at least half visible in the first picture: where it is hidden from the
start, nobody can know it.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.episode_batch import episode_groups
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.errors import SpawnError
from eyas.engine.core.identity.build import this_build
from eyas.engine.policies.sight import visible_shares
from eyas.engine.settings.env import EnvConfig
from eyas.engine.world.maps import MAPS

CELL = 100.0  # Side of the squares of the map that are visited in turn [m]
_VISIBLE = 0.5  # Least share of the target that is visible at the start
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
        if share >= _VISIBLE
    ]
    return min(ranked)[-1] if ranked else None


def starts_of(episodes: list[EpisodeSpec], protocol: Protocol) -> Floats:
    """Return what episodes begin with: visible share of the target, its square of the map, east and
    north, and its actor, shape (E, 4). Kept in the cache.
    """
    data = MAPS.get(episodes[0].place.town[0]).data_hash()
    inputs = (this_build().world, data, protocol.hash, *episodes)
    starts: Floats = cached(
        EntryKind.OCCLUSION, partial(_looked_at, episodes, protocol), inputs, of=np.ndarray
    )
    return starts


def _looked_at(episodes: list[EpisodeSpec], protocol: Protocol) -> Floats:
    starts = np.zeros((len(episodes), 4))
    for group in episode_groups(episodes, protocol, EnvConfig()):
        pixels, _ = group.subjects()
        targets = group.simulation.snapshot.targets
        starts[group.rows, 0] = visible_shares(pixels)
        starts[group.rows, 1:3] = np.floor(targets.centre[:, :2] / CELL)
        starts[group.rows, 3] = targets.actor
    return starts
