"""The parts of the flight controller against the original's formulas, written anew."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from eyas.engine.trackers.airframe import ORIGINAL
from eyas.engine.trackers.flight_controller import attitude_torque, mixed, within_tilt
from eyas.lanes import interpreted

LEVEL = (1.0, 0.0, 0.0, 0.0)
LIMIT = math.pi / 5
_within, _mixed, _torque = map(interpreted, (within_tilt, mixed, attitude_torque))
forces = st.tuples(*[st.floats(-200.0, 200.0)] * 3)


def scaled(force, weight):
    """The original's scale of a force, from its quadratic equation."""
    f, c2 = np.array(force), math.cos(LIMIT) ** 2
    total = f + np.array([0.0, 0.0, weight])
    if total[2] >= math.cos(LIMIT) * np.linalg.norm(total):
        return total
    a = c2 * f @ f - f[2] ** 2
    b, c = 2.0 * (c2 - 1.0) * f[2] * weight, (c2 - 1.0) * weight**2
    s = (-b + math.sqrt(max(b * b - 4.0 * a * c, 0.0))) / (2.0 * a)
    return s * f + np.array([0.0, 0.0, weight])


@settings(max_examples=200)
@given(forces)
def test_the_tilt_limit_is_the_original_s(force):
    weight, aside = 3.0 * 9.8, math.hypot(*force[:2])
    square = math.cos(LIMIT) ** 2 * np.dot(force, force) - force[2] ** 2
    assume(aside > 1e-3)
    assume(abs(square) > 1.0)  # the equation is not quadratic there
    assert _within(force, weight, LIMIT) == pytest.approx(scaled(force, weight), abs=1e-5)


@settings(max_examples=200)
@given(forces)
def test_no_force_tilts_further_than_the_limit(force):
    x, y, z = _within(force, 29.4, LIMIT)
    assert math.hypot(x, y) <= math.tan(LIMIT) * z + 1e-9
    assert z >= -1e-9


def test_a_force_straight_down_stops_the_rotors():
    assert _within((0.0, 0.0, -100.0), 29.4, LIMIT) == pytest.approx((0.0, 0.0, 0.0))


def produced(thrusts):
    """Force and torque of four thrusts."""
    fr, fl, rl, rr = thrusts
    arm, ratio = 0.22978, 0.02
    return (
        sum(thrusts),
        arm * (-fr + fl + rl - rr),
        arm * (-fr - fl + rl + rr),
        ratio * (-fr + fl - rl + rr),
    )


def test_unsaturated_rotors_give_what_is_asked():
    thrusts = _mixed(ORIGINAL, (0.0, 0.0, 30.0), (0.3, -0.2, 0.05), LEVEL)
    assert produced(thrusts) == pytest.approx((30.0, 0.3, -0.2, 0.05))


@settings(max_examples=200)
@given(st.floats(0.0, 60.0), st.tuples(*[st.floats(-5.0, 5.0)] * 3))
def test_saturated_rotors_keep_the_torque_and_raise_the_total_one_after_the_other(total, torque):
    thrusts = list(_mixed(ORIGINAL, (0.0, 0.0, total), torque, LEVEL))
    m1, m2, m3 = torque[0] / 0.22978, torque[1] / 0.22978, torque[2] / 0.02
    wanted = [
        0.25 * (total - m1 - m2 - m3),
        0.25 * (total + m1 - m2 + m3),
        0.25 * (total + m1 + m2 - m3),
        0.25 * (total - m1 + m2 + m3),
    ]
    for i in range(4):
        if wanted[i] < 0.0:
            wanted = [each - wanted[i] for each in wanted]
    assert thrusts == pytest.approx(wanted, abs=1e-9)
    assert min(thrusts) >= 0.0
    assert produced(thrusts)[1:] == pytest.approx(torque, abs=1e-9)
    assert produced(thrusts)[0] >= total - 1e-9


@settings(max_examples=300)
@given(st.floats(0.0, 60.0), st.tuples(*[st.floats(-5.0, 5.0)] * 3))
def test_the_original_s_loop_raises_only_the_rotors_before_one_that_lacks_thrust(total, torque):
    m1, m2, m3 = torque[0] / 0.22978, torque[1] / 0.22978, torque[2] / 0.02
    thrust = [
        0.25 * (total - m1 - m2 - m3),
        0.25 * (total + m1 - m2 + m3),
        0.25 * (total + m1 + m2 - m3),
        0.25 * (total - m1 + m2 + m3),
    ]
    for i in range(4):
        if thrust[i] < 0.0:
            thrust[0] -= thrust[i]  # one statement after the other, as there
            thrust[1] -= thrust[i]
            thrust[2] -= thrust[i]
            thrust[3] -= thrust[i]
    as_there = ORIGINAL._replace(as_original=1)
    assert _mixed(as_there, (0.0, 0.0, total), torque, LEVEL) == pytest.approx(thrust, abs=1e-9)


def test_the_original_s_loop_does_not_keep_the_torque():
    torque = (-4.0, 0.0, 0.0)  # front left and rear left would have to pull down
    as_there = _mixed(ORIGINAL._replace(as_original=1), (0.0, 0.0, 10.0), torque, LEVEL)
    assert produced(as_there)[1] > -3.7
    assert produced(_mixed(ORIGINAL, (0.0, 0.0, 10.0), torque, LEVEL))[1] == pytest.approx(-4.0)


def test_no_rounding_asks_a_rotor_for_less_than_nothing():
    torque = (1.869140625, -3.0, 0.0005880412408202641)
    assert min(_mixed(ORIGINAL, (0.0, 0.0, 1.8675980384350641), torque, LEVEL)) == 0.0


def test_rotors_reach_no_more_than_their_largest_rate():
    weak = ORIGINAL._replace(rotor_limit=600.0)
    most = 2.55e-5 * 600.0**2
    thrusts = _mixed(weak, (0.0, 0.0, 30.0), (2.0, 0.0, 0.0), LEVEL)
    assert max(thrusts) == pytest.approx(most)


@pytest.mark.parametrize(
    ("force", "yaw", "axis", "sign"),
    [((0, -5, 29), 0, 0, 1), ((5, 0, 29), 0, 1, 1), ((0, 0, 29), 0.3, 2, 1)],
)
def test_torque_turns_towards_the_force_and_the_heading(force, yaw, axis, sign):
    torque = np.array(_torque(ORIGINAL, force, yaw, LEVEL, (0.0, 0.0, 0.0)))
    assert sign * torque[axis] > 0.1
    assert np.abs(np.delete(torque, axis)).max() < 0.02


def test_torque_brakes_a_turn_and_counters_the_gyroscopic_one():
    rate = np.array([1.0, 2.0, 3.0])
    torque = _torque(ORIGINAL, (0.0, 0.0, 29.4), 0.0, LEVEL, rate)
    inertia = np.array(ORIGINAL.inertia)
    assert torque == pytest.approx(-0.7 * rate + np.cross(rate, inertia * rate))
