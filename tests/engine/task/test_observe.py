import math
from types import SimpleNamespace

import numpy as np
import pytest

from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.direction import TargetDirection
from eyas.engine.task.observe import clear_episode, observe
from eyas.engine.task.reward import rewarded_size

N = 1
FLAT = Terrain.flat(-0.1)

# Known when an episode begins, before its first observation.
KNOWN_BEFORE = {"number", "tick", "start_offset"}
# Said by every observation.
SAID_ANEW = {
    *("view_centre", "last_target", "relative_position"),
    *("offset", "proportion", "first_position"),
}


@pytest.fixture
def see(snapshot, rules_with, look):
    """Observe a target from a drone at a place and a heading, with a camera 1 m above it."""
    rules = rules_with()
    size = rewarded_size(0.7854, rules)
    trackers, cameras, targets, episodes, _ = snapshot
    clear_episode(episodes, N)

    def observed(target, target_yaw=0.0, position=(0.0, 0.0, 20.0), yaw=0.0, pitch=1.0):
        trackers.position[N] = position
        trackers.orientation[N] = math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)
        cameras.position[N] = trackers.position[N] + (0.0, 0.0, 1.0)
        cameras.rotation[N] = look(yaw, pitch)
        targets.position[N] = targets.centre[N] = target
        targets.yaw[N] = target_yaw
        targets.slowest[N] = 0.5
        observe(trackers, cameras, targets, episodes, N, FLAT, rules, size)
        return SimpleNamespace(**{name: array[N] for name, array in episodes._asdict().items()})

    return observed


def test_a_new_episode_forgets_the_one_before_and_no_other_tracker_s():
    episodes = EpisodeState(*(np.full_like(array, 7) for array in EpisodeState.create(3)))
    clear_episode(episodes, N)
    forgotten = {name for name, array in episodes._asdict().items() if not array[N].any()}
    assert episodes.contact_object[N] == -1
    forgotten.add("contact_object")
    assert forgotten == set(EpisodeState._fields) - KNOWN_BEFORE - SAID_ANEW
    for array in episodes:
        assert (array[[0, 2]] == np.full_like(array, 7)[[0, 2]]).all()


def test_reward_and_middle_of_the_view(see):
    reach = 21.1 / math.tan(1.0)
    episode = see((reach, 0.0, 0.3))
    assert episode.reward == pytest.approx(math.tanh(4.0))
    assert episode.view_centre == pytest.approx([reach, 0.0, -0.1])
    assert see((-reach, 0.0, 0.3)).reward == 0.0


def test_relative_position_is_in_the_body_frame(see):
    episode = see((1.0, 5.0, 0.5), position=(1.0, 2.0, 20.0), yaw=math.pi / 2)
    assert episode.relative_position == pytest.approx([3.0, 0.0, -19.5])


def test_first_sample_has_no_velocity_and_second_no_acceleration(see):
    episode = see((5.0, 0.0, 0.0))
    assert not episode.relative_velocity.any()
    episode = see((5.02, 0.0, 0.0))
    assert episode.relative_velocity == pytest.approx([10.0, 0.0, 0.0])
    assert not episode.relative_acceleration.any()
    episode = see((5.05, 0.0, 0.0))
    assert episode.relative_velocity == pytest.approx([15.0, 0.0, 0.0])
    assert episode.relative_acceleration == pytest.approx([2500.0, 0.0, 0.0], abs=1e-6)


def test_relative_velocity_feels_the_turning_frame(see):
    see((5.0, 0.0, 0.0))
    episode = see((5.0, 0.0, 0.0), yaw=0.002)
    assert episode.relative_velocity == pytest.approx([0.0, -5.0, 0.0], abs=6e-3)


def test_direction_is_known_from_the_second_sample(see):
    assert see((5.0, 0.0, 0.0), 3.0).direction == TargetDirection.STOP
    assert see((5.02, 0.0, 0.0), 3.0).direction == TargetDirection.STRAIGHT
    assert see((5.04, 0.0, 0.0), 3.001).direction == TargetDirection.LEFT
    assert see((5.06, 0.0, 0.0), 3.0).direction == TargetDirection.RIGHT
    assert see((5.06, 0.0, 0.0), 3.0).direction == TargetDirection.STOP


def test_the_reward_falls_steadily_as_the_view_rises_above_the_horizon(see):
    below = 21.1 / math.tan(1.0)
    rewards = [see((below, 0.0, 0.3), pitch=pitch).reward for pitch in np.linspace(1.0, -0.5, 100)]
    assert rewards[0] == pytest.approx(math.tanh(4.0))
    assert (np.diff(rewards) <= 0.0).all()
    assert rewards[-1] == 0.0
    # A target far ahead loses its reward before the horizon is in the middle, and for good.
    far = [see((2000.0, 0.0, 0.3), pitch=pitch).reward for pitch in np.linspace(0.01, -0.5, 60)]
    assert far[0] > 0.9
    assert (np.diff(far) <= 0.0).all()
    assert far[-1] == 0.0
