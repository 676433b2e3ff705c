"""Seamless fields of noise, shape (256, 256), that repeat at their edges."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

SIZE = 256  # Pixels on each side of a texture

Field = NDArray[np.float64]


def source(name: str) -> np.random.Generator:
    """Return the random numbers of a texture: always the same for one name."""
    key = int.from_bytes(name.encode()[:16].ljust(16, b"."), "little")
    return np.random.Generator(np.random.PCG64(key))


def white(rng: np.random.Generator) -> Field:
    """Return an independent value for each pixel, mean 0, deviation 1."""
    return np.asarray(exact.normal(rng, size=(SIZE, SIZE)), np.float64)


def fractal(
    rng: np.random.Generator,  # Random numbers of the texture
    slope: float,  # 0 is white noise, 1 is cloudy, 2 is smooth
    *,
    longest: float = 256.0,  # Longest wave [pixels]; a short limit hides that the texture repeats
    stretch: tuple[float, float] = (1.0, 1.0),  # Factors on the length of features in y and x
) -> Field:
    """Return cloudy noise, mean 0, deviation 1, amplitude proportional to frequency^-`slope`."""
    frequency, gain = _fall(slope, stretch)
    gain = gain * (1.0 / (1.0 + exact.power(1.0 / (frequency * longest), 6)))
    gain[0, 0] = 0.0
    field = np.fft.irfft2(np.fft.rfft2(white(rng)) * gain, (SIZE, SIZE))
    return np.asarray(field / field.std(), np.float64)


@lru_cache(maxsize=16)  # most textures have a few of the same, one after the other
def _fall(slope: float, stretch: tuple[float, float]) -> tuple[Field, Field]:
    """Return the frequencies of a field [1/pixel], at least 1e-9, and its amplitudes at them."""
    frequency_y = np.fft.fftfreq(SIZE)[:, None] * stretch[0]
    frequency_x = np.fft.rfftfreq(SIZE)[None] * stretch[1]
    frequency = np.maximum(exact.hypot(frequency_y, frequency_x), 1e-9)
    return frequency, exact.power(frequency, -slope)


def blurred(field: Field, radius: float) -> Field:
    """Return a field smoothed by a Gaussian of standard deviation `radius` [pixels]."""
    y = np.fft.fftfreq(SIZE)[:, None]
    x = np.fft.rfftfreq(SIZE)[None]
    gain = exact.exp(-2 * np.square(np.pi * radius) * (np.square(x) + np.square(y)))
    return np.fft.irfft2(np.fft.rfft2(field) * gain, (SIZE, SIZE))
