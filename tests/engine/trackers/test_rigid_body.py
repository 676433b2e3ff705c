"""The rigid body against closed forms, and the order of its integrator."""

import math

import numpy as np
import pytest

from eyas.engine.core.frames import rotate
from eyas.engine.state.terrain import Terrain
from eyas.engine.trackers.airframe import FIRM_GROUND, ORIGINAL
from eyas.engine.trackers.rigid_body import RigidBody, moved, turned
from eyas.lanes import interpreted

FLAT = Terrain.flat(0.0)
OFF = ((0.0,) * 4,) * 3
CALM = (0.0, 0.0, 0.0)
TUMBLING = RigidBody((1.0, 2.0, 300.0), (3.0, -4.0, 5.0), (1.0, 0.0, 0.0, 0.0), (2.0, 30.0, -1.0))
_moved, _rotate, _turned = interpreted(moved), interpreted(rotate), interpreted(turned)


def after(body, seconds, step=0.002, thrusts=OFF, frame=ORIGINAL, wind=CALM, terrain=FLAT):
    for _ in range(round(seconds / step)):
        body = _moved(frame, body, thrusts, wind, terrain, step)
    return body


def spin(body):
    """Angular momentum, world frame, and energy of rotation."""
    momentum = np.multiply(ORIGINAL.inertia, body.rate)
    return np.array(_rotate(body.attitude, *momentum)), 0.5 * momentum @ body.rate


def test_with_rotors_off_it_falls_like_a_stone_and_keeps_momentum_and_energy_of_its_spin():
    body = after(TUMBLING, 2.0)
    fallen = np.array([1.0 + 3.0 * 2.0, 2.0 - 4.0 * 2.0, 300.0 + 5.0 * 2.0 - 0.5 * 9.81 * 4.0])
    assert body.position == pytest.approx(fallen, abs=1e-9)
    assert body.velocity == pytest.approx([3.0, -4.0, 5.0 - 9.81 * 2.0], abs=1e-9)
    (momentum, energy), (first, whole) = spin(body), spin(TUMBLING)
    # It tumbles about its middle axis, which is unstable: nothing of it is as at first.
    assert np.abs(np.subtract(body.rate, TUMBLING.rate)).max() > 5.0
    assert momentum == pytest.approx(first, abs=1e-5)
    assert energy == pytest.approx(whole, rel=1e-6)
    assert math.hypot(*body.attitude) == pytest.approx(1.0, abs=1e-15)


def test_its_error_falls_with_the_fourth_power_of_the_step():
    thrusts = ((5.0, 7.0, 9.0, 6.0),) * 3
    frame = ORIGINAL._replace(drag_area=0.05)
    fast = TUMBLING._replace(rate=(2.0, 10.0, -4.0))

    def state(step):
        body = after(fast, 0.32, step, thrusts, frame)
        return np.concatenate([np.ravel(part) for part in body])

    exact = state(0.0005)
    errors = [np.abs(state(step) - exact).max() for step in (0.016, 0.008, 0.004)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders == pytest.approx([4.0, 4.0], abs=0.35)


def test_a_turn_is_the_same_by_its_series_and_by_sine_and_cosine():
    axis = np.array([2.0, -3.0, 6.0]) / 7.0
    for angle in (0.0, 1e-4, 0.05, 0.0999, 0.1001, 1.0, 3.0):
        half = 0.5 * angle
        expected = [math.cos(half), *(math.sin(half) * axis)]
        assert _turned((1.0, 0.0, 0.0, 0.0), tuple(angle * axis)) == pytest.approx(
            expected, abs=1e-15
        )


@pytest.mark.parametrize(
    ("rotor", "signs"), [(0, (-1, -1, -1)), (1, (1, -1, 1)), (2, (1, 1, -1)), (3, (-1, 1, 1))]
)
def test_each_rotor_pulls_up_and_turns_the_body_about_its_own_axes(rotor, signs):
    thrusts = tuple(8.0 if k == rotor else 0.0 for k in range(4))
    still = RigidBody((0.0, 0.0, 9.0), CALM, (1.0, 0.0, 0.0, 0.0), CALM)
    body = after(still, 0.002, thrusts=(thrusts,) * 3)
    arm = 8.0 * 0.22978 / np.array([0.0341171, 0.0363089])
    turning = np.multiply(signs, [*arm, 8.0 * 0.02 / 0.0627386]) * 0.002
    assert body.rate == pytest.approx(turning, rel=1e-3)
    assert body.velocity[2] == pytest.approx((8.0 / 3.0069 - 9.81) * 0.002, rel=1e-3)


def test_with_drag_it_falls_at_its_terminal_speed_and_drifts_with_the_wind():
    frame = ORIGINAL._replace(drag_area=0.05)
    terminal = math.sqrt(2.0 * 3.0069 * 9.81 / (1.225 * 0.05))
    still = RigidBody((0.0, 0.0, 9.0), CALM, (1.0, 0.0, 0.0, 0.0), CALM)
    falling = after(still, 20.0, 0.01, frame=frame, wind=(4.0, -3.0, 0.0))
    assert falling.velocity == pytest.approx([4.0, -3.0, -terminal], abs=0.05)


@pytest.fixture
def landed():
    """Dropped from 30 cm, tilted, sliding and turning, after 4 s."""
    frame = ORIGINAL._replace(contact_stiffness=FIRM_GROUND)
    slope = Terrain(0.0, np.full((2, 2), 2.0, np.float32), -50.0, -50.0, 100.0)
    dropped = RigidBody(
        (0.0, 0.0, 2.0 + 0.183 + 0.3), (1.0, 0.5, 0.0), (0.99, 0.08, 0.1, 0.0), (0.0, 0.0, 1.0)
    )
    return after(dropped, 4.0, frame=frame, terrain=slope)


def test_it_comes_to_rest_on_four_feet(landed):
    depth = 3.0069 * 9.81 / 4.0 / FIRM_GROUND
    assert landed.position[2] == pytest.approx(2.0 + 0.183 - depth, abs=1e-3)
    assert np.abs(landed.velocity).max() < 1e-2
    assert np.abs(landed.rate).max() < 1e-2
    assert np.abs(landed.attitude[1:3]).max() < 1e-3
    assert 0.05 < math.hypot(*landed.position[:2]) < 1.0
