"""What a drone exactly above its target would see of it: what is the place's, and not the policy's.

Kept in the cache, since it depends on the episodes only.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.core.cache.cached import cached
from eyas.core.cache.folder import Kind
from eyas.core.clock import PHYSICS_STEP
from eyas.envs.config import EnvConfig
from eyas.evaluation.episode import EpisodeSpec
from eyas.evaluation.episode_batch import episode_groups
from eyas.evaluation.protocol import Protocol
from eyas.evaluation.sight import visible_shares

__all__ = ["shares_from_above"]

Floats = NDArray[np.float64]


def shares_from_above(episodes: Sequence[EpisodeSpec], protocol: Protocol, period: float) -> Floats:
    """Return the share of each target that nothing hides, at looks throughout its episode.

    Args:
        episodes: N episodes.
        protocol: Their protocol.
        period: Time from the start to the first look, and between two [s].

    Returns:
        Shape (N, K); look k is at (k + 1) * `period`.
    """
    make = partial(_shares, episodes, protocol, period)
    made = cached(Kind.OCCLUSION, make, (protocol.hash, period, *episodes), of=NDArray[np.float64])
    return np.asarray(made)


def _shares(episodes: Sequence[EpisodeSpec], protocol: Protocol, period: float) -> Floats:
    # Without biases the target is in the middle. They are sampled last, so nothing else changes.
    own = {
        name: {group: values for group, values in changes.items() if group != "start"}
        for name, changes in protocol.variants.items()
    }
    start = {**protocol.changes.get("start", {}), "horizontal_bias": 0.0, "vertical_bias": 0.0}
    protocol = replace(protocol, changes={**protocol.changes, "start": start}, variants=own)
    ticks = round(period / PHYSICS_STEP)
    looks = max(protocol.settings.done.total_steps // ticks, 1)
    shares = np.zeros((len(episodes), looks))
    for group in episode_groups(episodes, protocol, EnvConfig()):
        for look in range(looks):
            group.simulation.carry(ticks)
            shares[group.rows, look] = visible_shares(group.subjects()[0])
    return shares
