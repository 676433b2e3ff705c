"""Development: from the light of a picture to its bytes, through a sensor that is exposed by
itself.

    radiance -> electrons -> noise -> full well -> converter -> [mosaic] -> white -> tone -> bytes
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.counting import Counts, tables_of_counts
from eyas.engine.camera.exposure import ExposureConfig, ExposureState, Zones, gain_of
from eyas.engine.camera.imager import (
    Demosaicking,
    ImagerConfig,
    ImagerState,
    Spectrum,
    WhiteBalance,
)
from eyas.engine.camera.metering import Exposed, Metered, expose, meter
from eyas.engine.camera.mosaic import HALO, MARGIN, demosaicked, denoised, read_mosaic
from eyas.engine.camera.photosites import (
    Readout,
    noise_bits,
    other_bits,
    pattern_bits,
    read_out,
    readout_of,
    row_error,
)
from eyas.engine.core.errors import ConfigError
from eyas.engine.render.kernels.pixels import pack
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.engine.render.pack.light import SHOULDER, encoded_tone
from eyas.lanes import PackedBundle, exact, kernel, parallel, thread_count
from eyas.lanes.vector import (
    WIDTH,
    gather,
    greater,
    lane_numbers,
    lesser,
    load,
    store_triples,
    to_i4,
    to_u4,
)

TONE_STEPS = 16384  # Entries of the tone curve, from black to saturation

_WHITE = 1.0 / 0.71
"""Exposed radiance that saturates the sensor, where that of white paper is 1: see `TARGET`."""

_BAND = 64  # Rows that are developed at a time


def tone_of_sensor() -> NDArray[np.uint8]:
    """Return the byte for each step of what a sensor reads, 0 to saturation.

    The curve is that of pictures without a sensor, stretched so that saturation is white.
    """
    return encoded_tone(_WHITE, 1.0 - float(exact.exp(-SHOULDER * _WHITE)))


class Development:
    """The sensors of N trackers' cameras, exposed by themselves.

    What it does to a picture depends on the tracker's own pictures before it, and on nothing else:
    each picture is exposed as the meter found right for those before it. The first one of an
    episode is exposed as if the camera had long been looking at it.

    Attributes:
        exposure: Exposure times and speeds, written in place.
    """

    def __init__(
        self,
        imager: ImagerConfig,  # The sensor
        exposure: ExposureConfig,
        spectrum: Spectrum,  # What light it tells apart
        luminance: float,  # That of radiance 1 [cd/m^2]
        count: int,  # N
    ) -> None:
        self.exposure = ExposureState.create(count)
        self._imagers = ImagerState.create(count)
        self._config, self._spectrum, self._luminance = imager, spectrum, luminance
        self._exposing = exposure
        grey = spectrum is not Spectrum.COLOUR
        mosaic = Demosaicking.NONE if grey else imager.mosaic
        limits = np.array([*exposure.time, *exposure.iso])
        self._exposed = PackedBundle(Exposed(self._imagers, self.exposure, limits))
        self._work = PackedBundle(
            _Work(
                self._imagers,
                self.exposure,
                tone_of_sensor(),
                imager.bits,
                imager.binning,
                grey,
                imager.white_balance is WhiteBalance.AUTO and not grey,
                any(getattr(imager, name) != 0.0 for name in _FIXED_PATTERN),
                list(Demosaicking).index(mosaic),
                tables_of_counts(),
            )
        )
        self._sizes: dict[tuple[int, int], Zones] = {}
        self._mosaic = mosaic is not Demosaicking.NONE

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""
        self._imagers.begin(tracker, self._config, self._spectrum, self._luminance, rng)
        self.exposure.begin(tracker, self._exposing, rng)

    def expose(self, trackers: NDArray[np.integer], step: NDArray[np.int64]) -> None:
        """Set the exposure of the pictures that are drawn next.

        Before the first picture of an episode it is that of a grey card; `develop` corrects it.

        Args:
            trackers: The tracker of each picture, shape (V,).
            step: Physics steps of each tracker since its reset, shape (N,).
        """
        expose(self._exposed, trackers.astype(np.int64), step)

    def develop(
        self,
        # Mean linear red, green and blue of the exposure, shape (V, 3, H, W)
        radiance: NDArray[np.float32],
        rgb: NDArray[np.uint8],  # Written, shape (V, H, W, 3)
        trackers: NDArray[np.integer],  # As for `expose`
        step: NDArray[np.int64],
    ) -> None:
        """Write the pictures that the sensors make of some light, after `expose`.

        Raises:
            ConfigError: The pictures are less than 8 pixels wide or high.
        """
        views, _, height, width = radiance.shape
        if height < WIDTH or width < WIDTH:
            raise ConfigError(
                f"camera.imager: pictures of {width}x{height} are too small: at least 8x8"
            )
        chosen = trackers.astype(np.int64)
        workers = min(thread_count(), views)
        metered = Metered(radiance, self._zones(height, width), chosen, step)
        meter(workers, self._exposed, metered)
        bands = -(-height // _BAND)
        workers = min(thread_count(), views * bands)
        rows = min(height, _BAND) + 2 * HALO if self._mosaic else 0
        raw = np.empty((workers, rows, width + 2 * MARGIN), np.float32)
        _develop(workers, self._work, _Developed(radiance, rgb, chosen, step, bands, raw))

    def _zones(self, height: int, width: int) -> Zones:
        size = height, width
        if size not in self._sizes:
            self._sizes[size] = Zones.of(self._exposing.metering, height, width)
        return self._sizes[size]


_FIXED_PATTERN = ("dark_nonuniformity", "gain_nonuniformity", "hot_pixels")


class _Work(NamedTuple):
    """What stays the same from picture to picture."""

    imagers: ImagerState
    exposure: ExposureState
    tone: NDArray[np.uint8]
    bits: int
    binning: int
    grey: bool
    finds_white: bool
    uneven: bool  # Whether there is a fixed pattern
    mosaic: int  # Number of the demosaicking; 0: none
    counts: Counts


class _Developed(NamedTuple):
    """Pictures to develop."""

    radiance: NDArray[np.float32]
    rgb: NDArray[np.uint8]
    trackers: NDArray[np.int64]
    step: NDArray[np.int64]
    bands: int  # Of each picture
    raw: NDArray[np.float32]
    """Working memory of each worker for a mosaic, with `HALO` rows above and below a band, and
    `MARGIN` columns beside it."""


@parallel
def _develop(worker: int, workers: int, work: _Work, developed: _Developed) -> None:
    """Develop the bands whose turn is this worker's."""
    height = developed.radiance.shape[2]
    for job in range(worker, len(developed.trackers) * developed.bands, workers):
        view, band = job // developed.bands, job % developed.bands
        n = developed.trackers[view]
        setup = (work.bits, work.binning, work.grey, work.finds_white, work.uneven)
        readout = readout_of(work.imagers, work.exposure, setup, n, developed.step[n])
        first, last = band * _BAND, min((band + 1) * _BAND, height)
        if work.mosaic > 0:
            raw = developed.raw[worker]
            read_mosaic(readout, developed.radiance, view, (first, last), work.counts, raw)
            gain = gain_of(work.imagers, work.exposure, n)
            strength = f4(min(max((gain - 4.0) / 12.0, 0.0), 1.0))
            grain = f4(6.0 * gain / work.imagers.full_well[n])
            _develop_mosaic(work, developed, view, (first, last), raw, (strength, grain))
        elif work.grey:
            _develop_grey(work, developed, readout, view, first, last)
        else:
            _develop_colours(work, developed, readout, view, first, last)


