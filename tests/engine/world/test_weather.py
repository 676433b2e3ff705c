"""The table of weathers, their light by map and hour, and weathers of a user's own."""

import hashlib
import math
import sys
from dataclasses import asdict, fields, replace
from pathlib import Path

import gymnasium
import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.envs.registration import register_map
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.settings.file import load_settings
from eyas.engine.state.lighting import Lighting
from eyas.engine.world.hours import sun_at
from eyas.engine.world.maps import MAPS
from eyas.engine.world.weather import (
    AUTUMN,
    CLEAR_DAY,
    CLEAR_NIGHT,
    DAY,
    DUSK,
    DUST,
    FOGGY,
    NIGHT,
    RAIN,
    SNOW,
    WEATHERS,
    Season,
)
from eyas.maps.citystreet import CITYSTREET

EXAMPLES = Path(__file__).parents[3] / "examples"

PUBLISHED_WEATHERS = tuple(each.name for each in (DAY, FOGGY, NIGHT, SNOW))
OWN_WEATHERS = tuple(name for name in WEATHERS.built_in if name not in PUBLISHED_WEATHERS)

PUBLISHED = {
    "citystreet": "b107983a3a74",
    "downtown": "be7525719521",
    "lake": "4440f8c963e9",
    "village": "b51e7b5857e3",
    "village-bare": "c49365d36fce",
    "desert": "138d8d7de93f",
    "desert-bare": "edd8797d2780",
    "farmland": "d4a2ea6d6db7",
    "farmland-bare": "c49365d36fce",
    "simpleway-grass": "46aa28f76d96",
    "simpleway-clinker": "b14c05947fbb",
    "simpleway-desert": "138d8d7de93f",
    "simpleway-farm": "87c41f30e924",
    "simpleway-lake": "87c41f30e924",
    "simpleway-village": "87c41f30e924",
    "simpleway-city": "069878a897d9",
}
"""A hash of light and air of all weathers of each map: what changes one changes every picture."""

NUMBERS = {
    *("sun_direction", "sun_colour", "zenith_colour", "horizon_colour", "ambient_up"),
    *("ambient_down", "fog_colour", "fog_density", "fog_power", "foggy", "exposure", "snow"),
    *("luminosity", "lamps", "windows", "clouds", "flakes"),
}
"""What a light said when they were published; later numbers do nothing there."""


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


@pytest.mark.parametrize("name", MAPS.built_in)
def test_the_published_weathers_keep_every_number(name):
    recipe, digest = MAPS.get(name), hashlib.sha256()
    for weather in (each for each in recipe.weathers if each in PUBLISHED_WEATHERS):
        light = asdict(recipe.light(weather))
        numbers = sorted((name, light[name]) for name in NUMBERS)
        for field in (each for each in fields(Lighting) if each.name not in NUMBERS):
            assert field.name == "luminance" or light[field.name] == field.default
        digest.update(f"{weather} {numbers}".encode())
    assert digest.hexdigest()[:12] == PUBLISHED[name]


def test_the_sun_rises_in_the_east_and_stands_in_the_south_at_noon():
    morning, noon, evening = (np.array(sun_at(hour)) for hour in (7.0, 12.0, 17.0))
    assert morning[0] > 0.8
    assert noon == pytest.approx([0.0, -math.cos(math.radians(65)), math.sin(math.radians(65))])
    assert evening == pytest.approx(morning * [-1.0, 1.0, 1.0])
    assert 0.3 < morning[2] < 0.5


@pytest.mark.parametrize("weather", WEATHERS.built_in)
def test_every_hour_has_light_from_above(weather):
    record = WEATHERS.get(weather)
    assert record.name == weather
    for hour in np.linspace(0.0, 24.0, 97).tolist():
        light = record.light(hour)
        assert np.linalg.norm(light.sun_direction) == pytest.approx(1.0, abs=0.01)
        assert light.sun_direction[2] > 0.06
        for name, value in asdict(light).items():
            assert np.isfinite(value).all(), (hour, name)
            assert name in ("sun_direction", "moon_limb") or np.min(value) >= 0.0, (hour, name)


def test_a_low_sun_is_weaker_and_warmer():
    noon, evening = DAY.light(12.0), DAY.light(17.5)
    red, _, blue = np.array(evening.sun_colour) / noon.sun_colour
    assert blue < red < 1.0
    assert sum(evening.ambient_up) < sum(noon.ambient_up)
    assert evening.clouds == CLEAR_DAY.clouds


