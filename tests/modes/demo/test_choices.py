"""Who walks around in a demo."""

import pytest

from eyas.core.config import updated
from eyas.modes.demo.choices import Plan, plan_of
from eyas.modes.demo.messages import World
from eyas.modes.demo.run import cockpit_of
from eyas.settings.config import EyasConfig
from eyas.settings.file import load_settings
from eyas.sim.crowd import extras_of


class BuildError(Exception):
    """Holds the plan that a demo wants to build."""


def first(config):
    return Plan(config, 40)


def walkers(plan):
    return [(extra.kind, extra.count, extra.behaviour) for extra in extras_of(plan.config)]


def test_the_command_begins_with_the_pedestrians_of_the_map(monkeypatch):
    def build(plan):
        raise BuildError(plan)

    monkeypatch.setattr(Plan, "build", build)
    with pytest.raises(BuildError) as begun:
        cockpit_of(load_settings(None))
    assert walkers(begun.value.args[0]) == [("Pedestrian", 40, "crossing")]


def test_each_map_has_its_own_until_a_number_is_chosen():
    city = first(EyasConfig())
    lake = plan_of(city, World(map="lake"))
    assert walkers(lake) == []
    downtown = plan_of(lake, World(map="downtown"))
    assert walkers(downtown) == [("Pedestrian", 80, "crossing")]
    assert walkers(plan_of(downtown, World(weather="snow"))) == walkers(downtown)
    assert walkers(plan_of(downtown, World(people=0))) == []


def test_as_many_as_chosen_walk_in_the_next_world_in_its_own_way():
    city = plan_of(first(EyasConfig()), World(people=30))
    assert ("Pedestrian", 18, "crossing") in walkers(city)
    lake = plan_of(city, World(map="lake"))
    assert sum(count for _, count, _ in walkers(lake)) == 30
    assert {behaviour for *_, behaviour in walkers(lake)} == {None}
    assert walkers(plan_of(lake, World(map="citystreet"))) == walkers(city)


def test_nobody_crosses_where_nobody_knows_what_vehicles_will_do():
    live = first(updated(EyasConfig(), {"traffic": {"source": "live"}}))
    some = walkers(plan_of(live, World(people=20)))
    assert ("Pedestrian", 12, "pavement") in some
