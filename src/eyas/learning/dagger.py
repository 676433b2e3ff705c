"""The update of dataset aggregation (Ross et al. 2011, arXiv:1011.0686)."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor, nn

from eyas.learning.config import TrainConfig
from eyas.learning.minibatch import descend, outputs, taken
from eyas.learning.network import TrackingNetwork
from eyas.learning.rollout import Rollout
from eyas.learning.shards import TorchThreads

__all__ = ["Buffer", "ImitationLosses", "update"]


class ImitationLosses(NamedTuple):
    """Of the last minibatch of an update, named as the columns of the curve."""

    imitation_loss: float
    """Cross-entropy between the teacher's actions and the network's."""
    agreement: float
    """Share of decisions in which the network's best action is the teacher's."""
    value_loss: float


@dataclass
class Lessons:
    """What is learned from T decisions in each of M environments."""

    pictures: Tensor
    """uint8, shape (T, M, C, H, W)."""
    states: Tensor
    """What the network carried, shape (T, M, S)."""
    ended: Tensor
    """Whether the episode ended with each decision, shape (T, M)."""
    labels: Tensor
    """The teacher's actions, shape (T, M)."""
    weights: Tensor
    """Of these, shape (T, M)."""
    targets: Tensor
    """Of the values, shape (T, M)."""


class Buffer:
    """The latest R rollouts of N environments, side by side as if of R N environments.

    Attributes:
        lessons: They; only the first `filled` environments are there yet.
        filled: How many are.
        latest: Numbers of the environments of the latest rollout.

    Args:
        rollouts: R.
    """

    lessons: Lessons
    latest: Tensor

    def __init__(self, rollouts: int) -> None:
        self._rollouts, self._next = rollouts, 0
        self.filled = 0

    def add(self, data: Rollout, targets: Tensor) -> None:
        """Keep a rollout in the place of the oldest one.

        Args:
            data: The rollout.
            targets: Of its values, shape (T, N).
        """
        new = (data.pictures, data.states, data.ended, data.labels, data.weights, targets)
        count = targets.shape[1]
        if self.filled == 0:
            width = self._rollouts * count
            empty = [each.new_zeros(len(each), width, *each.shape[2:]) for each in new]
            self.lessons = Lessons(*empty)
        first = self._next * count
        for kept, each in zip(vars(self.lessons).values(), new, strict=True):
            kept[:, first : first + count] = each
        self.latest = torch.arange(first, first + count)
        self.filled = max(self.filled, first + count)
        self._next = (self._next + 1) % self._rollouts


def update(
    network: TrackingNetwork,
    optimiser: torch.optim.Optimizer,
    buffer: Buffer,
    config: TrainConfig,
    generator: torch.Generator,
    threads: TorchThreads,
) -> ImitationLosses:
    """Teach the network what the teacher has told in the latest rollout and, again, in others.

    Args:
        network: Changed in place.
        optimiser: Of its parameters.
        buffer: Rollouts of the block.
        config: The settings.
        generator: Source of the random order of the data.
        threads: Finds the gradients of the parts of a minibatch.
    """
    losses = torch.zeros(len(ImitationLosses._fields))
    for chosen in _minibatches(network, buffer, config, generator):
        weight = taken(buffer.lessons.weights, chosen, network).sum().clamp(min=1.0)
        parts = [
            _Part(part, len(part) / len(chosen), weight) for part in chosen.chunk(config.parts)
        ]
        found = threads.each(lambda job: _gradients(network, buffer.lessons, job, config), parts)
        losses = torch.stack([loss for loss, _ in found]).sum(0)
        descend(network, optimiser, [gradients for _, gradients in found], config.max_grad_norm)
    return ImitationLosses(*losses.tolist())


def _minibatches(
    network: TrackingNetwork, buffer: Buffer, config: TrainConfig, generator: torch.Generator
) -> Iterator[Tensor]:
    """Yield minibatches of an update, see `taken`: all new ones once, each with some old ones."""
    steps, width = buffer.lessons.labels.shape
    whole = network.shape.memory
    new = buffer.latest
    if not whole:
        new = (torch.arange(steps)[:, None] * width + new).flatten()
    imitation = config.imitation
    for fresh in new[torch.randperm(len(new), generator=generator)].chunk(imitation.minibatches):
        count = round(len(fresh) * imitation.replay)
        old = torch.randint(buffer.filled, (count,), generator=generator)
        if not whole:
            old += width * torch.randint(steps, (count,), generator=generator)
        yield torch.cat([fresh, old]).to(buffer.lessons.labels.device)


class _Part(NamedTuple):
    """A part of a minibatch."""

    chosen: Tensor
    """See `taken`."""
    share: float
    """Of the minibatch."""
    weight: Tensor
    """Sum of the weights in the minibatch."""


def _gradients(
    network: TrackingNetwork, lessons: Lessons, part: _Part, config: TrainConfig
) -> tuple[Tensor, tuple[Tensor, ...]]:
    """Return what a part of a minibatch adds to the losses, and to the gradient of their sum."""
    chosen, share, weight = part
    logits, values = outputs(network, lessons, chosen)
    labels = taken(lessons.labels, chosen, network)
    weights = taken(lessons.weights, chosen, network) / weight
    wrong = nn.functional.cross_entropy(logits, labels, reduction="none")
    imitation = (weights * wrong).sum()
    # The value is learned as well, so that PPO can go on from there.
    value = share * (values - taken(lessons.targets, chosen, network)).square().mean()
    loss = imitation + config.vf_coef * value
    gradients = torch.autograd.grad(loss, tuple(network.parameters()))
    agreement = (weights * (logits.argmax(1) == labels)).sum()
    return torch.stack([imitation, agreement, value]).detach(), gradients
