"""The table of maps, and what each map in it must have."""

import subprocess
import sys
from dataclasses import replace

import pytest

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.traffic.library import RESPAWN_GROUPS, TEST_TRAFFIC
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import (
    DENSE_FILE,
    DENSE_TEST_FILE,
    MIXED_FILE,
    SIGNALS_TRAFFIC_FILE,
    TEST_TOWNS,
    TRAFFIC_FILE,
    drivers_file,
    respawn_file,
    town_traffic_file,
)
from eyas.engine.world.weather import DAY, SNOW, WEATHERS, Season
from eyas.maps.citystreet import CITYSTREET


def test_an_unknown_map_is_told_with_the_nearest_name():
    with pytest.raises(UnknownNameError, match=r"world\.map: .*'citystret'.*mean 'citystreet'"):
        MAPS.get("citystret")


@pytest.mark.parametrize("name", MAPS.built_in)
def test_a_map_ships_the_roads_and_the_traffic_of_seed_0(name):
    recipe = MAPS.get(name)
    assert recipe.name == name
    assert recipe.shipped_network() is not None
    assert recipe.shipped(TRAFFIC_FILE) is not None
    files = [file.name for file in recipe.shipped_traffic()]
    lit = name.removesuffix("-bare") in ("citystreet", "downtown", "village", "desert")
    usual = {TRAFFIC_FILE, SIGNALS_TRAFFIC_FILE} if lit else {TRAFFIC_FILE}
    assert set(files[: len(usual)]) == usual
    mixed = (
        {DENSE_FILE, DENSE_TEST_FILE, MIXED_FILE} if name in ("citystreet", "downtown") else set()
    )
    tests = {
        town_traffic_file(0, seed) for seed in TEST_TRAFFIC if not name.startswith("simpleway")
    }
    towns = {
        town_traffic_file(town, TEST_TRAFFIC[0])
        for town in TEST_TOWNS
        if name.removesuffix("-bare") in ("citystreet", "downtown", "village")
    }
    canonical = {respawn_file(size) for size in RESPAWN_GROUPS}
    lost = {
        drivers_file(drivers, seed)
        for seed in (None, TEST_TRAFFIC[0])
        for drivers, maps in {
            "hiding": ("citystreet", "village"),
            "evading": ("citystreet", "downtown"),
        }.items()
        if name.removesuffix("-bare") in maps
    }
    assert set(files[len(usual) :]) == canonical | mixed | tests | towns | lost
    assert recipe.shipped("no such file") is None


@pytest.mark.parametrize("name", MAPS.built_in)
def test_a_maps_weathers_come_in_the_order_of_the_table(name):
    names = WEATHERS.names()
    assert sorted(MAPS.get(name).weathers, key=names.index) == list(MAPS.get(name).weathers)


def test_knowing_the_maps_imports_nothing_that_builds_one():
    code = "import sys, eyas; print(*sorted({'numba', 'shapely', 'pydantic'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""


def test_a_weather_that_a_map_lacks_is_told_with_those_it_has():
    with pytest.raises(UnknownNameError, match=r"world\.weather: .*'fogy'.*did you mean 'foggy'"):
        CITYSTREET.light("fogy")
    bare = replace(CITYSTREET, name="bare-land", without=("foggy", "night", "snow"))
    for ask in (bare.light, bare.season):
        with pytest.raises(UnknownNameError) as caught:
            ask("snow")
        line = "world.weather: 'snow' is not allowed on the map 'bare-land'; known: "
        line += "autumn, day, dusk, dust, overcast, rain"
        assert str(caught.value) == line


def test_an_unknown_map_is_told_what_else_names_one():
    with pytest.raises(UnknownNameError, match=r", or FILE\.plan\.json or package\.module:attr"):
        MAPS.get("my.json")


def test_a_map_without_seasons_has_no_winter_but_leaves_turn_everywhere():
    found = {weather: CITYSTREET.season(weather) for weather in CITYSTREET.weathers}
    assert found.pop("autumn") is Season.AUTUMN
    assert set(found.values()) == {Season.SUMMER}
    seasonal = replace(CITYSTREET, seasons=True)
    assert seasonal.season(DAY.name) is Season.SUMMER
    assert seasonal.season(SNOW.name) is Season.WINTER


@pytest.mark.parametrize("name", ["", "a map", "a/b", "-lake", "../lake"])
def test_the_name_of_a_map_can_name_a_folder(name):
    with pytest.raises(ConfigError, match=r"MapRecipe\.name: .*words joined by hyphens"):
        replace(CITYSTREET, name=name)


def test_a_map_outside_of_a_package_ships_nothing():
    loose = replace(CITYSTREET, package=None)
    assert loose.shipped_network() is None
    assert loose.shipped(TRAFFIC_FILE) is None
    assert loose.shipped_traffic() == ()
    assert loose.data_hash() is None


def test_a_change_of_what_a_map_of_ones_own_is_made_of_shows_in_its_hash(tmp_path, monkeypatch):
    package = tmp_path / "fields_of_the_test"
    (package / "parts").mkdir(parents=True)
    for path in ("__init__.py", "parts/__init__.py", "parts/hedge.py"):
        (package / path).write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    recipe = replace(CITYSTREET, package=package.name)
    first = recipe.data_hash()
    (package / "parts" / "__pycache__").mkdir()  # by the first start: the second finds its map
    (package / "parts" / "hedge.py").write_text("# no code")
    (package / "traffic.npz").write_text("is not part of the scene")
    assert recipe.data_hash() == first
    (package / "parts" / "hedge.py").write_text("HEIGHT = 2.0")
    second = recipe.data_hash()
    assert second != first
    (package / "heights.bin").write_text("a hill")
    assert recipe.data_hash() not in (first, second)
