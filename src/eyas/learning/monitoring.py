"""What a run tells of itself: evaluation with its best actions, and curves for TensorBoard."""

from collections.abc import Mapping
from copy import deepcopy
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from eyas.benchmark.episodes.episode import EpisodeSpec, Place, episodes_of
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.protocols.table import protocol_named
from eyas.engine.policies.policy import Decision, PolicyInput, Start
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.env import EnvConfig
from eyas.engine.world.maps import MAPS
from eyas.learning.config import TrainConfig
from eyas.learning.network import TrackingNetwork


class EvaluationScores(NamedTuple):
    """Means over the episodes, see `eyas.benchmark.records.record.EpisodeRecord`."""

    cr: float
    tsr: float


NO_SCORES = EvaluationScores(float("nan"), float("nan"))
"""Figures of a block that no evaluation follows."""


class _NetworkPolicy:
    """The network as a policy."""

    sampled = False
    told: frozenset[str] = frozenset()

    def __init__(self, network: TrackingNetwork, env: EnvConfig) -> None:
        self.env = env
        self._network = network
        self._state = torch.zeros(0)

    def begin(self, start: Start) -> None:
        self._state = torch.zeros(len(start.seeds), self._network.shape.state)

    @torch.no_grad()
    def act(self, sight: PolicyInput) -> Decision:
        assert isinstance(sight.observation, np.ndarray)
        logits, _, memory = self._network(torch.from_numpy(sight.observation), self._state)
        action: Tensor = logits.argmax(1)
        deciding = torch.from_numpy(sight.deciding)[:, None]
        after = self._network.next_state(action, memory)
        self._state = torch.where(deciding, after, self._state)
        return Decision(action.numpy())


def evaluated(network: TrackingNetwork, config: EyasConfig) -> EvaluationScores:
    """Return how the network does, on this processor, in the episodes of `train.evaluation`."""
    episodes, protocol = evaluation_episodes(config)
    env = config.env.model_copy(update={"mixture": ()})
    flight = BatchFlight(
        episodes, protocol, _NetworkPolicy(deepcopy(network).cpu(), env), delay_from("0")
    )
    records = [record for ended in flight.fly() for record in ended]
    means = [
        np.mean([getattr(record, name) for record in records]) for name in EvaluationScores._fields
    ]
    return EvaluationScores(*(round(float(mean), 6) for mean in means))


def evaluation_episodes(config: EyasConfig) -> tuple[list[EpisodeSpec], Protocol]:
    """Return the episodes of `train.evaluation`, and their protocol.

    Raises:
        UnknownNameError: There is no such protocol, or no such weather on the map.
    """
    asked, world = TrainConfig.of(config).evaluation, config.world
    protocol = protocol_named(asked.protocol, "train.evaluation.protocol")
    weathers = asked.weathers or (world.weather,)
    for weather in weathers:
        MAPS.get(world.map).light(weather)
    places = [Place(world.map, weather, config.target) for weather in weathers]
    return episodes_of(places, protocol.directions, asked.episodes, asked.seed), protocol


class TensorBoardWriter:
    """Writes numbers for TensorBoard, if it is installed."""

    def __init__(self, folder: Path) -> None:
        try:
            from torch.utils.tensorboard import SummaryWriter
        except ImportError:  # curve.csv has the same
            self._writer = None
        else:
            self._writer = SummaryWriter
        self._folder = folder

    def add(self, decisions: int, values: Mapping[str, float]) -> None:
        """Add a point to each curve."""
        if self._writer is None:
            return
        with self._writer(str(self._folder), purge_step=decisions) as writer:
            for name, value in values.items():
                if name != "decisions":
                    writer.add_scalar(name, value, decisions)
