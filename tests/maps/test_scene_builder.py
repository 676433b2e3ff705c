"""Putting scenes together: prototypes by name, objects by number."""

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.mesh.solids import box
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass, Scene
from eyas.engine.state.terrain import Terrain
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import SceneBuilder

ROADS: RoadNetwork = Scene.empty().network


def builder() -> SceneBuilder:
    return SceneBuilder("field", 3, (200.0, 100.0), Terrain.flat(-0.1))


def cube(side):
    return (box((side, side, side), (0.0, 0.0, 0.0), material("plain"), 1.0),)


def test_copies_know_their_prototype_by_name():
    build = builder()
    hut, post = build.prototype("hut", lambda: cube(4.0)), build.prototype("post", lambda: cube(1))
    build.add_copy(ObjectClass.POLE, post, (1.0, 2.0, 0.0), 0.0, 1.0)
    build.add_copy(ObjectClass.BUILDING, hut, (5.0, 6.0, 0.0), 0.0, 2.0)
    fixtures = build.build(ROADS).fixtures
    assert [fixtures.names[kind] for kind in fixtures.prototype] == ["post", "hut"]
    sides = [np.ptp(fixtures.levels[kind][0].positions[:, 0]) for kind in fixtures.prototype]
    assert sides == [1.0, 4.0]


def test_a_prototype_is_made_once_and_when_all_is_placed():
    build, made = builder(), []

    def make():
        made.append(True)
        return cube(1.0)

    first, again = build.prototype("post", make), build.prototype("post", make)
    assert first is again
    assert not made
    build.build(ROADS)
    assert made == [True]


def test_prototypes_are_made_in_the_order_in_which_they_were_first_asked_for():
    build, order = builder(), []
    for name in ("b", "a", "b", "c"):
        build.prototype(name, lambda name=name: order.append(name) or cube(1.0))
    assert build.build(ROADS).fixtures.names == ("b", "a", "c")
    assert order == ["b", "a", "c"]


def test_more_objects_than_there_are_ids_for_are_refused():
    build = builder()
    build._classes = [ObjectClass.GROUND] * (ACTOR_OBJECT - 1)
    assert build.add(ObjectClass.GROUND) == ACTOR_OBJECT - 1
    post = build.prototype("post", lambda: cube(1.0))
    for more in (
        lambda: build.add(ObjectClass.GROUND),
        lambda: build.add_copy(ObjectClass.POLE, post, (0.0, 0.0, 0.0), 0.0, 1.0),
    ):
        with pytest.raises(ConfigError, match=r"'field' has more than 65,536 objects"):
            more()
    # A part of an object is no object.
    build.add_copy(ObjectClass.POLE, post, (0.0, 0.0, 0.0), 0.0, 1.0, owner=0)