@kernel(inline=True)
def _byte(tone: NDArray[np.uint8], value: float) -> int:
    """Return the byte for a value, 1 at saturation; not a number becomes black."""
    step = lesser(greater(value, f4(0.0)), f4(1.0)) * f4(TONE_STEPS - 1)
    byte: int = gather(tone, to_i4(step + f4(0.5)))
    return byte


@kernel
def _develop_colours(
    work: _Work, developed: _Developed, readout: Readout, view: int, first: int, last: int
) -> None:
    """Develop some rows of a picture of which each pixel has a photosite of each colour."""
    radiance, tone = developed.radiance, work.tone
    height, width = radiance.shape[2], radiance.shape[3]
    plane = height * width
    for row in range(first, last):
        common = row_error(readout, row)
        for start in range(0, width, WIDTH):
            # The last eight overlap those before them: they are computed again, alike.
            pixel = row * width + min(start, width - WIDTH)
            at = 3 * view * plane + pixel
            index = to_u4(lane_numbers() + i4(pixel))
            red = load(radiance, at) * readout.electrons[0]
            green = load(radiance, at + plane) * readout.electrons[1]
            blue = load(radiance, at + 2 * plane) * readout.electrons[2]
            noise, pattern = noise_bits(readout, index), pattern_bits(readout, index)
            red = read_out(readout, red, noise, pattern, common, work.counts)
            noise, pattern = other_bits(noise), other_bits(pattern)
            green = read_out(readout, green, noise, pattern, common, work.counts)
            noise, pattern = other_bits(noise), other_bits(pattern)
            blue = read_out(readout, blue, noise, pattern, common, work.counts)
            packed = pack(
                _byte(tone, red * readout.balance[0]),
                _byte(tone, green * readout.balance[1]),
                _byte(tone, blue * readout.balance[2]),
            )
            store_triples(developed.rgb, 3 * (view * plane + pixel), packed)


