"""The update of proximal policy optimisation (Schulman et al. 2017, arXiv:1707.06347)."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import torch
from torch import Tensor, nn

from eyas.learning.config import TrainConfig
from eyas.learning.crew import Crew
from eyas.learning.network import ACTIONS, TrackingNetwork
from eyas.learning.rollout import Rollout

__all__ = ["Losses", "advantages", "update"]


class Losses(NamedTuple):
    """Of the last minibatch of an update, on average over the shards."""

    policy: float
    value: float
    entropy: float
    divergence: float
    """Estimate of the Kullback-Leibler divergence between the policies before and after."""


def advantages(data: Rollout, discount: float, trace: float) -> Tensor:
    """Return generalised advantage estimates (Schulman et al. 2016, arXiv:1506.02438), (T, N)."""
    estimates = torch.zeros_like(data.rewards)
    following = torch.zeros_like(data.rewards[0])
    for step in reversed(range(len(data.rewards))):
        goes_on = 1.0 - data.ended[step]
        error = data.rewards[step] + discount * goes_on * data.values[step + 1] - data.values[step]
        following = error + discount * trace * goes_on * following
        estimates[step] = following
    return estimates


def update(
    network: TrackingNetwork,
    optimiser: torch.optim.Optimizer,
    rollouts: Sequence[Rollout],
    config: TrainConfig,
    generator: torch.Generator,
    crew: Crew,
) -> Losses:
    """Improve the network with the rollouts of all shards.

    Args:
        network: Changed in place.
        optimiser: Of its parameters.
        rollouts: Of this network, one of each shard, of equal shapes.
        config: The settings.
        generator: Source of the random order of the data.
        crew: Finds the gradients of the shards.
    """
    lessons = _lessons(rollouts, config)
    losses = torch.zeros(len(Losses._fields))
    for _ in range(config.epochs):
        orders = [_parts(lesson, network, config.minibatches, generator) for lesson in lessons]
        for parts in zip(*orders, strict=True):
            jobs = zip(lessons, parts, strict=True)
            found = crew.each(lambda job: _gradients(network, *job, config), jobs)
            losses = torch.stack([loss for loss, _ in found]).mean(0)
            _step(network, optimiser, [gradients for _, gradients in found], config)
    return Losses(*losses.tolist())


class _Lesson(NamedTuple):
    """What is learned from a shard's rollout."""

    data: Rollout
    gains: Tensor
    """Advantages of the actions; over all shards their mean is 0 and their deviation 1, (T, N)."""
    targets: Tensor
    """Of the values, shape (T, N)."""


def _lessons(rollouts: Sequence[Rollout], config: TrainConfig) -> list[_Lesson]:
    estimates = [advantages(data, config.discount, config.trace) for data in rollouts]
    every = torch.cat(estimates, 1)
    mean, deviation = every.mean(), every.std() + 1e-8
    return [
        _Lesson(data, (estimate - mean) / deviation, estimate + data.values[:-1])
        for data, estimate in zip(rollouts, estimates, strict=True)
    ]


def _parts(
    lesson: _Lesson, network: TrackingNetwork, minibatches: int, generator: torch.Generator
) -> tuple[Tensor, ...]:
    """Return the indices of each minibatch: of environments if there is a memory, which needs whole
    sequences, else of single decisions.
    """
    steps, count = lesson.gains.shape
    order = torch.randperm(count if network.shape.memory else steps * count, generator=generator)
    return order.chunk(minibatches)


def _step(
    network: TrackingNetwork,
    optimiser: torch.optim.Optimizer,
    gradients: Sequence[Sequence[Tensor]],
    config: TrainConfig,
) -> None:
    """Take a step of the optimiser with the mean of the shards' gradients."""
    for parameter, parts in zip(network.parameters(), zip(*gradients, strict=True), strict=True):
        parameter.grad = torch.stack(parts).mean(0)
    nn.utils.clip_grad_norm_(network.parameters(), config.largest_gradient)
    optimiser.step()


def _gradients(
    network: TrackingNetwork, lesson: _Lesson, part: Tensor, config: TrainConfig
) -> tuple[Tensor, tuple[Tensor, ...]]:
    """Return the losses of a shard's part of a minibatch, and the gradient of their sum."""
    data = lesson.data

    def of(array: Tensor) -> Tensor:
        return array[:, part].flatten(0, 1) if network.shape.memory else array.flatten(0, 1)[part]

    logits, values = _outputs(network, data, part, of)
    all_log = logits.log_softmax(1)
    change = all_log.gather(1, of(data.actions)[:, None])[:, 0] - of(data.log_probability)
    ratio, gain = change.exp(), of(lesson.gains)
    clipped = ratio.clamp(1.0 - config.clip, 1.0 + config.clip)
    policy_loss = -torch.min(ratio * gain, clipped * gain).mean()
    value_loss = (values - of(lesson.targets)).square().mean()
    entropy = -(all_log.exp() * all_log).sum(1).mean()
    loss = policy_loss + config.value * value_loss - config.entropy * entropy
    gradients = torch.autograd.grad(loss, tuple(network.parameters()))
    divergence = (ratio - 1.0 - change).mean()
    return torch.stack([policy_loss, value_loss, entropy, divergence]).detach(), gradients


def _outputs(
    network: TrackingNetwork, data: Rollout, part: Tensor, of: Callable[[Tensor], Tensor]
) -> tuple[Tensor, Tensor]:
    """Return logits (B, 7) and values (B,) of a minibatch."""
    states = of(data.states)
    features = network.features(of(data.pictures), states[:, : ACTIONS - 1])
    if network.memory is not None:
        memory, kept = data.states[0, part, ACTIONS - 1 :], []
        for step, seen in enumerate(features.view(len(data.rewards), len(part), -1)):
            memory = network.memory(seen, memory)
            kept.append(memory)
            memory = torch.where(data.ended[step, part, None] > 0.0, 0.0, memory)
        features = torch.cat(kept)
    return network.heads(features)
