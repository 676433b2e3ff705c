"""Which episodes can be solved: those that an oracle solves that is told only what can be seen."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.delay import delay_from
from eyas.benchmark.episode import EpisodeSpec
from eyas.benchmark.flight import BatchFlight
from eyas.benchmark.policies.road_search import sighted
from eyas.benchmark.protocol import Protocol
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import Kind
from eyas.engine.core.identity.build import this_build

__all__ = ["SOLVED", "solvable"]

SOLVED = 0.95  # TSR from which `sighted` has solved an episode


def solvable(episodes: list[EpisodeSpec], protocol: Protocol) -> list[bool | None]:
    """Return whether `sighted` solves each episode; None: the protocol does not ask.

    Kept in the cache, since it depends on the episodes only.
    """
    if not protocol.tells_solvable:
        return [None] * len(episodes)
    make = partial(_kept_shares, episodes, protocol)
    inputs = (this_build().world, protocol.hash, *episodes)
    shares = np.asarray(cached(Kind.OCCLUSION, make, inputs, of=np.ndarray))
    return [bool(share >= SOLVED) for share in shares.tolist()]


def _kept_shares(episodes: list[EpisodeSpec], protocol: Protocol) -> NDArray[np.float64]:
    """Return the TSR of `sighted` in each episode, shape (E,)."""
    flight = BatchFlight(episodes, protocol, sighted(protocol.oracles), delay_from("0"))
    kept = {record.name: record.tsr for ended in flight.fly() for record in ended}
    return np.array([kept[episode.name] for episode in episodes])
