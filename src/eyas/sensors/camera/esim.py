"""Pixels that see changes: the contrast model of ESIM, with the noise of real sensors.

A pixel holds a reference of the logarithm of its light. Each time the light has changed by its
contrast threshold, it tells an event and moves the reference by this; in between two pictures the
logarithm is taken to change linearly (Rebecq, Gehrig, Scaramuzza: ESIM: an Open Event Camera
Simulator, CoRL 2018, section 3). Real pixels differ in their thresholds, are blind for a while
after an event, and leak: their reference drifts, which tells events of more light; in the dark,
single photons tell events of either kind (Hu, Liu, Delbruck: v2e: From Video Frames to Realistic DVS
Events, CVPRW 2021, section 4).
"""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from eyas.core.config import Config
from eyas.lanes import compiled, kernel
from eyas.lanes.elementary import log
from eyas.sensors.chance import mixed, normal, uniform

__all__ = ["EVENT", "EventPixels", "EventsConfig", "Interval", "fill_levels", "log_of_light", "most_events", "tell_events"]

Single = NDArray[np.float32]
Floats = NDArray[np.float64]

EVENT = np.dtype([("x", "<u2"), ("y", "<u2"), ("p", "<i2"), ("t", "<i8")])
"""An event: column and row [pixels], 1 for more light and 0 for less, and the time [us]. The same
names and types as those of Metavision's and expelliarmus' arrays."""


class EventsConfig(Config):
    """A sensor of events beside the camera, with its lens and size; by default there is none.

    Thresholds, refractory time and leak are of the order of those of published sensors: 0.15 to
    0.3, 0.1 ms to 1 ms, and 0.1 events a second (v2e, table 1).
    """

    enabled: bool = False
    """Whether the tracker has one."""
    positive: Annotated[float, Field(gt=0, le=5)] = 0.2
    """Contrast threshold of more light: change of the natural logarithm of the light."""
    negative: Annotated[float, Field(gt=0, le=5)] = 0.2
    """The same of less light."""
    mismatch: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    """Standard deviation of the thresholds of the pixels, as a share of them."""
    refractory: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Time after an event in which a pixel tells no other [s]."""
    leak: Annotated[float, Field(ge=0, le=100)] = 0.0
    """Events of more light that a pixel tells each second where nothing changes [Hz]."""
    shot: Annotated[float, Field(ge=0, le=100)] = 0.0
    """Events that a dark pixel tells each second by shot noise; a bright one a quarter [Hz]."""
    dark: Annotated[float, Field(gt=0, le=1)] = 0.001
    """Light that a pixel sees in the dark, of the radiance of white paper in the sun: it keeps the
    logarithm finite."""
    most_samples: Annotated[int, Field(ge=1, le=1000)] = 32
    """Most instants between two pictures that are drawn: one for each pixel of motion up to this.
    """


class EventPixels(NamedTuple):
    """The pixels of N sensors."""

    reference: Single
    """Logarithm of the light at the last event, shape (N, pixels)."""
    last: Single
    """Logarithm of the light when it was last seen, shape (N, pixels)."""
    positive: Single
    """Threshold of more light, shape (N, pixels)."""
    negative: Single
    """Threshold of less light, shape (N, pixels)."""
    blind: Floats
    """Until when it tells nothing [s], shape (N, pixels)."""

    @classmethod
    def create(cls, count: int, pixels: int) -> "EventPixels":
        """Return pixels that have seen nothing."""
        plane = (count, pixels)
        light = [np.zeros(plane, np.float32) for _ in range(4)]
        return cls(*light, np.zeros(plane))


class Interval(NamedTuple):
    """The light of one sensor at two instants."""

    begin: float
    """[s]"""
    end: float
    """[s]"""
    width: int
    """Pixels in a row."""
    refractory: float
    """See `EventsConfig`."""
    leak: float
    shot: float
    seed: int
    """Of the shot noise."""
    number: int
    """Of the interval in its episode."""


@kernel(inline=True)
def light_of(radiance: Single, at: int) -> float:
    """Return the light of a pixel: the luminance of its radiance (ITU-R BT.709)."""
    return 0.2126 * radiance[0, at] + 0.7152 * radiance[1, at] + 0.0722 * radiance[2, at]


@compiled
def log_of_light(radiance: Single, dark: float, out: Single) -> None:
    """Write the natural logarithm of the light of each pixel.

    Args:
        radiance: Linear, red, green and blue, shape (3, pixels).
        dark: See `EventsConfig`.
        out: Shape (pixels,).
    """
    for at in range(out.shape[0]):
        out[at] = log(max(light_of(radiance, at), 0.0) + dark)


@compiled
def fill_levels(pixels: EventPixels, n: int, light: Single, seed: int, settings: Floats) -> None:
    """Begin an episode of sensor `n`: each pixel has seen what it sees, and has its thresholds.

    Args:
        pixels: All sensors.
        n: Which.
        light: Logarithm of what it sees, shape (pixels,).
        seed: Of its thresholds.
        settings: Thresholds of more and of less light, and their mismatch, shape (3,).
    """
    for at in range(light.shape[0]):
        pixels.reference[n, at] = pixels.last[n, at] = light[at]
        pixels.blind[n, at] = -1.0
        more, less = 1.0, 1.0
        if settings[2] > 0.0:
            more += settings[2] * normal(seed, at, 0)
            less += settings[2] * normal(seed, at, 1)
        pixels.positive[n, at] = settings[0] * max(more, _LEAST)
        pixels.negative[n, at] = settings[1] * max(less, _LEAST)


_LEAST = 0.05
"""Least threshold of any pixel, as a share: v2e's 0.01 of 0.2."""

