"""An oracle: flies to the target's true position, by the same actions as all others."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from eyas.core import exact
from eyas.evaluation.policies.policy import BLIND, Decision, PolicyInput, Start, env_config
from eyas.evaluation.steering import towards

__all__ = ["Follow", "follow"]


class Follow:
    """Brings the middle of the picture over the target, whose true position it knows."""

    sampled = False
    told = frozenset({"truth"})

    def __init__(self, changes: Mapping[str, Any]) -> None:
        self.env = env_config(BLIND, {**changes, "actions": "discrete"})

    def begin(self, start: Start) -> None:
        """Do nothing, for it remembers nothing."""

    def act(self, sight: PolicyInput) -> Decision:
        """Fly along the axis with the larger error."""
        trackers, _, targets, episodes, _ = sight.snapshot()
        error = targets.centre[:, :2] - episodes.view_centre[:, :2]
        yaw = trackers.euler[:, 2]
        sine, cosine = exact.sin(yaw), exact.cos(yaw)
        ahead = cosine * error[:, 0] + sine * error[:, 1]
        left = -sine * error[:, 0] + cosine * error[:, 1]
        return Decision(towards(np.stack((ahead, left), axis=-1), self.env))


def follow(changes: Mapping[str, Any]) -> Follow:
    """Return the oracle."""
    return Follow(changes)
