"""A learning algorithm of your own, added without changes to Eyas: REINFORCE with a baseline.

    PYTHONPATH=examples python examples/own_algorithm.py

Williams, "Simple statistical gradient-following algorithms for connectionist reinforcement
learning" (1992): actions become likelier by the rewards that follow them, less what the network
expected. `train.method` takes its path, so `eyas train` runs it, resumes it, and evaluates and
exports the network: `eyas train --trust --method own_algorithm:Reinforce --set
train.own.entropy=0.02`. To give it a short name, define an entry point in the group
`eyas.algorithms`. With `dagger+own_algorithm:Reinforce` a teacher teaches first.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch

import eyas
from eyas import Algorithm, Config, Rollout


class ReinforceSettings(Config):
    """Fields of `train.own`."""

    entropy: float = 0.01
    """Weight of the entropy of actions."""
    smoothing: float = 0.9
    """Share of the old scale that is kept in an update."""


class Reinforce(Algorithm):
    """One step of the optimiser along the gradient of the rewards of each rollout."""

    Settings = ReinforceSettings
    columns = ("policy_loss", "value_loss", "scale")

    scale = 1.0  # of what is gained by actions; it lasts from update to update, so it is state

    def update(self, data: Rollout) -> torch.Tensor:
        """Improve the network with a rollout; return the figures of `columns`."""
        gains = data.advantages(self.learner.config.gamma, gae_lambda=1.0)
        targets = gains + data.values[:-1]
        kept = self.settings.smoothing
        self.scale = kept * self.scale + (1.0 - kept) * float(gains.square().mean().sqrt())

        def loss_of(part: torch.Tensor, share: float) -> tuple[torch.Tensor, torch.Tensor]:
            logits, values = self.outputs(data, part)
            every = logits.log_softmax(1)
            chosen = every.gather(1, self.taken(data.actions, part)[:, None])[:, 0]
            policy = -(chosen * self.taken(gains, part) / self.scale).mean()
            value = (values - self.taken(targets, part)).square().mean()
            entropy = -(every.exp() * every).sum(1).mean()
            loss = policy + 0.5 * value - self.settings.entropy * entropy
            scale = torch.tensor(self.scale)
            return share * loss, share * torch.stack([policy, value, scale])

        return self.descend(self.everything(data), loss_of)

    def report(self, figures: Mapping[str, float]) -> str:
        """Return what the line of a block tells."""
        return f"loss {figures['policy_loss']:.3f}"

    def state_dict(self) -> dict[str, Any]:
        """Return what the checkpoint keeps, so that a run can be resumed."""
        return {"scale": self.scale}

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on where a checkpoint was written."""
        self.scale = state["scale"]


def main(decisions: int = 20_480, out: Path | str = "runs/reinforce") -> Path:
    """Teach a network for a minute; return its ONNX file."""
    learning = {
        "method": "own_algorithm:Reinforce",
        "own": {"entropy": 0.02},
        "learning_rate": 2e-3,
        "updates_per_block": 5,
        "evaluation": {"every": 0},
        "stages": [{"total_timesteps": decisions}],
    }
    config = eyas.updated(eyas.make_config("fast"), {"train": learning})
    return eyas.train(config, out, quiet=False)


if __name__ == "__main__":
    main()
