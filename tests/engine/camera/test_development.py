"""The chain from light to bytes: electrons, noise, clipping, exposure, mosaic."""

import numpy as np
import pytest
from scipy import ndimage

from eyas.engine.camera.development import TONE_STEPS, Development, tone_of_sensor
from eyas.engine.camera.exposure import ExposureConfig, Metering
from eyas.engine.camera.imager import ImagerConfig, Spectrum
from eyas.engine.core.errors import ConfigError
from eyas.lanes import limit_threads, thread_count

SUN = 30000.0
"""Luminance of white paper in the sun [cd/m^2]."""

NOISELESS = {
    "read_noise": 0.0,
    "dark_current": 0.0,
    "dark_nonuniformity": 0.0,
    "gain_nonuniformity": 0.0,
    "row_noise": 0.0,
    "bits": 14,
}
SMOOTH = NOISELESS | {"binning": 4096}


def fixed(time=0.001, iso=100.0):
    return ExposureConfig(time=(time, time), iso=(iso, iso))


def automatic(**settings):
    """Return an exposure that no limit holds back."""
    return ExposureConfig(**{"time": (1e-6, 0.02), "iso": (1.0, 1e6)} | settings)


def developed(radiance, exposure=None, luminance=SUN, spectrum=Spectrum.COLOUR, **imager):
    """Return pictures of some light by trackers of their own, and what made them."""
    count = len(radiance)
    development = Development(
        ImagerConfig(**imager), exposure or ExposureConfig(), spectrum, luminance, count
    )
    for n in range(count):
        development.begin(n, np.random.default_rng(n))
    return drawn(development, radiance, 0), development


def drawn(development, radiance, step, trackers=None):
    trackers = np.arange(len(radiance)) if trackers is None else trackers
    rgb = np.zeros((*radiance.shape[:1], *radiance.shape[2:], 3), np.uint8)
    steps = np.full(len(development.exposure.step), step)
    development.expose(trackers, steps)
    development.develop(radiance, rgb, trackers, steps)
    return rgb


def uniform(level, views=1, height=16, width=16):
    return np.full((views, 3, height, width), level, np.float32)


def values_of(rgb):
    """Return the share of saturation that bytes stand for, the middle of all that give them."""
    table = tone_of_sensor()
    step = [np.flatnonzero(table == byte).mean() for byte in range(256)]
    return (np.array(step) / (TONE_STEPS - 1))[rgb]


def electrons_of(radiance, seconds, luminance=SUN, efficiency=0.52):
    """By hand, for the default lens and photosite: lux, photons of 555 nm, electrons."""
    lux = np.pi / 4 * 0.9 * luminance * radiance / 2.8**2
    joule = 6.62607015e-34 * 2.99792458e8 / 555e-9
    return lux * seconds / 683.0 * (1.55e-6) ** 2 / joule * efficiency


def test_the_mean_is_linear_in_time_and_gain_until_it_clips():
    base = 78.0 * electrons_of(1.0, 1.0) / (np.pi / 4 * 0.9 * SUN / 2.8**2) / 5000.0
    for time, gain in [(5e-5, 1.0), (1e-4, 1.0), (2e-4, 1.0), (5e-5, 4.0), (2e-4, 2.0)]:
        rgb, _ = developed(uniform(0.4), fixed(time, base * gain), **SMOOTH)
        expected = electrons_of(0.4, time) * gain / 5000.0
        assert 0.02 < expected < 0.9
        np.testing.assert_allclose(values_of(rgb), expected, rtol=0.015)


@pytest.mark.parametrize("level", [0.02, 0.1, 0.3])
@pytest.mark.parametrize("binning", [1, 4])
def test_the_variance_is_that_of_photon_transfer(level, binning):
    # EMVA 1288, equation 10: counting light and dark, reading, and rounding.
    imager = NOISELESS | {"read_noise": 4.0, "dark_current": 3000.0, "binning": binning}
    rgb, made = developed(
        uniform(level, 1000), fixed(0.01, 3200.0), luminance=25.0, **(imager | {"bits": 10})
    )
    gain = float(made.exposure.iso[0]) / 80.4
    seen = values_of(rgb[..., 1]) * 5000.0 / gain
    light, dark, step = electrons_of(level, 0.01, 25.0), 30.0, 5000.0 / 1023 / gain
    expected = (light + dark + 4.0**2) / binning + (step / binning) ** 2 / 12
    clipped = np.sqrt(expected) * 3 > light  # below black, noise is cut off
    assert clipped == (level == 0.02 or (level == 0.1 and binning == 1))
    if not clipped:
        assert seen.mean() == pytest.approx(light, rel=0.01)
        assert seen.var() == pytest.approx(expected, rel=0.02)
    else:
        assert seen.mean() > light
        assert seen.var() < expected


