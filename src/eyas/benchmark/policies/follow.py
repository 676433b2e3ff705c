"""An oracle: flies to the target's true position, by the same actions as all others."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from eyas.benchmark.policies.oracle_commands import actions_of_oracles, flown_over
from eyas.engine.policies.policy import BLIND, Decision, PolicyInput, Start, env_config


class Follow:
    """Brings the middle of the picture over the target, whose true position it knows."""

    sampled = False
    told = frozenset({"truth"})

    def __init__(self, changes: Mapping[str, Any]) -> None:
        self.env = env_config(
            BLIND, {**changes, "actions": actions_of_oracles(changes.get("actions"))}
        )

    def begin(self, start: Start) -> None:
        """No-op: this oracle is stateless."""

    def act(self, sight: PolicyInput) -> Decision:
        """Fly there."""
        state = sight.snapshot()
        places, velocities = state.targets.centre[:, :2], state.targets.velocity[:, :2]
        levels = np.stack((state.targets.centre[:, 2], state.targets.velocity[:, 2]), axis=1)
        return Decision(flown_over(state, places, velocities, levels, self.env))
