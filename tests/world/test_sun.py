"""Where the sun stands at an hour, and what light it gives."""

import math

import numpy as np
import pytest

from eyas.core.errors import ConfigError
from eyas.world.maps import MAPS
from eyas.world.sun import at_hour, sun_at
from eyas.world.weather import CLEAR_DAY, CLEAR_NIGHT


def test_the_sun_rises_in_the_east_and_stands_in_the_south_at_noon():
    morning, noon, evening = (np.array(sun_at(hour)) for hour in (7.0, 12.0, 17.0))
    assert morning[0] > 0.8
    assert noon == pytest.approx([0.0, -math.cos(math.radians(65)), math.sin(math.radians(65))])
    assert evening == pytest.approx(morning * [-1.0, 1.0, 1.0])
    assert 0.3 < morning[2] < 0.5


@pytest.mark.parametrize("hour", np.linspace(6.5, 17.5, 12))
def test_it_is_up_at_every_hour_that_is_allowed(hour):
    assert np.linalg.norm(sun_at(hour)) == pytest.approx(1.0)
    assert sun_at(hour)[2] > math.sin(math.radians(15))


def test_a_low_sun_is_weaker_and_warmer():
    noon, evening = at_hour(CLEAR_DAY, 12.0), at_hour(CLEAR_DAY, 17.5)
    red, _, blue = np.array(evening.sun_colour) / noon.sun_colour
    assert blue < red < 1.0
    assert sum(evening.ambient_up) < sum(noon.ambient_up)
    assert evening.clouds == CLEAR_DAY.clouds


def test_a_sun_as_high_as_the_weathers_own_changes_only_its_direction():
    heights = [abs(sun_at(hour)[2] - CLEAR_DAY.sun_direction[2]) for hour in np.arange(7, 12, 0.01)]
    hour = 7.0 + 0.01 * int(np.argmin(heights))
    assert at_hour(CLEAR_DAY, hour).sun_colour == pytest.approx(CLEAR_DAY.sun_colour, rel=0.01)
    assert at_hour(CLEAR_DAY, hour).sun_direction[0] > 0.0 > CLEAR_DAY.sun_direction[0]


def test_a_day_on_which_lamps_burn_has_hours():
    foggy = MAPS.get("farmland").light("day")
    assert foggy.lamps > 0.0
    assert at_hour(foggy, 9.0).sun_direction == pytest.approx(sun_at(9.0))


def test_a_night_has_no_hour():
    with pytest.raises(ConfigError, match=r"world\.hour"):
        at_hour(CLEAR_NIGHT, 12.0)
