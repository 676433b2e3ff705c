"""Smoothed trajectories: less of the errors, and still the motion."""

from pathlib import Path

import numpy as np
import pytest

from eyas.engine.custom.smoothing import smoothed
from eyas.engine.custom.trajectory import Trajectory
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import together

GRID = np.arange(0.0, 120.0, 0.1)


def track(time: np.ndarray, points: np.ndarray, yaw: np.ndarray | None = None) -> Trajectory:
    return Trajectory(time, np.column_stack([points, np.full(len(time), np.nan)]), yaw)


def walk(time: np.ndarray) -> np.ndarray:
    """East for 40 s, a stand of 40 s, north for 40 s, at 1.4 m/s."""
    return 1.4 * np.column_stack([np.clip(time, 0.0, 40.0), np.clip(time - 80.0, 0.0, 40.0)])


def uneven(rng: np.random.Generator) -> np.ndarray:
    """Times of 1 to 10 Hz from 0 to 120 s, with a gap of 6 s."""
    time = np.cumsum(rng.uniform(0.1, 1.0, 400))
    time = time[(time < 119.5) & ((time < 20.0) | (time > 26.0))]
    return np.concatenate([[0.0], time, [120.0]])


def erring(rng: np.random.Generator, time: np.ndarray) -> np.ndarray:
    """Errors of a receiver of 1 m a direction, correlated over half a second."""
    errors = rng.normal(0.0, 1.0, (len(time), 2))
    for k, step in enumerate(np.diff(time), 1):
        same = np.exp(-step / 0.5)
        errors[k] = same * errors[k - 1] + np.sqrt(1.0 - same**2) * errors[k]
    return errors


def distance(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.hypot(*(a[:, :2] - b[:, :2]).T)


@pytest.mark.parametrize("seed", range(3))
def test_errors_fall_by_half_and_a_stand_is_one(seed: int):
    rng = np.random.default_rng(seed)
    time = uneven(rng)
    noisy = track(time, walk(time) + erring(rng, time))
    before, _ = noisy.at(GRID)
    after, yaw = smoothed(noisy, 2.0).at(GRID)
    rms = [np.sqrt(np.square(distance(path, walk(GRID))).mean()) for path in (before, after)]
    assert rms[1] < 0.5 * rms[0]
    shake = [np.diff(path[:, :2] - walk(GRID), axis=0).std() * 10.0 for path in (before, after)]
    assert shake[1] < 0.15 * shake[0]
    standing = slice(480, 720)  # after T * 4 s of it
    assert distance(after[standing], after[standing][:1]).max() < 0.3
    assert np.ptp(yaw[standing]) == 0.0
    assert abs(yaw[standing][0]) < 0.7  # as it came
    ends = distance(after[[0, -1]], walk(GRID[[0, -1]]))
    assert ends.max() < 2.0


def test_uniform_motion_and_stands_stay_whatever_the_times():
    rng = np.random.default_rng(0)
    time = np.concatenate([np.arange(0.0, 2.0, 0.001), uneven(rng) + 3.0, [2000.0]])
    line = np.column_stack([3.0 * time - 50.0, 7.0 - time])
    for seconds in (1e-300, 1e-3, 1.0, 10.0):
        np.testing.assert_allclose(smoothed(track(time, line), seconds).position[:, :2], line,
                                   atol=1e-5)  # fmt: skip
    still = smoothed(track(time, np.full((len(time), 2), 30.0)), 3.0)
    np.testing.assert_allclose(still.at(GRID)[0][:, :2], 30.0, atol=1e-9)
    np.testing.assert_array_equal(still.at(GRID)[1], 0.0)


def test_it_is_the_spline_that_it_says():
    rng = np.random.default_rng(3)
    time, seconds = np.sort(rng.uniform(0.0, 20.0, 30)), 1.3
    time -= time[0]
    points, step = 30.0 * rng.normal(size=(30, 2)), np.diff(time)
    near = np.concatenate([[0.0], np.minimum(step, seconds), [0.0]])
    weight = np.diag(near[:-1] + near[1:]) / 2.0
    # Green and Silverman (1994), 2.1: the integral of f''^2 is f' Q R^-1 Q' f.
    bend = np.diff(np.diff(np.eye(30), axis=0) / step[:, None], axis=0)
    gram = np.diag(step[:-1] + step[1:]) / 3.0
    gram += np.diag(step[1:-1], 1) / 6.0 + np.diag(step[1:-1], -1) / 6.0
    whole = weight + seconds**4 * bend.T @ np.linalg.solve(gram, bend)
    found = smoothed(track(time, points), seconds).position[:, :2]
    np.testing.assert_allclose(found, np.linalg.solve(whole, weight @ points), atol=1e-5)


@pytest.mark.parametrize(("speed", "seconds"), [(1.4, 2.0), (10.0, 1.0)])
def test_a_sharp_turn_is_cut_by_half_of_the_way_in_that_time(speed: float, seconds: float):
    time = np.arange(0.0, 40.0, 0.2)
    ways = np.minimum(time, 20.0), np.maximum(time - 20.0, 0.0)
    turn = smoothed(track(time, speed * np.column_stack(ways)), seconds)
    place, yaw = turn.at(np.arange(0.0, 39.8, 0.1))
    corner = np.array([[20.0 * speed, 0.0]])
    assert distance(place, corner).min() == pytest.approx(0.5 * speed * seconds, rel=0.02)
    assert yaw[[0, -1]] == pytest.approx([0.0, np.pi / 2], abs=0.01)


def test_who_brakes_hard_does_not_turn_round():
    time = np.arange(0.0, 40.0)
    stop = smoothed(track(time, np.column_stack([10.0 * np.minimum(time, 20.0), 0.0 * time])), 2.0)
    np.testing.assert_allclose(stop.at(np.arange(0.0, 39.0, 0.1))[1], 0.0, atol=1e-6)


def test_heights_are_smoothed_too_and_headings_stay():
    time = np.arange(0.0, 60.0)
    rng = np.random.default_rng(0)
    points = np.column_stack([walk(time), 5.0 + rng.normal(0.0, 1.0, 60)])
    noisy = Trajectory(time, points, np.linspace(0.0, 3.0, 60))
    place, yaw = smoothed(noisy, 3.0).at(time)
    assert (place[:, 2] - 5.0).std() < 0.5 * points[:, 2].std()
    np.testing.assert_array_equal(yaw, noisy.at(time)[1])


def test_the_setting_reaches_the_motion_and_0_leaves_it_alone(tmp_path: Path):
    rng = np.random.default_rng(1)
    time = uneven(rng)
    points = walk(time) + erring(rng, time)
    lines = [f"{t},{x},{y}" for t, (x, y) in zip(time, points, strict=True)]
    (tmp_path / "walk.csv").write_text("\n".join(["t,x,y", *lines]))

    def speed(**custom: object) -> np.ndarray:
        settings = {"trajectory": str(tmp_path / "walk.csv"), **custom}
        config = SimConfig.model_validate({"extras": [], "custom": settings})
        first = build_simulation(config, together(1)).traffic.motion.table[:1190, 0]
        return np.hypot(first["velocity_x"], first["velocity_y"])

    np.testing.assert_array_equal(speed(smoothing=0.0), speed())
    place, _ = track(time, points).at(GRID)
    plain = np.hypot(*np.gradient(place[:, :2], 0.1, axis=0).T)
    np.testing.assert_allclose(speed()[1:1180], plain[1:1180], atol=1e-4)
    assert speed().max() > 4.0
    calm = speed(smoothing=2.0)
    assert calm.max() < 2.5
    assert calm[480:720].max() < 0.1  # it stands
