"""Episodes in which another vehicle is beside the target at the start."""

from collections.abc import Iterator
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import SpawnError
from eyas.envs.config import EnvConfig
from eyas.evaluation.episode import Episode, Place, episodes_of
from eyas.evaluation.flock import Squad, squads_of
from eyas.evaluation.protocol import Protocol

__all__ = ["NEAR", "episodes_with_neighbours"]

NEAR = 12.0
"""Largest distance of the other vehicle from the target [m]."""

_TRIED = 50
"""Number of seeds that are tried for each episode."""


def episodes_with_neighbours(
    places: list[Place], protocol: Protocol, count: int, first_seed: int
) -> list[Episode]:
    """Return the first `count` episodes of each place and direction that have a neighbour.

    They are those of `episodes_of`, with others left out.

    Raises:
        SpawnError: There are too few.
    """
    found = []
    for place in places:
        for turn in range(len(protocol.directions)):
            tried = episodes_of([place], protocol.directions, count * _TRIED, first_seed)
            own = tried[turn :: len(protocol.directions)]
            chosen = list(islice(_with_neighbours(own, protocol, count), count))
            if len(chosen) < count:
                raise SpawnError(
                    f"protocol '{protocol.name}': only {len(chosen)} of {len(own)} starts in "
                    f"'{place.map}' have another vehicle within {NEAR:g} m of the target; "
                    f"{count} are needed"
                )
            found.append(chosen)
    return [episode for group in found for episode in group]


def _with_neighbours(episodes: list[Episode], protocol: Protocol, step: int) -> Iterator[Episode]:
    """Yield the episodes that have a neighbour; a few are begun at a time."""
    for start in range(0, len(episodes), 4 * step):
        part = episodes[start : start + 4 * step]
        for squad in squads_of(part, protocol, EnvConfig()):
            for row in np.flatnonzero(_nearest(squad) <= NEAR).tolist():
                yield part[squad.rows[row]]


def _nearest(squad: Squad) -> NDArray[np.float64]:
    """Return the distance from each target to the nearest other vehicle [m], shape (K,)."""
    targets = squad.simulation.snapshot.targets
    nearest = np.empty(len(squad.rows))
    for tracker, actor in enumerate(targets.actor.tolist()):
        actors, _ = squad.simulation.actors_around(tracker)
        away = np.linalg.norm(actors.position[0, :, :2] - targets.position[tracker, :2], axis=1)
        away = np.where(actors.present[0], away, np.inf)
        away[actor] = np.inf
        nearest[tracker] = away.min()
    return nearest
