"""Events: their number, times and signs against the contrast model's equations, and its noise."""

import math

import numpy as np
import pytest

from eyas.engine.camera.esim import EventPixels, EventSettings, Look, see_light

DARK = 1e-9


class Sensor:
    """One sensor of a row of pixels, which sees the logarithm of light at instants."""

    def __init__(self, light, **settings):
        exact = EventSettings(0.2, 0.2, 0.0, 0.0, 0.0, 0.0, DARK, len(light))
        self.settings = exact._replace(**settings)
        self.pixels = EventPixels.create(1, len(light))
        self.pixels.seed[:] = 3
        self.see(light, 0.0)

    def see(self, light, length=0.01):
        radiance = np.tile(np.exp(np.asarray(light, np.float64)).astype(np.float32), (1, 3, 1))
        end, time = np.ones(1, np.int64), self.pixels.time + length
        look = Look(end - 1, end - 1, end, radiance, time, np.zeros((1, len(light)), np.float32))
        self.pixels.number[:] = 0
        see_light(1, self.pixels, self.settings, look)
        assert look.next[0] == 1
        return self.pixels.emitted[0, : self.pixels.number[0]].copy()


def test_a_change_tells_an_event_for_each_threshold_at_the_times_of_the_crossings():
    sensor = Sensor([0.0, 0.0, 0.0, 0.0], positive=0.25, negative=0.2)
    events = sensor.see([1.01, -1.01, 0.24, 0.0])
    np.testing.assert_array_equal(events["x"], [0] * 4 + [1] * 5)
    np.testing.assert_array_equal(events["p"], [1] * 4 + [0] * 5)
    np.testing.assert_allclose(events["t"][:4], 0.25 * np.arange(1, 5) / 1.01 * 1e4, atol=1)
    np.testing.assert_allclose(events["t"][4:], 0.2 * np.arange(1, 6) / 1.01 * 1e4, atol=1)


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
    events = np.concatenate([sensor.see(light(k * 1e-4), 1e-4) for k in range(1, 161)])
    assert (events["p"] == 1).all()
    np.testing.assert_array_equal(np.bincount(events["x"], minlength=16), 6)
    for k in range(6):
        crossing = 1e6 * (1e-3 * place + 1e-3 * 0.2 * (k + 1) / math.log(4.0))
        times = np.array([events["t"][events["x"] == x][k] for x in range(16)])
        np.testing.assert_allclose(times, crossing, atol=1.0)


def test_a_pixel_is_blind_for_the_refractory_time():
    sensor = Sensor([0.0, 0.0], refractory=0.003)
    times = sensor.see([1.01, 0.0])["t"]  # crossings at nearly 2, 4, 6, 8 and 10 ms
    np.testing.assert_allclose(times, np.array([0.2, 0.6, 1.0]) / 1.01 * 1e4, atol=1)


def test_thresholds_differ_between_pixels_as_they_are_asked_to():
    sensor = Sensor(np.zeros(20_000), mismatch=0.1)
    for side in (sensor.pixels.positive[0], sensor.pixels.negative[0]):
        assert side.mean() == pytest.approx(0.2, rel=0.01)
        assert side.std() == pytest.approx(0.02, rel=0.03)
    assert abs(np.corrcoef(sensor.pixels.positive[0], sensor.pixels.negative[0])[0, 1]) < 0.03


def test_leaks_tell_events_of_more_light_at_their_rate():
    sensor = Sensor(np.zeros(50), leak=5.0)
    events = np.concatenate([sensor.see(np.zeros(50)) for _ in range(250)])
    assert (events["p"] == 1).all()
    assert len(events) / (50 * 2.5) == pytest.approx(5.0, rel=0.05)


@pytest.mark.parametrize(("light", "rate"), [(-7.0, 8.0), (0.0, 2.0)])
def test_shot_noise_comes_more_often_in_the_dark(light, rate):
    sensor = Sensor(np.full(400, light), shot=8.0)
    events = np.concatenate([sensor.see(np.full(400, light), 0.002) for _ in range(500)])
    assert len(events) / 400 == pytest.approx(rate, rel=0.08)
    assert events["p"].mean() == pytest.approx(0.5, abs=0.05)
    assert len(np.unique(events["t"])) > 0.9 * len(events)


def test_the_light_is_the_luminance():
    sensor = Sensor([0.0], negative=0.5)
    look = Look(
        *np.array([[0], [0], [1]]),
        np.array([[[0.5], [0.25], [1.0]]], np.float32), np.ones(1), np.zeros((1, 1), np.float32),
    )  # fmt: skip
    see_light(1, sensor.pixels, sensor.settings, look)
    light = 0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722
    np.testing.assert_allclose(sensor.pixels.last, np.log(light), rtol=1e-6)


def test_what_there_is_no_room_for_is_not_seen():
    sensor = Sensor([0.0])
    pixels = sensor.pixels._replace(emitted=sensor.pixels.emitted[:, :2].copy())
    bright = np.full((2, 3, 1), math.exp(0.31), np.float32) ** np.arange(1, 3)[:, None, None]
    look = Look(
        *np.array([[0], [0], [2]]),
        bright.astype(np.float32), np.array([0.01, 0.02]), np.zeros((1, 1), np.float32),
    )  # fmt: skip
    see_light(1, pixels, sensor.settings, look)
    assert (look.next[0], pixels.number[0]) == (1, 1)
    roomy = pixels._replace(emitted=np.concatenate([pixels.emitted, pixels.emitted], axis=1))
    see_light(1, roomy, sensor.settings, look)
    assert (look.next[0], roomy.number[0]) == (2, 3)
    whole = Sensor([0.0])
    times = [*whole.see([0.31])["t"], *whole.see([0.62])["t"]]
    np.testing.assert_array_equal(roomy.emitted[0, :3]["t"], times)
