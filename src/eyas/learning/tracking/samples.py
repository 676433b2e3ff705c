"""Groups of pictures of one flight each, changed at random, with expected places of all sorts."""

from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from eyas.learning.tracking.shots import Shots

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
