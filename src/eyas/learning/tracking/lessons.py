"""What the network is taught: in which cell the target is, or that it is not seen, and where."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from eyas.benchmark.policies.tracker.detector import STRIDE
from eyas.learning.config import LESSON
from eyas.learning.tracking.network import DetectorNetwork
from eyas.learning.tracking.samples import GROUP, Sample, Samples

_GROUPS = LESSON // GROUP  # Groups in a step
_SHOWN = 0.6  # Share of the other pictures of a group whose keys make the target's
_UNKNOWN = 0.15  # Share of the pictures without any key

_IMPOSTORS = 0.5
"""Share of the pictures with a key and a wide expectation that get another target's key instead:
theirs is not seen. Else places are enough to be right, and keys would tell little."""

_WIDE = 5.0  # Least standard deviation of such an expectation [pixels]
_PLACE = 0.3  # Weight of the place within a cell
_APART = 0.3  # Weight of whose key it is among those of all groups
_WARM_UP = 200  # Steps in which the rate of learning rises, at most a quarter of all


class Progress(NamedTuple):
    """How well a network has learned since the last progress."""

    step: int
    loss: float  # Cross entropy
    right: float  # Share of the pictures whose most probable answer is right, within a cell


class Loss(NamedTuple):
    """How wrong a network is in a sample."""

    total: Tensor
    cells: Tensor  # Cross entropy of the cells and "not seen"
    right: Tensor  # Whether the most probable answer is right, within a cell, shape (B,)
    off: Tensor  # Distance of the place in the true cell [pixels], shape (B,)


def loss_of(network: DetectorNetwork, sample: Sample, rng: np.random.Generator) -> Loss:
    """Return how wrong a network is."""
    features, answers = network.see(sample.picture)
    height, width = (length // STRIDE for length in network.size)
    column, row = (sample.place / STRIDE).long().unbind(1)
    cell = row.clamp(0, height - 1) * width + column.clamp(0, width - 1)
    rows = torch.arange(len(cell))
    own = network.keys_of(answers)[rows, cell]
    key, known = _keys(own, sample.seen, rng)
    told_apart = _told_apart(network, own, (key, known), sample.seen)
    next_group = _as_light(sample.picture)
    other = _impostors(sample.spread, known, next_group, rng)
    key = torch.where(other[:, None], key[next_group], key)
    clue = sample.expected, sample.spread[:, None], key, known
    chance = torch.log_softmax(network.scores(features, answers, clue), 1)
    shown = sample.seen & ~other
    label = torch.where(shown, cell, height * width)
    clear = (~sample.unclear).float()
    cells = -(chance[rows, label] * clear).sum() / clear.sum()
    places = network.places(answers)[rows, cell]
    off = (places[:, :2] - sample.place).square().sum(1)
    sure = places[:, 2]
    wrong = (off / (2.0 * torch.exp(2.0 * sure)) + 2.0 * sure) * sample.seen
    best = chance.argmax(1)
    cells_of = network.cells[best.clamp(max=height * width - 1)]
    near = (cells_of - sample.place).abs().amax(1) <= 1.5 * STRIDE
    right = torch.where(shown, (best < height * width) & near, best == height * width)
    total = cells + _PLACE * wrong.sum() / sample.seen.sum().clamp(min=1) + _APART * told_apart
    return Loss(total, cells, right, off.sqrt())


def taught(
    network: DetectorNetwork, samples: Samples, steps: int, rate: float, rng: np.random.Generator
) -> Iterator[Progress]:
    """Teach a network; yield its progress ten times."""
    optimiser = torch.optim.AdamW(network.parameters(), rate, weight_decay=1e-4)
    recent = []
    for step in range(steps):
        share = min(1.0, (step + 1) / min(_WARM_UP, max(steps // 4, 1))) * (
            1.0 - 0.98 * step / steps
        )
        optimiser.param_groups[0]["lr"] = rate * share
        sample = samples.draw(_GROUPS)
        loss = loss_of(network, sample, rng)
        optimiser.zero_grad()
        loss.total.backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(network.parameters(), 5.0)
        optimiser.step()
        clear = ~sample.unclear
        recent.append((loss.cells.item(), loss.right[clear].float().mean().item()))
        if (step + 1) % max(steps // 10, 1) == 0:
            cells, right = np.mean(recent, axis=0)
            yield Progress(step + 1, float(cells), float(right))
            recent.clear()


def _as_light(picture: Tensor) -> Tensor:
    """Return for each picture one of another group that is about as light, shape (B,): by night no
    key looks like one of the day.
    """
    order = picture.view(len(picture) // GROUP, -1).mean(1).argsort()
    group = torch.empty_like(order)
    group[order] = order.roll(1)
    return (group[:, None] * GROUP + torch.arange(GROUP)).view(-1)


def _impostors(spread: Tensor, known: Tensor, others: Tensor, rng: np.random.Generator) -> Tensor:
    """Return which pictures get the key of another instead of their own, shape (B,)."""
    chosen = torch.from_numpy(rng.random(len(known)) < _IMPOSTORS)
    both = (known * known[others])[:, 0] > 0.0
    return chosen & both & (spread > _WIDE)


def _told_apart(
    network: DetectorNetwork, own: Tensor, given: tuple[Tensor, Tensor], seen: Tensor
) -> Tensor:
    """Return the cross entropy of the group to which each seen key belongs, by how far it is from
    the keys of all groups.
    """
    key, known = given
    groups, number = len(own) // GROUP, torch.arange(len(own))
    others = key.view(groups, GROUP, -1)[:, 0]
    apart = (own[:, None] - others[None]).square().sum(-1)
    mine = (own - key).square().sum(-1)
    here = torch.nn.functional.one_hot(number // GROUP, groups).bool()
    apart = torch.where(here, mine[:, None], apart)
    none = (known.view(groups, GROUP)[:, 0] == 0.0)[None] & ~here
    chance = torch.log_softmax((-network.alike[1].exp() * apart).masked_fill(none, -1e9), 1)
    counts = (known[:, 0] * seen).float()
    return -(chance[number, number // GROUP] * counts).sum() / counts.sum().clamp(min=1.0)


def _keys(keys: Tensor, seen: Tensor, rng: np.random.Generator) -> tuple[Tensor, Tensor]:
    """Return the key of each target from other pictures of its group, (B, K), and whether there is
    one, (B, 1).
    """
    groups = len(keys) // GROUP
    shown = rng.random((groups, GROUP, GROUP)) < _SHOWN
    shown &= rng.random((groups, GROUP, 1)) >= _UNKNOWN
    shown &= ~np.eye(GROUP, dtype=bool)
    weight = torch.from_numpy(shown.astype(np.float32)) * seen.view(groups, 1, GROUP)
    count = weight.sum(-1, keepdim=True)
    key = (weight @ keys.view(groups, GROUP, -1)) / count.clamp(min=1.0)
    return key.view(len(keys), -1), (count > 0).float().view(-1, 1)
