"""Proximal policy optimisation (Schulman et al. 2017, arXiv:1707.06347)."""

from typing import ClassVar

import torch
from torch import Tensor

from eyas.engine.core.config import Config
from eyas.learning.algorithm import Algorithm
from eyas.learning.config import PpoConfig
from eyas.learning.rollout import Rollout


class Ppo(Algorithm):
    """Several passes over each rollout, in which the policy may not move far.

    `divergence` estimates the Kullback-Leibler divergence between the policies before and after.
    """

    Settings: ClassVar[type[Config]] = PpoConfig
    columns = ("policy_loss", "value_loss", "entropy", "divergence")
    settings: PpoConfig

    def update(self, data: Rollout) -> Tensor:
        """See `Algorithm.update`; the figures are those of the last minibatch."""
        learner = self.learner
        estimates = data.advantages(learner.config.gamma, learner.config.gae_lambda)
        gains = (estimates - estimates.mean()) / (estimates.std() + 1e-8)
        targets = estimates + data.values[:-1]
        every, figures = self.everything(data), torch.zeros(len(self.columns))
        for _ in range(self.settings.n_epochs):
            order = torch.randperm(len(every), generator=learner.generator).to(every.device)
            for chosen in order.chunk(self.settings.minibatches):
                figures = self.descend(
                    chosen, lambda part, share: self.loss(data, gains, targets, part, share)
                )
        return figures

    def loss(
        self, data: Rollout, gains: Tensor, targets: Tensor, part: Tensor, share: float
    ) -> tuple[Tensor, Tensor]:
        """Return the loss of a part of a minibatch and its figures, both times the part's share.

        Args:
            gains: Advantages of the actions, scaled to mean 0 and deviation 1, shape (T, N).
            targets: What the values should be, shape (T, N).
        """
        settings, config = self.settings, self.learner.config
        logits, values = self.outputs(data, part)
        all_log = logits.log_softmax(1)
        chosen = all_log.gather(1, self.taken(data.actions, part)[:, None])[:, 0]
        change = chosen - self.taken(data.log_probability, part)
        ratio, gain = change.exp(), self.taken(gains, part)
        clipped = ratio.clamp(1.0 - settings.clip_range, 1.0 + settings.clip_range)
        policy_loss = -torch.min(ratio * gain, clipped * gain).mean()
        value_loss = (values - self.taken(targets, part)).square().mean()
        entropy = -(all_log.exp() * all_log).sum(1).mean()
        loss = policy_loss + config.vf_coef * value_loss - settings.ent_coef * entropy
        divergence = (ratio - 1.0 - change).mean()
        return share * loss, share * torch.stack([policy_loss, value_loss, entropy, divergence])
