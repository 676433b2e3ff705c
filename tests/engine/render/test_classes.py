"""Each pixel's class is that of the object it shows."""

import numpy as np
import pytest

from eyas.engine.state.draw import DrawList, Picture, Views
from eyas.engine.state.scene import ACTOR_OBJECT, SKY_OBJECT, ObjectClass

from ...kit.small_city import (
    GROUND,
    TOWER,
    TREE_OBJECT,
    car_parts,
    floor,
    looking,
    put_car,
    scene_of,
    tower,
    trees_at,
)

SIZE = (96, 128)


@pytest.fixture(scope="module")
def stage(renderer_of):
    """One of each: lawn, a house, a tree, and a car under the sky."""
    ground, house = floor(), tower(30.0, 12.0, 10.0, 9.0)
    scene = scene_of([ground, house], [GROUND, TOWER], trees_at([(30.0, -10.0)]))
    scene.object_class[TOWER] = ObjectClass.BUILDING
    scene.object_class[TREE_OBJECT] = ObjectClass.TREE
    draw_list = DrawList.create(1, 6)
    put_car(draw_list, 0, 0, 3, 20.0, 0.0, 1.2)
    return renderer_of(scene, car_parts()), draw_list, looking([(0.0, 0.0, 5.0)], pitch=0.05)


def test_class_of_every_pixel_agrees_with_its_object(stage):
    renderer, draw_list, views = stage
    picture = Picture.create(1, *SIZE, object_id=True, class_id=True)
    picture.class_id[:] = 77  # what is not written shows
    renderer.draw(views, draw_list, picture)
    expected = {
        SKY_OBJECT: ObjectClass.SKY,
        GROUND: ObjectClass.GROUND,
        TOWER: ObjectClass.BUILDING,
        TREE_OBJECT: ObjectClass.TREE,
        ACTOR_OBJECT + 3: ObjectClass.CAR,
    }
    assert set(np.unique(picture.object_id)) == set(expected)
    for thing, kind in expected.items():
        assert set(picture.class_id[picture.object_id == thing]) == {kind}


def test_movers_have_the_classes_of_their_own_world(stage):
    renderer, _, views = stage
    movers = DrawList.create(2, 6)
    movers.object_class[:, 3] = ObjectClass.ROBOT, ObjectClass.BUS
    for world in (0, 1):
        put_car(movers, world, 0, 3, 20.0, 0.0, 1.2)
    both = Views(
        np.repeat(views.position, 3, 0), np.repeat(views.rotation, 3, 0),
        np.array([1, 0, 1], np.int32), np.repeat(views.subject, 3, 0), views.field_of_view,
    )  # fmt: skip
    picture = Picture.create(3, *SIZE, object_id=True, class_id=True)
    renderer.draw(both, movers, picture)
    for view, expected in enumerate((ObjectClass.BUS, ObjectClass.ROBOT, ObjectClass.BUS)):
        mover = picture.object_id[view] == ACTOR_OBJECT + 3
        assert set(picture.class_id[view][mover]) == {expected}


def test_classes_need_no_other_output_and_change_none(stage):
    renderer, draw_list, views = stage
    every = Picture.create(1, *SIZE, depth=True, object_id=True, class_id=True)
    fewer = Picture.create(1, *SIZE, depth=True, object_id=True)
    alone = Picture.create(1, *SIZE, rgb=False, class_id=True)
    for picture in (every, fewer, alone):
        renderer.draw(views, draw_list, picture)
    np.testing.assert_array_equal(alone.class_id, every.class_id)
    np.testing.assert_array_equal(fewer.rgb, every.rgb)
    np.testing.assert_array_equal(fewer.depth, every.depth)
    assert fewer.class_id is None


def test_numbers_of_classes_stay_as_they_are():
    # People's data sets hold them.
    names = (
        "GROUND ROAD MARKING PAVEMENT BUILDING TREE STRUCTURE POLE WATER CAR SKY "
        "TRUCK BUS MOTORCYCLE PERSON ROBOT BICYCLE BOAT TRAIN"
    )
    assert [kind.name for kind in sorted(ObjectClass)] == names.split()
    assert sorted(ObjectClass) == list(range(19))
