"""What a drone exactly above its target would see of it: what is the place's, and not the policy's.

Kept in the cache, since it depends on the episodes only.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.episodes.episode_batch import episode_groups
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.identity.build import this_build
from eyas.engine.policies.sight import visible_shares
from eyas.engine.settings.env import EnvConfig
from eyas.engine.sim.simulation import Simulation
from eyas.lanes import exact

Floats = NDArray[np.float64]


class FromAbove(NamedTuple):
    """N targets at K looks; look k is at (k + 1) periods."""

    shares: Floats  # Share of each that nothing hides, shape (N, K)
    places: Floats  # Centre of each, east and north [m], shape (N, K, 2)


def seen_from_above(
    episodes: Sequence[EpisodeSpec],
    protocol: Protocol,
    period: float,  # Time from the start to the first look, and between two [s]
) -> FromAbove:
    """Return what is seen of the targets of N episodes."""
    if protocol.reference:  # its variants differ by cameras and air, which hide nothing
        plain = [episode._replace(variant="") for episode in episodes]
        alone = list(dict.fromkeys(plain))
        changes = _without_camera(protocol.changes)
        one = replace(protocol, variants={}, reference="", changes=changes)
        seen = seen_from_above(alone, one, period)
        rows = [alone.index(episode) for episode in plain]
        return FromAbove(*(array[rows] for array in seen))
    make = partial(_seen, episodes, protocol, period)
    inputs = (this_build().world, protocol.hash, period, *episodes)
    return cached(EntryKind.OCCLUSION, make, inputs, of=FromAbove)


def _without_camera(changes: Mapping[str, Any]) -> dict[str, Any]:
    return {group: values for group, values in changes.items() if group != "camera"}


def _seen(episodes: Sequence[EpisodeSpec], protocol: Protocol, period: float) -> FromAbove:
    # Without biases the target is in the middle. They are sampled last, so nothing else changes.
    own = {
        name: {group: values for group, values in changes.items() if group != "start"}
        for name, changes in protocol.variants.items()
    }
    start = {**protocol.changes.get("start", {}), "horizontal_bias": 0.0, "vertical_bias": 0.0}
    protocol = replace(protocol, changes={**protocol.changes, "start": start}, variants=own)
    ticks = round(period / PHYSICS_STEP)
    looks = max(protocol.settings.done.total_steps // ticks, 1)
    shape = len(episodes), looks
    seen = FromAbove(np.zeros(shape), np.zeros((*shape, 2)))
    for group in episode_groups(episodes, protocol, EnvConfig()):
        if protocol.stage is not None:
            _look_at_targets(group.simulation)
        for look in range(looks):
            group.simulation.carry(ticks)
            seen.shares[group.rows, look] = visible_shares(group.subjects()[0])
            seen.places[group.rows, look] = group.simulation.snapshot.targets.centre[:, :2]
    return seen


def _look_at_targets(simulation: Simulation) -> None:
    """Let drones carried by their targets have them in the middle where starts are staged."""
    pitch, offset = simulation.config.start.pitch, simulation.snapshot.episodes.start_offset
    assert isinstance(pitch, float), "staged starts have one pitch"
    back = exact.tan(abs(0.5 * math.pi - pitch)) * offset[:, 2]
    offset[:, 0], offset[:, 1] = simulation.snapshot.targets.ahead - back, 0.0
