"""The image sensor: its settings, and what they mean in electrons.

The model is that of EMVA 1288 (release 4.0, Linear): light frees electrons in photosites, with the
noise of counting them; what is dark adds its own, a readout adds noise, and a converter rounds.
"""

import math
from enum import StrEnum
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field

from eyas.engine.core.config import Config
from eyas.engine.core.counter_rng import SEEDS
from eyas.engine.core.variation import Variation, sample, within

PHOTONS = 4.089e3
"""Photons of one lux in one second on one square micrometre: 1/683 W/m^2 at 555 nm."""

SATURATION = 78.0
"""Exposure that saturates a sensor, times its speed [lux s] (ISO 12232:2019, 6.2)."""

Efficiency = Annotated[float, Field(gt=0, le=1)]


class Spectrum(StrEnum):
    """What light a sensor tells apart."""

    COLOUR = "colour"
    GREY = "grey"
    NEAR_INFRARED = "near-infrared"
    THERMAL = "thermal"


class Demosaicking(StrEnum):
    """How the two missing colours of each photosite behind a Bayer mosaic are found."""

    NONE = "none"
    BILINEAR = "bilinear"
    MALVAR = "malvar"


class WhiteBalance(StrEnum):
    """What is taken for white."""

    DAYLIGHT = "daylight"
    AUTO = "auto"


class ImagerConfig(Config):
    """A sensor and its readout; by default the colour sensor of a small drone, 1/2.3 inch."""

    f_number: Annotated[Variation, AfterValidator(within(0.7, 32.0))] = 2.8
    """Focal length over the diameter of the lens; the iris does not move."""
    transmission: Annotated[float, Field(gt=0, le=1)] = 0.9
    """Share of the light that passes the lens."""
    pixel_pitch: Annotated[Variation, AfterValidator(within(0.5, 50.0))] = 1.55
    """Side of a photosite [micrometres]."""
    quantum_efficiency: tuple[Efficiency, Efficiency, Efficiency] = (0.40, 0.52, 0.42)
    """Electrons for each photon, behind the red, the green and the blue filter."""
    full_well: Annotated[Variation, AfterValidator(within(100.0, 1e6))] = 5000.0
    """Electrons that a photosite holds."""
    read_noise: Annotated[Variation, AfterValidator(within(0.0, 1000.0))] = 2.5
    """Standard deviation of a reading [electrons]."""
    dark_current: Annotated[Variation, AfterValidator(within(0.0, 1e5))] = 6.0
    """Electrons that gather in a second without light, at the sensor's temperature."""
    dark_nonuniformity: Annotated[Variation, AfterValidator(within(0.0, 1000.0))] = 0.7
    """Standard deviation of the dark level from photosite to photosite (DSNU) [electrons]."""
    gain_nonuniformity: Annotated[Variation, AfterValidator(within(0.0, 0.5))] = 0.01
    """Standard deviation of the sensitivity from photosite to photosite (PRNU), as a share."""
    row_noise: Annotated[Variation, AfterValidator(within(0.0, 1000.0))] = 0.25
    """Standard deviation that all readings of a row share [electrons]."""
    hot_pixels: Annotated[Variation, AfterValidator(within(0.0, 1.0))] = 0.0
    """Share of photosites that are broken, and read as full."""
    bits: Annotated[int, Field(ge=6, le=16)] = 10
    """Bits of the converter."""
    binning: Annotated[int, Field(ge=1, le=4096)] = 1
    """Photosites whose readings are averaged for each colour of a pixel; 1: the readout skips the
    others."""
    mosaic: Demosaicking = Demosaicking.NONE
    """How colours are found behind a Bayer mosaic with one photosite for each pixel; `none`: each
    pixel has a photosite of each colour."""
    white_balance: WhiteBalance = WhiteBalance.DAYLIGHT
    """`daylight`: white is what is white in the sun; `auto`: the mean of the picture is made grey,
    with the speed of `camera.exposure`."""


class ImagerState(NamedTuple):
    """The sensors of N trackers: what is sampled for each episode, and what follows from it."""

    electrons: NDArray[np.float64]
    """Electrons in a second for radiance 1 in red, green and blue, shape (N, 3)."""
    white: NDArray[np.float64]
    """Electrons in a second for radiance 1 in the photosites that fill first, shape (N,), as all
    below."""
    full_well: NDArray[np.float64]
    read_noise: NDArray[np.float64]
    dark_current: NDArray[np.float64]
    dark_nonuniformity: NDArray[np.float64]
    gain_nonuniformity: NDArray[np.float64]
    row_noise: NDArray[np.float64]
    hot_pixels: NDArray[np.float64]
    base_iso: NDArray[np.float64]
    """Speed at gain 1, which turns a full well into the largest number."""
    fixed_seed: NDArray[np.int64]  # Seed of the fixed pattern
    noise_seed: NDArray[np.int64]  # Seed of what differs from picture to picture

    @classmethod
    def create(cls, count: int) -> "ImagerState":
        """Return the state of sensors before their first episode."""
        one, none = np.ones(count), np.zeros(count, np.int64)
        return cls(
            electrons=np.ones((count, 3)),
            white=one,
            full_well=one.copy(),
            read_noise=one.copy(),
            dark_current=one.copy(),
            dark_nonuniformity=one.copy(),
            gain_nonuniformity=one.copy(),
            row_noise=one.copy(),
            hot_pixels=np.zeros(count),
            base_iso=one.copy(),
            fixed_seed=none,
            noise_seed=none.copy(),
        )

    def begin(
        self,
        tracker: int,
        config: ImagerConfig,  # The settings
        spectrum: Spectrum,  # What light it tells apart
        luminance: float,  # That of radiance 1 [cd/m^2]
        rng: np.random.Generator,  # Random numbers of the episode
    ) -> None:
        """Sample the sensor of an episode.

        Light: `E = pi/4 T L / N^2` lux on the sensor for a luminance L, by a lens of transmission T
        and f-number N (ISO 12232, without its vignetting and flare). Electrons: photons on a
        photosite times quantum efficiency (EMVA 1288, equations 1 to 3), all of them counted as if
        they had 555 nm. Speed: `S = 78 / H`, H the exposure in lux seconds that fills the well.
        """
        self.fixed_seed[tracker] = rng.integers(SEEDS)
        self.noise_seed[tracker] = rng.integers(SEEDS)
        f_number, pitch = (sample(v, rng) for v in (config.f_number, config.pixel_pitch))
        for name in _SAMPLED:
            getattr(self, name)[tracker] = sample(getattr(config, name), rng)
        by_lux = PHOTONS * pitch * pitch * np.array(config.quantum_efficiency)
        lux = 0.25 * math.pi * config.transmission * luminance / (f_number * f_number)
        self.electrons[tracker] = by_lux * lux
        of_white = by_lux.sum() if spectrum is not Spectrum.COLOUR else by_lux.max()
        self.white[tracker] = of_white * lux
        self.base_iso[tracker] = SATURATION * of_white / self.full_well[tracker]


_SAMPLED = (
    "full_well",
    "read_noise",
    "dark_current",
    "dark_nonuniformity",
    "gain_nonuniformity",
    "row_noise",
    "hot_pixels",
)
