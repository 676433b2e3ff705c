"""Cyclists pedal and hold on."""

import numpy as np
import pytest

from art.cars.bicycle import WHEEL_RADIUS
from art.jointed.cycle import frames_of, shapes_of
from art.jointed.riders.cyclist import CYCLISTS
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import KINDS, extent_of, kind_index, model_index

CYCLE = np.linspace(0.0, 1.0, 25)


@pytest.mark.parametrize("model", CYCLISTS, ids=lambda model: model.name)
def test_feet_go_round_with_the_pedals_and_hands_stay_on_the_grips(model):
    frames = frames_of(model.figure, CYCLE, moving=True)
    count = len([joint for joint in model.figure.joints if joint.shape is not None])
    assert len(shapes_of(model.figure)) == count + 2 * (3 + 2)
    left, right = frames[:, count + 2, :, 3], frames[:, count + 7, :, 3]
    middle = 0.5 * (left + right)
    assert np.ptp(middle, axis=0) == pytest.approx(np.zeros(3), abs=1e-9)
    assert np.linalg.norm((left - middle)[:, [0, 2]], axis=1) == pytest.approx(0.165, abs=2e-3)
    top = int(np.argmax(left[:, 2]))
    assert left[(top + 2) % 24, 0] > left[top, 0]  # on top, a pedal goes ahead
    for arm in (count + 3, count + 8):
        forearm = frames[:, arm + 1]
        wrist = forearm[..., 3] - 0.26 * forearm[..., 2]
        assert np.ptp(wrist, axis=0).max() < 0.01


def test_a_turn_of_the_cranks_is_some_turns_of_the_wheels():
    model = CYCLISTS[0]
    assert model.stride == pytest.approx(2.2 * 2.0 * np.pi * WHEEL_RADIUS)
    assert 50.0 < 60.0 * model.speed / model.stride < 75.0


def test_a_bicycle_is_a_class_of_its_own_and_fits_its_box():
    assert KINDS[kind_index("Cyclist")].object_class is ObjectClass.BICYCLE
    box = extent_of(model_index("Cyclist"), 3.0, 5.0, 0.0)
    assert np.ptp(box, axis=0) == pytest.approx(CYCLISTS[0].size, rel=0.1)