@pytest.mark.parametrize("mean", [0.1, 0.7, 3.0, 11.5])
@pytest.mark.parametrize("binning", [1, 4])
def test_few_electrons_are_counted_as_by_poisson(mean, binning):
    from scipy import stats  # which takes half a second to import

    time = mean / binning / electrons_of(1.0, 1.0, 3.0)
    gain = 80.0 * binning
    imager = NOISELESS | {"binning": binning}
    rgb, made = developed(uniform(1.0, 200), fixed(time, 80.3816 * gain), 3.0, **imager)
    assert made.exposure.time[0] == pytest.approx(time)
    seen = np.rint(values_of(rgb[..., 1]) * 5000.0 / gain * binning).astype(int)
    share = stats.poisson(mean).pmf(np.arange(40))
    assert np.bincount(seen.ravel(), minlength=40) / seen.size == pytest.approx(share, abs=0.006)
    assert seen.mean() == pytest.approx(mean, rel=0.015)
    assert seen.var() == pytest.approx(mean, rel=0.02)
    assert stats.skew(seen, axis=None) == pytest.approx(mean**-0.5, rel=0.05)
    others = [(rgb[..., 0], rgb[..., 1]), (rgb[:, 1:], rgb[:, :-1]), (rgb[1:], rgb[:-1])]
    assert all(abs(np.corrcoef(a.ravel(), b.ravel())[0, 1]) < 0.02 for a, b in others)


def test_noise_of_colours_pixels_pictures_and_trackers_is_unrelated():
    rgb, made = developed(uniform(0.3, 8, 64, 64), fixed(0.01, 1600.0), 10.0, **NOISELESS)
    later = drawn(made, uniform(0.3, 8, 64, 64), 1)
    values = values_of(rgb)
    pairs = [
        (values[..., 0], values[..., 1]),
        (values[..., 0], values[..., 2]),
        (values[..., 1], values[..., 2]),
        (values[:, 1:], values[:, :-1]),
        (values[:, :, 1:], values[:, :, :-1]),
        (values[:, :, 8:], values[:, :, :-8]),
        (values[1:], values[:-1]),
        (values, values_of(later)),
    ]
    for one, other in pairs:
        assert abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 0.025


def test_row_noise_is_shared_by_a_row_and_differs_from_row_to_row():
    imager = SMOOTH | {"row_noise": 20.0 * 4096**0.25}
    rgb, _ = developed(uniform(0.3, 1, 256, 8), fixed(1e-4), **imager)
    rows = values_of(rgb[0, :, :, 1])
    assert np.ptp(rows, axis=1).max() < 0.01
    assert rows[:, 0].std() * 5000 / (100 / 80.4) == pytest.approx(20.0, rel=0.15)


def test_the_fixed_pattern_stays_for_an_episode():
    imager = NOISELESS | {"gain_nonuniformity": 0.5, "binning": 100}
    light = uniform(0.2, 2, 64, 64)
    rgb, made = developed(light, fixed(1e-4), **imager)
    later = drawn(made, light, 500)
    first, second = values_of(rgb), values_of(later)
    deviation = first[0].std() / first[0].mean()
    assert deviation == pytest.approx(0.05, rel=0.1)
    assert np.corrcoef(first[0].ravel(), second[0].ravel())[0, 1] > 0.9
    assert abs(np.corrcoef(first[0].ravel(), first[1].ravel())[0, 1]) < 0.05


def test_a_full_well_is_white_and_no_light_is_black():
    light = np.concatenate((uniform(0.0), uniform(1e9), uniform(np.inf), uniform(np.nan)))
    rgb, _ = developed(light, fixed(), **SMOOTH)
    assert [int(picture.min()) for picture in rgb] == [0, 255, 255, 0]
    assert [int(picture.max()) for picture in rgb] == [0, 255, 255, 0]


def test_white_stays_white_through_unequal_filters():
    rgb, _ = developed(uniform(0.5), fixed(2e-4), quantum_efficiency=(0.3, 0.6, 0.2), **SMOOTH)
    assert np.ptp(rgb) <= 1


@pytest.mark.parametrize("metering", Metering)
def test_the_first_picture_of_an_episode_is_well_exposed(metering):
    light = np.random.default_rng(1).uniform(0.0, 0.6, (4, 3, 40, 44)).astype(np.float32)
    light *= np.array([1e-3, 0.1, 1.0, 3.0], np.float32)[:, None, None, None]
    exposure = automatic(metering=metering)
    rgb, _ = developed(light, exposure, **SMOOTH)
    means = values_of(rgb).mean(axis=(1, 2, 3))
    np.testing.assert_allclose(means, 10 / 78, rtol=0.02 if metering is Metering.AVERAGE else 0.3)