def test_a_sun_as_high_as_the_weathers_own_changes_only_its_direction():
    heights = [abs(sun_at(hour)[2] - CLEAR_DAY.sun_direction[2]) for hour in np.arange(7, 12, 0.01)]
    light = DAY.light(7.0 + 0.01 * int(np.argmin(heights)))
    assert light.sun_colour == pytest.approx(CLEAR_DAY.sun_colour, rel=0.01)
    assert light.sun_direction[0] > 0.0 > CLEAR_DAY.sun_direction[0]


def test_an_hour_of_the_night_is_the_night_and_a_night_has_hours_of_the_day():
    assert DAY.light(0.0) == NIGHT.light() == CLEAR_NIGHT
    assert NIGHT.light(12.0) == DAY.light(12.0)
    assert DAY.light() == CLEAR_DAY
    assert FOGGY.light(23.0).foggy
    assert SNOW.light(1.0).snow == 1.0


def test_dusk_grows_darker_without_a_jump():
    """In five minutes nothing changes by much, also not where sun and moon change places."""
    hours = np.arange(18.0, 22.0, 1 / 12)
    lights = [DAY.light(float(hour)) for hour in hours]
    sky = np.array([light.ambient_up for light in lights]).mean(axis=1)
    assert (np.diff(sky) < 0.001).all()
    for name in ("sun_colour", "horizon_colour", "fog_colour", "ambient_up", "exposure", "lamps"):
        values = np.array([getattr(light, name) for light in lights])
        assert np.abs(np.diff(values, axis=0)).max() < 0.25, name
    directions = np.array([light.sun_direction for light in lights])
    jumps = np.flatnonzero(np.abs(np.diff(directions, axis=0)).max(axis=1) > 0.1)
    assert len(jumps) == 1
    assert max(max(lights[jump].sun_colour) for jump in (jumps[0], jumps[0] + 1)) < 0.02


def test_lamps_are_lit_at_dusk_and_not_by_day():
    assert [DAY.light(hour).lamps for hour in (12.0, 19.0, 22.0)] == [0.0, 0.0, 1.0]
    assert 0.0 < DAY.light(19.6).lamps < 1.0


def test_a_day_on_which_lamps_burn_has_hours():
    farmland = MAPS.get("farmland")
    assert farmland.light("day").lamps > 0.0
    assert farmland.light("day", 9.0).sun_direction == pytest.approx(sun_at(9.0))
    assert farmland.light("day", 9.0).lamps == farmland.light("day").lamps


@pytest.mark.parametrize("name", MAPS.built_in)
@pytest.mark.parametrize("weather", OWN_WEATHERS)
def test_every_map_has_the_weathers_of_eyas_alone(name, weather):
    recipe = MAPS.get(name)
    if weather in recipe.without:
        pytest.skip("excluded by its record")
    light, day = recipe.light(weather), MAPS.get("citystreet").light("day")
    assert weather in recipe.weathers
    assert sum(light.ambient_up) < 1.3 * sum(day.ambient_up)
    alone = WEATHERS.get(weather)
    assert (max(light.sun_colour) == 0.0) == (max(alone.light().sun_colour) == 0.0)
    assert 1.0 / light.fog_density < 20_000.0
    assert recipe.season(weather) is alone.season


def test_what_each_weather_of_eyas_alone_is_known_by():
    closed = [name for name in OWN_WEATHERS if max(WEATHERS.get(name).day.sun_colour) == 0.0]
    assert closed == ["rain", "overcast"]
    assert AUTUMN.season is Season.AUTUMN
    for name in MAPS.built_in:
        assert 1.0 / MAPS.get(name).light("dust").fog_density < 501.0


def test_dusk_has_a_low_sun_and_its_hours_go_on_into_the_night():
    light = DUSK.light()
    height = math.degrees(math.asin(light.sun_direction[2]))
    assert 4.0 < height < 6.0
    assert light.sun_colour[0] > 3.0 * light.sun_colour[2]  # orange
    assert light.glare > 0.0 < light.lamps
    assert 1.0 / light.sun_direction[2] < light.longest_shadow
    assert light.stars == 0.0
    assert DUSK.light(0.0) == CLEAR_NIGHT
    assert DUSK.light(18.9) == light


def test_what_falls_and_lies_does_so_at_every_hour():
    for hour in (0.0, 5.0, 12.0, 19.5, 21.0):
        assert RAIN.light(hour).wet == pytest.approx(1.0)
        assert RAIN.light(hour).rain == pytest.approx(RAIN.day.rain)
        assert AUTUMN.light(hour).litter == pytest.approx(1.0)
        assert DUST.light(hour).mist == pytest.approx(DUST.day.mist)
    assert RAIN.light(0.0).daytime_lamps == 0.0 < RAIN.light(0.0).lamps


