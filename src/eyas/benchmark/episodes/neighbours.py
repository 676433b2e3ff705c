"""Episodes whose target has others near it at the start."""

from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.episode_batch import EpisodeGroup, episode_groups
from eyas.benchmark.episodes.starts import visible_at_start
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.errors import SpawnError
from eyas.engine.settings.env import EnvConfig

NEAR = 12.0  # Largest distance of the other vehicle from the target [m]

CLOSE, COMPANY = 8.0, 2
"""Distance within which a target in a crowd has others [m], and how many at least."""

_TRIED = 50  # Number of seeds that are tried for each episode


def with_neighbours(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the first episodes of each place and direction whose target has a neighbour.

    They are those of `Protocol.starts`, with others left out.

    Raises:
        SpawnError: There are too few.
    """
    return _chosen(places, protocol, count, first_seed, (1, NEAR))


def in_company(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the first episodes of each place and direction whose target is among others.

    Raises:
        SpawnError: There are too few.
    """
    return _chosen(places, protocol, count, first_seed, (COMPANY, CLOSE))


def _chosen(
    places: Sequence[Place],
    protocol: Protocol,
    count: int,
    first_seed: int,
    company: tuple[int, float],
) -> list[EpisodeSpec]:
    """Return the first episodes of each place and way with enough others within a distance [m]."""
    found = []
    for place in places:
        for turn in range(len(protocol.directions)):
            tried = protocol.starts([place], count * _TRIED, first_seed)
            own = tried[turn :: len(protocol.directions)]
            chosen = list(islice(_in_company(own, protocol, count, company), count))
            if len(chosen) < count:
                raise SpawnError(
                    f"protocol '{protocol.name}': only {len(chosen)} of {len(own)} starts in "
                    f"'{place.map}' have {company[0]} other within {company[1]:g} m of the target; "
                    f"{count} are needed"
                )
            found.append(chosen)
    return [episode for chosen in found for episode in chosen]


def _in_company(
    episodes: list[EpisodeSpec], protocol: Protocol, step: int, company: tuple[int, float]
) -> Iterator[EpisodeSpec]:
    """Yield the episodes with so many others; a few are begun at a time."""
    for start in range(0, len(episodes), 4 * step):
        part = episodes[start : start + 4 * step]
        shown = visible_at_start(part, protocol)
        for group in episode_groups(part, protocol, EnvConfig()):
            for row in np.flatnonzero(_nearby(group, company[1]) >= company[0]).tolist():
                if shown[group.rows[row]]:
                    yield part[group.rows[row]]


def _nearby(group: EpisodeGroup, distance: float) -> NDArray[np.int64]:
    """Return how many others are so near to each target [m], shape (K,)."""
    targets = group.simulation.snapshot.targets
    nearby = np.zeros(len(group.rows), np.int64)
    for tracker, actor in enumerate(targets.actor.tolist()):
        actors, _ = group.simulation.actors_around(tracker)
        away = np.linalg.norm(actors.position[0, :, :2] - targets.position[tracker, :2], axis=1)
        there = actors.present[0] & (away <= distance)
        there[actor] = False
        nearby[tracker] = there.sum()
    return nearby
