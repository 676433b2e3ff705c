"""What the tracker's network is taught: pictures of flights, groups of them, and losses."""

import io
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from eyas.benchmark.policies.tracker.detector import STRIDE
from eyas.engine.core.files import write_atomic
from eyas.engine.state.snapshot import Snapshot
from eyas.lanes import exact
from eyas.learning.config import LESSON
from eyas.learning.tracking.network import DetectorNetwork

Floats = NDArray[np.float32]


class Shots(NamedTuple):
    """Pictures of E flights at T instants each."""

    picture: NDArray[np.uint8]  # Shape (E, T, 3, H, W)
    place: Floats
    """The target's centre, in the picture or outside of it, column and row [pixels], (E, T, 2)."""
    share: Floats  # Share of the target that is visible, shape (E, T)
    expected: Floats  # Where the tracker expected it, NaN where none flew [pixels], shape (E, T, 2)
    spread: Floats  # Standard deviation of that, or NaN [pixels], shape (E, T)
    flown: NDArray[np.bool_]  # Whether the flight was still under way, shape (E, T)

    @classmethod
    def of(cls, instants: Sequence["Shots"]) -> "Shots":
        """Return those of a batch of flights, of its instants, shape (E, ...) each."""
        return cls(*(np.stack(parts, axis=1) for parts in zip(*instants, strict=True)))

    @classmethod
    def joined(cls, batches: Sequence["Shots"]) -> "Shots":
        """Return those of several batches; shorter flights are filled up with instants unflown."""
        longest = max(batch.flown.shape[1] for batch in batches)

        def padded(part: NDArray[np.generic]) -> NDArray[np.generic]:
            after = [(0, 0)] * part.ndim
            after[1] = 0, longest - part.shape[1]
            return np.pad(part, after)

        parts = zip(*batches, strict=True)
        return cls(*(np.concatenate([padded(each) for each in part]) for part in parts))


def projected(
    state: Snapshot,
    size: tuple[int, int],  # Height and width [pixels]
) -> Floats:
    """Return where the targets' centres are in pictures of 4 to 3, shape (N, 2)."""
    cameras = state.cameras
    away = state.targets.centre - cameras.position
    forward, left, up = np.moveaxis(exact.product(away[:, None], cameras.rotation)[:, 0], -1, 0)
    reach = np.maximum(forward, 0.1) * exact.tan(0.5 * cameras.field_of_view)
    column, row = 1.0 - left / reach, 1.0 - up / (0.75 * reach)
    return np.stack((0.5 * size[1] * column, 0.5 * size[0] * row), axis=-1).astype(np.float32)


def save(shots: Shots, path: Path) -> None:
    """Write pictures to a file of numpy."""
    content = io.BytesIO()
    np.savez(content, **shots._asdict())
    write_atomic(path, content.getvalue())


def load(path: Path) -> Shots:
    """Return the pictures of a file of `save`."""
    with np.load(path) as kept:
        return Shots(**kept)


GROUP = 4
"""Pictures of one flight in a group: some of them show the target whose key others are given."""

_ENOUGH = 0.3
"""Share of a target that must be visible for it to count as seen. Of less the network tells the
place badly: at the edge of cover, where the target has driven on."""

_EITHER = 0.05  # Around that share either answer is right
_HARD = 0.5  # Share of the groups that are chosen for a picture in which it is hard
_AROUND = 7  # Farthest second picture of such a group [pictures]
_OWN = 0.55  # Share of the pictures with a place that a tracker expected for which it is taken
_SPREADS = 0.6, 30.0  # Standard deviations of other expected places [pixels]


class Sample(NamedTuple):
    """B pictures."""

    picture: Tensor  # Shape (B, 3, H, W)
    place: Tensor  # True place, column and row [pixels], shape (B, 2)
    seen: Tensor  # Whether the target is seen, shape (B,)
    unclear: Tensor  # Whether that is neither right nor wrong, shape (B,)
    expected: Tensor  # Shape (B, 2)
    spread: Tensor  # Shape (B,)


