"""The networks of a duel: numbers in, probabilities of actions and a value out."""

from pathlib import Path
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from onnx import TensorProto, helper
from torch import Tensor, nn

from eyas.engine.behaviours.evading import CAR_SEEN
from eyas.engine.settings.env import EnvConfig
from eyas.engine.traffic.steering import TOP_SHARE
from eyas.learning.export import OnnxGraph, write_model

SPEEDS: Final = (0.0, 0.5, 1.0, TOP_SHARE)  # Shares of the limit that a driver chooses from
TURNS: Final = (1.0, 0.0, -1.0)  # Left, straight on, right
DRIVER_ACTIONS: Final = len(SPEEDS) * len(TURNS)

_SCALES: Final = {"junction": 0.02, "gap": 0.03, "limit": 0.1, "speed": 0.1, "leader_speed": 0.1}
_TRACKER: Final = 0.05  # Scale of distances and speeds of the tracker
_LIMIT: Final = CAR_SEEN.index("limit")


def scales() -> NDArray[np.float32]:
    """Return the factors on what a driver sees, so that all are about 1, shape (C,)."""
    return np.array(
        [
            _TRACKER if name.startswith(("tracker", "closing")) else _SCALES.get(name, 1.0)
            for name in CAR_SEEN
        ],
        np.float32,
    )


def driver_actions(chosen: NDArray[np.int64], seen: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the actions of the environment for numbers of actions, shapes (N,), (N, 2).

    Args:
        chosen: Number of a speed times that of all turns, plus number of a turn, shape (N,).
        seen: What drivers see, columns `CAR_SEEN`, shape (N, C).
    """
    speed = np.array(SPEEDS)[chosen // len(TURNS)] * seen[:, _LIMIT]
    return np.stack([speed, np.array(TURNS)[chosen % len(TURNS)]], axis=1)


class DuelNetwork(nn.Module):
    """Two layers for the actor, and two for the critic."""

    def __init__(self, inputs: int, actions: int, hidden: int, generator: torch.Generator) -> None:
        super().__init__()

        def layers(outputs: int, gain: float) -> nn.Sequential:
            sizes = ((inputs, hidden, 2**0.5), (hidden, hidden, 2**0.5), (hidden, outputs, gain))
            parts: list[nn.Module] = []
            for given, made, scale in sizes:
                layer = nn.Linear(given, made)
                drawn = torch.empty(layer.weight.shape)
                nn.init.orthogonal_(drawn, scale, generator)
                with torch.no_grad():
                    layer.weight.copy_(drawn)
                    layer.bias.zero_()
                parts += [layer, nn.Tanh()]
            return nn.Sequential(*parts[:-1])

        self.actor, self.critic = layers(actions, 0.01), layers(1, 1.0)

    def forward(self, seen: Tensor) -> tuple[Tensor, Tensor]:
        """Return logits (B, A) and values (B,)."""
        return self.actor(seen), self.critic(seen)[:, 0]


def export_driver(network: DuelNetwork, env: EnvConfig, path: Path) -> None:
    """Write a driver: input `seen`, float (N, C), see `CAR_SEEN`; output `logits`, float
    (N, `DRIVER_ACTIONS`), see `driver_actions`.
    """
    graph, width = OnnxGraph(), len(CAR_SEEN)
    value = graph.node("Mul", ["seen", graph.weight("scale", scales())], "scaled")
    linear = [layer for layer in network.actor if isinstance(layer, nn.Linear)]
    for number, layer in enumerate(linear):
        last = number == len(linear) - 1
        name = "logits" if last else f"layer.{number}"
        value = graph.linear(name, value, layer.weight, layer.bias)
        if not last:
            value = graph.node("Tanh", [value], f"{name}.tanh")
    body = helper.make_graph(
        graph.nodes,
        "driver",
        [helper.make_tensor_value_info("seen", TensorProto.FLOAT, ["n", width])],
        [helper.make_tensor_value_info("logits", TensorProto.FLOAT, ["n", DRIVER_ACTIONS])],
        graph.weights,
    )
    write_model(body, env, path)
