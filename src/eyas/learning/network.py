"""The network: picture and last action in, probabilities of the seven actions and a value out."""

from dataclasses import asdict, dataclass
from typing import Any

import torch
from torch import Tensor, nn

from eyas.engine.core.errors import ConfigError
from eyas.lanes.shipped import features
from eyas.learning.config import NetworkKind, NumberType, TrainConfig

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
    kind: str = NetworkKind.EYAS.value

    def to_json(self) -> dict[str, Any]:
        """Return the numbers by name."""
        return asdict(self)

    @property
    def state(self) -> int:
        """Numbers that are carried from one decision to the next: last action, and memory."""
        return ACTIONS - 1 + (self.memories * self.hidden if self.memory else 0)

    @property
    def memories(self) -> int:
        """Memories of `hidden` numbers, one behind the other in the state."""
        return 2 if self.kind == NetworkKind.GC_VAT else 1


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
        return _state_after(action, memory)

    def initialise(self, generator: torch.Generator) -> None:
        """Draw orthogonal weights, as is usual for this method (Andrychowicz et al. 2021)."""
        _draw_orthogonal(self, {self.policy: 0.01, self.value: 1.0}, generator)


def _state_after(action: Tensor, memory: Tensor) -> Tensor:
    told = nn.functional.one_hot(action, ACTIONS)[:, :HOVER].float()
    return torch.cat([told, memory], 1)


class _Tower(nn.Module):
    """An actor or a critic of GC-VAT, see `GoalCenteredNetwork`."""

    def __init__(self, shape: NetworkShape, outputs: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(shape.channels, 16, 8, 4)
        self.second = nn.Conv2d(16, 32, 4, 2)
        with torch.no_grad():
            seen = self.seen(torch.zeros(1, shape.channels, shape.height, shape.width))
        self.layer = nn.Linear(seen.shape[1], shape.hidden)
        self.memory = nn.GRUCell(shape.hidden, shape.hidden)
        self.wide, self.narrow = nn.Linear(shape.hidden, 200), nn.Linear(200, 100)
        self.out = nn.Linear(100, outputs)

    def seen(self, pixels: Tensor) -> Tensor:
        """Return what the convolutions make of pixels from 0 to 1, shape (B, K)."""
        return torch.relu(self.second(torch.relu(self.first(pixels)))).flatten(1)

    def features(self, pixels: Tensor) -> Tensor:
        """Return what is seen, shape (B, hidden)."""
        return torch.relu(self.layer(self.seen(pixels)))

    def head(self, features: Tensor) -> Tensor:
        """Return what the tower answers, shape (B, outputs)."""
        answer: Tensor = self.out(torch.relu(self.narrow(torch.relu(self.wide(features)))))
        return answer


class _BothMemories(nn.Module):
    """The memories of both towers, one behind the other."""

    def __init__(self, actor: _Tower, critic: _Tower) -> None:
        super().__init__()
        self._cells = [actor.memory, critic.memory]  # whose weights are those of the towers

    def forward(self, seen: Tensor, memory: Tensor) -> Tensor:
        """Return the memories that follow, shape (B, 2 * hidden)."""
        parts = zip(self._cells, seen.chunk(2, 1), memory.chunk(2, 1), strict=True)
        return torch.cat([cell(own, kept) for cell, own, kept in parts], 1)


class GoalCenteredNetwork(nn.Module):
    """The network of GC-VAT (R-VAT in the code of the DAT benchmark): an actor and a critic that
    share nothing, each of two convolutions (16 of 8x8 with stride 4, 32 of 4x4 with stride 2), a
    layer, a gated recurrent unit of the same width, layers of 200 and 100 and an output. It does
    not see its last action. It offers what `TrackingNetwork` does.
    """

    def __init__(self, shape: NetworkShape) -> None:
        super().__init__()
        self.shape = shape
        self.actor, self.critic = _Tower(shape, ACTIONS), _Tower(shape, 1)
        self.memory = _BothMemories(self.actor, self.critic)

    def forward(self, picture: Tensor, state: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Return logits (B, 7), values (B,) and the memories that follow (B, 2 * hidden)."""
        seen = self.features(picture, state[:, : ACTIONS - 1])
        memory: Tensor = self.memory(seen, state[:, ACTIONS - 1 :])
        return *self.heads(memory), memory

    def features(self, picture: Tensor, told: Tensor) -> Tensor:
        """Return what both see, shape (B, 2 * hidden)."""
        pixels = picture.to(torch.float32) / 255.0
        return torch.cat([self.actor.features(pixels), self.critic.features(pixels)], 1)

    def heads(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """Return logits (B, 7) and values (B,)."""
        own, worth = features.chunk(2, 1)
        return self.actor.head(own), self.critic.head(worth)[:, 0]

    def next_state(self, action: Tensor, memory: Tensor) -> Tensor:
        """Return the state for the next decision, shape (B, `shape.state`)."""
        return _state_after(action, memory)

    def initialise(self, generator: torch.Generator) -> None:
        """Draw orthogonal weights, of the outputs small ones for the actor."""
        _draw_orthogonal(self, {self.actor.out: 0.01, self.critic.out: 1.0}, generator)


def _draw_orthogonal(
    network: nn.Module, gains: dict[nn.Module, float], generator: torch.Generator
) -> None:
    for module in network.modules():
        if isinstance(module, nn.Conv2d | nn.Linear):
            gain = gains.get(module, 2**0.5)
            drawn = torch.empty(module.weight.shape)  # channels first, as it must be there
            nn.init.orthogonal_(drawn, gain, generator)
            with torch.no_grad():
                module.weight.copy_(drawn)
            assert module.bias is not None
            nn.init.zeros_(module.bias)
        elif isinstance(module, nn.GRUCell):
            for weight in (module.weight_ih, module.weight_hh):
                nn.init.orthogonal_(weight, 1.0, generator)
            nn.init.zeros_(module.bias_ih)
            nn.init.zeros_(module.bias_hh)


def fastest_numbers(device: torch.device) -> NumberType:
    """Return with which numbers a device learns in the least time."""
    if device.type == "cuda":
        multiplies = torch.cuda.get_device_capability(device) >= (8, 0)
    else:
        multiplies = bool({"amx_bf16", "avx512_bf16"} & features())
    return NumberType.BFLOAT16 if multiplies else NumberType.FLOAT32


AnyNetwork = TrackingNetwork | GoalCenteredNetwork


def network_of(shape: NetworkShape, config: TrainConfig) -> AnyNetwork:
    """Return a new network that learns by some settings."""
    if shape.kind == NetworkKind.GC_VAT:
        return GoalCenteredNetwork(shape)
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
