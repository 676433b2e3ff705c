"""Evaluation during training: the network flies episodes of a protocol, with its best actions."""

from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from eyas.envs.config import EnvConfig
from eyas.evaluation.delay import delay_from
from eyas.evaluation.episode import Episode, Place, episodes_of
from eyas.evaluation.flight import Flight
from eyas.evaluation.policies.policy import Decision, PolicyInput, Start
from eyas.evaluation.protocol import Protocol, protocol_named
from eyas.learning.network import TrackingNetwork
from eyas.settings.config import EyasConfig
from eyas.world.maps import MAPS

__all__ = ["NO_MARKS", "Marks", "episodes_of_exam", "examine"]


class Marks(NamedTuple):
    """Means over the episodes, see `eyas.evaluation.record.Record`."""

    cr: float
    tsr: float


NO_MARKS = Marks(float("nan"), float("nan"))
"""Of a block that is not followed by an evaluation."""


class _Student:
    """The network as a policy."""

    sampled = False

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


def examine(network: TrackingNetwork, config: EyasConfig) -> Marks:
    """Return how the network does in the episodes of `train.evaluation`."""
    episodes, protocol = episodes_of_exam(config)
    env = config.env.model_copy(update={"mixture": ()})
    flight = Flight(episodes, protocol, _Student(network, env), delay_from("0"))
    records = [record for ended in flight.fly() for record in ended]
    means = [np.mean([getattr(record, name) for record in records]) for name in Marks._fields]
    return Marks(*(round(float(mean), 6) for mean in means))


def episodes_of_exam(config: EyasConfig) -> tuple[list[Episode], Protocol]:
    """Return the episodes of `train.evaluation`, and their protocol.

    Raises:
        UnknownNameError: There is no such protocol, or no such weather on the map.
    """
    asked, world = config.train.evaluation, config.world
    protocol = protocol_named(asked.protocol, "train.evaluation.protocol")
    weathers = asked.weathers or (world.weather,)
    for weather in weathers:
        MAPS.get(world.map).light(weather)
    places = [Place(world.map, weather, config.target) for weather in weathers]
    return episodes_of(places, protocol.directions, asked.episodes, asked.seed), protocol
