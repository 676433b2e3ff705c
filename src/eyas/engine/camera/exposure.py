"""Automatic exposure: how long the light is gathered, and how far it is amplified."""

from enum import StrEnum
from typing import Annotated, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, model_validator

from eyas.engine.camera.imager import SATURATION, ImagerState
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.config import Config
from eyas.engine.core.variation import Variation, sample, within
from eyas.lanes import exact, kernel
from eyas.lanes.elementary import exp, log
from eyas.lanes.vector import WIDTH

TARGET = 10.0 / SATURATION
"""Mean that is aimed at, as a share of saturation: a mean exposure of 10 / S lux seconds on the
sensor (ISO 12232:2019, 6.3). White paper then reaches 0.71 of saturation."""

GUESS = 0.18  # Mean radiance that is expected before the first picture: a grey card's

_LN2 = 0.6931471805599453

_DARKEST = 1e-7  # Least share of saturation that is told from nothing

Seconds = Annotated[float, Field(ge=1e-6, le=10)]
Speed = Annotated[float, Field(ge=1, le=1e7)]


class Metering(StrEnum):
    """What part of the picture decides the exposure."""

    AVERAGE = "average"
    CENTRE = "centre"
    SPOT = "spot"


class ExposureConfig(Config):
    """Automatic exposure: first a longer time, then a higher gain; equal limits fix a value."""

    time: tuple[Seconds, Seconds] = (1.0 / 8000.0, 1.0 / 50.0)
    """Shortest and longest exposure [s]."""
    iso: tuple[Speed, Speed] = (100.0, 3200.0)
    """Lowest and highest speed (ISO 12232); none is below that of the sensor without gain."""
    metering: Metering = Metering.CENTRE
    """What part of the picture decides: the whole, weighted towards the middle, or a tenth of its
    width and height in the middle."""
    speed: Annotated[Variation, AfterValidator(within(0.0, 100.0))] = 0.4
    """Time in which a wrong exposure comes nearer to the right one by 63 % [s]; 0: the next
    picture is right."""
    compensation: Annotated[Variation, AfterValidator(within(-10.0, 10.0))] = 0.0
    """Brighter than the meter says, in steps of a factor of 2 [EV]."""

    @model_validator(mode="after")
    def _limits_in_order(self) -> Self:
        for name in ("time", "iso"):
            low, high = getattr(self, name)
            if low > high:
                raise ValueError(f"{name} must be two numbers in ascending order")
        return self


class ExposureState(NamedTuple):
    """The automatic exposure of N trackers; all of shape (N,) but the tint."""

    step: NDArray[np.int64]
    """Physics step, since the reset, of the picture that it was set for; -1: none yet."""
    metered: NDArray[np.int64]  # The step of the last picture that was metered; -1: none yet
    value: NDArray[np.float64]  # Logarithm to base 2 of time [s] times gain
    error: NDArray[np.float64]  # What the meter wants added to it
    speed: NDArray[np.float64]  # [s]
    target: NDArray[np.float64]  # Mean that is aimed at, as a share of saturation
    time: NDArray[np.float64]  # Exposure time [s]
    iso: NDArray[np.float64]  # Speed (ISO 12232)
    tint: NDArray[np.float64]
    """Logarithms to base 2 of the factors on red and blue of the white balance, and what the
    meter wants added to them, shape (N, 4)."""

    @classmethod
    def create(cls, count: int) -> "ExposureState":
        """Return the state before the first episode."""
        none, zero = np.full(count, -1, np.int64), np.zeros(count)
        return cls(
            step=none,
            metered=none.copy(),
            value=zero,
            error=zero.copy(),
            speed=zero.copy(),
            target=zero.copy(),
            time=zero.copy(),
            iso=zero.copy(),
            tint=np.zeros((count, 4)),
        )

    def begin(self, tracker: int, config: ExposureConfig, rng: np.random.Generator) -> None:
        """Begin an episode: its first picture will be well exposed."""
        self.step[tracker] = self.metered[tracker] = -1
        self.error[tracker] = 0.0
        self.tint[tracker] = 0.0
        self.speed[tracker] = sample(config.speed, rng)
        self.target[tracker] = TARGET * exact.power(2.0, float(sample(config.compensation, rng)))


