"""What a picture shows of what is parked: pixels, boxes, and what is hidden of it."""

import numpy as np
import pytest

from eyas.engine.core.optics.lens import BROWN, Lens, lens_of
from eyas.engine.mesh.solids import box
from eyas.engine.sim.views.parked import ParkedObjects
from eyas.engine.state.draw import DrawList, Picture
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.state.snapshot import CameraState
from eyas.engine.state.terrain import Terrain
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import SceneBuilder

from ...kit.small_city import car_parts, floor, looking

HEIGHT, WIDTH = 120, 160
FIELD = 1.0
PLAIN = material("plain", (0.5, 0.5, 0.5))
NETWORK = Scene.empty().network


def scene_with(*walls, network: RoadNetwork = NETWORK) -> Scene:
    """A lawn with a car across the view 20 m ahead, a train of two cars and walls."""
    builder = SceneBuilder("lot", 0, (200.0, 200.0), Terrain.flat(0.0))
    builder.add(ObjectClass.GROUND, floor())
    car = builder.prototype("parked car 3", lambda: (box((4.0, 2.0, 1.5), (0, 0, 0.75), PLAIN, 1),))
    builder.add_copy(ObjectClass.CAR, car, (20.0, 0.0, 0.1), 0.5 * np.pi, 1.0)
    coach = builder.prototype("coach", lambda: (box((9.0, 2.0, 3.0), (0, 0, 1.5), PLAIN, 1.0),))
    train = builder.add_copy(ObjectClass.TRAIN, coach, (50.0, -5.0, 0.1), 0.5 * np.pi, 1.0)
    builder.add_copy(ObjectClass.TRAIN, coach, (50.0, 5.0, 0.1), 0.5 * np.pi, 1.0, train)
    for wall in walls:
        builder.add(ObjectClass.STRUCTURE, wall)
    return builder.build(network)


@pytest.fixture
def seen_in(renderer_of):
    """Return a function that draws a scene, and tells what is parked in it."""

    def run(scene: Scene, lens: Lens | None = None):
        views = looking([(0.0, 0.0, 4.0)], pitch=0.15, fov=FIELD)
        if lens is not None:
            views.lens = np.array([lens])
        picture = Picture.create(1, HEIGHT, WIDTH, depth=True, object_id=True)
        renderer_of(scene, car_parts()).draw(views, DrawList.create(1, 1), picture)
        cameras = CameraState.create(1)
        cameras.position[:], cameras.rotation[:] = views.position, views.rotation
        cameras.field_of_view[:] = FIELD
        shown, depth = picture.object_id[0], picture.depth[0]
        return shown, ParkedObjects(scene).seen(shown, depth, cameras, 0, lens)

    return run


def test_what_stands_free_is_measured_by_its_pixels(seen_in):
    shown, (car, train) = seen_in(scene_with())
    assert (car.what.type, car.what.object_class) == ("parked car 3", ObjectClass.CAR)
    assert car.what.size == pytest.approx((4.0, 2.0, 1.5), abs=1e-6)
    assert car.what.foot == pytest.approx((20.0, 0.0, 0.1), abs=1e-6)
    assert car.what.yaw == pytest.approx(0.5 * np.pi)
    rows, columns = np.nonzero(shown == car.what.object_id)
    ends = [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
    assert car.visible_box.tolist() == car.box.tolist() == ends
    assert car.seen_pixels == car.covered_pixels == len(rows)
    # Its left end is 2 m to the left and 19 m ahead, turned down by the camera's pitch.
    ahead = 19.0 * np.cos(0.15) + (4.0 - 0.1) * np.sin(0.15)
    focal = 0.5 * WIDTH / np.tan(0.5 * FIELD)
    assert car.whole_box[0] == pytest.approx(0.5 * WIDTH - focal * 2.0 / ahead, abs=0.3)
    assert np.abs(car.whole_box - car.box).max() < 1.0
    assert train.what.size[0] == pytest.approx(19.0, abs=1e-6)


@pytest.mark.parametrize("lens", [None, lens_of(BROWN, (-0.2, 0.03, 0.0, 0.0))])
def test_what_a_wall_hides_is_counted(seen_in, lens):
    _, (free, _) = seen_in(scene_with(), lens)
    wall = box((0.2, 10.0, 5.0), (10.0, -5.0, 2.5), PLAIN, 1.0)  # before its right half
    _, (half, _) = seen_in(scene_with(wall), lens)
    assert 0.4 * free.seen_pixels < half.seen_pixels < 0.6 * free.seen_pixels
    assert half.covered_pixels == pytest.approx(free.seen_pixels, rel=0.02)
    assert np.abs(half.box - free.box).max() <= 1
    assert half.visible_box[2] < free.visible_box[2] - 5
    assert np.abs(half.whole_box - free.whole_box).max() == 0.0


def test_what_is_behind_does_not_hide(seen_in):
    _, (free, _) = seen_in(scene_with())
    wall = box((0.2, 40.0, 5.0), (22.0, 0.0, 2.5), PLAIN, 1.0)
    _, (car,) = seen_in(scene_with(wall))
    assert car.seen_pixels == car.covered_pixels == free.seen_pixels


def test_a_map_without_anything_parked_has_none():
    nothing = ParkedObjects(Scene.empty())
    shown, depth = np.zeros((4, 4), np.int32), np.ones((4, 4), np.float32)
    assert nothing.objects == ()
    assert nothing.seen(shown, depth, CameraState.create(1), 0) == []
