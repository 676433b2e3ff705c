"""Light by map and weather."""

import numpy as np
import pytest

from eyas.world.maps.citystreet import CITYSTREET


def test_the_sun_of_the_street_city_stands_in_the_north_west_51_degrees_high():
    sun = np.array(CITYSTREET.light("day").sun_direction)
    assert np.linalg.norm(sun) == pytest.approx(1.0)
    assert np.degrees(np.arcsin(sun[2])) == pytest.approx(50.9, abs=0.1)
    assert sun[0] < 0 < sun[1]


def test_at_night_the_lamps_are_on_and_the_moon_is_weak():
    night, day = CITYSTREET.light("night"), CITYSTREET.light("day")
    assert (night.lamps, day.lamps, day.windows) == (1.0, 0.0, 0.0)
    assert max(night.sun_colour) < 0.15 * max(day.sun_colour)
    assert max(night.zenith_colour) < 0.02


def test_fog_of_the_street_city_is_the_originals():
    fog = CITYSTREET.light("foggy")
    assert 1 / fog.fog_density == pytest.approx(1000.0)
    assert fog.fog_power == 1
    # Grey: no colour stands out, and the sun hardly adds to what the sky gives.
    assert np.ptp(fog.fog_colour) < 0.03
    assert max(fog.sun_colour) < 0.25 * min(fog.ambient_up)
