"""The network: picture and last action in, probabilities of the seven actions and a value out."""

from dataclasses import asdict, dataclass
from typing import Any

import torch
from torch import Tensor, nn

from eyas.engine.core.errors import ConfigError
from eyas.lanes.shipped import features
from eyas.learning.config import NumberType, TrainConfig

ACTIONS = 7
HOVER = 6  # The action that stands for "none yet"; the network sees it as zeros

STRIDE = 2
"""Stride of each convolution [pixels]. With a first step of three, cars of 8 pixels are found less
often: after the same time of training, TSR is 0.90 instead of 0.94."""

MEAN, SPREAD = 110.0, 60.0  # Mean and standard deviation of pixels by day


@dataclass(frozen=True)
class NetworkShape:
    """What a network is made for."""

    channels: int  # Channels of the picture
    height: int
    width: int
    hidden: int
    memory: bool

    def to_json(self) -> dict[str, Any]:
        """Return the numbers by name."""
        return asdict(self)

    @property
    def state(self) -> int:
        """Numbers that are carried from one decision to the next: last action, and memory."""
        return ACTIONS - 1 + (self.hidden if self.memory else 0)


class TrackingNetwork(nn.Module):
    """Three convolutions, a layer, perhaps a memory, and two heads.

    Attributes:
        shape: What it is made for.

    Args:
        shape: The same.
        channels_last: See `TrainConfig`.
        bfloat16: Whether it computes with bfloat16 while it learns, but for heads and memory.
    """

    def __init__(
        self, shape: NetworkShape, *, channels_last: bool = False, bfloat16: bool = False
    ) -> None:
        super().__init__()
        self.shape = shape
        self._bfloat16 = bfloat16
        self._layout = torch.channels_last if channels_last else torch.contiguous_format
        self.first = nn.Conv2d(shape.channels, 16, 5, STRIDE)
        self.second = nn.Conv2d(16, 32, 3, STRIDE)
        self.third = nn.Conv2d(32, 64, 3, STRIDE)
        with torch.no_grad():
            size = shape.channels, shape.height, shape.width
            seen = self._seen(torch.zeros(1, *size, dtype=torch.uint8))
        self.layer = nn.Linear(seen.shape[1] + ACTIONS - 1, shape.hidden)
        self.memory = nn.GRUCell(shape.hidden, shape.hidden) if shape.memory else None
        self.policy = nn.Linear(shape.hidden, ACTIONS)
        self.value = nn.Linear(shape.hidden, 1)
        for layer in (self.first, self.second, self.third):
            layer.weight = nn.Parameter(
                layer.weight.detach().contiguous(memory_format=self._layout)
            )

    def forward(self, picture: Tensor, state: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Return logits (B, 7), values (B,) and the memory that follows (B, hidden or 0).

        Args:
            picture: uint8, shape (B, C, H, W).
            state: Last action and memory, shape (B, `shape.state`); zeros at the start.
        """
        features = self.features(picture, state[:, : ACTIONS - 1])
        memory = state[:, ACTIONS - 1 :]
        if self.memory is not None:
            features = memory = self.memory(features, memory)
        return *self.heads(features), memory

    def features(
        self,
        picture: Tensor,  # uint8, shape (B, C, H, W)
        told: Tensor,  # The last action, shape (B, 6)
    ) -> Tensor:
        """Return what is seen, shape (B, hidden)."""
        short = self._bfloat16 and self.training
        with torch.autocast(picture.device.type, torch.bfloat16, enabled=short):
            seen = torch.cat([self._seen(picture), told], 1)
            return torch.relu(self.layer(seen)).float()

    def _seen(self, picture: Tensor) -> Tensor:
        """Return what the convolutions make of pictures, shape (B, K)."""
        weight, bias = self.first_convolution()
        seen = torch.relu(nn.functional.conv2d(self._floats(picture), weight, bias, STRIDE))
        return torch.relu(self.third(torch.relu(self.second(seen)))).flatten(1)

    def _floats(self, picture: Tensor) -> Tensor:
        return picture.to(torch.float32, memory_format=self._layout)

    def first_convolution(self) -> tuple[Tensor, Tensor]:
        """Return weights and biases for pixels of 0 to 255: the network learns those for pixels
        about 0 of about 1, but to scale a few weights is faster than to scale all pixels.
        """
        weight = self.first.weight / SPREAD
        assert self.first.bias is not None
        return weight, self.first.bias - MEAN * weight.sum((1, 2, 3))

    def heads(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """Return logits (B, 7) and values (B,)."""
        return self.policy(features), self.value(features)[:, 0]

    def next_state(
        self,
        action: Tensor,  # The actions taken, shape (B,)
        memory: Tensor,  # The memory from `forward`
    ) -> Tensor:
        """Return the state for the next decision, shape (B, `shape.state`)."""
        told = nn.functional.one_hot(action, ACTIONS)[:, :HOVER].float()
        return torch.cat([told, memory], 1)

    def initialise(self, generator: torch.Generator) -> None:
        """Draw orthogonal weights, as is usual for this method (Andrychowicz et al. 2021)."""
        gains: dict[nn.Module, float] = {self.policy: 0.01, self.value: 1.0}
        for module in self.modules():
            if isinstance(module, nn.Conv2d | nn.Linear):
                gain = gains.get(module, 2**0.5)
                drawn = torch.empty(module.weight.shape)  # channels first, as it must be there
                nn.init.orthogonal_(drawn, gain, generator)
                with torch.no_grad():
                    module.weight.copy_(drawn)
                assert module.bias is not None
                nn.init.zeros_(module.bias)
        if self.memory is not None:
            for weight in (self.memory.weight_ih, self.memory.weight_hh):
                nn.init.orthogonal_(weight, 1.0, generator)
            nn.init.zeros_(self.memory.bias_ih)
            nn.init.zeros_(self.memory.bias_hh)


def fastest_numbers(device: torch.device) -> NumberType:
    """Return with which numbers a device learns in the least time."""
    if device.type == "cuda":
        multiplies = torch.cuda.get_device_capability(device) >= (8, 0)
    else:
        multiplies = bool({"amx_bf16", "avx512_bf16"} & features())
    return NumberType.BFLOAT16 if multiplies else NumberType.FLOAT32


def network_of(shape: NetworkShape, config: TrainConfig) -> TrackingNetwork:
    """Return a new network that learns by some settings."""
    short = config.number_type is NumberType.BFLOAT16
    return TrackingNetwork(shape, channels_last=config.channels_last, bfloat16=short)


def torch_device(name: str | None) -> torch.device:
    """Return where the network of a run is.

    On a graphics processor, PyTorch is told to choose convolutions that give the same each time.

    Raises:
        ConfigError: PyTorch cannot use it.
    """
    if name in (None, "host"):
        return torch.device("cpu")
    if not torch.cuda.is_available():
        build = torch.version.cuda or "none, it is PyTorch's build for processors"
        raise ConfigError(
            f"train.device: '{name}' cannot be used by PyTorch {torch.__version__} (CUDA: {build})"
        )
    torch.backends.cudnn.deterministic = True
    return torch.device(name)
