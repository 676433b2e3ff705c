"""Pixels that see changes: the contrast model of ESIM, with the noise of real sensors.

A pixel holds a reference of the logarithm of its light. Each time the light has changed by its
contrast threshold, it emits an event and moves the reference by this; in between two pictures the
logarithm is taken to change linearly (Rebecq, Gehrig, Scaramuzza: ESIM: an Open Event Camera
Simulator, CoRL 2018, section 3). Real pixels differ in their thresholds, are blind for a while
after an event, and leak: their reference drifts, which makes events of more light; in the dark,
single photons make events of either kind (Hu, Liu, Delbruck: v2e: From Video Frames to Realistic
DVS Events, CVPRW 2021, section 4).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.counter_rng import mixed, normal, uniform
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.lanes import kernel, parallel
from eyas.lanes.vector import (
    WIDTH,
    any_of,
    bit_pattern,
    from_bits,
    greater,
    load,
    select,
    store,
    to_f4,
)

Single = NDArray[np.float32]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

EVENT = np.dtype([("x", "<u2"), ("y", "<u2"), ("p", "<i2"), ("t", "<i8")])
"""An event: column and row [pixels], 1 for more light and 0 for less, and the time [us]. The same
names and types as those of Metavision's and expelliarmus' arrays."""


class EventSettings(NamedTuple):
    """`EventsConfig`, for kernels."""

    positive: float
    negative: float
    mismatch: float
    refractory: float
    leak: float
    shot: float
    dark: float
    width: int  # Pixels in a row


class EventPixels(NamedTuple):
    """The pixels of N sensors, and the events that they have emitted."""

    reference: Single  # Logarithm of the light at the last event, shape (N, pixels)
    last: Single  # Logarithm of the light when it was last seen, shape (N, pixels)
    positive: Single  # Threshold of more light, shape (N, pixels)
    negative: Single  # Threshold of less light, shape (N, pixels)
    blind: Floats  # Until when it emits nothing [s], shape (N, pixels)
    time: Floats  # When each sensor has last seen [s], shape (N,)
    seen: Integers  # How often each has seen in its episode, shape (N,); 0: it is to begin
    seed: Integers  # Seed of the noise of each in its episode, shape (N,)
    number: Integers  # Number of events of each, shape (N,)
    emitted: NDArray[np.void]
    """Its events, of dtype `EVENT`, in the first elements of its row, those of each pixel in the
    order of their times, shape (N, room)."""

    @classmethod
    def create(cls, count: int, pixels: int) -> "EventPixels":
        """Return pixels that have seen nothing."""
        plane = (count, pixels)
        return cls(
            reference=np.zeros(plane, np.float32),
            last=np.zeros(plane, np.float32),
            positive=np.zeros(plane, np.float32),
            negative=np.zeros(plane, np.float32),
            blind=np.zeros(plane),
            time=np.zeros(count),
            seen=np.zeros(count, np.int64),
            seed=np.zeros(count, np.int64),
            number=np.zeros(count, np.int64),
            emitted=np.zeros((count, 4 * pixels), EVENT),
        )


class Look(NamedTuple):
    """P pictures of the light that V of the sensors see, those of each in the order of time."""

    sensor: Integers  # Which sensors, shape (V,)
    next: Integers
    """The first picture of each; written: the first that was not seen, since there is no room for
    its events, shape (V,)."""
    end: Integers  # Where those of each end, shape (V,)
    radiance: Single  # Linear, red, green and blue, shape (P, 3, pixels)
    time: Floats  # [s], shape (P,)
    light: Single  # Working memory, shape (V, pixels)


@parallel
def see_light(
    worker: int, workers: int, pixels: EventPixels, settings: EventSettings, look: Look
) -> None:
    """Let sensors see, and append their events, as far as there is room for them."""
    for v in range(worker, look.sensor.shape[0], workers):
        n, light = look.sensor[v], look.light[v]
        for p in range(look.next[v], look.end[v]):
            _log_of_light(look.radiance[p], settings.dark, light)
            if pixels.seen[n] == 0:
                _begin(pixels, settings, n, light)
            elif not _has_room(pixels, settings, n, light):
                break
            else:
                _emit(pixels, settings, n, light, look.time[p])
            pixels.time[n] = look.time[p]
            pixels.seen[n] += 1
            look.next[v] = p + 1


@kernel(inline=True)
def _logarithm(red: float, green: float, blue: float, dark: float) -> float:
    """Return the natural logarithm of the luminance of pixels (ITU-R BT.709), in float32.

    Of a number m 2^e, with m around 1, it is that of m, by the series of the inverse hyperbolic
    tangent, plus e log 2. What the series leaves out is less than what float32 rounds off.
    """
    one = f4(1.0)
    light = f4(0.2126) * red + f4(0.7152) * green + f4(0.0722) * blue
    bits = bit_pattern(greater(light, f4(0.0)) + dark)
    power = (bits >> i4(23)) - i4(127)
    part = from_bits((bits & i4(0x7FFFFF)) | i4(0x3F800000))
    large = part > f4(1.41421356)
    part = select(large, part * f4(0.5), part)
    power = select(large, power + i4(1), power)
    ratio = (part - one) / (part + one)
    square = ratio * ratio
    series = f4(1.0 / 7.0) + square * f4(1.0 / 9.0)
    series = f4(1.0 / 3.0) + square * (f4(0.2) + square * series)
    log: float = (ratio + ratio) * (one + square * series) + to_f4(power) * f4(0.69314718)
    return log


@kernel(inline=True)
def _log_of_light(radiance: Single, dark: float, light: Single) -> None:
    """Write the logarithm of the light of each pixel."""
    red, green, blue, count = radiance[0], radiance[1], radiance[2], light.shape[0]
    for at in range(0, count - WIDTH + 1, WIDTH):
        colour = load(red, at), load(green, at), load(blue, at)
        store(light, at, _logarithm(colour[0], colour[1], colour[2], f4(dark)))
    for at in range(count - count % WIDTH, count):
        light[at] = _logarithm(red[at], green[at], blue[at], f4(dark))


@kernel(inline=True)
def _begin(pixels: EventPixels, settings: EventSettings, n: int, light: Single) -> None:
    """Begin an episode of sensor `n`: each pixel has seen what it sees, and has its thresholds."""
    for at in range(light.shape[0]):
        pixels.reference[n, at] = pixels.last[n, at] = light[at]
        pixels.blind[n, at] = -1.0
        more, less = 1.0, 1.0
        if settings.mismatch > 0.0:
            more += settings.mismatch * normal(pixels.seed[n], at, 0)
            less += settings.mismatch * normal(pixels.seed[n], at, 1)
        pixels.positive[n, at] = settings.positive * max(more, _LEAST)
        pixels.negative[n, at] = settings.negative * max(less, _LEAST)


@kernel(inline=True)
def _has_room(pixels: EventPixels, settings: EventSettings, n: int, light: Single) -> bool:
    """Return whether there is room for all events that the next look may make."""
    most, count = 0, light.shape[0]
    for first in range(0, count, WIDTH):
        some = min(WIDTH, count - first)
        if some == WIDTH and _none_changed(pixels, n, light, first):
            continue
        for at in range(first, first + some):
            away = light[at] - pixels.reference[n, at]
            step = pixels.positive[n, at] if away > 0.0 else pixels.negative[n, at]
            most += int(abs(away) / step + 0.001)  # more than roundings
    of_noise = 0
    if settings.shot > 0.0:
        of_noise += light.shape[0]
    if settings.leak > 0.0:
        of_noise += light.shape[0]
    room: bool = pixels.number[n] + most + of_noise <= pixels.emitted.shape[1]
    return room


@kernel(inline=True)
def _emit(pixels: EventPixels, settings: EventSettings, n: int, light: Single, time: float) -> None:
    """Let sensor `n` see the light at a time, and append its events."""
    if settings.shot > 0.0:
        base = mixed(mixed(pixels.seed[n]) ^ (pixels.seen[n] & 0xFFFFFFFF))
        for at in range(light.shape[0]):
            _shot_noise(pixels, settings, n, at, (light[at], time), base)
    last, count = pixels.last[n], light.shape[0]
    for first in range(0, count, WIDTH):
        some = min(WIDTH, count - first)
        if some == WIDTH and settings.leak <= 0.0 and _none_changed(pixels, n, light, first):
            store(last, first, load(light, first))
            continue
        for at in range(first, first + some):
            _contrast(pixels, settings, n, at, light[at], time)
            last[at] = light[at]


@kernel(inline=True)
def _none_changed(pixels: EventPixels, n: int, light: Single, first: int) -> bool:
    """Return whether none of eight pixels has changed by its threshold; most have not."""
    away = load(light, first) - load(pixels.reference[n], first)
    near = f4(0.999)  # roundings must not hide an event
    more = away > near * load(pixels.positive[n], first)
    less = f4(0.0) - away > near * load(pixels.negative[n], first)
    changed: bool = any_of(more | less)
    return not changed


_LEAST = 0.05  # Least threshold of any pixel, as a share: v2e's 0.01 of 0.2.

_BRIGHT = -1.6
"""Logarithm of the light, of white paper in the sun, of what is bright for shot noise."""


@kernel(inline=True)
def _contrast(
    pixels: EventPixels, settings: EventSettings, n: int, at: int, now: float, time: float
) -> None:
    """Append the events of one pixel, and move its reference.

    The leak lowers the reference; as the difference to it is all that counts, the light is let
    rise in its place, at constant speed, and the reference is put back at the end.
    """
    begin, length = pixels.time[n], time - pixels.time[n]
    reference, before = float(pixels.reference[n, at]), float(pixels.last[n, at])
    drift = settings.leak * float(pixels.positive[n, at]) * length
    after = now + drift
    more = after > before
    step = float(pixels.positive[n, at]) if more else -float(pixels.negative[n, at])
    sign = 1.0 if more else -1.0
    level = reference + step
    while sign * (after - level) >= 0.0 and after != before:
        share = min(max((level - before) / (after - before), 0.0), 1.0)
        crossed = begin + share * length
        if crossed >= pixels.blind[n, at]:
            _append(pixels, settings, n, at, 1 if more else 0, crossed)
            pixels.blind[n, at] = crossed + settings.refractory
        reference = level
        level += step
    pixels.reference[n, at] = reference - drift


@kernel(inline=True)
def _shot_noise(
    pixels: EventPixels,  # All sensors
    settings: EventSettings,
    n: int,  # Which sensor
    at: int,  # Which pixel
    now: tuple[float, float],  # Logarithm of its light, and the time [s]
    base: int,  # Seed of this look
) -> None:
    """Append the event of a pixel that single photons make, if any.

    At most one in a look: at 10 Hz and 2 ms, 1 % of those that would come are left out.
    """
    light, time = now
    length = time - pixels.time[n]
    bright = min(max(1.0 + (light - _BRIGHT) / 4.0, 0.0), 1.0)
    rate = settings.shot * (1.0 - 0.75 * bright)
    if uniform(base, at, 0) < rate * length:
        came = pixels.time[n] + uniform(base, at, 1) * length
        _append(pixels, settings, n, at, 1 if uniform(base, at, 2) < 0.5 else 0, came)


@kernel(inline=True)
def _append(
    pixels: EventPixels, settings: EventSettings, n: int, at: int, sign: int, time: float
) -> None:
    event = pixels.emitted[n, pixels.number[n]]
    event.x, event.y = at % settings.width, at // settings.width
    event.p, event.t = sign, int(time * 1e6 + 0.5)
    pixels.number[n] += 1
