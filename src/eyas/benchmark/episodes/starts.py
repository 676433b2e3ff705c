"""What episodes begin with, whatever is flown in them; kept in the cache."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.episodes.episode_batch import episode_groups
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.identity.build import this_build
from eyas.engine.policies.sight import visible_shares
from eyas.engine.settings.env import EnvConfig
from eyas.engine.world.maps import MAPS

CELL = 100.0  # Side of the squares of the map that are visited in turn [m]
VISIBLE = 0.5  # Least share of the target that is visible at the start

Floats = NDArray[np.float64]


def visible_at_start(episodes: Sequence[EpisodeSpec], protocol: Protocol) -> list[bool]:
    """Return whether at least half of each target is visible in the first picture.

    The first variant decides for all of an episode's.
    """
    if not episodes:
        return []
    first = next(iter(protocol.variants), "")
    alike = [episode._replace(variant=episode.variant or first) for episode in episodes]
    shares: list[bool] = (starts_of(alike, protocol)[:, 0] >= VISIBLE).tolist()
    return shares


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
