"""Names of the original's world files, and the simple maps that stand for its maps."""

import pytest

from eyas.engine.core.config import updated
from eyas.engine.settings.config import EyasConfig, variants
from eyas.engine.settings.file import load_settings, preset_file
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.engine.world.simple_maps import simple_world

ORIGINALS = ("citystreet", "desert", "downtown", "farmland", "lake", "village")
WEATHERS = ("day", "foggy", "night", "snow")


@pytest.mark.parametrize("name", ORIGINALS)
def test_each_map_has_a_simple_one_in_each_weather(name):
    for weather in WEATHERS:
        simple, same = simple_world(name, weather)
        assert same == weather
        MAPS.get(simple).light(weather)  # raises where it does not exist


def test_the_published_training_begins_on_the_simple_map_of_its_map():
    changes = ["world.map=downtown", "world.weather=snow"]
    config = load_settings(preset_file("paper"), changes)
    (path, first), *_ = variants(config)
    assert path == "train.stages.0.settings"
    assert (first.world.map, first.world.weather) == ("simpleway-city", "snow")
    assert first.traffic.colour == (0.0, 0.0, 1.0)
    assert config.world.map == "downtown"


@pytest.mark.parametrize(
    ("name", "world"),
    [
        ("lake-night.wbt", ("lake", "night")),
        ("a/b\\simpleway-farm_foggy.wbt", ("simpleway-farm", "foggy")),
        ("worlds/simpleway-grass.wbt", ("simpleway-grass", "day")),
        ("lake", ("lake", "day")),
        ("lake.wbt", ("lake.wbt", "day")),
    ],
)
def test_the_name_of_a_world_file_is_that_of_a_map(name, world):
    config = WorldConfig(map=name)
    assert (config.map, config.weather) == world
    assert WorldConfig(map=name, weather="snow").weather == "snow"
    config = updated(EyasConfig(), {"world": {"map": name}})
    assert (config.world.map, config.world.weather) == world
