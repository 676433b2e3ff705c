"""The update of proximal policy optimisation (Schulman et al. 2017, arXiv:1707.06347)."""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from eyas.learning.config import TrainConfig
from eyas.learning.network import TrackingNetwork
from eyas.learning.rollout import Rollout

__all__ = ["Losses", "advantages", "update"]


class Losses(NamedTuple):
    """Of the last minibatch of an update."""

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
    data: Rollout,
    config: TrainConfig,
    generator: torch.Generator,
) -> Losses:
    """Improve the network with the data of a rollout.

    Args:
        network: Changed in place.
        optimiser: Of its parameters.
        data: A rollout of this network.
        config: The settings.
        generator: Source of the random order of the data.
    """
    estimates = advantages(data, config.discount, config.trace)
    targets = estimates + data.values[:-1]
    losses = Losses(0.0, 0.0, 0.0, 0.0)
    for _ in range(config.epochs):
        for part in _parts(data, network.shape.memory, config.minibatches, generator):
            losses = _step(network, optimiser, data, part, (estimates, targets), config)
    return losses


def _parts(
    data: Rollout, memory: bool, minibatches: int, generator: torch.Generator
) -> tuple[Tensor, ...]:
    """Return the indices of each minibatch: of environments if there is a memory, which needs whole
    sequences, else of single decisions.
    """
    steps, count = data.rewards.shape
    order = torch.randperm(count if memory else steps * count, generator=generator)
    return order.chunk(minibatches)


def _step(
    network: TrackingNetwork,
    optimiser: torch.optim.Optimizer,
    data: Rollout,
    part: Tensor,
    aims: tuple[Tensor, Tensor],
    config: TrainConfig,
) -> Losses:
    """Take a step of the optimiser with one minibatch."""

    def of(array: Tensor) -> Tensor:
        return array[:, part].flatten(0, 1) if network.shape.memory else array.flatten(0, 1)[part]

    logits, values = _outputs(network, data, part)
    all_log = logits.log_softmax(1)
    log = all_log.gather(1, of(data.actions)[:, None])[:, 0]
    gain, target = of(aims[0]), of(aims[1])
    gain = (gain - gain.mean()) / (gain.std() + 1e-8)
    change = log - of(data.log_probability)
    ratio = change.exp()
    clipped = ratio.clamp(1.0 - config.clip, 1.0 + config.clip)
    policy_loss = -torch.min(ratio * gain, clipped * gain).mean()
    value_loss = (values - target).square().mean()
    entropy = -(all_log.exp() * all_log).sum(1).mean()
    loss = policy_loss + config.value * value_loss - config.entropy * entropy
    optimiser.zero_grad()
    loss.backward()  # type: ignore[no-untyped-call]
    nn.utils.clip_grad_norm_(network.parameters(), config.largest_gradient)
    optimiser.step()
    divergence = (ratio - 1.0 - change).mean()
    return Losses(*(x.item() for x in (policy_loss, value_loss, entropy, divergence)))


def _outputs(network: TrackingNetwork, data: Rollout, part: Tensor) -> tuple[Tensor, Tensor]:
    """Return logits (B, 7) and values (B,) of a minibatch."""
    if not network.shape.memory:
        pictures, states = data.pictures.flatten(0, 1)[part], data.states.flatten(0, 1)[part]
        logits, values, _ = network(pictures, states)
        return logits, values
    memory = data.states[0, part, -network.shape.hidden :]
    outputs = []
    for step in range(len(data.rewards)):
        told = data.states[step, part, : -network.shape.hidden]
        logits, values, memory = network(data.pictures[step, part], torch.cat([told, memory], 1))
        memory = torch.where(data.ended[step, part, None] > 0.0, 0.0, memory)
        outputs.append((logits, values))
    return torch.cat([o[0] for o in outputs]), torch.cat([o[1] for o in outputs])
