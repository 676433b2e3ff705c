"""Who walks around in a demo."""

import json
import sys

import pytest

from eyas.demo import choices
from eyas.demo.choices import WorldChoice
from eyas.demo.messages import WorldMessage
from eyas.demo.offer import Offer
from eyas.demo.run import session_of
from eyas.engine.core.config import updated
from eyas.engine.core.errors import UnknownNameError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.sim.crowd import extras_of


class BuildError(Exception):
    """Holds the plan that a demo wants to build."""


def choice_of(before, said):
    return choices.choice_of(before, said, Offer.of(before.config))


def first(config):
    return WorldChoice(config, 40)


def walkers(plan):
    return [(extra.kind, extra.count, extra.behaviour) for extra in extras_of(plan.config)]


def test_the_command_begins_with_the_pedestrians_of_the_map(monkeypatch):
    def build(plan):
        raise BuildError(plan)

    monkeypatch.setattr(WorldChoice, "build", build)
    with pytest.raises(BuildError) as begun:
        session_of(load_settings(None))
    assert walkers(begun.value.args[0])[0] == ("Pedestrian", 40, "crossing")


def test_each_map_has_its_own_until_a_number_is_chosen():
    city = first(EyasConfig())
    lake = choice_of(city, WorldMessage(map="lake"))
    assert walkers(lake) == [("Pedestrian", 24, "verge"), ("Cyclist", 8, "ride")]
    downtown = choice_of(lake, WorldMessage(map="downtown"))
    assert walkers(downtown)[0] == ("Pedestrian", 80, "crossing")
    assert walkers(choice_of(downtown, WorldMessage(weather="snow"))) == walkers(downtown)
    assert walkers(choice_of(downtown, WorldMessage(people=0))) == []


def test_as_many_as_chosen_walk_in_the_next_world_in_its_own_way():
    city = choice_of(first(EyasConfig()), WorldMessage(people=30))
    assert ("Pedestrian", 18, "crossing") in walkers(city)
    lake = choice_of(city, WorldMessage(map="lake"))
    assert sum(count for _, count, _ in walkers(lake)) == 30
    assert {behaviour for *_, behaviour in walkers(lake)} == {"verge", None}
    assert walkers(choice_of(lake, WorldMessage(map="citystreet"))) == walkers(city)


def test_nobody_crosses_where_nobody_knows_what_vehicles_will_do():
    live = first(updated(EyasConfig(), {"traffic": {"source": "live"}}))
    some = walkers(choice_of(live, WorldMessage(people=20)))
    assert ("Pedestrian", 12, "pavement") in some


@pytest.mark.parametrize(
    "name", ["someones:MAP", "lake/../lake", "/tmp", "../x", ".", "", "citystret"]
)
def test_a_page_names_only_maps_that_are_offered(name, tmp_path, monkeypatch):
    (tmp_path / "someones.py").write_text("raise SystemExit('it was imported')")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(UnknownNameError, match=r"^world\.map: .* known: citystreet, "):
        choice_of(first(EyasConfig()), WorldMessage(map=name))
    assert "someones" not in sys.modules


def test_a_page_does_not_name_the_folder_of_a_map(tmp_path):
    """Not even one that is there."""
    folder = tmp_path / "town"
    folder.mkdir()
    said = {"name": "town", "title": "", "source": "", "longitude": 0.0, "latitude": 0.0}
    (folder / "map.json").write_text(json.dumps({**said, "size": [100, 100]}))
    config = updated(EyasConfig(), {"world": {"map": str(folder)}})
    with pytest.raises(UnknownNameError):
        choice_of(first(EyasConfig()), WorldMessage(map=str(folder)))
    assert choice_of(first(config), WorldMessage(weather="night")).config.world.map == str(folder)
