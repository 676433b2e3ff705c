"""Dirt and drops of water on the glass in front of the lens, far out of focus."""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field

from eyas.engine.core.config import Config
from eyas.engine.core.variation import Uniform, Variation, sample, within
from eyas.engine.render.kernels.scalars import f4, i8
from eyas.lanes import kernel, parallel, thread_count
from eyas.lanes.vector import WIDTH, lane, load, splat

MOST = 64  # Most spots, and most drops, on a lens

Count = Annotated[Variation, AfterValidator(within(0, MOST))]
Size = Annotated[Variation, AfterValidator(within(0.005, 1.0))]
Share = Annotated[Variation, AfterValidator(within(0.0, 1.0))]


class DirtConfig(Config):
    """What sticks to the front glass; each episode has its own pattern, which stays."""

    spots: Count = 8
    """Spots of dust or mud."""
    spot_size: Size = Uniform(uniform=(0.02, 0.08))
    """Radius of each, as a share of the picture's height."""
    opacity: Share = Uniform(uniform=(0.15, 0.5))
    """Share of the light that each takes away in its middle."""
    scatter: Annotated[float, Field(ge=0, le=1)] = 0.4
    """Share of what they take away that comes back as a veil of the whole picture's light."""
    drops: Count = 0
    """Drops of water in any weather."""
    wet: Count = 8
    """Drops that the heaviest rain or snow adds; lighter ones add as many fewer."""
    drop_size: Size = Uniform(uniform=(0.04, 0.12))
    """Radius of each, as a share of the picture's height."""


class _Spots(NamedTuple):
    """What is on the lenses of N trackers. Places and radii are shares of the height and width."""

    number: NDArray[np.int64]  # How many, shape (N,)
    row: NDArray[np.float64]  # Shape (N, MOST), as all below
    column: NDArray[np.float64]
    radius: NDArray[np.float64]
    strength: NDArray[np.float64]
    """Opacity of dirt; of drops, how much smaller the world is in them."""

    @classmethod
    def create(cls, count: int) -> "_Spots":
        return cls(np.zeros(count, np.int64), *(np.zeros((count, MOST)) for _ in range(4)))

    def sample(
        self, tracker: int, count: float, size: Variation, strength: Variation,
        rng: np.random.Generator,
    ) -> None:  # fmt: skip
        """Sample a pattern: places, radii and strengths."""
        self.number[tracker] = round(count)
        for k in range(int(self.number[tracker])):
            self.row[tracker, k], self.column[tracker, k] = rng.random(2)
            self.radius[tracker, k] = sample(size, rng)
            self.strength[tracker, k] = sample(strength, rng)


_SMALLER = Uniform(uniform=(2.0, 5.0))
"""How much smaller than beside it the world is in a drop, which is a lens of its own."""


class Dirt:
    """The dirt on the lenses of N trackers.

    A spot is so near to the lens that its edge is soft; it takes light away, and scatters the light
    of the whole scene instead. A drop shows the world upside down, smaller and blurred, and is dark
    at its edge, where light is reflected within (Roser and Geiger, Video-based raindrop detection
    for improved image registration, ICCV workshops 2009, in their simplest form).

    Args:
        config: The settings.
        falling: Density of rain and snow, see `eyas.engine.state.lighting.Lighting`.
        count: N.
    """

    def __init__(self, config: DirtConfig, falling: float, count: int) -> None:
        self._config, self._falling = config, falling
        self._spots, self._drops = _Spots.create(count), _Spots.create(count)

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""
        config = self._config
        spots, drops, wet = (
            sample(count, rng) for count in (config.spots, config.drops, config.wet)
        )
        self._spots.sample(tracker, spots, config.spot_size, config.opacity, rng)
        drops = min(drops + wet * self._falling, MOST)
        self._drops.sample(tracker, drops, config.drop_size, _SMALLER, rng)

    def cover(self, radiance: NDArray[np.float32], trackers: NDArray[np.integer]) -> None:
        """Change the light of pictures in place.

        Args:
            radiance: Shape (V, 3, H, W).
            trackers: The tracker of each, shape (V,).
        """
        chosen = trackers.astype(np.int64)
        workers = min(thread_count(), len(chosen))
        drops = bool(self._drops.number[chosen].any())
        before = np.empty((workers, *radiance.shape[1:]) if drops else (0, 0, 0, 0), np.float32)
        scatter = self._config.scatter
        _cover(workers, _Work(self._spots, self._drops, radiance, before, chosen, scatter))


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    spots: _Spots
    drops: _Spots
    radiance: NDArray[np.float32]  # Shape (V, 3, H, W)
    before: NDArray[np.float32]
    """Working memory of each worker: the light without drops, shape (workers, 3, H, W); empty where
    there are none."""
    trackers: NDArray[np.int64]
    scatter: float


