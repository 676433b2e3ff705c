from dataclasses import replace

import numpy as np
import pytest

from eyas.engine.traffic.config import Demand
from eyas.engine.traffic.recording import TrafficRecording
from eyas.engine.traffic.smoothing import held, runs, smooth


def test_even_motion_is_left_as_it_is_to_both_ends(make_recording):
    time = np.arange(80) / 10.0
    path = np.stack([3.0 * time, 4.0 * time], axis=-1)[:, None]
    tracks = smooth(make_recording(path, np.full((80, 1), np.arctan2(4.0, 3.0))))
    np.testing.assert_allclose(tracks.position, path, atol=0.01)
    np.testing.assert_allclose(np.hypot(*tracks.velocity.T), 5.0, atol=0.1)
    np.testing.assert_allclose(tracks.yaw_rate, 0.0, atol=0.01)
    assert tracks.travelled[-1, 0] == pytest.approx(5.0 * 7.9, abs=0.05)


def test_a_sideways_jump_becomes_a_lane_change(make_recording):
    time = np.arange(100) / 10.0
    path = np.stack([12.0 * time, np.where(time < 5.0, 0.0, 3.5)], axis=-1)[:, None]
    tracks = smooth(make_recording(path))
    sideways = np.abs(np.diff(tracks.position[:, 0, 1]))
    assert sideways.max() < 0.5
    np.testing.assert_allclose(tracks.position[[0, -1], 0, 1], [0.0, 3.5], atol=0.05)
    # The nose leads: the car turns towards the other lane, by less than a car can steer.
    assert 0.1 < tracks.yaw.max() < 0.8
    assert tracks.yaw[-1, 0] == pytest.approx(0.0, abs=0.02)


def test_only_groups_brake_in_an_instant(make_recording):
    """From 12.5 m/s to 0 in half a second, in the middle of a lane change."""
    speed = np.concatenate([np.full(50, 12.5), np.arange(10.0, 0.0, -2.5), np.zeros(40)])
    ahead = np.concatenate([[0.0], np.cumsum(speed) / 10.0])
    sideways = np.where(np.arange(len(ahead)) < 45, 0.0, 3.5)
    kept = make_recording(np.stack([ahead, sideways], axis=-1)[:, None])
    config = kept.provenance.config.model_copy(update={"demand": Demand.RESPAWN})
    groups = replace(kept, provenance=replace(kept.provenance, config=config))
    braking, tracks = {}, {}
    for name, recording in (("kept", kept), ("groups", groups)):
        tracks[name] = smooth(recording)
        braking[name] = -np.diff(tracks[name].velocity[:, 0, 0]).min() * 10.0
        assert np.abs(np.diff(tracks[name].position[:, 0, 1])).max() < 0.5
    assert braking["kept"] < 17.0
    assert 24.0 < braking["groups"] < 27.0
    np.testing.assert_allclose(tracks["groups"].velocity[58:], 0.0, atol=0.02)
    np.testing.assert_allclose(tracks["groups"].position[:, 0, 0], ahead, atol=0.35)
    assert (np.diff(tracks["groups"].travelled[:, 0]) >= 0.0).all()


def test_on_a_circle_the_rear_axle_runs_inside(make_recording):
    radius, speed = 20.0, 8.0
    angle = speed / radius * np.arange(400) / 10.0
    centre = radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    tracks = smooth(make_recording(centre[:, None], (angle + np.pi / 2)[:, None]))
    front = np.hypot(radius, 1.35)
    front *= np.exp(-0.5 * (0.3 * speed / radius) ** 2)  # what the Gaussian cuts off the corner
    rear = np.sqrt(front**2 - 2.7**2)
    middle = np.sqrt(rear**2 + 1.35**2)
    settled = slice(200, 380)
    np.testing.assert_allclose(np.hypot(*tracks.position[settled, 0].T), middle, atol=0.02)
    np.testing.assert_allclose(tracks.yaw_rate[settled, 0], speed / radius, atol=0.02)


def test_a_standing_car_does_not_turn(make_recording):
    tracks = smooth(make_recording(np.full((50, 1, 2), 7.25), np.full((50, 1), 1.0)))
    np.testing.assert_allclose(tracks.yaw, 1.0)
    np.testing.assert_allclose(tracks.velocity, 0.0, atol=1e-9)


def test_stays_are_smoothed_apart(wandering: TrafficRecording):
    tracks = smooth(wandering)
    here = wandering.present
    shift = np.hypot(*np.moveaxis(tracks.position - wandering.position, -1, 0))
    assert shift[here].max() < 1.0  # the second car is 1,500 m away
    gone = slice(51, 60)
    np.testing.assert_array_equal(tracks.position[gone, 2], tracks.position[[50] * 9, 2])
    assert not tracks.velocity[gone, 2].any()
    assert tracks.travelled[60, 2] == tracks.travelled[50, 2] > 0.0


def test_short_stays_do_not_fail(make_recording):
    present = np.zeros((9, 3), np.bool_)
    present[4, 0] = present[2:4, 1] = True
    tracks = smooth(make_recording(np.ones((9, 3, 2)), present=present))
    np.testing.assert_allclose(tracks.position[:, :2], 1.0)
    np.testing.assert_allclose(tracks.position[:, 2], 0.0)  # never there


def test_runs_and_held_values():
    present = np.array([False, True, True, False, False, True])
    assert runs(present) == [(1, 3), (5, 6)]
    values = np.arange(6.0)
    np.testing.assert_array_equal(held(values, present), [1.0, 1.0, 2.0, 2.0, 2.0, 5.0])