@kernel(inline=True)
def gain_of(imagers: ImagerState, state: ExposureState, n: int) -> float:
    """Return the gain of tracker `n`, 1 for the sensor's own speed."""
    return float(state.iso[n] / imagers.base_iso[n])


@kernel
def _set(
    state: ExposureState, imagers: ImagerState, limits: NDArray[np.float64], n: int, value: float
) -> None:
    """Set time and gain of tracker `n` to a value within their limits."""
    base = imagers.base_iso[n]
    least = max(limits[2] / base, 1.0)
    most = max(limits[3] / base, least)
    gathered = exp(value * _LN2)
    gathered = min(max(gathered, limits[0] * least), limits[1] * most)
    time = min(max(gathered / least, limits[0]), limits[1])
    state.time[n] = time
    state.iso[n] = base * min(max(gathered / time, least), most)
    state.value[n] = log(gathered) / _LN2


@kernel
def _begin(state: ExposureState, imagers: ImagerState, limits: NDArray[np.float64], n: int) -> None:
    """Expose for a grey card."""
    level = GUESS * imagers.white[n] / imagers.full_well[n]
    _set(state, imagers, limits, n, log(state.target[n] / level) / _LN2)


@kernel
def follow_meter(
    state: ExposureState, imagers: ImagerState, limits: NDArray[np.float64], n: int, share: float
) -> None:
    """Make a share of the change that the meter wants."""
    _set(state, imagers, limits, n, state.value[n] + share * state.error[n])
    for channel in range(2):
        state.tint[n, channel] += share * state.tint[n, channel + 2]


@kernel
def advance_exposure(
    state: ExposureState, imagers: ImagerState, limits: NDArray[np.float64], n: int, step: int
) -> None:
    """Let the exposure of tracker `n` follow the meter up to a physics step.

    A picture that is drawn again, and one of the past, leave it as it is.
    """
    if state.step[n] < 0:
        _begin(state, imagers, limits, n)
    elif step > state.step[n]:
        share, speed = 1.0, state.speed[n]
        if speed > 0.0:
            share = 1.0 - exp(-(step - state.step[n]) * PHYSICS_STEP / speed)
        follow_meter(state, imagers, limits, n, share)
    else:
        return
    state.step[n] = step


@kernel
def answer_meter(
    state: ExposureState,
    n: int,  # The tracker
    # Mean of the picture as a share of saturation, and of its red, green and blue
    mean: tuple[float, float, float, float],
) -> None:
    """Note what the meter wants changed."""
    state.error[n] = log(state.target[n] / max(mean[0], _DARKEST)) / _LN2
    green = max(mean[2], _DARKEST)
    for channel in range(2):
        other = max(mean[1] if channel == 0 else mean[3], _DARKEST)
        wanted = min(max(log(green / other) / _LN2, -2.0), 2.0)
        state.tint[n, channel + 2] = wanted - state.tint[n, channel]


class Zones(NamedTuple):
    """How much each row and column of a picture count for the meter; pixels have the product."""

    rows: NDArray[np.float32]  # Shape (H,)
    columns: NDArray[np.float32]
    """Of eight columns in a row, one after the other; the last eight are the picture's last, and
    count for nothing where others hold them. Shape (W rounded up to a multiple of eight,)."""

    @classmethod
    def of(cls, metering: Metering, height: int, width: int) -> "Zones":
        """Return the zones of pictures of a size."""
        return cls(_weights(metering, height), _in_eights(_weights(metering, width)))


def _weights(metering: Metering, count: int) -> NDArray[np.float32]:
    """Return weights along an axis of a picture: in the middle 1."""
    place = np.abs((np.arange(count) + 0.5) / count - 0.5)
    match metering:
        case Metering.SPOT:
            inside = place <= max(0.05, 0.5 / count)
            return inside.astype(np.float32)
        case Metering.CENTRE:
            weights: NDArray[np.float32] = exact.exp(-np.square(place / 0.3)).astype(np.float32)
            return weights
        case _:
            return np.ones(count, np.float32)


def _in_eights(weights: NDArray[np.float32]) -> NDArray[np.float32]:
    whole, rest = len(weights) // WIDTH * WIDTH, len(weights) % WIDTH
    if rest == 0:
        return weights
    last = weights[-WIDTH:].copy()
    last[:-rest] = 0.0
    return np.concatenate((weights[:whole], last))
