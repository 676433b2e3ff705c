"""What the methods of teaching share: outputs for a minibatch, and a step of the optimiser.

Minibatches are of environments if there is a memory, which needs whole sequences, else of single
decisions.
"""

from collections.abc import Sequence
from typing import Protocol

import torch
from torch import Tensor, nn

from eyas.learning.network import ACTIONS, TrackingNetwork

__all__ = ["Views", "descend", "outputs", "taken"]


class Views(Protocol):
    """T views of each of N environments."""

    pictures: Tensor
    """uint8, shape (T, N, C, H, W)."""
    states: Tensor
    """What the network carried, shape (T, N, S)."""
    ended: Tensor
    """Whether the episode ended with each decision, shape (T, N)."""


def taken(array: Tensor, part: Tensor, network: TrackingNetwork) -> Tensor:
    """Return the values of a minibatch, shape (B, ...).

    Args:
        array: Shape (T, N, ...).
        part: Numbers of environments if the network has a memory, else of decisions.
        network: The network.
    """
    return array[:, part].flatten(0, 1) if network.shape.memory else array.flatten(0, 1)[part]


def outputs(network: TrackingNetwork, data: Views, part: Tensor) -> tuple[Tensor, Tensor]:
    """Return logits (B, 7) and values (B,) of a minibatch; `part` as for `taken`."""
    states = taken(data.states, part, network)
    pictures = taken(data.pictures, part, network)
    features = network.features(pictures, states[:, : ACTIONS - 1])
    if network.memory is not None:
        memory, kept = data.states[0, part, ACTIONS - 1 :], []
        for number, seen in enumerate(features.view(len(data.ended), len(part), -1)):
            memory = network.memory(seen, memory)
            kept.append(memory)
            memory = torch.where(data.ended[number, part, None] > 0.0, 0.0, memory)
        features = torch.cat(kept)
    return network.heads(features)


def descend(
    network: TrackingNetwork,
    optimiser: torch.optim.Optimizer,
    gradients: Sequence[Sequence[Tensor]],
    max_norm: float,
) -> None:
    """Take a step of the optimiser with the sum of the parts' gradients, cut to a norm."""
    for parameter, parts in zip(network.parameters(), zip(*gradients, strict=True), strict=True):
        parameter.grad = torch.stack(parts).sum(0)
    nn.utils.clip_grad_norm_(network.parameters(), max_norm)
    optimiser.step()
