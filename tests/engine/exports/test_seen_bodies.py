"""3D boxes of walkers against what pictures show of them."""

import numpy as np
import pytest

from eyas.engine.core.optics.pinhole import project
from eyas.engine.exports.capture import FrameMoment, frame_of
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture

pytestmark = pytest.mark.slow  # what its tests share takes long to make

WIDTH, HEIGHT, COUNT = 320, 240, 12


@pytest.fixture(scope="module")
def frames():
    """Frames of walkers among walkers, from close by."""
    config = EyasConfig(
        target="Pedestrian",
        extras=[{"kind": "Pedestrian", "count": 60, "behaviour": "crossing"}],
        start={"height": {"uniform": [2.5, 9.0]}, "pitch": {"uniform": [0.35, 1.2]}},
    )
    simulation = build_simulation(config, each_alone(COUNT))
    picture = Picture.create(COUNT, HEIGHT, WIDTH, subject=True, actors=simulation.actors)
    seen = []
    for _ in range(4):
        simulation.reset()
        simulation.carry(90)
        simulation.draw(np.arange(COUNT, dtype=np.int32), picture)
        for n in range(COUNT):
            shown, actors = simulation.snapshot, simulation.view.actors(n)
            moment = FrameMoment(shown, shown.episodes, actors)
            seen.append(frame_of(moment, n, picture, n, 0, RecordedAction(-1, None)))
    return seen


def test_the_box_of_a_moment_holds_all_that_a_picture_shows_of_a_walker(frames):
    nominal, looked = 0, 0
    for frame in frames:
        camera = frame.camera
        for subject in (frame.target, *frame.others):
            left, top, right, bottom = subject.box.tolist()
            whole = 0 < left and right < WIDTH and 0 < top and bottom < HEIGHT
            if subject.posed_corners is None or not whole or subject.covered_pixels < 40:
                continue
            outside = []
            for corners in (subject.posed_corners, subject.corners):
                pose = camera.position, camera.rotation
                x, y, _ = project(corners, *pose, WIDTH, HEIGHT, camera.field_of_view)
                past = (x.min() - left, right - x.max(), y.min() - top, bottom - y.max())
                outside.append(max(past))
            assert outside[0] < 1.0, subject
            nominal += outside[1] > 1.0
            looked += 1
    assert looked > 40
    assert nominal > 0.05 * looked  # whose limbs leave the box of their size: it is needed
