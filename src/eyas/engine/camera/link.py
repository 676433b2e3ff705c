"""The link that carries pictures: coding, lost slices, pictures that freeze."""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field

from eyas.engine.camera.codec import code, planes_for, quantisation
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.config import Config
from eyas.engine.core.counter_rng import SEEDS, uniform
from eyas.engine.core.variation import Variation, sample, within
from eyas.lanes import kernel, parallel, thread_count
from eyas.lanes.elementary import exp, log

_BEGIN, _LENGTH, _SLICE = 0, 1, 2
"""Channels of the random numbers: whether a picture freezes, for how long, and each slice."""


class LinkConfig(Config):
    """A digital link; losses are shown as a receiver conceals them, by what it showed before."""

    quality: Annotated[Variation, AfterValidator(within(1.0, 100.0))] | None = 40
    """Of JPEG, 1 to 100, with colours at half the width and height; null: not coded."""
    slices: Annotated[int, Field(ge=1, le=256)] = 8
    """Slices, one below the other, that a picture is sent in."""
    slice_loss: Annotated[Variation, AfterValidator(within(0.0, 1.0))] = 0.0
    """Probability that a slice is lost, and shows what it showed before."""
    freezes: Annotated[Variation, AfterValidator(within(0.0, 100.0))] = 0.0
    """How often the picture freezes [1/s]."""
    freeze_time: Annotated[Variation, AfterValidator(within(0.0, 100.0))] = 0.3
    """How long it stays so, on average [s]; each time differs (exponentially distributed)."""


class _Links(NamedTuple):
    """What is sampled for each episode, of N trackers."""

    tables: NDArray[np.float32]  # See `quantisation`, shape (N, 2, 64)
    slice_loss: NDArray[np.float64]
    freezes: NDArray[np.float64]
    freeze_time: NDArray[np.float64]
    seed: NDArray[np.int64]


class _Shown(NamedTuple):
    """What N receivers have shown, of pictures of one size."""

    step: NDArray[np.int64]  # Physics step of the last picture, -1: none yet, shape (N,)
    until: NDArray[np.int64]  # Step at which the last freeze ends, shape (N,)
    last: NDArray[np.uint8]
    """The last picture as it was shown, shape (N, H, W, 3); without pixels where nothing is lost.
    """
    before: NDArray[np.uint8]  # The one shown before it

    @classmethod
    def create(cls, count: int, height: int, width: int) -> "_Shown":
        pictures = (np.zeros((count, height, width, 3), np.uint8) for _ in range(2))
        return cls(np.full(count, -1), np.zeros(count, np.int64), *pictures)


class Link:
    """The links of N trackers.

    A picture that is drawn again is received as it was, and one of the past without losses.

    Args:
        config: The settings.
        count: N.
    """

    def __init__(self, config: LinkConfig, count: int) -> None:
        self._config, self._count = config, count
        self._links = _Links(
            tables=np.ones((count, 2, 64), np.float32),
            slice_loss=np.zeros(count),
            freezes=np.zeros(count),
            freeze_time=np.zeros(count),
            seed=np.zeros(count, np.int64),
        )
        self._loses = config.slice_loss != 0.0 or config.freezes != 0.0
        self._shown: dict[tuple[int, int], _Shown] = {}

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""
        config, links = self._config, self._links
        links.seed[tracker] = rng.integers(SEEDS)
        if config.quality is not None:
            links.tables[tracker] = quantisation(sample(config.quality, rng))
        links.slice_loss[tracker] = sample(config.slice_loss, rng)
        links.freezes[tracker] = sample(config.freezes, rng)
        links.freeze_time[tracker] = sample(config.freeze_time, rng)
        for shown in self._shown.values():
            shown.step[tracker] = -1

    def carry(
        self,
        rgb: NDArray[np.uint8],  # Shape (V, H, W, 3)
        trackers: NDArray[np.integer],  # The tracker of each, shape (V,)
        step: NDArray[np.int64],  # Physics steps of each tracker since its reset, shape (N,)
    ) -> None:
        """Make pictures what is shown of them at the other end, in place."""
        views, height, width, _ = rgb.shape
        workers = min(thread_count(), views)
        rows, columns = planes_for(height, width) if self._config.quality is not None else (0, 0)
        work = _Work(
            self._links,
            self._shown_of(height, width),
            rgb,
            trackers.astype(np.int64),
            step,
            self._config.slices,
            np.empty((workers, 3, rows, columns), np.float32),
            np.empty((workers, rows + 2, columns // 2), np.float32),
        )
        _carry(workers, work)

    def _shown_of(self, height: int, width: int) -> _Shown:
        size = (height, width) if self._loses else (0, 0)
        if size not in self._shown:
            self._shown[size] = _Shown.create(self._count, *size)
        return self._shown[size]


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    links: _Links
    shown: _Shown
    rgb: NDArray[np.uint8]
    trackers: NDArray[np.int64]
    step: NDArray[np.int64]
    slices: int
    planes: NDArray[np.float32]
    """Working memory of each worker, see `code`; empty where pictures are not coded."""
    halves: NDArray[np.float32]  # The same


@parallel
def _carry(worker: int, workers: int, work: _Work) -> None:
    """Carry the pictures whose turn is this worker's."""
    for view in range(worker, len(work.trackers), workers):
        n = work.trackers[view]
        rgb = work.rgb[view]
        if work.planes.shape[2] > 0:
            code(rgb, work.links.tables[n], work.planes[worker], work.halves[worker])
        if work.shown.last.shape[1] > 0:
            _receive(work, n, work.step[n], rgb)


@kernel
def _receive(work: _Work, n: int, step: int, rgb: NDArray[np.uint8]) -> None:
    """Put what is shown of a picture of tracker `n` in its place."""
    shown = work.shown
    if shown.step[n] < 0:
        _copy(rgb, shown.last[n])
        _copy(rgb, shown.before[n])
        shown.step[n], shown.until[n] = step, step
        return
    if step < shown.step[n]:
        return
    if step > shown.step[n]:
        _copy(shown.last[n], shown.before[n])
        _freeze(work.links, shown, n, step)
        shown.step[n] = step
    height = rgb.shape[0]
    for number in range(work.slices):
        chance = uniform(work.links.seed[n], step, _SLICE + number)
        if step < shown.until[n] or chance < work.links.slice_loss[n]:
            first, last = height * number // work.slices, height * (number + 1) // work.slices
            _copy(shown.before[n, first:last], rgb[first:last])
    _copy(rgb, shown.last[n])


@kernel
def _freeze(links: _Links, shown: _Shown, n: int, step: int) -> None:
    """Let a freeze begin, with the probability that it does since the last picture."""
    if step < shown.until[n]:
        return
    passed = (step - shown.step[n]) * PHYSICS_STEP
    if uniform(links.seed[n], step, _BEGIN) < 1.0 - exp(-links.freezes[n] * passed):
        length = -log(uniform(links.seed[n], step, _LENGTH)) * links.freeze_time[n]
        shown.until[n] = step + max(int(length / PHYSICS_STEP), 1)


@kernel(inline=True)
def _copy(picture: NDArray[np.uint8], to: NDArray[np.uint8]) -> None:
    for row in range(picture.shape[0]):
        for column in range(picture.shape[1]):
            for channel in range(3):
                to[row, column, channel] = picture[row, column, channel]
