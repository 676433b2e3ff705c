"""Whole boxes of targets of several kinds, against what pictures show of them and of others."""

import numpy as np
import pytest

from eyas.engine.exports.capture import frame_of, moment_of
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture

from ...kit.walkers import FEW

WIDTH, HEIGHT, COUNT = 320, 240, 8
CAR = {"world": {"map": "citystreet"}, "start": {"height": {"uniform": [4.0, 20.0]}}}
WALK = {
    "start": {"height": {"uniform": [2.5, 9.0]}, "pitch": {"uniform": [0.35, 1.2]}},
    "objects": FEW,
}


def frames_of(**settings) -> list:
    simulation = build_simulation(EyasConfig(**settings), each_alone(COUNT))
    picture = Picture.create(COUNT, HEIGHT, WIDTH, subject=True, actors=simulation.actors)
    seen = []
    for aside in (0.0, 0.35):
        simulation.reset()
        simulation.carry(90)
        rotation = simulation.snapshot.cameras.rotation
        turn = [[np.cos(aside), -np.sin(aside), 0], [np.sin(aside), np.cos(aside), 0], [0, 0, 1]]
        rotation[:] = rotation @ np.array(turn)  # so that the border cuts some
        simulation.draw(np.arange(COUNT, dtype=np.int32), picture)
        for n in range(COUNT):
            moment = moment_of(simulation, n, picture, n)
            seen.append(frame_of(moment, n, picture, n, 0, RecordedAction(-1, None)))
    return seen


@pytest.mark.slow
@pytest.mark.parametrize(
    "settings",
    [CAR, {"target": "Pedestrian", **WALK}, {"target": "Mantis", **WALK}],
    ids=["car", "person", "robot"],
)
def test_a_whole_box_is_what_a_larger_picture_would_show(settings):
    inside = cut = 0
    for frame in frames_of(**settings):
        for subject in (frame.target, *frame.others):
            if subject.covered_pixels == 0:
                continue
            box, whole = subject.box, subject.whole_box
            # Pixels show it whose centres it covers: within half a pixel, and roundings of levels.
            past = np.array([whole[0] - box[0], whole[1] - box[1], box[2] - whole[2],
                             box[3] - whole[3]])  # fmt: skip
            assert past.max() < 1.0, subject
            if subject.truncated(frame.camera) == 0.0:
                inside += 1
                if subject.covered_pixels > 60:
                    assert past.min() > -1.5, subject
            else:
                cut += 1
    assert inside > 3
    assert cut > 1


def test_what_is_behind_the_camera_has_no_box():
    simulation = build_simulation(EyasConfig(), each_alone(1))
    simulation.reset()
    picture = Picture.create(1, HEIGHT, WIDTH, subject=True, actors=simulation.actors)
    simulation.snapshot.cameras.rotation[0] *= [-1.0, -1.0, 1.0]
    simulation.draw(np.zeros(1, np.int32), picture)
    moment = moment_of(simulation, 0, picture, 0)
    target = frame_of(moment, 0, picture, 0, 0, RecordedAction(-1, None)).target
    assert target.covered_pixels == 0
    assert not target.whole_box.any()
