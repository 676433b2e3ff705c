"""Dataset aggregation (Ross et al. 2011, arXiv:1011.0686)."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor, nn

from eyas.engine.core.config import Config
from eyas.learning.algorithm import Algorithm
from eyas.learning.config import DaggerConfig
from eyas.learning.rollout import Rollout


@dataclass
class Lessons:
    """What is learned from T decisions in each of M environments."""

    pictures: Tensor  # uint8, shape (T, M, C, H, W)
    states: Tensor  # What the network carried, shape (T, M, S)
    ended: Tensor  # Whether the episode ended with each decision, shape (T, M)
    labels: Tensor  # The teacher's actions, shape (T, M)
    weights: Tensor  # Weights of the labels, shape (T, M)
    targets: Tensor  # Targets of the values, shape (T, M)


class Buffer:
    """The latest R rollouts of N environments, side by side as if of R N environments.

    Attributes:
        lessons: They; only the first `filled` environments are there yet.
        filled: How many are.
        latest: Numbers of the environments of the latest rollout.
    """

    lessons: Lessons
    latest: Tensor

    def __init__(self, rollouts: int) -> None:
        self._rollouts, self._next = rollouts, 0
        self.filled = 0

    def add(self, data: Rollout, targets: Tensor) -> None:
        """Keep a rollout, and targets of its values, shape (T, N), in place of the oldest one."""
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


class Dagger(Algorithm):
    """The network flies, a teacher tells what it would do, and the network learns that.

    `imitation_loss` is the cross-entropy between the teacher's actions and the network's,
    `agreement` the share of decisions in which the network's best action is the teacher's.
    """

    Settings: ClassVar[type[Config]] = DaggerConfig
    columns = ("imitation_loss", "agreement", "value_loss")
    taught = True
    settings: DaggerConfig
    buffer: Buffer

    def begin(self, updates: int) -> None:
        """Begin with an empty buffer: it is not in the checkpoint."""
        most = -(-self.settings.buffer // self.learner.config.update_decisions)
        self.buffer = Buffer(min(most, updates))

    def guided(self, decisions: int) -> float:
        """See `Algorithm.guided`: the share falls from all to none."""
        length = self.settings.guided_timesteps
        return max(1.0 - decisions / length, 0.0) if length else 0.0

    @property
    def learning_rate(self) -> float:
        """A rate of its own: a teacher's actions may be followed faster than rewards."""
        return self.settings.learning_rate

    def update(self, data: Rollout) -> Tensor:
        """Teach what the teacher has told in this rollout and, again, in others of the block."""
        ahead = data.advantages(self.learner.config.gamma, self.learner.config.gae_lambda)
        self.buffer.add(data, ahead + data.values[:-1])
        figures = torch.zeros(len(self.columns))
        for chosen in self.minibatches():
            total = self.taken(self.buffer.lessons.weights, chosen).sum().clamp(min=1.0)
            figures = self._descended(chosen, total)
        return figures

    def minibatches(self) -> Iterator[Tensor]:
        """Yield minibatches of an update: all new views once, each with some old ones."""
        generator = self.learner.generator
        steps, width = self.buffer.lessons.labels.shape
        whole = self.learner.network.shape.memory
        new = self.buffer.latest
        if not whole:
            new = (torch.arange(steps)[:, None] * width + new).flatten()
        order = torch.randperm(len(new), generator=generator)
        for fresh in new[order].chunk(self.settings.minibatches):
            count = round(len(fresh) * self.settings.replay)
            old = torch.randint(self.buffer.filled, (count,), generator=generator)
            if not whole:
                old += width * torch.randint(steps, (count,), generator=generator)
            yield torch.cat([fresh, old]).to(self.buffer.lessons.labels.device)

    def _descended(self, chosen: Tensor, total: Tensor) -> Tensor:
        return self.descend(chosen, lambda part, share: self.loss(part, share, total))

    def loss(self, part: Tensor, share: float, total: Tensor) -> tuple[Tensor, Tensor]:
        """Return what a part of a minibatch adds to the loss, and to the figures."""
        lessons = self.buffer.lessons
        logits, values = self.outputs(lessons, part)
        labels = self.taken(lessons.labels, part)
        weights = self.taken(lessons.weights, part) / total
        wrong = nn.functional.cross_entropy(logits, labels, reduction="none")
        imitation = (weights * wrong).sum()
        # The value is learned as well, so that PPO can go on from there.
        value = share * (values - self.taken(lessons.targets, part)).square().mean()
        agreement = (weights * (logits.argmax(1) == labels)).sum()
        loss = imitation + self.learner.config.vf_coef * value
        return loss, torch.stack([imitation, agreement, value])
