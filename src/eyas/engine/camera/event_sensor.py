"""Event cameras of N trackers: their state, and their events as arrays."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.esim import EventPixels, EventSettings, Look, see_light
from eyas.engine.camera.events import EventsConfig
from eyas.engine.core.counter_rng import SEEDS
from eyas.lanes import parallel, thread_count

Integers = NDArray[np.int64]
Floats = NDArray[np.float64]


class EventSensors:
    """N event cameras.

    Attributes:
        size: Height and width [pixels].

    Args:
        config: The settings.
        size: Height and width of the camera [pixels].
        count: N.
    """

    def __init__(self, config: EventsConfig, size: tuple[int, int], count: int) -> None:
        self.size = config.height or size[0], config.width or size[1]
        self._pixels = EventPixels.create(count, self.size[0] * self.size[1])
        self._emitted, self._since = self._pixels.emitted, np.zeros(count)
        self._settings = EventSettings(
            float(config.positive),
            float(config.negative),
            float(config.mismatch),
            float(config.refractory),
            float(config.leak),
            float(config.shot),
            float(config.dark),
            self.size[1],
        )

    @classmethod
    def of(cls, config: EventsConfig, size: tuple[int, int], count: int) -> "EventSensors | None":
        """Return the sensors of some settings; None: there are none."""
        return cls(config, size, count) if config.enabled else None

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode: the first light that is seen makes no events."""
        self._pixels.seed[tracker] = rng.integers(SEEDS)
        self._pixels.seen[tracker] = 0

    @property
    def pixels(self) -> EventPixels:
        """Their pixels, and the events that these have emitted."""
        return self._pixels._replace(emitted=self._emitted)  # there may be more room by now

    def forget(self, chosen: Integers, time: Floats) -> None:
        """Begin to collect events anew.

        Args:
            chosen: The sensors, shape (V,).
            time: When each has last seen [s], shape (V,).
        """
        self._pixels.number[chosen] = 0
        self._since[chosen] = time

    def see(self, chosen: Integers, of: Integers, time: Floats, light: NDArray[np.float32]) -> None:
        """See light.

        Args:
            chosen: Sensors, shape (V,).
            of: Which of them each picture is for, in ascending order, those of each in the order
                of time, shape (P,).
            time: Of the pictures [s], shape (P,).
            light: Linear radiance, shape (P, 3, H, W).
        """
        first, end = (
            np.searchsorted(of, np.arange(len(chosen)), side) for side in ("left", "right")
        )
        flat = light.reshape(len(light), 3, -1)
        memory = np.empty((len(chosen), flat.shape[2]), np.float32)
        look = Look(chosen, first, end, flat, time, memory)
        workers = min(thread_count(), len(chosen))
        see_light(workers, self.pixels, self._settings, look)
        while (look.next < look.end).any():
            full = self._emitted
            self._emitted = np.zeros((len(full), 2 * full.shape[1]), full.dtype)
            self._emitted[:, : full.shape[1]] = full
            see_light(workers, self.pixels, self._settings, look)

    def events_of(self, tracker: int) -> NDArray[np.void]:
        """Return the events of a sensor since `forget`, in the order of their times,
        of dtype `eyas.engine.camera.esim.EVENT`; times count from the episode's start.
        """
        events = self._emitted[tracker, : self._pixels.number[tracker]]
        return events[np.argsort(events["t"], kind="stable")]

    def count(self, chosen: Integers, out: NDArray[np.uint8]) -> None:
        """Write how many events of each pixel there are in equal parts of the time since.

        Args:
            chosen: Sensors, shape (V,).
            out: For each part those of less light, then those of more, at most 255, shape
                (V, 2 bins, H, W).
        """
        counting = _Counting(chosen, self._since, self._settings.width, out.reshape(len(out), -1))
        _count(min(thread_count(), len(chosen)), self.pixels, counting)


class _Counting(NamedTuple):
    """Inputs and outputs of the kernel."""

    chosen: Integers
    begin: Floats  # When each sensor began to collect [s], shape (N,)
    width: int  # Pixels in a row
    out: NDArray[np.uint8]  # Shape (V, 2 bins * pixels)


@parallel
def _count(worker: int, workers: int, pixels: EventPixels, counting: _Counting) -> None:
    chosen, begin = counting.chosen, counting.begin
    width, out = counting.width, counting.out
    size = pixels.last.shape[1]
    bins = out.shape[1] // (2 * size)
    for v in range(worker, chosen.shape[0], workers):
        n = chosen[v]
        out[v, :] = 0
        since = begin[n] * 1e6
        length = max(pixels.time[n] * 1e6 - since, 1.0)
        for k in range(pixels.number[n]):
            event = pixels.emitted[n, k]
            part = min(max(int(bins * (event.t - since) / length), 0), bins - 1)
            at = (2 * part + event.p) * size + event.y * width + event.x
            out[v, at] = min(out[v, at] + 1, 255)
