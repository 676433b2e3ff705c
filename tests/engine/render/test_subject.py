"""How much of the subject is seen, and where it is."""

import numpy as np

from eyas.engine.core.optics.pinhole import project
from eyas.engine.mesh.solids import box
from eyas.engine.state.draw import DrawList
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.world.build.materials import material

from ...kit.small_city import GROUND, TOWER, car_parts, floor, looking, put_car, scene_of

SIZE = (96, 128)


def car_at(x: float, y: float, yaw: float = 0.0) -> DrawList:
    draw_list = DrawList.create(1, 12)
    put_car(draw_list, 0, 0, 0, x, y, yaw)
    return draw_list


def test_an_occluder_takes_what_is_seen_but_not_what_is_covered(renderer_of, drawn):
    views = looking([(0.0, 0.0, 3.0)], pitch=0.1, fov=0.5, subject=ACTOR_OBJECT)
    free = renderer_of(scene_of([floor()], [GROUND]), car_parts())
    screen = box((0.2, 20.0, 8.0), (15.0, 10.0, 4.0), material("plain"), 1.0)  # y from 0 to 20
    hidden = renderer_of(scene_of([floor(), screen], [GROUND, TOWER]), car_parts())
    cars = car_at(25.0, 0.0, np.pi / 2)
    open_view, half_view = drawn(free, views, cars), drawn(hidden, views, cars)
    seen, covered = open_view.subject_pixels[0]
    assert seen == covered > 300
    assert half_view.subject_pixels[0, 1] == covered
    np.testing.assert_array_equal(half_view.subject_box, open_view.subject_box)
    assert abs(half_view.subject_pixels[0, 0] / covered - 0.5) < 0.03


def test_the_box_is_around_the_pixels_of_the_subject(renderer_of, drawn):
    renderer = renderer_of(scene_of([floor()], [GROUND]), car_parts())
    views = looking([(0.0, 0.0, 22.0)], pitch=1.2, fov=0.785, subject=ACTOR_OBJECT)
    picture = drawn(renderer, views, car_at(8.0, 1.0, 0.6))
    rows, columns = np.nonzero(picture.object_id[0] == ACTOR_OBJECT)
    expected = [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
    np.testing.assert_array_equal(picture.subject_box[0], expected)
    assert picture.subject_pixels[0].tolist() == [len(rows), len(rows)]
    column, row, _ = project(
        (8.0, 1.0, 0.7), views.position[0], views.rotation[0], SIZE[1], SIZE[0], 0.785
    )
    assert expected[0] < column < expected[2]
    assert expected[1] < row < expected[3]


def test_a_subject_outside_the_picture_measures_nothing(renderer_of, drawn):
    renderer = renderer_of(scene_of([floor()], [GROUND]), car_parts())
    views = looking([(0.0, 0.0, 22.0)] * 2, pitch=1.2, subject=ACTOR_OBJECT)
    views.subject[1] = -1
    picture = drawn(renderer, views, car_at(-60.0, 0.0))
    assert not picture.subject_box.any()
    assert not picture.subject_pixels.any()


def test_another_car_in_front_hides_it(renderer_of, drawn):
    renderer = renderer_of(scene_of([floor()], [GROUND]), car_parts())
    cars = car_at(25.0, 0.0)
    put_car(cars, 0, 6, 1, 17.0, 0.0, 0.0)
    views = looking([(0.0, 0.0, 1.0)], fov=0.4, subject=ACTOR_OBJECT)
    seen, covered = drawn(renderer, views, cars).subject_pixels[0]
    assert seen < 0.1 * covered