def test_a_full_moon_stands_opposite_the_sun_and_a_new_one_gives_no_light():
    full = NIGHT.light(23.0, 0.5)
    toward, sun = np.array(full.sun_direction), np.array(sun_at(23.0))
    assert toward @ sun == pytest.approx(-1.0, abs=1e-6)
    assert full.sun_colour == pytest.approx(CLEAR_NIGHT.sun_colour)
    assert full.ambient_up == pytest.approx(CLEAR_NIGHT.ambient_up)
    new = NIGHT.light(23.0, 0.0)
    assert max(new.sun_colour) == 0.0
    assert sum(new.ambient_up) < 0.5 * sum(full.ambient_up)


def test_a_half_moon_gives_a_tenth_of_a_full_one_and_its_limb_faces_the_sun():
    half = NIGHT.light(2.5, 0.75)  # the last quarter is high before dawn
    assert half.moon_lit == pytest.approx(0.5)
    assert 0.05 < half.sun_colour[0] / CLEAR_NIGHT.sun_colour[0] < 0.12
    assert np.dot(half.moon_limb, half.sun_direction) == pytest.approx(0.0, abs=1e-6)
    assert np.dot(half.moon_limb, sun_at(2.5)) > 0.9


def test_stars_turn_by_a_sidereal_day_and_only_under_a_moon():
    turns = [NIGHT.light(hour, 0.1).star_turn for hour in (0.0, 1.0, 2.0)]
    assert np.degrees(np.diff(turns)) == pytest.approx(15.041)
    assert NIGHT.light(1.0).star_turn == 0.0
    assert NIGHT.light(None, 0.1) == NIGHT.light(0.0, 0.1)
    assert DAY.light(None, 0.1) == CLEAR_DAY


@pytest.fixture
def haze(monkeypatch):
    """The weather of the example, which is in one file that Eyas does not know."""
    monkeypatch.syspath_prepend(EXAMPLES)
    import own_weather

    yield own_weather.HAZE
    del sys.modules["own_weather"]


@pytest.fixture
def registered(haze, monkeypatch):
    """The same with a short name, until the end of the test."""
    monkeypatch.setattr(WEATHERS, "_table", dict(WEATHERS._table))
    monkeypatch.setattr(WEATHERS, "_loaded", {})
    WEATHERS.register("haze", haze)
    yield haze
    for name in [name for name in gymnasium.registry if name.endswith("-haze-v0")]:
        del gymnasium.registry[name]


@pytest.mark.slow
def test_a_users_weather_flies_by_its_path_at_dusk(haze):
    means = []
    for weather in ("day", "own_weather:HAZE"):
        env = TrackingEnv(weather=weather, config={"world": {"hour": 18.5}}, render_mode=None)
        observation, _ = env.reset(seed=1)
        for _ in range(3):
            observation, *_ = env.step(0)
        means.append(observation.astype(float).mean())
    assert means[1] != pytest.approx(means[0], abs=2.0)


def test_a_users_weather_has_a_name_and_environments_on_every_map(registered):
    assert CITYSTREET.weathers == (*PUBLISHED_WEATHERS, *OWN_WEATHERS, "haze")
    register_map("lake")
    assert "eyas/lake-haze-v0" in gymnasium.registry
    assert CITYSTREET.light("haze") == registered.day
    assert CITYSTREET.season("haze") is Season.SUMMER


def test_maps_add_to_a_users_weather_what_is_special_about_them(registered):
    assert MAPS.get("farmland").light("haze").lamps == MAPS.get("farmland").light("day").lamps
    assert MAPS.get("lake").light("haze").fog_density == 1.0 / 400.0
    dusty = MAPS.get("desert").light("haze")
    assert dusty.horizon_colour != registered.day.horizon_colour
    assert dusty.sun_colour == registered.day.sun_colour


def test_a_file_of_settings_names_a_users_weather_only_if_it_is_trusted(tmp_path):
    file = tmp_path / "eyas.json"
    file.write_text('{"world": {"weather": "own_weather:HAZE"}}')
    with pytest.raises(ConfigError, match=r"would run code: 'own_weather:HAZE' \(world\.weather\)"):
        load_settings(file)
    assert load_settings(file, trust=True).world.weather == "own_weather:HAZE"


def test_what_is_no_weather_is_refused_in_a_line():
    with pytest.raises(ConfigError, match=r"world\.weather: 'math:pi' is a float, not a Weather"):
        CITYSTREET.light("math:pi")
    with pytest.raises(ConfigError, match=r"Weather\.name: 'a b' is not allowed"):
        replace(DAY, name="a b")
    with pytest.raises(UnknownNameError, match="known: autumn, day, dusk, dust, foggy"):
        CITYSTREET.light("hail")