class Samples:
    """Draws samples of pictures."""

    def __init__(self, shots: Shots, rng: np.random.Generator) -> None:
        self._shots, self._rng = shots, rng
        self._flown = np.argwhere(shots.flown)
        off = np.abs(shots.expected - shots.place).max(axis=-1)
        hard = shots.flown & ((shots.share < 0.6) | (np.nan_to_num(off) > 8.0))
        self._difficult = np.argwhere(hard)
        self._last = shots.flown.sum(axis=1)

    def draw(self, groups: int) -> Sample:
        """Return that many groups, one after another."""
        rows, times = self._chosen(groups)
        shots, (height, width) = self._shots, self._shots.picture.shape[-2:]
        place = shots.place[rows, times]
        share = shots.share[rows, times]
        inside = ((place > 0.0) & (place < (width, height))).all(axis=-1)
        seen = inside & (share > _ENOUGH)
        expected, spread = self._expected(rows, times)
        picture = shots.picture[rows, times].astype(np.float32)
        picture, mirror = self._changed(picture)
        size = np.array((width, height), np.float32)
        for axis in range(2):
            turned = mirror[:, axis][:, None]
            for each in (place, expected):
                each[..., axis] = np.where(turned, size[axis] - each[..., axis], each[..., axis])
        unclear = inside & (np.abs(share - _ENOUGH) < _EITHER)
        parts = (picture, place, seen, unclear, expected, spread)
        return Sample(*(torch.from_numpy(_flat(part)) for part in parts))

    def _chosen(self, groups: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return flights and instants, shape (groups, GROUP)."""
        rng = self._rng
        rows, first = self._flown[rng.integers(len(self._flown), size=groups)].T
        hard = (rng.random(groups) < _HARD) & bool(len(self._difficult))
        rows, first = rows.copy(), first.copy()
        rows[hard], first[hard] = self._difficult[
            rng.integers(max(len(self._difficult), 1), size=int(hard.sum()))
        ].T
        last = self._last[rows][:, None]
        times = (rng.random((groups, GROUP)) * last).astype(np.int64)
        times[:, 0] = first
        times[hard, 1] = first[hard] + rng.integers(-_AROUND, _AROUND, int(hard.sum()))
        return np.repeat(rows[:, None], GROUP, axis=1), np.clip(times, 0, last - 1)

    def _expected(
        self, rows: NDArray[np.int64], times: NDArray[np.int64]
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return expected places, those of a tracker where one flew, and their deviations."""
        shots, rng = self._shots, self._rng
        spread = np.exp(rng.uniform(np.log(_SPREADS[0]), np.log(_SPREADS[1]), rows.shape)).astype(
            np.float32
        )
        noise = rng.standard_normal((*rows.shape, 2)).astype(np.float32)
        expected = shots.place[rows, times] + spread[..., None] * noise
        own = ~np.isnan(shots.spread[rows, times]) & (rng.random(rows.shape) < _OWN)
        expected = np.where(own[..., None], shots.expected[rows, times], expected)
        return expected, np.where(own, shots.spread[rows, times], spread)

    def _changed(
        self, picture: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
        """Return pictures (G, GROUP, 3, H, W), mirrored, recoloured, lighter or darker, a group
        alike; and which are mirrored in columns and rows, shape (G, 2).
        """
        rng, groups = self._rng, len(picture)
        mirror = rng.random((groups, 2)) < 0.5
        colours = rng.random(groups) < 0.5
        for row in range(groups):
            if mirror[row, 0]:
                picture[row] = picture[row, ..., ::-1]
            if mirror[row, 1]:
                picture[row] = picture[row, ..., ::-1, :]
            if colours[row]:
                picture[row] = picture[row][:, rng.permutation(3)]
        light = rng.uniform(0.75, 1.25, (groups, 1, 1, 1, 1)).astype(np.float32)
        return np.clip(picture * light, 0.0, 255.0), mirror


def _flat(part: NDArray[np.generic]) -> NDArray[np.generic]:
    return np.ascontiguousarray(part.reshape(-1, *part.shape[2:]))


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


class DetectionLoss(NamedTuple):
    """How wrong a network is in a sample."""

    total: Tensor
    cells: Tensor  # Cross entropy of the cells and "not seen"
    right: Tensor  # Whether the most probable answer is right, within a cell, shape (B,)
    off: Tensor  # Distance of the place in the true cell [pixels], shape (B,)


def loss_of(network: DetectorNetwork, sample: Sample, rng: np.random.Generator) -> DetectionLoss:
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
    return DetectionLoss(total, cells, right, off.sqrt())


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
