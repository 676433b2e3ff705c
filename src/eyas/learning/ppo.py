"""The update of proximal policy optimisation (Schulman et al. 2017, arXiv:1707.06347)."""

from typing import NamedTuple

import torch
from torch import Tensor

from eyas.learning.config import TrainConfig
from eyas.learning.minibatch import descend, outputs, taken
from eyas.learning.network import TrackingNetwork
from eyas.learning.rollout import Rollout
from eyas.learning.shards import TorchThreads

__all__ = ["Losses", "advantages", "update"]


class Losses(NamedTuple):
    """Of the last minibatch of an update."""

    policy_loss: float
    value_loss: float
    entropy: float
    divergence: float
    """Estimate of the Kullback-Leibler divergence between the policies before and after."""


def advantages(data: Rollout, gamma: float, gae_lambda: float) -> Tensor:
    """Return generalised advantage estimates (Schulman et al. 2016, arXiv:1506.02438), (T, N)."""
    estimates = torch.zeros_like(data.rewards)
    following = torch.zeros_like(data.rewards[0])
    for step in reversed(range(len(data.rewards))):
        goes_on = 1.0 - data.ended[step]
        error = data.rewards[step] + gamma * goes_on * data.values[step + 1] - data.values[step]
        following = error + gamma * gae_lambda * goes_on * following
        estimates[step] = following
    return estimates


def update(
    network: TrackingNetwork,
    optimiser: torch.optim.Optimizer,
    data: Rollout,
    config: TrainConfig,
    generator: torch.Generator,
    threads: TorchThreads,
) -> Losses:
    """Improve the network with a rollout.

    Args:
        network: Changed in place.
        optimiser: Of its parameters.
        data: A rollout of this network.
        config: The settings.
        generator: Source of the random order of the data.
        threads: Finds the gradients of the parts of a minibatch.
    """
    estimates = advantages(data, config.gamma, config.gae_lambda)
    gains = (estimates - estimates.mean()) / (estimates.std() + 1e-8)
    lesson = _Lesson(data, gains, estimates + data.values[:-1])
    count = gains.shape[1] if network.shape.memory else gains.numel()
    losses = torch.zeros(len(Losses._fields))
    for _ in range(config.n_epochs):
        order = torch.randperm(count, generator=generator).to(gains.device)
        for chosen in order.chunk(config.minibatches):
            parts = [(part, len(part) / len(chosen)) for part in chosen.chunk(config.parts)]
            found = threads.each(lambda job: _gradients(network, lesson, *job, config), parts)
            losses = torch.stack([loss for loss, _ in found]).sum(0)
            descend(network, optimiser, [gradients for _, gradients in found], config.max_grad_norm)
    return Losses(*losses.tolist())


class _Lesson(NamedTuple):
    """What is learned from a rollout."""

    data: Rollout
    gains: Tensor
    """Advantages of the actions, scaled to mean 0 and deviation 1, shape (T, N)."""
    targets: Tensor
    """Of the values, shape (T, N)."""


def _gradients(
    network: TrackingNetwork, lesson: _Lesson, part: Tensor, share: float, config: TrainConfig
) -> tuple[Tensor, tuple[Tensor, ...]]:
    """Return the losses of a part of a minibatch, and the gradient of their sum, both times the
    part's share of the minibatch.
    """
    data = lesson.data

    def of(array: Tensor) -> Tensor:
        return taken(array, part, network)

    logits, values = outputs(network, data, part)
    all_log = logits.log_softmax(1)
    change = all_log.gather(1, of(data.actions)[:, None])[:, 0] - of(data.log_probability)
    ratio, gain = change.exp(), of(lesson.gains)
    clipped = ratio.clamp(1.0 - config.clip_range, 1.0 + config.clip_range)
    policy_loss = -torch.min(ratio * gain, clipped * gain).mean()
    value_loss = (values - of(lesson.targets)).square().mean()
    entropy = -(all_log.exp() * all_log).sum(1).mean()
    loss = policy_loss + config.vf_coef * value_loss - config.ent_coef * entropy
    gradients = torch.autograd.grad(share * loss, tuple(network.parameters()))
    divergence = (ratio - 1.0 - change).mean()
    losses = torch.stack([policy_loss, value_loss, entropy, divergence])
    return share * losses.detach(), gradients
