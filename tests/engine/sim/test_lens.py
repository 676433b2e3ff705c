"""Fields of view that differ from tracker to tracker, and from episode to episode."""

import math

import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.errors import ConfigError
from eyas.engine.exports.capture import FrameMoment, frame_of
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.draw import Picture
from eyas.engine.task.config import DoneConfig, StartConfig

RANDOM = {"uniform": [0.5, 1.3]}
FORWARD = (8.0, 0.0, 0.0, 0.0)


def started(field_of_view, count=1, *, shared=False, seed=0):
    config = SimConfig(
        seed=seed,
        camera=CameraConfig(width=96, height=72, field_of_view=field_of_view),
        start=StartConfig(pitch=1.2, height=22.0),
        done=DoneConfig(no_reward_steps=10_000),
    )
    simulation = build_simulation(config, (together if shared else each_alone)(count))
    simulation.reset()
    return simulation


def fields(simulation):
    return simulation.snapshot.cameras.field_of_view


def pictures(simulation):
    count = simulation.count
    picture = Picture.create(count, 36, 48, depth=True, object_id=True, subject=True)
    simulation.draw(np.arange(count, dtype=np.int32), picture)
    return picture


def test_a_number_is_the_field_of_view_of_all_episodes():
    simulation = started(0.9, 3)
    assert fields(simulation).tolist() == [0.9, 0.9, 0.9]
    simulation.reset(np.array([False, True, False]))
    assert fields(simulation).tolist() == [0.9, 0.9, 0.9]


@pytest.mark.parametrize("shared", [False, True])
def test_each_tracker_draws_its_own_at_each_reset(shared):
    simulation = started(RANDOM, 4, shared=shared)
    first = fields(simulation).copy()
    assert len(set(first.tolist())) == 4
    assert ((first >= 0.5) & (first <= 1.3)).all()
    simulation.reset(np.array([False, True, False, False]))
    assert (fields(simulation) != first).tolist() == [False, True, False, False]


def test_it_depends_on_seed_tracker_and_episode_only():
    one, many = started(RANDOM), started(RANDOM, 3)
    for simulation in (one, many):
        simulation.reset()
    assert fields(one)[0] == fields(many)[0]
    assert fields(started(RANDOM, seed=1))[0] != fields(started(RANDOM))[0]


def test_nothing_else_of_an_episode_changes_by_it():
    fixed, varied = started(0.9, 2), started(RANDOM, 2)
    for before, after in zip(fixed.snapshot.trackers, varied.snapshot.trackers, strict=True):
        np.testing.assert_array_equal(before, after)
    for before, after in zip(fixed.snapshot.targets, varied.snapshot.targets, strict=True):
        np.testing.assert_array_equal(before, after)


def test_rewards_packets_and_frames_are_those_of_a_simulation_with_that_lens():
    varied = started(RANDOM, 2)
    for n, field in enumerate(fields(varied).tolist()):
        alone = started(field, 2)
        for _ in range(5):
            mixed = varied.advance(np.tile(FORWARD, (2, 1)), 4)
            expected = alone.advance(np.tile(FORWARD, (2, 1)), 4)
            assert 0.0 < mixed.reward[n] == expected.reward[n] < 1.0
        for ours, theirs in zip(varied.packets(), alone.packets(), strict=True):
            np.testing.assert_array_equal(ours[n], theirs[n])
        assert varied.packets()[1][n, 2] == field
        assert varied.packets()[1][n, 3] == pytest.approx(48 / math.tan(field / 2))
        now, action = varied.snapshot.episodes, RecordedAction(-1, None)
        frame = frame_of(FrameMoment(varied.snapshot, now), n, pictures(varied), n, 0, action)
        assert frame.camera.field_of_view == field
        varied = started(RANDOM, 2)


def test_pictures_and_overlays_are_those_of_a_simulation_with_that_lens():
    varied = started(RANDOM, 2)
    mixed = pictures(varied)
    assert (mixed.subject_pixels[:, 0] > 0).all()
    for n, field in enumerate(fields(varied).tolist()):
        alone = started(field, 2)
        expected = pictures(alone)
        for name in ("rgb", "depth", "object_id", "subject_box", "subject_pixels"):
            np.testing.assert_array_equal(getattr(mixed, name)[n], getattr(expected, name)[n])
        overlaid = [Picture.create(2, 36, 48) for _ in range(2)]
        for simulation, picture in zip((varied, alone), overlaid, strict=True):
            simulation.draw(np.arange(2, dtype=np.int32), picture, overlay=True)
        np.testing.assert_array_equal(overlaid[0].rgb[n], overlaid[1].rgb[n])


def test_limits_hold_for_all_values_of_a_variation():
    for wrong in ({"uniform": [0.01, 1.0]}, {"choice": [0.7, 3.0]}, 0.0):
        with pytest.raises(ConfigError, match=r"field_of_view: .* it must stay within"):
            CameraConfig(field_of_view=wrong)