@parallel
def _cover(worker: int, workers: int, work: _Work) -> None:
    """Cover the pictures whose turn is this worker's."""
    for view in range(worker, len(work.trackers), workers):
        n, light = work.trackers[view], work.radiance[view]
        if work.spots.number[n] > 0:
            for channel in range(3):
                veil = work.scatter * _mean_of(light[channel])
                for k in range(work.spots.number[n]):
                    _dim(light[channel], work.spots, n, k, veil)
        if work.drops.number[n] > 0:
            for channel in range(3):
                before = work.before[worker, channel]
                _copy(light[channel], before)
                for k in range(work.drops.number[n]):
                    _refract(light[channel], before, work.drops, n, k)


@kernel
def _mean_of(plane: NDArray[np.float32]) -> float:
    """Return the mean of a plane, without what does not fill eight pixels at its end."""
    total, pixels = splat(f4(0.0)), plane.shape[0] * plane.shape[1] // WIDTH * WIDTH
    for at in range(0, pixels, WIDTH):
        total += load(plane, at)
    mean = 0.0
    for k in range(WIDTH):
        mean += lane(total, k)
    return float(mean / pixels)


@kernel(inline=True)
def _copy(plane: NDArray[np.float32], to: NDArray[np.float32]) -> None:
    for row in range(plane.shape[0]):
        for column in range(plane.shape[1]):
            to[row, column] = plane[row, column]


@kernel(inline=True)
def _extent(middle: float, radius: float, size: int) -> tuple[int, int]:
    """Return the first pixel of an axis that a spot may cover, and the one after the last."""
    return max(i8(middle - radius), 0), min(i8(middle + radius) + 2, size)


@kernel
def _dim(plane: NDArray[np.float32], spots: _Spots, n: int, k: int, veil: float) -> None:
    """Draw one spot of dirt."""
    height, width = plane.shape
    radius = spots.radius[n, k] * height
    y, x = spots.row[n, k] * height, spots.column[n, k] * width
    top, bottom = _extent(y, radius, height)
    left, right = _extent(x, radius, width)
    for row in range(top, bottom):
        for column in range(left, right):
            down, across = (row + 0.5 - y) / radius, (column + 0.5 - x) / radius
            inside = 1.0 - down * down - across * across
            if inside > 0.0:
                share = spots.strength[n, k] * inside * (2.0 - inside)
                plane[row, column] = f4(plane[row, column] * (1.0 - share) + share * veil)


@kernel
def _refract(
    plane: NDArray[np.float32], before: NDArray[np.float32], drops: _Spots, n: int, k: int
) -> None:
    """Draw one drop, in which the world is upside down."""
    height, width = plane.shape
    radius, smaller = drops.radius[n, k] * height, drops.strength[n, k]
    y, x = drops.row[n, k] * height, drops.column[n, k] * width
    top, bottom = _extent(y, radius, height)
    left, right = _extent(x, radius, width)
    for row in range(top, bottom):
        for column in range(left, right):
            down, across = row + 0.5 - y, column + 0.5 - x
            away = (down * down + across * across) / (radius * radius)
            if away < 1.0:
                seen = _blurred(before, y - smaller * down, x - smaller * across, smaller)
                seen *= 1.0 - 0.6 * away * away
                share = 1.0 - away * away
                plane[row, column] = f4(plane[row, column] * (1.0 - share) + share * seen)


@kernel
def _blurred(plane: NDArray[np.float32], y: float, x: float, step: float) -> float:
    """Return the mean of nine pixels around a place; what is outside is mirrored."""
    height, width = plane.shape
    total = 0.0
    for i in range(-1, 2):
        for j in range(-1, 2):
            row = _reflected(i8(y + i * step), height)
            column = _reflected(i8(x + j * step), width)
            total += plane[row, column]
    return float(total / 9.0)


@kernel(inline=True)
def _reflected(at: int, size: int) -> int:
    """Return the pixel of an axis for any whole number, mirrored at its ends."""
    at = abs(at) % (2 * size)
    return at if at < size else 2 * size - 1 - at
