"""Episodes whose target has another vehicle near it at the start."""

from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import SpawnError
from eyas.envs.config import EnvConfig
from eyas.evaluation.episode import EpisodeSpec, Place, episodes_of
from eyas.evaluation.episode_batch import EpisodeGroup, episode_groups
from eyas.evaluation.protocol import Protocol

__all__ = ["NEAR", "with_neighbours"]

NEAR = 12.0
"""Largest distance of the other vehicle from the target [m]."""

_TRIED = 50
"""Number of seeds that are tried for each episode."""


def with_neighbours(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the first episodes of each place and direction whose target has a neighbour.

    They are those of `episodes_of`, with others left out.

    Raises:
        SpawnError: There are too few.
    """
    found = []
    for place in places:
        for turn in range(len(protocol.directions)):
            tried = episodes_of([place], protocol.directions, count * _TRIED, first_seed)
            own = tried[turn :: len(protocol.directions)]
            chosen = list(islice(_beginning_beside(own, protocol, count), count))
            if len(chosen) < count:
                raise SpawnError(
                    f"protocol '{protocol.name}': only {len(chosen)} of {len(own)} starts in "
                    f"'{place.map}' have another vehicle within {NEAR:g} m of the target; "
                    f"{count} are needed"
                )
            found.append(chosen)
    return [episode for chosen in found for episode in chosen]


def _beginning_beside(
    episodes: list[EpisodeSpec], protocol: Protocol, step: int
) -> Iterator[EpisodeSpec]:
    """Yield the episodes that have a neighbour; a few are begun at a time."""
    for start in range(0, len(episodes), 4 * step):
        part = episodes[start : start + 4 * step]
        for group in episode_groups(part, protocol, EnvConfig()):
            for row in np.flatnonzero(_nearest(group) <= NEAR).tolist():
                yield part[group.rows[row]]


def _nearest(group: EpisodeGroup) -> NDArray[np.float64]:
    """Return the distance from each target to the nearest other vehicle [m], shape (K,)."""
    targets = group.simulation.snapshot.targets
    nearest = np.empty(len(group.rows))
    for tracker, actor in enumerate(targets.actor.tolist()):
        actors, _ = group.simulation.actors_around(tracker)
        away = np.linalg.norm(actors.position[0, :, :2] - targets.position[tracker, :2], axis=1)
        away = np.where(actors.present[0], away, np.inf)
        away[actor] = np.inf
        nearest[tracker] = away.min()
    return nearest
