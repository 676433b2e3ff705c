import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.state.motion import ActorState
from eyas.engine.traffic.recording import TrafficRecording
from eyas.engine.traffic.replay import Replay, check_time
from eyas.engine.traffic.smoothing import smooth


@pytest.fixture(scope="module")
def replay(wandering: TrafficRecording, flat_motion) -> Replay:
    return Replay(flat_motion(wandering))


def _at(replay: Replay, time: np.ndarray) -> ActorState:
    out = ActorState.create(len(time), replay.actors)
    replay.at(time, out)
    return out


def test_actors_and_duration_are_those_of_the_recording(
    replay: Replay, wandering: TrafficRecording
):
    assert (replay.actors, replay.duration) == (wandering.actors, wandering.duration) == (3, 20.0)


def test_samples_are_met(replay: Replay, wandering: TrafficRecording):
    tracks = smooth(wandering)
    out = _at(replay, np.arange(201) / 10.0)
    np.testing.assert_allclose(out.position[..., :2], tracks.position, atol=1e-4)
    np.testing.assert_allclose(out.yaw, tracks.yaw, atol=1e-5)
    np.testing.assert_allclose(out.yaw_rate, tracks.yaw_rate, atol=1e-4)
    np.testing.assert_allclose(out.travelled, tracks.travelled, atol=1e-4)
    speed = np.hypot(*np.moveaxis(tracks.velocity, -1, 0))
    np.testing.assert_allclose(out.speed, speed, atol=1e-3)
    np.testing.assert_array_equal(out.present, tracks.present)


def test_motion_has_no_seams(replay: Replay):
    time = np.arange(0.0, 20.0, 0.002)
    out = _at(replay, time)
    step = np.diff(out.position[:, :2, :2], axis=0) / 0.002
    speed = 0.5 * (out.speed[1:, :2] + out.speed[:-1, :2])
    np.testing.assert_allclose(np.hypot(*np.moveaxis(step, -1, 0)), speed, atol=0.02)
    assert np.abs(np.diff(out.speed[:, :2], axis=0)).max() < 0.01
    assert np.abs(np.diff(out.yaw[:, :2], axis=0) / 0.002 - out.yaw_rate[1:, :2]).max() < 0.02
    assert (np.diff(out.travelled[:, :2], axis=0) > 0.0).all()


def test_times_outside_are_held_at_the_ends(replay: Replay):
    out = _at(replay, np.array([-5.0, 0.0, 20.0, 99.0]))
    np.testing.assert_array_equal(out.position[0], out.position[1])
    np.testing.assert_array_equal(out.position[2], out.position[3])


def test_an_actor_is_away_between_two_vehicles(replay: Replay):
    times = np.array([5.0, 5.01, 5.5, 5.99, 6.0, 15.0, 15.05])
    there = _at(replay, times).present[:, 2]
    assert there.tolist() == [True, False, False, False, True, True, False]


def test_it_is_known_who_stays(replay: Replay, staying):
    assert staying(replay, 0.0, 5.0) == [0, 1, 2]
    assert staying(replay, 0.0, 5.05) == [0, 1]
    assert staying(replay, 4.0, 7.0) == [0, 1]
    assert staying(replay, 5.5, 5.6) == [0, 1]
    assert staying(replay, 6.0, 15.0) == [0, 1, 2]


def test_times_that_were_not_recorded_are_an_error(replay: Replay):
    check_time(20.0 + 1e-12, replay.duration)
    with pytest.raises(ConfigError, match=r"lasts 20 s, but 20\.1 s was asked for"):
        check_time(20.1, replay.duration)