def test_spot_and_centre_look_at_the_middle():
    light = uniform(0.05, 1, 64, 64)
    light[..., 30:34, 30:34] = 1.0
    means = {}
    for metering in Metering:
        rgb, _ = developed(light, automatic(metering=metering), **SMOOTH)
        means[metering] = values_of(rgb).mean()
    assert means[Metering.SPOT] < 0.3 * means[Metering.CENTRE] < 0.3 * means[Metering.AVERAGE]
    assert means[Metering.AVERAGE] == pytest.approx(10 / 78, rel=0.02)


def test_exposure_follows_a_change_of_light_with_its_speed():
    exposure = automatic(speed=0.5, metering=Metering.AVERAGE)
    _, made = developed(uniform(0.4), exposure, **SMOOTH)
    before = made.exposure.value[0]
    drawn(made, uniform(0.2), 250)  # half a second later the light is half of what it was
    assert made.exposure.value[0] == pytest.approx(before, abs=1e-3)  # not yet metered
    for step, left in [(500, np.exp(-1)), (750, np.exp(-2)), (1250, np.exp(-4))]:
        drawn(made, uniform(0.2), step)
        assert made.exposure.value[0] == pytest.approx(before + 1 - left, abs=2e-3)


def test_a_flood_of_light_blinds_for_a_moment():
    exposure = automatic(speed=0.3, metering=Metering.AVERAGE)
    rgb, made = developed(uniform(0.002), exposure, **SMOOTH)
    assert 100 < rgb.mean() < 160
    shown = [drawn(made, uniform(0.5), step).mean() for step in range(50, 1500, 50)]
    assert shown[0] == 255.0
    assert 100 < shown[-1] < 160
    assert sorted(shown, reverse=True) == shown


def test_time_comes_before_gain_and_both_end_at_their_limits():
    exposure = ExposureConfig(time=(1e-4, 0.01), iso=(100.0, 1600.0), speed=0.0)
    levels = [30.0, 0.3, 0.03, 0.001, 0.0001]
    times, speeds = [], []
    for level in levels:
        _, made = developed(uniform(level), exposure, luminance=3000.0, **SMOOTH)
        times.append(float(made.exposure.time[0]))
        speeds.append(float(made.exposure.iso[0]))
    assert times == pytest.approx([1e-4, times[1], 0.01, 0.01, 0.01])
    assert speeds == pytest.approx([100.0, 100.0, speeds[2], 1600.0, 1600.0])
    assert 1e-4 < times[1] < 0.01
    assert 100.0 < speeds[2] < 1600.0


def test_compensation_and_automatic_white_balance():
    exposure = automatic(compensation=1.0, metering=Metering.AVERAGE)
    rgb, _ = developed(uniform(0.3), exposure, **SMOOTH)
    assert values_of(rgb).mean() == pytest.approx(20 / 78, rel=0.02)
    light = uniform(0.3)
    light[:, 0] *= 1.5
    light[:, 2] *= 0.6
    plain, _ = developed(light, **SMOOTH)
    found, _ = developed(light, white_balance="auto", **SMOOTH)
    assert np.ptp(plain.mean(axis=(0, 1, 2))) > 30
    assert np.ptp(found.mean(axis=(0, 1, 2))) < 3


def test_a_grey_sensor_gathers_what_filters_take_away():
    light, noise = uniform(0.3, 40), {}
    for spectrum in Spectrum:
        rgb, _ = developed(
            light, fixed(0.01, 3200.0), luminance=10.0, spectrum=spectrum, **NOISELESS
        )
        assert spectrum is Spectrum.COLOUR or (rgb == rgb[..., :1]).all()
        values = values_of(rgb[..., 1])
        noise[spectrum] = values.std() / values.mean()
    seen = {Spectrum.COLOUR: 0.52, Spectrum.GREY: 0.40 + 0.52 + 0.42}
    for spectrum, efficiency in seen.items():
        counted = electrons_of(0.3, 0.01, 10.0, efficiency)
        assert noise[spectrum] == pytest.approx(1 / np.sqrt(counted), rel=0.03)


@pytest.mark.parametrize("size", [(84, 84), (30, 43), (150, 24)])
@pytest.mark.parametrize("mosaic", ["none", "malvar"])
def test_bytes_depend_on_nothing_but_the_tracker(size, mosaic):
    light = np.random.default_rng(2).uniform(0, 1, (5, 3, *size)).astype(np.float32)
    together, made = developed(light, mosaic=mosaic)
    again = drawn(made, light, 0)
    np.testing.assert_array_equal(together, again)
    assert (drawn(made, light, 1) != together).any()
    threads = thread_count()
    _, alone = developed(light, mosaic=mosaic)
    try:
        limit_threads(1)
        for n in (4, 0, 2):
            picture = drawn(alone, light[n : n + 1], 1, np.array([n]))
            np.testing.assert_array_equal(picture[0], drawn(made, light, 1)[n])
    finally:
        limit_threads(threads)


