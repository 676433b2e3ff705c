"""How much of a target can be seen at all: its visible share under exact following."""

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.core.cache.cached import cached
from eyas.core.cache.folder import Kind
from eyas.core.clock import physics_steps
from eyas.envs.config import EnvConfig
from eyas.evaluation.episode import Episode
from eyas.evaluation.flock import squads_of
from eyas.evaluation.protocol import Protocol

__all__ = ["clear_shares"]

_PERIOD = 0.128
"""Time between two looks [s]."""


def clear_shares(episodes: list[Episode], protocol: Protocol) -> list[float]:
    """Return the mean share of each target that nothing hides from a drone exactly above it.

    Kept in the cache, since it depends on the episodes only.
    """
    make = partial(_flown, episodes, protocol)
    made = cached(Kind.OCCLUSION, make, (protocol.hash, *episodes), of=np.ndarray)
    shares: list[float] = np.asarray(made).tolist()
    return shares


def _flown(episodes: list[Episode], protocol: Protocol) -> NDArray[np.float64]:
    # Without biases the target is in the middle. They are drawn last, so nothing else changes.
    start = {**protocol.changes.get("start", {}), "horizontal_bias": 0.0, "vertical_bias": 0.0}
    protocol = replace(protocol, changes={**protocol.changes, "start": start})
    settings = protocol.settings
    ticks = round(_PERIOD * 500)
    looks = settings.done.total_steps // max(ticks, physics_steps(settings.control.frequency))
    shares = np.zeros(len(episodes))
    for squad in squads_of(episodes, protocol, EnvConfig()):
        for _ in range(looks):
            squad.simulation.carry(ticks)
            pixels, _ = squad.subjects()
            shares[squad.rows] += pixels[:, 0] / np.maximum(pixels[:, 1], 1)
    return shares / max(looks, 1)
