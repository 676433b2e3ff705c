"""Step responses of the flown drone against a reference written apart from it.

The reference has rotation matrices in place of quaternions, vectors in place of scalars, the
original's quadratic equation for the tilt limit, and scipy's integrator of order 8 between the
instants of the controller. What is off its centre moves it by the equations of Newton and Euler
about the origin, in six unknowns, where the code goes by the centre of mass.
"""

import math
from itertools import pairwise

import numpy as np
import pytest

from eyas.engine.trackers.config import TrackerConfig

from ...kit.flight import Drones, held

MASS, INERTIA, ARM, KAPPA = 3.0069, np.diag([0.0341171, 0.0363089, 0.0627386]), 0.22978, 0.02
UP = np.array([0.0, 0.0, 1.0])


def hat(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def filtered(values):
    """The shaping filter in direct form I."""
    k = 2 * math.pi * 20 / 500
    d = k * k + math.sqrt(2) * k + 1
    b = np.array([k * k, 2 * k * k, k * k]) / d
    a1, a2 = 2 * (k * k - 1) / d, (k * k - math.sqrt(2) * k + 1) / d
    x, y = [0.0, 0.0], [0.0, 0.0]
    for value in values:
        out = b[0] * value + b[1] * x[0] + b[2] * x[1] - a1 * y[0] - a2 * y[1]
        x, y = [value, x[0]], [out, y[0]]
        yield out


def limited(force):
    """The sum of a force and the weight, within the tilt limit."""
    weight, c2 = 3.0 * 9.8, math.cos(math.pi / 5) ** 2
    total = force + weight * UP
    if total[2] >= math.sqrt(c2) * np.linalg.norm(total):
        return total
    a = c2 * force @ force - force[2] ** 2
    b, c = 2 * (c2 - 1) * force[2] * weight, (c2 - 1) * weight**2
    return force * (-b + math.sqrt(b * b - 4 * a * c)) / (2 * a) + weight * UP


def rotor_thrusts(force, yaw, attitude, rate, as_original=False):
    b3 = force / np.linalg.norm(force)
    b2 = np.cross(b3, [math.cos(yaw), math.sin(yaw), 0])
    b2 /= np.linalg.norm(b2)
    desired = np.column_stack([np.cross(b2, b3), b2, b3])
    skew = 0.5 * (desired.T @ attitude - attitude.T @ desired)
    error = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    torque = -np.diag([4, 4, 2]) @ error - 0.7 * rate + np.cross(rate, INERTIA @ rate)
    total = max(0.0, force @ attitude @ UP)
    roll, pitch, yaw = np.array([[-1, 1, 1, -1], [-1, -1, 1, 1], [-1, 1, -1, 1]])
    mixing = np.array([np.ones(4), ARM * roll, ARM * pitch, KAPPA * yaw])
    thrusts = np.linalg.solve(mixing, [total, *torque])
    for i in range(4):
        if as_original and thrusts[i] < 0.0:  # in place, as its loop
            for rotor in range(4):
                thrusts[rotor] -= thrusts[i]
        thrusts = thrusts - min(thrusts[i], 0.0)
    return mixing @ thrusts


def massed(parts):
    """The matrix of masses about the origin, shape (6, 6), of a body with parts (mass, place)."""
    mass = MASS - sum(m for m, _ in parts)
    matrix = np.zeros((6, 6))
    matrix[:3, :3], matrix[3:, 3:] = mass * np.eye(3), INERTIA
    for m, place in parts:
        arm = np.vstack([np.eye(3), hat(place)])
        matrix += m * arm @ arm.T
    return matrix


def flown(commands, parts=(), *, as_original=False):
    """Positions and attitudes after each step of 2 ms, shapes (K, 3) and (K, 3, 3)."""
    matrix = massed(parts)
    first_moment = np.array([matrix[5, 1], matrix[3, 2], matrix[4, 0]])
    integrate = pytest.importorskip("scipy.integrate").solve_ivp
    shaped = zip(*(filtered(commands[:, axis]) for axis in (0, 1, 3)), strict=True)
    position, velocity, rate = np.array([0.0, 0.0, 20.0]), np.zeros(3), np.zeros(3)
    attitude, goal, yaw, last, measured = np.eye(3), position.copy(), 0.0, np.zeros(3), np.zeros(3)
    places, attitudes = [], []
    for (ahead, left, turn), command in zip(shaped, commands, strict=True):
        heading = attitude[:2, 0] / np.linalg.norm(attitude[:2, 0])
        wanted = np.array([*(ahead * heading + left * np.array([-heading[1], heading[0]])), 0.0])
        goal = goal + wanted * 0.002 + command[2] * UP
        yaw += turn * 0.002
        force = np.diag([8, 8, 17]) @ (goal - position) + 10 * (wanted - measured)
        force, last = force + 3.0 * (wanted - last) / 0.002, wanted
        total, *torque = rotor_thrusts(limited(force), yaw, attitude, rate, as_original)

        def change(_, state, total=total, torque=torque):
            turned, spin = state[6:15].reshape(3, 3), state[15:]
            down = -9.81 * turned.T @ UP
            swung = np.cross(spin, np.cross(spin, first_moment))
            push = total * UP + MASS * down - swung
            turn = torque + np.cross(first_moment, down) - np.cross(spin, matrix[3:, 3:] @ spin)
            told = np.linalg.solve(matrix, np.concatenate([push, turn]))
            moves = [state[3:6], turned @ told[:3], np.ravel(turned @ hat(spin)), told[3:]]
            return np.concatenate(moves)

        first = np.concatenate([position, velocity, np.ravel(attitude), rate])
        state = integrate(change, (0, 0.002), first, "DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
        measured = (state[:3] - position) / 0.002
        position, velocity, rate = state[:3], state[3:6], state[15:]
        attitude = state[6:15].reshape(3, 3)
        places.append(position)
        attitudes.append(attitude)
    return np.array(places), np.array(attitudes)


def matrices(quaternions):
    w, v = quaternions[:, 0], quaternions[:, 1:]
    outer = np.einsum("ki,kj->kij", v, v)
    cross = np.stack([hat(each) for each in v])
    size = (w * w - (v * v).sum(1))[:, None, None]
    return 2 * outer + 2 * w[:, None, None] * cross + size * np.eye(3)


FLIGHTS = {
    "forward": held(forward=3.0, steps=500),
    "across, climbing and turning": held(left=-4.0, up=0.004, yaw_rate=1.5, steps=400),
    "reversed, at its limits": np.concatenate(
        [held(forward=40.0, steps=200), held(forward=-40.0, yaw_rate=-2.0, steps=200)]
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_is_that_of_the_reference(name):
    commands = FLIGHTS[name]
    places, attitudes = flown(commands)
    log = Drones().fly(commands)
    assert log.position[:, 0] == pytest.approx(places, abs=1e-6)
    assert matrices(log.attitude[:, 0]) == pytest.approx(attitudes, abs=1e-6)


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_with_gimbal_and_lidar_off_its_centre_is_that_of_the_reference(name):
    commands = FLIGHTS[name][:200]
    gimbal = [(0.13, -0.00469654, -0.013), (0.130625212, -0.01, -0.0337448)]
    gimbal.append((0.138172072, 0.0060388, -0.03960881))
    parts = [*((0.0333, np.array(place)) for place in gimbal), (0.2, np.array([0.0, 0.0, 0.02]))]
    places, attitudes = flown(commands, parts, as_original=True)
    config = TrackerConfig(supervised=False, flight="original", off_centre=True)
    log = Drones(config=config).fly(commands)
    assert log.position[:, 0] == pytest.approx(places, abs=1e-6)
    assert matrices(log.attitude[:, 0]) == pytest.approx(attitudes, abs=1e-6)


def figures(response):
    """Rise time from 10 to 90 % [s], and overshoot, of a response to a step of 1."""
    at = [int(np.argmax(response >= share)) for share in (0.1, 0.9)]
    return 0.002 * float(*np.diff(at)), float(response.max() - 1.0)


@pytest.mark.parametrize(
    ("command", "quantity", "rise", "overshoot"),
    [
        ({"forward": 1.0}, lambda log: log.velocity[:, 0, 0], 0.328, 0.328),
        ({"left": 1.0}, lambda log: log.velocity[:, 0, 1], 0.330, 0.324),
        ({"up": 0.002}, lambda log: log.velocity[:, 0, 2], 0.892, 0.046),
        ({"yaw_rate": 1.0}, lambda log: log.rate[:, 0, 2], 0.604, 0.0),
    ],
)
def test_the_responses_to_steps_are_these(command, quantity, rise, overshoot):
    """Recorded once; those of the reference are the same, by the test above."""
    seen = figures(quantity(Drones().fly(held(**command, steps=3000))))
    assert seen == pytest.approx((rise, overshoot), abs=0.004)


def test_larger_steps_take_longer_because_tilt_is_limited():
    times = [
        figures(Drones().fly(held(forward=speed, steps=3000)).velocity[:, 0, 0] / speed)[0]
        for speed in (1.0, 3.0, 6.0)
    ]
    assert all(slower > faster for faster, slower in pairwise(times))