@kernel
def _develop_grey(
    work: _Work, developed: _Developed, readout: Readout, view: int, first: int, last: int
) -> None:
    """Develop some rows of a picture of a sensor without filters."""
    radiance, tone = developed.radiance, work.tone
    height, width = radiance.shape[2], radiance.shape[3]
    plane = height * width
    for row in range(first, last):
        common = row_error(readout, row)
        for start in range(0, width, WIDTH):
            pixel = row * width + min(start, width - WIDTH)
            at = 3 * view * plane + pixel
            light = load(radiance, at) * readout.electrons[0]
            light += load(radiance, at + plane) * readout.electrons[1]
            light += load(radiance, at + 2 * plane) * readout.electrons[2]
            index = to_u4(lane_numbers() + i4(pixel))
            noise, pattern = noise_bits(readout, index), pattern_bits(readout, index)
            value = read_out(readout, light, noise, pattern, common, work.counts)
            byte = _byte(tone, value * readout.balance[0])
            store_triples(developed.rgb, 3 * (view * plane + pixel), pack(byte, byte, byte))


@kernel
def _develop_mosaic(
    work: _Work,
    developed: _Developed,
    view: int,
    rows: tuple[int, int],  # First, and after the last
    raw: NDArray[np.float32],
    noise: tuple[float, float],  # Strength of the filter, and the grain; see `denoised`
) -> None:
    """Develop some rows of a picture behind a mosaic, whose photosites have been read."""
    (first, last), (strength, grain) = rows, noise
    height, width = developed.radiance.shape[2], developed.radiance.shape[3]
    tone, malvar = work.tone, work.mosaic == 2
    for row in range(first, last):
        for start in range(0, width, WIDTH):
            column = min(start, width - WIDTH)
            colours = demosaicked(raw, row, row - first, column, malvar)
            if strength > f4(0.0):
                colours = denoised(raw, row, row - first, column, colours, strength, grain)
            packed = pack(_byte(tone, colours[0]), _byte(tone, colours[1]), _byte(tone, colours[2]))
            at = 3 * ((view * height + row) * width + column)
            store_triples(developed.rgb, at, packed)
