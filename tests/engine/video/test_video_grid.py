import numpy as np
import pytest

from eyas.engine.settings.video import VideoConfig
from eyas.engine.video.frame_grid import FrameGrid


def frames_of(video: VideoConfig, *, episode_steps: int, ticks: int, begin: int = 0) -> list[int]:
    """Return the ticks at which the only tracker, reset every `episode_steps`, has a frame."""
    grid = FrameGrid(video, 1)
    found, step = [], 0
    for tick in range(begin + 1, begin + ticks + 1):
        step += 1
        if grid.due(tick, np.array([step])).size:
            found.append(tick)
        if step == episode_steps:
            grid.restart(np.array([True]))
            step = 0
    return found


def test_frames_lie_within_the_asked_time():
    video = VideoConfig(fps=25.0, start_time=1.0, total_time=0.1, warm_up_steps=0)
    assert frames_of(video, episode_steps=10_000, ticks=2000) == [500, 520, 540]


def test_a_rate_that_is_no_whole_number_of_steps_does_not_drift():
    video = VideoConfig(fps=30.0, start_time=0.0, total_time=10.0, warm_up_steps=0)
    found = frames_of(video, episode_steps=10_000, ticks=5000)
    assert len(found) == 300
    assert found == [1 + int(k * 500 / 30 + 0.5) for k in range(300)]


def test_the_second_frame_of_a_later_episode_keeps_its_distance():
    video = VideoConfig(fps=50.0, start_time=0.0, total_time=10.0, warm_up_steps=30)
    found = frames_of(video, episode_steps=100, ticks=300)
    assert found == [base + step for base in (0, 100, 200) for step in (31, 41, 51, 61, 71, 81, 91)]


def test_warm_up_steps_have_no_frame():
    video = VideoConfig(fps=500.0, start_time=0.0, total_time=1.0, warm_up_steps=40)
    assert frames_of(video, episode_steps=50, ticks=100)[:11] == [*range(41, 51), 91]


@pytest.mark.parametrize("fps", [333.0, 500.0])
def test_no_rate_gives_two_frames_at_a_step(fps):
    video = VideoConfig(fps=fps, start_time=0.0, total_time=1.0, warm_up_steps=0)
    found = frames_of(video, episode_steps=10_000, ticks=500)
    assert len(found) == pytest.approx(fps, abs=1)
    assert sorted(set(found)) == found


def test_each_tracker_has_its_own_grid():
    video = VideoConfig(fps=50.0, start_time=0.0, total_time=10.0, warm_up_steps=0)
    grid = FrameGrid(video, 2)
    assert grid.due(7, np.array([1, 0])).tolist() == [0]
    assert grid.due(9, np.array([3, 1])).tolist() == [1]
    assert grid.due(17, np.array([11, 9])).tolist() == [0]
    grid.restart(np.array([True, False]))
    assert grid.due(19, np.array([1, 11])).tolist() == [0, 1]
