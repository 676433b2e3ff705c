"""Photosites: from the light of a pixel to the number that is read of it."""

import math
from typing import NamedTuple

from eyas.engine.camera.counting import FEW, Counts, counted
from eyas.engine.camera.exposure import ExposureState, gain_of
from eyas.engine.camera.imager import ImagerState
from eyas.engine.core.counter_rng import mixed
from eyas.engine.render.kernels.hash_noise import scrambled
from eyas.engine.render.kernels.scalars import f4, u4
from eyas.lanes import kernel
from eyas.lanes.elementary import exp
from eyas.lanes.vector import any_of, greater, lesser, root, select, to_f4, to_i4, to_u4, whole

_DEVIATION_OF_FOUR, _DEVIATION_OF_TWO = 147.8, 104.5
"""Standard deviations of the sums of four and of two random bytes: (k (256^2 - 1) / 12)^(1/2)."""

_LN2 = 0.6931471805599453

_FULLEST = 16.0  # Light beyond so many full wells changes nothing


class Readout(NamedTuple):
    """How the photosites of a picture are exposed and read; electrons, float32."""

    electrons: tuple[float, float, float]  # Of radiance 1 in red, green and blue
    most: float  # Most electrons of light that a photosite holds beside those of the dark
    dark: float  # Electrons of the dark and variance of a reading, over the number of photosites
    unlit: float  # Electrons of the dark in a photosite
    reading: float  # Standard deviation of a reading, averaged
    share: float  # One over the number of photosites that are averaged
    sites: float  # Their number
    uneven: bool  # Whether photosites have a fixed pattern
    uneven_gain: float  # Standard deviation of the gain from photosite to photosite, averaged
    uneven_dark: float  # The same of the dark level
    hot: float  # Share of photosites that read as full
    row: float  # Standard deviation that a row shares
    steps: float  # Steps of the converter for each electron
    levels: float  # Steps at saturation
    balance: tuple[float, float, float]  # Value of a step in red, green and blue: 1 is white
    noise: int  # Seed of the picture's noise
    pattern: int  # Seed of the fixed pattern


@kernel
def readout_of(
    imagers: ImagerState,
    state: ExposureState,
    setup: tuple[int, int, bool, bool, bool],
    n: int,
    step: int,
) -> Readout:
    """Return how a picture of tracker `n` is read.

    Args:
        imagers: The sensors.
        state: Their exposures.
        setup: Bits, binning, whether the sensor is grey, whether it finds white by itself, and
            whether it has a fixed pattern.
        n: The tracker.
        step: Physics step of the picture, for its noise.
    """
    bits, binning, grey, finds_white, uneven = setup
    time, gain, sites = state.time[n], gain_of(imagers, state, n), 1.0 / binning
    red, green, blue = imagers.electrons[n, 0], imagers.electrons[n, 1], imagers.electrons[n, 2]
    dark, spread = imagers.dark_current[n] * time, math.sqrt(sites)
    brightest = imagers.white[n]
    levels = ((1 << bits) - 1.0) * binning
    # What would be white in daylight fills the wells of all channels alike.
    warm, cool = 1.0, 1.0
    if finds_white:
        warm, cool = exp(_LN2 * state.tint[n, 0]), exp(_LN2 * state.tint[n, 1])
    each = 1.0 / levels
    return Readout(
        (f4(red * time), f4(green * time), f4(blue * time)),
        f4(max(imagers.full_well[n] - dark, 0.0)),
        f4((dark + imagers.read_noise[n] * imagers.read_noise[n]) * sites),
        f4(dark),
        f4(imagers.read_noise[n] * spread / _DEVIATION_OF_FOUR),
        f4(sites),
        f4(binning),
        uneven,
        f4(imagers.gain_nonuniformity[n] * spread / _DEVIATION_OF_TWO),
        f4(imagers.dark_nonuniformity[n] * spread / _DEVIATION_OF_TWO),
        f4(imagers.hot_pixels[n]),
        # So many photosites lie in the square root of as many rows.
        f4(imagers.row_noise[n] * math.sqrt(spread) / _DEVIATION_OF_FOUR),
        f4(gain * levels / imagers.full_well[n]),
        f4(levels),
        (
            f4(each * (1.0 if grey else brightest / red) * warm),
            f4(each * (1.0 if grey else brightest / green)),
            f4(each * (1.0 if grey else brightest / blue) * cool),
        ),
        u4(mixed(mixed(imagers.noise_seed[n]) ^ (step & 0xFFFFFFFF))),
        u4(mixed(imagers.fixed_seed[n])),
    )


@kernel(inline=True)
def bell(word: int) -> float:
    """Return a nearly normal number of mean 0 and deviation 147.8 from 32 random bits."""
    pairs = to_u4((word & u4(0x00FF00FF)) + ((word >> u4(8)) & u4(0x00FF00FF)))
    total: float = to_f4(to_i4((pairs & u4(0xFFFF)) + (pairs >> u4(16))))
    return total - f4(510.0)


@kernel(inline=True)
def row_error(readout: Readout, row: int) -> float:
    """Return what a row's readings have in common [electrons]."""
    return readout.row * bell(scrambled(to_u4(readout.noise ^ u4(0xA5A5A5A5)) + u4(row)))


@kernel(inline=True)
def noise_bits(readout: Readout, index: int) -> int:
    """Return random bits of photosites by their numbers, others in each picture."""
    return scrambled(to_u4(index ^ readout.noise))


@kernel(inline=True)
def pattern_bits(readout: Readout, index: int) -> int:
    """Return random bits of photosites by their numbers, the same for an episode."""
    return scrambled(to_u4(index ^ readout.pattern))


@kernel(inline=True)
def other_bits(word: int) -> int:
    """Return other random bits made of some: of the next colour of the same pixel.

    One round of `scrambled`, for half its time; the bytes' sums are then unrelated.
    """
    bits: int = to_u4((word ^ (word >> u4(13))) * u4(0x9E3779B1))
    return bits


@kernel(inline=True)
def read_out(
    readout: Readout,  # How they are read
    electrons: float,  # Electrons that light frees in them
    noise: int,  # Random bits of this picture
    pattern: int,  # Random bits of the episode
    row: float,  # See `row_error`
    counts: Counts,  # Tables of few electrons
) -> float:
    """Return the number that is read of photosites."""
    light = lesser(greater(electrons, f4(0.0)), f4(_FULLEST) * readout.most)
    deviation = root(light * readout.share + readout.dark) * f4(1.0 / _DEVIATION_OF_FOUR)
    held = light + deviation * bell(noise)
    mean = (light + readout.unlit) * readout.sites
    few = mean <= f4(FEW)
    if any_of(few):
        count = counted(counts, lesser(mean, f4(FEW)), scrambled(noise))
        dim = count * readout.share - readout.unlit + readout.reading * bell(noise)
        held = select(few, dim, held)
    held += row
    if readout.uneven:
        pairs = to_u4((pattern & u4(0x00FF00FF)) + ((pattern >> u4(8)) & u4(0x00FF00FF)))
        held += light * (readout.uneven_gain * (to_f4(to_i4(pairs & u4(0xFFFF))) - f4(255.0)))
        held += readout.uneven_dark * (to_f4(to_i4(pairs >> u4(16))) - f4(255.0))
        if readout.hot > f4(0.0):
            drawn = to_f4(to_i4(scrambled(pattern) >> u4(8))) * f4(1.0 / (1 << 24))
            held = select(drawn < readout.hot, held + readout.most, held)
    step = whole(lesser(held, readout.most) * readout.steps + f4(0.5))
    number: float = lesser(step, readout.levels)
    return number
