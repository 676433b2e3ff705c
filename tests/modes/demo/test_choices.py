"""Who walks around in a demo."""

import pytest

from eyas.core.config import updated
from eyas.modes.demo.choices import Plan, first_plan, plan_of
from eyas.modes.demo.messages import World
from eyas.modes.demo.run import cockpit_of
from eyas.settings.config import EyasConfig
from eyas.settings.file import load_settings


class BuildError(Exception):
    """Holds the plan that a demo wants to build."""


def walkers(plan):
    return [(extra.kind, extra.count, extra.behaviour) for extra in plan.config.extras]


@pytest.mark.parametrize("name", ["citystreet", "downtown"])
def test_people_walk_in_the_cities_and_cross_their_roads(name):
    plan = first_plan(EyasConfig(world={"map": name}))
    assert walkers(plan) == [("Pedestrian", 40, "crossing")]


def test_there_are_none_elsewhere_and_others_where_the_settings_name_them():
    assert walkers(first_plan(EyasConfig(world={"map": "lake"}))) == []
    dogs = EyasConfig(extras=[{"kind": "GhostDog", "count": 2}])
    assert walkers(first_plan(dogs)) == [("GhostDog", 2, None)]


def test_the_command_has_them_too(monkeypatch):
    def build(plan):
        raise BuildError(plan)

    monkeypatch.setattr(Plan, "build", build)
    with pytest.raises(BuildError) as begun:
        cockpit_of(load_settings(None))
    assert walkers(begun.value.args[0]) == [("Pedestrian", 40, "crossing")]


def test_as_many_walk_in_the_next_world_in_its_own_way():
    city = first_plan(EyasConfig())
    lake = plan_of(city, World(map="lake"))
    assert sum(count for _, count, _ in walkers(lake)) == 40
    assert {behaviour for *_, behaviour in walkers(lake)} == {None}
    back = plan_of(lake, World(map="downtown"))
    assert ("Pedestrian", 24, "crossing") in walkers(back)
    assert walkers(plan_of(back, World(weather="snow"))) == walkers(back)
    assert walkers(plan_of(city, World(map="citystreet", weather="snow"))) == walkers(city)
    assert walkers(plan_of(back, World(people=0))) == []


def test_nobody_crosses_where_nobody_knows_what_vehicles_will_do():
    live = first_plan(updated(EyasConfig(), {"traffic": {"source": "live"}}))
    assert walkers(live) == []
    some = walkers(plan_of(live, World(people=20)))
    assert {behaviour for *_, behaviour in some} == {None}
