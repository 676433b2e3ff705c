"""The network of the listener: in each cell of a picture, is there a vehicle, and how does it look?

X. Zhou, D. Wang, P. Krähenbühl, "Objects as points" (2019, arXiv:1904.07850): a vehicle is the peak
of a map, and what is known of it stands beside the peak.
"""

import torch
from torch import Tensor, nn

from eyas.benchmark.policies.listener.detector import BODIES, NAMES, STRIDE
from eyas.learning.tracking.network import MEAN, OFFSET, SPREAD

PARTS = (1, 2, 4, len(NAMES), len(BODIES))
"""Numbers of a cell: vehicle, place, headings, colours, bodies."""

PLAIN = 3  # Convolutions that are not added to what comes before them
_RARE = -4.0  # Logarithm of the odds of a vehicle in a cell before anything is learned


class ListenerNetwork(nn.Module):
    """Five convolutions, and a head for each cell.

    Args:
        size: Height and width of the pictures [pixels].
    """

    def __init__(self, size: tuple[int, int], width: int = 48) -> None:
        super().__init__()
        self.size, self.width = size, width
        self.first = nn.Conv2d(3, 16, 5, 2, 2)
        self.second = nn.Conv2d(16, 32, 3, 2, 1)
        self.third = nn.Conv2d(32, width, 3, 1, 1)
        self.fourth = nn.Conv2d(width, width, 3, 1, 2, 2)
        self.fifth = nn.Conv2d(width, width, 3, 1, 2, 2)
        self.norms = nn.ModuleList(nn.BatchNorm2d(n) for n in (16, 32, width, width, width))
        self.head = nn.Conv2d(width, sum(PARTS), 1)
        assert self.head.bias is not None
        nn.init.constant_(self.head.bias[:1], _RARE)
        down, across = (torch.arange(-(-length // STRIDE)) for length in size)
        cells = torch.stack(torch.meshgrid(across, down, indexing="xy"), -1).reshape(-1, 2)
        self.cells: Tensor = (cells + 0.5) * STRIDE
        """Middles of the cells, column and row [pixels], shape (C, 2)."""

    @property
    def layers(self) -> tuple[nn.Conv2d, ...]:
        """The convolutions; the last two are added to what comes before them."""
        return self.first, self.second, self.third, self.fourth, self.fifth

    @property
    def grid(self) -> tuple[int, int]:
        """Cells down and across."""
        return -(-self.size[0] // STRIDE), -(-self.size[1] // STRIDE)

    def forward(self, pictures: Tensor) -> tuple[Tensor, ...]:
        """Return the outputs of `eyas.benchmark.policies.listener.detector`."""
        value = (pictures.float() - MEAN) / SPREAD
        for number, layer in enumerate(self.layers):
            before = value
            value = torch.relu(self.norms[number](layer(value)))
            value = value + before if number >= PLAIN else value
        answers = self.head(value).flatten(2).transpose(1, 2)
        vehicle, offset, heading, colour, body = answers.split(PARTS, -1)
        return vehicle[..., 0], self.cells + OFFSET * offset, heading, colour, body
