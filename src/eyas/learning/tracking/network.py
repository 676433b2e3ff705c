"""The network of the tracker: a detector that is told where to look, and for which one.

The logarithm of the probability of a cell is the sum of three: how much it looks like a target, how
much it looks like this target (the less, the farther its key is from the target's), and how
probable it is that the target is there at all (a Gaussian around the expected place). "Not seen"
competes with all cells; it follows from what the picture shows around the expected place.
"""

import torch
from torch import Tensor, nn

from eyas.benchmark.policies.tracker.detector import STRIDE

MEAN, SPREAD = 110.0, 60.0  # Mean and standard deviation of pixels by day
OFFSET = 4.0  # Place within a cell for an output of 1 [pixels]

PATCH = 6
"""Side of the square around the middle of a cell whose mean colour is part of its key [pixels]."""

CELL = 1.5  # Variance of a place in a cell, in one axis [pixels^2]
SURE, UNSURE = -4.0, 3.0  # Limits of the logarithm of the standard deviation of a place [pixels]


class DetectorNetwork(nn.Module):
    """Four convolutions, a head for each cell, and one for "not seen".

    Args:
        size: Height and width of the pictures [pixels].
    """

    def __init__(self, size: tuple[int, int], width: int = 48, keys: int = 24) -> None:
        super().__init__()
        self.size, self.width, self.keys = size, width, keys
        self.first = nn.Conv2d(3, 16, 5, 2, 2)
        self.second = nn.Conv2d(16, 32, 3, 2, 1)
        self.third = nn.Conv2d(32, width, 3, 1, 1)
        self.fourth = nn.Conv2d(width, width, 3, 1, 2, 2)
        self.head = nn.Conv2d(width, 4 + keys, 1)
        self.colour = nn.Conv2d(3, keys, 1)
        self.alike = nn.Parameter(torch.tensor([2.0, -1.5]))
        """What a known key is worth that fits, and the logarithm of what is lost by each unit of
        squared distance."""
        self.unseen_first, self.unseen_last = nn.Linear(width + 3, 32), nn.Linear(32, 1)
        down, across = (torch.arange(length // STRIDE) for length in size)
        cells = torch.stack(torch.meshgrid(across, down, indexing="xy"), -1).reshape(-1, 2)
        self.cells: Tensor = (cells + 0.5) * STRIDE
        """Middles of the cells, column and row [pixels], shape (C, 2)."""

    def see(self, pictures: Tensor) -> tuple[Tensor, Tensor]:
        """Return features (B, C, width) and answers (B, C, 4 + K) of the cells."""
        value = scaled = (pictures.float() - MEAN) / SPREAD
        for layer in (self.first, self.second, self.third):
            value = torch.relu(layer(value))
        value = value + torch.relu(self.fourth(value))
        answers = _by_cell(self.head(value))
        around = nn.functional.avg_pool2d(scaled, PATCH, STRIDE, (PATCH - STRIDE) // 2)
        keys = answers[..., 4:] + _by_cell(self.colour(around))
        return _by_cell(value), torch.cat((answers[..., :4], keys), -1)

    def places(self, answers: Tensor) -> Tensor:
        """Return column, row, and logarithm of the standard deviation [pixels], (B, C, 3)."""
        where = self.cells + OFFSET * answers[..., 1:3]
        return torch.cat((where, answers[..., 3:4].clamp(SURE, UNSURE)), -1)

    def keys_of(self, answers: Tensor) -> Tensor:
        """Return how the target looks if it is in a cell, shape (B, C, K)."""
        return answers[..., 4:]

    def scores(
        self, features: Tensor, answers: Tensor, clue: tuple[Tensor, Tensor, Tensor, Tensor]
    ) -> Tensor:
        """Return logarithms of unnormalised probabilities of all cells and "not seen", (B, C + 1).

        Args:
            clue: As the inputs of `eyas.benchmark.policies.tracker.detector`.
        """
        expected, spread, key, known = clue
        apart = (self.keys_of(answers) - key[:, None]).square().sum(-1)
        alike = known * (self.alike[0] - self.alike[1].exp() * apart)
        variance = spread * spread + CELL
        away = (self.cells - expected[:, None]).square().sum(-1)
        prior = -away / (2.0 * variance) - variance.log()
        near = (torch.softmax(prior, 1)[..., None] * features).sum(1)
        inside = prior.logsumexp(1, keepdim=True)
        around = torch.cat((near, spread.log(), known, inside), 1)
        unseen = self.unseen_last(torch.relu(self.unseen_first(around)))
        return torch.cat((answers[..., 0] + alike + prior, unseen), 1)


def _by_cell(values: Tensor) -> Tensor:
    return values.flatten(2).transpose(1, 2)
