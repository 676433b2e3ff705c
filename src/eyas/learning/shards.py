"""The shards of a rollout: where they run does not change what they give."""

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from eyas.learning.crew import Crew
from eyas.learning.network import TrackingNetwork
from eyas.learning.rollout import Finished, Roller, Rollout
from eyas.settings.config import EyasConfig

__all__ = ["LocalShards", "MakeShards", "Shards"]


class Shards(Protocol):
    """All environments of a stage."""

    def begin(self, draws: Sequence[np.random.Generator]) -> None:
        """Begin new episodes, each shard with random numbers of its own."""

    def roll(self) -> Rollout:
        """Return what the environments do next with the network as it is now; the arrays are
        overwritten by the next call.
        """

    def finished(self) -> list[Finished]:
        """Return what each shard has finished since `begin`."""

    def close(self) -> None:
        """Give back what the environments hold."""


MakeShards = Callable[[EyasConfig, TrackingNetwork], Shards]
"""Makes the environments for the settings of a stage, and for the network that flies."""


class LocalShards:
    """Shards in threads of this process."""

    def __init__(self, config: EyasConfig, network: TrackingNetwork) -> None:
        self._rollers = [Roller(config, network) for _ in range(config.train.shards)]
        self._crew = Crew(config.train.shards)

    def begin(self, draws: Sequence[np.random.Generator]) -> None:
        """See `Shards.begin`."""
        for roller, own in zip(self._rollers, draws, strict=True):
            roller.begin(own)

    def roll(self) -> Rollout:
        """See `Shards.roll`."""
        return Rollout.joined(self._crew.each(Roller.roll, self._rollers))

    def finished(self) -> list[Finished]:
        """See `Shards.finished`."""
        return [roller.finished for roller in self._rollers]

    def close(self) -> None:
        """See `Shards.close`."""
        for roller in self._rollers:
            roller.env.close()
