"""The ends of the scale: a drone that hovers, one that flies at random."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from eyas.engine.core.rng import stream
from eyas.engine.policies.policy import Decision, PolicyInput, Start, env_config
from eyas.engine.settings.env import ObservationPart

_NO_PICTURE = {"observation": {"parts": [ObservationPart.SENSORS]}}
"""Changes of `EnvConfig`: neither looks, so that no picture is drawn."""

HOVER = 6
ACTIONS = 7


class Hover:
    """Does nothing."""

    sampled = False
    told: frozenset[str] = frozenset()

    def __init__(self, changes: Mapping[str, Any]) -> None:
        self.env = env_config(_NO_PICTURE, {**changes, "actions": "discrete"})

    def begin(self, start: Start) -> None:
        """Remember the number of drones."""
        self._actions = np.full(len(start.seeds), HOVER)

    def act(self, sight: PolicyInput) -> Decision:
        """Hover."""
        return Decision(self._actions)


class Random:
    """Draws one of the seven actions every 32 ms."""

    sampled = True
    told: frozenset[str] = frozenset()

    def __init__(self, changes: Mapping[str, Any]) -> None:
        self.env = env_config(
            {**_NO_PICTURE, "action_repeat": 4}, {**changes, "actions": "discrete"}
        )

    def begin(self, start: Start) -> None:
        """Begin the random numbers of each episode."""
        self._streams = [stream(seed, "policy") for seed in start.seeds.tolist()]

    def act(self, sight: PolicyInput) -> Decision:
        """Draw actions, for those who decide."""
        actions = np.full(len(self._streams), HOVER)
        for row in np.flatnonzero(sight.deciding).tolist():
            actions[row] = self._streams[row].integers(ACTIONS)
        return Decision(actions)
