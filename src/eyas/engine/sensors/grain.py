"""Noise and bias of the camera's sensor."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.counter_rng import SEEDS, mixed
from eyas.engine.sensors.config import CameraErrors
from eyas.lanes import exact, parallel, thread_count

_DEVIATION = 147.8  # Standard deviation of the sum of four random bytes: (4 (256^2 - 1) / 12)^(1/2)


class Grain:
    """Adds noise, and the bias of each episode, to the pictures of N trackers.

    The noise of a channel of a pixel is the sum of four random bytes, which is nearly normal. Each
    physics step has its own, so a picture that is drawn twice is the same.

    Args:
        config: Their deviations.
        count: N.
    """

    def __init__(self, config: CameraErrors, count: int) -> None:
        self._scale = config.noise / _DEVIATION
        self._deviation = config.bias
        self._seed = np.zeros(count, np.int64)
        self._bias = np.zeros((count, 3))

    @classmethod
    def of(cls, config: CameraErrors, count: int) -> "Grain | None":
        """Return the grain of some settings; None if they have none."""
        return cls(config, count) if config.noise > 0.0 or config.bias > 0.0 else None

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""
        self._seed[tracker] = rng.integers(SEEDS)
        self._bias[tracker] = exact.normal(rng, 0.0, self._deviation, 3)

    def add(
        self,
        rgb: NDArray[np.uint8],  # Pictures, shape (V, H, W, 3)
        trackers: NDArray[np.integer],  # The tracker of each, shape (V,)
        step: NDArray[np.int64],  # Physics steps of each tracker since its reset, shape (N,)
    ) -> None:
        """Add noise in place."""
        views = len(trackers)
        work = _Work(
            rgb.reshape(views, -1),
            self._seed[trackers],
            self._bias[trackers],
            step[trackers],
            self._scale,
        )
        _add_noise(min(thread_count(), views), work)


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    pixels: NDArray[np.uint8]  # Shape (V, bytes of a picture)
    seed: NDArray[np.int64]
    bias: NDArray[np.float64]  # Of each channel, shape (V, 3)
    step: NDArray[np.int64]
    scale: float


@parallel
def _add_noise(worker: int, workers: int, work: _Work) -> None:
    """Add noise to the pictures whose turn is this worker's."""
    pixels, bias, scale = work.pixels, work.bias, work.scale
    for view in range(worker, pixels.shape[0], workers):
        base = mixed(mixed(work.seed[view]) ^ (work.step[view] & 0xFFFFFFFF))
        for at in range(pixels.shape[1]):
            word = mixed(base ^ at)
            four = (word & 255) + ((word >> 8) & 255) + ((word >> 16) & 255) + (word >> 24)
            value = pixels[view, at] + scale * (four - 510) + bias[view, at % 3] + 0.5
            pixels[view, at] = int(min(max(value, 0.0), 255.0))
