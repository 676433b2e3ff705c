import math

import numpy as np
import pytest

UNIT_STEP = np.array([0.0445, 0.1924, 0.4100, 0.6236, 0.7973, 0.9200, 0.9955, 1.0339])


def test_a_start_places_the_drone_at_rest(drone):
    drone.advance(forward=10.0, up=0.1, yaw_rate=1.0, steps=20)
    rows = drone.start(1.0, 2.0, 3.0, 0.5)
    assert list(rows.position) == list(rows.commanded_position) == [1.0, 2.0, 3.0]
    assert list(rows.euler) == [0.0, 0.0, 0.5]
    assert rows.orientation == pytest.approx([math.cos(0.25), 0.0, 0.0, math.sin(0.25)])
    for still in (rows.velocity, rows.acceleration, rows.angular_velocity):
        assert not still.any()
    rows = drone.advance(steps=5)
    assert list(rows.position) == [1.0, 2.0, 3.0]
    assert rows.euler[2] == 0.5


def test_a_drone_leaves_the_others_alone(drone):
    for array in drone.arrays():
        array[...] = 7.0
    before = [array.copy() for array in drone.arrays()]
    drone.start(1.0, 2.0, 3.0, 0.5)
    drone.advance(forward=3.0, left=2.0, up=0.1, yaw_rate=1.0, steps=3)
    drone.carry(1.0, 1.0, 1.0, 1.0)
    drone.aim()
    trackers = drone.trackers  # the field of view is the episode's, what is smoothed the sensors'
    elsewhere = (
        *(drone.cameras.field_of_view, drone.cameras.velocity, drone.cameras.angular_velocity),
        *(trackers.smoothed, trackers.smoothed_acceleration, trackers.smoothed_lag),
    )
    for array, old in zip(drone.arrays(), before, strict=True):
        np.testing.assert_array_equal(array[[0, 2]], old[[0, 2]])
        if not any(array is other for other in elsewhere):
            assert (array[1] != old[1]).any()


def test_each_command_passes_a_low_pass_of_its_own(drone):
    commands = {"forward": {"forward": 1.0}, "left": {"left": 1.0}, "yaw_rate": {"yaw_rate": 1.0}}
    for name, command in commands.items():
        drone.start()
        drone.advance(**command)
        used = {field for field in commands if getattr(drone.memory, field)[1].any()}
        assert used == {name}


def test_forward_speed_answers_in_the_first_step_with_the_filter_s_response(drone):
    drone.start()
    speeds = [drone.advance(forward=1.0).velocity[0] for _ in UNIT_STEP]
    assert speeds == pytest.approx(UNIT_STEP, abs=5e-5)
    assert drone.rows.position[0] == pytest.approx(0.002 * UNIT_STEP.sum(), abs=1e-6)


@pytest.mark.parametrize("yaw", [0.0, math.pi / 2, 2.5])
def test_commands_are_in_the_heading_frame_with_left_positive(drone, yaw):
    ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    aside = np.array([-math.sin(yaw), math.cos(yaw), 0.0])
    drone.start(yaw=yaw)
    assert drone.advance(forward=3.0, steps=200).velocity == pytest.approx(3 * ahead, abs=1e-6)
    drone.start(yaw=yaw)
    assert drone.advance(left=3.0, steps=200).velocity == pytest.approx(3 * aside, abs=1e-6)


def test_up_is_metres_in_each_step_and_not_filtered(drone):
    drone.start(z=20.0)
    rows = drone.advance(up=0.01)
    assert rows.position[2] == pytest.approx(20.01)
    assert rows.velocity[2] == pytest.approx(5.0)
    assert drone.advance(up=0.01, steps=3).position[2] == pytest.approx(20.04)


def test_positive_yaw_rate_turns_counter_clockwise(drone):
    drone.start(yaw=3.0)
    rows = drone.advance(yaw_rate=2.0, steps=500)
    # The filter delays by 2.81 steps.
    turned = 2.0 * 0.002 * (500 - 2.81)
    assert rows.euler[2] == pytest.approx(3.0 + turned - 2 * math.pi, abs=1e-4)
    assert rows.angular_velocity == pytest.approx([0, 0, 2], abs=1e-9)
    assert math.atan2(rows.orientation[3], rows.orientation[0]) == pytest.approx(rows.euler[2] / 2)


def test_forward_and_turn_together_drive_a_circle(drone):
    drone.start()
    drone.advance(forward=10.0, yaw_rate=2.0, steps=100)
    points = np.array(
        [drone.advance(forward=10.0, yaw_rate=2.0).position.copy() for _ in range(1571)]
    )
    centre = (points.max(0) + points.min(0)) / 2
    radius = np.linalg.norm(points[:, :2] - centre[:2], axis=1)
    assert radius == pytest.approx(5.0, abs=2e-3)


def test_velocity_and_acceleration_are_differences_over_a_step(drone):
    drone.start(yaw=0.7)
    rng = np.random.default_rng(1)
    last_position, last_velocity = drone.rows.position.copy(), drone.rows.velocity.copy()
    for _ in range(30):
        rows = drone.advance(*rng.uniform([-40, -40, -0.01, -2], [40, 40, 0.01, 2]))
        assert rows.velocity == pytest.approx((rows.position - last_position) / 0.002)
        assert rows.acceleration == pytest.approx((rows.velocity - last_velocity) / 0.002, abs=1e-6)
        assert list(rows.position) == list(rows.commanded_position)
        last_position, last_velocity = rows.position.copy(), rows.velocity.copy()


def test_the_camera_looks_along_the_heading_and_down_by_its_pitch(drone):
    yaw, pitch = 2.0, 1.1
    drone.start(5.0, 6.0, 7.0, yaw, pitch)
    position, rotation = drone.aim()
    forward = [math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch), -math.sin(pitch)]
    assert rotation[:, 0] == pytest.approx(forward)
    assert np.linalg.norm(position - [5.0, 6.0, 7.0]) < 0.2