_BRIGHT = -1.6
"""Logarithm of the light, of white paper in the sun, of what is bright for shot noise."""


@compiled
def tell_events(
    pixels: EventPixels, n: int, light: Single, interval: Interval, out: NDArray[np.void],
    count: NDArray[np.int64],
) -> None:  # fmt: skip
    """Let sensor `n` see the light at the end of an interval, and append its events.

    Events of one pixel are in the order of their times; those of different pixels are not. What
    does not fit is counted, not written: the caller gives room for `most_events`.

    Args:
        pixels: All sensors.
        n: Which.
        light: Logarithm of what it sees at the end, shape (pixels,).
        interval: The interval.
        out: Events of dtype `EVENT`.
        count: Number of events in `out`, shape (1,); updated.
    """
    length = interval.end - interval.begin
    base = mixed(mixed(interval.seed) ^ (interval.number & 0xFFFFFFFF))
    for at in range(light.shape[0]):
        _shot_noise(interval, length, base, at, light[at], out, count)
        _contrast(pixels, n, at, light[at], interval, length, out, count)
        pixels.last[n, at] = light[at]


@kernel(inline=True)
def _contrast(
    pixels: EventPixels, n: int, at: int, now: float, interval: Interval, length: float,
    out: NDArray[np.void], count: NDArray[np.int64],
) -> None:  # fmt: skip
    """Append the events of one pixel, and move its reference.

    The leak lowers the reference; as the difference to it is all that counts, the light is let
    rise in its place, at constant speed, and the reference is put back at the end.
    """
    reference, before = float(pixels.reference[n, at]), float(pixels.last[n, at])
    drift = interval.leak * float(pixels.positive[n, at]) * length
    after = now + drift
    more = after > before
    step = float(pixels.positive[n, at]) if more else -float(pixels.negative[n, at])
    sign = 1.0 if more else -1.0
    level = reference + step
    while sign * (after - level) >= 0.0 and after != before:
        share = min(max((level - before) / (after - before), 0.0), 1.0)
        time = interval.begin + share * length
        if time >= pixels.blind[n, at]:
            _append(out, count, interval.width, at, 1 if more else 0, time)
            pixels.blind[n, at] = time + interval.refractory
        reference = level
        level += step
    pixels.reference[n, at] = reference - drift


@kernel(inline=True)
def _shot_noise(
    interval: Interval, length: float, base: int, at: int, light: float,
    out: NDArray[np.void], count: NDArray[np.int64],
) -> None:  # fmt: skip
    """Append the event of a pixel that single photons tell, if one does.

    At most one in an interval: at 10 Hz and 2 ms, 1 % of those that would come are left out.
    """
    if interval.shot <= 0.0:
        return
    bright = min(max(1.0 + (light - _BRIGHT) / 4.0, 0.0), 1.0)
    rate = interval.shot * (1.0 - 0.75 * bright)
    if uniform(base, at, 0) < rate * length:
        time = interval.begin + uniform(base, at, 1) * length
        _append(out, count, interval.width, at, 1 if uniform(base, at, 2) < 0.5 else 0, time)


@kernel(inline=True)
def _append(
    out: NDArray[np.void], count: NDArray[np.int64], width: int, at: int, sign: int, time: float
) -> None:
    k = count[0]
    if k < out.shape[0]:
        out[k].x, out[k].y = at % width, at // width
        out[k].p, out[k].t = sign, int(time * 1e6 + 0.5)
    count[0] = k + 1


def most_events(pixels: EventPixels, n: int, light: Single) -> int:
    """Return how many events `tell_events` may append."""
    least = min(float(pixels.positive[n].min()), float(pixels.negative[n].min()))
    away = np.abs(light - pixels.reference[n])
    return int((away / least).sum()) + 3 * light.size