def test_a_mosaic_of_high_gain_keeps_no_confetti():
    dim = uniform(0.1, 1, 64, 64)
    spread = []
    for mosaic in ("none", "bilinear"):
        rgb, _ = developed(dim, fixed(0.01, 3200.0), luminance=10.0, mosaic=mosaic)
        colours = rgb[0].astype(float)
        spread.append((np.ptp(colours, axis=2).mean(), colours.mean(axis=2).std()))
    (confetti, grain), (left, kept) = spread
    assert left < 0.35 * confetti
    assert 0.3 * grain < kept < grain


def test_malvar_and_bilinear_are_the_published_filters():
    light = np.random.default_rng(3).uniform(0.1, 0.5, (1, 3, 70, 41)).astype(np.float32)
    light = ndimage.gaussian_filter(light, (0, 0, 1, 1))
    rows, columns = np.indices(light.shape[2:])
    channel = (rows & 1) + (columns & 1)
    raw = np.choose(channel, light[0])
    for mosaic, filters in (("bilinear", BILINEAR), ("malvar", MALVAR)):
        rgb, _ = developed(light, fixed(1e-4), mosaic=mosaic, **SMOOTH)
        scale = electrons_of(1.0, 1e-4) * (100.0 / 80.4) / 5000.0
        expected = _demosaicked(raw, filters) * scale
        np.testing.assert_allclose(values_of(rgb[0]), expected, atol=0.006)


BILINEAR = {
    "cross": np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]]) / 4,
    "across": np.array([[0, 0, 0], [1, 0, 1], [0, 0, 0]]) / 2,
    "diagonal": np.array([[1, 0, 1], [0, 0, 0], [1, 0, 1]]) / 4,
}
MALVAR = {
    "cross": np.array(
        [[0, 0, -1, 0, 0], [0, 0, 2, 0, 0], [-1, 2, 4, 2, -1], [0, 0, 2, 0, 0], [0, 0, -1, 0, 0]]
    )
    / 8,
    "across": np.array(
        [
            [0, 0, 0.5, 0, 0],
            [0, -1, 0, -1, 0],
            [-1, 4, 5, 4, -1],
            [0, -1, 0, -1, 0],
            [0, 0, 0.5, 0, 0],
        ]
    )
    / 8,
    "diagonal": np.array(
        [
            [0, 0, -1.5, 0, 0],
            [0, 2, 0, 2, 0],
            [-1.5, 0, 6, 0, -1.5],
            [0, 2, 0, 2, 0],
            [0, 0, -1.5, 0, 0],
        ]
    )
    / 8,
}
"""Malvar, He and Cutler, 2004, figure 2."""


def _demosaicked(raw, filters):
    made = {
        name: ndimage.correlate(raw.astype(np.float64), kernel, mode="mirror")
        for name, kernel in filters.items()
    }
    made["down"] = ndimage.correlate(raw.astype(np.float64), filters["across"].T, mode="mirror")
    rows, columns = np.indices(raw.shape)
    place = 2 * (rows & 1) + (columns & 1)
    names = {  # at red, green beside red, green beside blue, blue
        0: ("own", "across", "down", "diagonal"),
        1: ("cross", "own", "own", "cross"),
        2: ("diagonal", "down", "across", "own"),
    }
    made["own"] = raw
    return np.stack([np.choose(place, [made[n] for n in names[c]]) for c in range(3)], axis=-1)


def test_pictures_that_are_too_small_are_refused():
    with pytest.raises(ConfigError, match="at least 8x8"):
        developed(uniform(0.1, 1, 8, 6))
    with pytest.raises(ConfigError, match=r"time: .* ascending"):
        ExposureConfig(time=(0.1, 0.01))


def test_hot_pixels_are_as_many_as_said_and_stay():
    light = uniform(0.05, height=64, width=64)
    sensor = developed(light, fixed(), hot_pixels=0.1)[1]
    hot = [drawn(sensor, light, step).max(axis=-1)[0] > 240 for step in (1, 2)]
    assert hot[0].mean() == pytest.approx(1.0 - 0.9**3, abs=0.02)  # in each of three colours
    assert (hot[0] == hot[1]).mean() > 0.99
    assert not (developed(light, fixed())[0] > 240).any()
