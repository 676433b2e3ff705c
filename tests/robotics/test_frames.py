import math

import numpy as np
import pytest

from eyas.robotics.mavlink.frames import (
    Geodesy,
    camera_angles,
    compass,
    of_angles,
    of_body,
    swapped,
    to_frd,
)

ZURICH = Geodesy(47.397742, 8.545594, 488.0)


def matrix(q):
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_a_quaternion_turns_the_same_vectors_in_both_frames():
    rng = np.random.default_rng(1)
    for _ in range(20):
        q = rng.uniform(-1, 1, 4)
        q /= np.linalg.norm(q)
        vector = rng.uniform(-1, 1, 3)
        ours = swapped(matrix(q) @ vector)
        theirs = matrix(of_body(q)) @ to_frd(vector)
        np.testing.assert_allclose(ours, theirs, atol=1e-12)


@pytest.mark.parametrize(
    ("yaw", "clockwise_from_north"),
    [(0.0, 90.0), (math.pi / 2, 0.0), (math.pi, -90.0), (-math.pi / 2, -180.0)],
)
def test_headings_are_clockwise_from_north(yaw, clockwise_from_north):
    assert math.degrees(compass(yaw)) == pytest.approx(clockwise_from_north)
    level = np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)])
    ahead = matrix(of_body(level))[:, 0]
    assert (
        math.degrees(math.atan2(ahead[1], ahead[0])) == pytest.approx(clockwise_from_north)
        or clockwise_from_north == -180.0
    )


def test_nose_up_and_right_side_down_are_positive():
    angles = 0.2, 0.3, 0.4
    north_east_down = matrix(of_angles(*angles))
    assert north_east_down[2, 0] == pytest.approx(-math.sin(0.3))  # the nose is up
    assert north_east_down[2, 1] > 0.0  # the right side is down
    world = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]], float)
    camera = world @ north_east_down @ np.diag([1.0, -1.0, -1.0])
    assert camera_angles(camera) == pytest.approx(angles)


def test_degrees_lead_back_to_metres():
    for east, north in ((0.0, 0.0), (1234.5, -987.6), (0.001, 0.0)):
        assert ZURICH.place(*ZURICH.degrees(east, north)) == pytest.approx((east, north), abs=1e-6)


def test_a_degree_of_latitude_is_111_km():
    latitude, longitude = ZURICH.degrees(0.0, 111_194.9)
    assert latitude == pytest.approx(48.397742, abs=1e-6)
    assert longitude == pytest.approx(8.545594)
    # One of longitude is shorter by the cosine of the latitude.
    assert ZURICH.place(47.397742, 8.546594)[0] == pytest.approx(111.1949 * 0.676900, abs=1e-3)
