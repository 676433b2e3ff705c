"""When objects come, and when they are moved elsewhere."""

import numpy as np
import pytest

from eyas.engine.behaviours.groups import SampleClock, recycled
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.targets.config import ObjectsConfig
from eyas.engine.traffic.replay import Replay


def test_objects_are_recycled_but_stay_for_an_episode(staying):
    config, clock = ObjectsConfig(), SampleClock(12601, 10.0)
    lifetimes = recycled(config, *clock, episode=3.0)
    assert set(lifetimes.slot.tolist()) == set(range(10))
    assert len(lifetimes.slot) > 100  # moved elsewhere again and again
    motion = np.zeros((clock.samples, 10))
    for slot, a, b in zip(*lifetimes, strict=True):
        assert not motion[a - 1 if a else 0 : b + 1, slot].any()  # never twice at once
        motion[a : b + 1, slot] = 1
    assert motion[50:].sum(axis=1).min() >= 10 - config.group_size
    # Groups enter after each other, as in the original.
    assert motion[0].sum() == 4
    assert motion[6].sum() == 8
    table = np.zeros(motion.shape, SAMPLE)
    table["present"] = motion
    replay = Replay(SampledMotion(table, np.zeros(10, np.int32), 10.0).packed())
    lasts = [len(staying(replay, t, t + 3.0)) for t in np.linspace(2.0, 1200.0, 400)]
    assert min(lasts) >= 5


@pytest.mark.parametrize(
    ("count", "group", "followers", "episode"),
    [(1, 4, 1, 3.0), (4, 4, 4, 3.0), (6, 4, 4, 3.0), (9, 1, 8, 20.0), (100, 50, 40, 30.0)],
)
def test_nobody_is_moved_whom_a_tracker_must_follow(count, group, followers, episode, staying):
    """In a world whose time goes on, each of the followers finds somebody who stays."""
    config, clock = (
        ObjectsConfig(max_count=count, group_size=group, interval=5.0),
        SampleClock(12601, 10),
    )
    lifetimes = recycled(config, *clock, episode, followers)
    table = np.zeros((clock.samples, count), SAMPLE)
    for slot, a, b in zip(*lifetimes, strict=True):
        table["present"][a : b + 1, slot] = 1
    replay = Replay(SampledMotion(table, np.zeros(count, np.int32), 10.0).packed())
    begins = np.arange(0.0, clock.samples / 10.0 - 1.0 - episode, 0.25)
    stay = [len(staying(replay, t, t + episode)) for t in begins.tolist()]
    assert min(stay) >= followers
    assert (len(lifetimes.slot) > count) == (count > followers)  # moved, where one can be spared


def test_longer_episodes_make_longer_lives():
    long = recycled(ObjectsConfig(), 12601, 10.0, episode=60.0)
    stays = (long.leaves - long.enters)[long.slot == 5] / 10.0
    assert sorted(stays)[len(stays) // 2] == pytest.approx(240.0, abs=1.0)


def test_an_interval_that_leaves_each_four_episodes_is_that_between_groups():
    for interval, stay in ((0.5, 60.0), (3.9, 60.0), (4.0, 12.0), (10.0, 30.0), (30.0, 90.0)):
        lifetimes = recycled(ObjectsConfig(interval=interval), 12601, 10.0, episode=3.0)
        moved = np.sort(lifetimes.enters[lifetimes.slot == 5])[2:]
        assert np.diff(moved).mean() / 10.0 == pytest.approx(stay, abs=0.1)
        begun = np.unique(lifetimes.enters[lifetimes.enters > 3000])
        assert np.diff(begun).mean() / 10.0 == pytest.approx(stay / 3, abs=0.1)
