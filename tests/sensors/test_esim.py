"""Events: their number, times and signs against the contrast model's equations, and its noise."""

import math

import numpy as np
import pytest

from eyas.sensors.camera.esim import (
    EVENT,
    EventPixels,
    Interval,
    fill_levels,
    log_of_light,
    most_events,
    tell_events,
)

NO_NOISE = Interval(0.0, 0.01, 16, 0.0, 0.0, 0.0, 7, 1)


class Sensor:
    """One sensor of a row of pixels, which sees the light at instants."""

    def __init__(self, light, positive=0.2, negative=0.2, mismatch=0.0, **noise):
        light = np.asarray(light, np.float32)
        self.pixels = EventPixels.create(1, len(light))
        self.noise, self.number, self.time = noise, 0, 0.0
        fill_levels(self.pixels, 0, light, 3, np.array([positive, negative, mismatch]))

    def see(self, light, length=0.01):
        light = np.asarray(light, np.float32)
        self.number += 1
        interval = NO_NOISE._replace(
            begin=self.time, end=self.time + length, width=len(light), number=self.number,
            **self.noise,
        )  # fmt: skip
        self.time += length
        out = np.zeros(most_events(self.pixels, 0, light), EVENT)
        count = np.zeros(1, np.int64)
        tell_events(self.pixels, 0, light, interval, out, count)
        assert count[0] <= len(out)
        return out[: count[0]]


def test_a_change_tells_an_event_for_each_threshold_at_the_times_of_the_crossings():
    sensor = Sensor([0.0, 0.0, 0.0, 0.0], positive=0.25, negative=0.2)
    told = sensor.see([1.0, -1.01, 0.24, 0.0])
    np.testing.assert_array_equal(told["x"], [0] * 4 + [1] * 5)
    np.testing.assert_array_equal(told["p"], [1] * 4 + [0] * 5)
    np.testing.assert_allclose(told["t"][:4], [2500, 5000, 7500, 10000], atol=1)
    np.testing.assert_allclose(told["t"][4:], 0.2 * np.arange(1, 6) / 1.01 * 1e4, atol=1)


def test_what_was_left_over_counts_in_the_next_interval_however_it_is_cut():
    whole = Sensor([0.0], positive=0.3).see([1.0])
    pieces = Sensor([0.0], positive=0.3)
    cut = np.concatenate([pieces.see([share], 0.01 * 0.1) for share in np.arange(0.1, 1.05, 0.1)])
    assert len(whole) == len(cut) == 3
    np.testing.assert_allclose(cut["t"], whole["t"], atol=1)


def test_light_that_goes_up_and_down_must_come_back_by_a_whole_threshold():
    sensor = Sensor([0.0])
    assert len(sensor.see([0.25])) == 1  # the reference is 0.2 now
    assert len(sensor.see([0.05])) == 0
    assert sensor.see([-0.05])["p"].tolist() == [0]


def test_a_moving_edge_tells_as_many_events_as_theory_says():
    """An edge of a contrast of ln(4), which passes 16 pixels at a pixel in 1 ms, drawn each 0.1 ms.

    Each pixel tells floor(ln(4) / 0.2) = 6 events, and the crossings of neighbours are 1 ms apart.
    """
    dark, bright = math.log(0.1), math.log(0.4)
    place = np.arange(16)

    def light(time):  # the edge covers a pixel linearly in its logarithm
        return dark + (bright - dark) * np.clip(1000.0 * time - place, 0.0, 1.0)

    sensor = Sensor(light(0.0))
    told = np.concatenate([sensor.see(light(k * 1e-4), 1e-4) for k in range(1, 161)])
    assert (told["p"] == 1).all()
    np.testing.assert_array_equal(np.bincount(told["x"], minlength=16), 6)
    for k in range(6):
        crossing = 1e6 * (1e-3 * place + 1e-3 * 0.2 * (k + 1) / math.log(4.0))
        times = np.array([told["t"][told["x"] == x][k] for x in range(16)])
        np.testing.assert_allclose(times, crossing, atol=1.0)


def test_a_pixel_is_blind_for_the_refractory_time():
    sensor = Sensor([0.0], refractory=0.003)
    times = sensor.see([1.0])["t"]  # crossings at 2, 4, 6, 8 and 10 ms
    np.testing.assert_allclose(times, [2000, 6000, 10000], atol=1)


def test_thresholds_differ_between_pixels_as_they_are_asked_to():
    sensor = Sensor(np.zeros(20_000), mismatch=0.1)
    for side in (sensor.pixels.positive[0], sensor.pixels.negative[0]):
        assert side.mean() == pytest.approx(0.2, rel=0.01)
        assert side.std() == pytest.approx(0.02, rel=0.03)
    assert abs(np.corrcoef(sensor.pixels.positive[0], sensor.pixels.negative[0])[0, 1]) < 0.03


def test_leaks_tell_events_of_more_light_at_their_rate():
    sensor = Sensor(np.zeros(50), leak=5.0)
    told = np.concatenate([sensor.see(np.zeros(50)) for _ in range(250)])
    assert (told["p"] == 1).all()
    assert len(told) / (50 * 2.5) == pytest.approx(5.0, rel=0.05)


@pytest.mark.parametrize(("light", "rate"), [(-7.0, 8.0), (0.0, 2.0)])
def test_shot_noise_comes_more_often_in_the_dark(light, rate):
    sensor = Sensor(np.full(400, light), shot=8.0)
    told = np.concatenate([sensor.see(np.full(400, light), 0.002) for _ in range(500)])
    assert len(told) / 400 == pytest.approx(rate, rel=0.08)
    assert told["p"].mean() == pytest.approx(0.5, abs=0.05)
    assert len(np.unique(told["t"])) > 0.9 * len(told)


def test_the_logarithm_is_that_of_the_luminance():
    radiance = np.array([[0.5, 0.0], [0.25, 0.0], [1.0, 0.0]], np.float32)
    out = np.zeros(2, np.float32)
    log_of_light(radiance, 0.001, out)
    light = 0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722
    np.testing.assert_allclose(out, np.log([light + 0.001, 0.001]), rtol=1e-6)
