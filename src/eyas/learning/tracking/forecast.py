"""A network that says where drivers go: how far from a straight course they are after a while."""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor, nn

from eyas.benchmark.policies.tracker.course import HORIZONS, PAST
from eyas.learning.tracking.driving import Drives

_WIDTH = 64  # Numbers of a hidden layer
FARTHEST = 6.0  # Limit of the scaled numbers of a past: rare ones are no reason for wild answers
_BATCH = 1024  # Pasts in a step
_RATE = 3e-3  # Largest rate of learning of Adam; it falls to nothing

_FREEDOM = 3.0
"""Degrees of freedom of Student's distribution of what drivers do otherwise: some surprise."""


class Forecast(nn.Module):
    """Two hidden layers."""

    def __init__(self) -> None:
        super().__init__()
        self.first = nn.Linear(PAST, _WIDTH)
        self.second = nn.Linear(_WIDTH, _WIDTH)
        self.last = nn.Linear(_WIDTH, 3 * len(HORIZONS))
        self.mean: Tensor
        self.spread: Tensor  # Standard deviation of each number of `past`, (PAST,)
        self.register_buffer("mean", torch.zeros(PAST))
        self.register_buffer("spread", torch.ones(PAST))
        unit = torch.tensor(HORIZONS, dtype=torch.float32)
        self.unit: Tensor = torch.stack((3.0 * unit, 3.0 * unit, torch.ones_like(unit)), -1)
        """Factors of the outputs, shape (H, 3)."""
        self.least: Tensor = torch.stack((0.0 * unit, 0.0 * unit, unit.log()), -1)
        """What is added to them then, shape (H, 3)."""

    def forward(self, past: Tensor) -> Tensor:
        """Return metres ahead and to the left of a straight course, and the logarithm of their
        standard deviation, (B, H, 3).

        Args:
            past: Shape (B, PAST).
        """
        value = ((past - self.mean) / self.spread).clamp(-FARTHEST, FARTHEST)
        value = torch.relu(self.second(torch.relu(self.first(value))))
        answer: Tensor = self.last(value).view(-1, *self.unit.shape)
        return answer * self.unit + self.least


def taught_forecast(
    network: Forecast, drives: Drives, steps: int, rng: np.random.Generator
) -> Iterator[tuple[int, float]]:
    """Teach a network; yield the step and the mean loss since the last ten times."""
    past, after = torch.from_numpy(drives.past), torch.from_numpy(drives.ahead)
    network.mean.copy_(past.mean(0))
    network.spread.copy_(past.std(0) + 1e-6)
    optimiser = torch.optim.Adam(network.parameters(), _RATE)
    recent = []
    for step in range(steps):
        optimiser.param_groups[0]["lr"] = _RATE * (1.0 - step / steps)
        chosen = torch.from_numpy(rng.integers(len(past), size=_BATCH))
        loss = _loss(network(past[chosen]), after[chosen])
        optimiser.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        optimiser.step()
        recent.append(loss.item())
        if (step + 1) % max(steps // 10, 1) == 0:
            yield step + 1, float(np.mean(recent))
            recent.clear()


def _loss(said: Tensor, ahead: Tensor) -> Tensor:
    """Return the mean negative logarithm of the likelihood of ways (B, H, 2), but for a constant:
    Student's distribution in two dimensions.
    """
    unsure = said[..., 2].clamp(-3.0, 3.0)
    away = (said[..., :2] - ahead).square().sum(-1) * torch.exp(-2.0 * unsure)
    heavy = 0.5 * (_FREEDOM + 2.0) * torch.log1p(away / _FREEDOM)
    return (2.0 * unsure + heavy).mean()
