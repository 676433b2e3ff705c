"""The simulation as a whole, on the shipped map and traffic."""

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.draw import Picture
from eyas.engine.task.config import DoneConfig, StartConfig
from eyas.engine.task.done import DoneReason

CONFIG = SimConfig(
    start=StartConfig(pitch=1.37, height=22.0), done=DoneConfig(no_reward_steps=10_000)
)


def started(count: int = 1, *, shared: bool = False, config: SimConfig = CONFIG):
    simulation = build_simulation(config, (together if shared else each_alone)(count))
    simulation.reset()
    return simulation


def rollout(simulation, tracker: int, steps: int = 30) -> bytes:
    """Fly fixed actions; return everything that tracker saw and measured, as bytes."""
    actions = np.zeros((simulation.count, 4))
    actions[tracker] = [8.0, -3.0, 0.002, 0.4]
    said = []
    for _ in range(steps):
        simulation.advance(actions, 4)
        basic, reward = simulation.packets()
        said += [basic[tracker].tobytes(), reward[tracker].tobytes()]
    picture = Picture.create(1, 48, 64, depth=True, object_id=True, subject=True)
    simulation.draw(np.array([tracker], np.int32), picture)
    said += [picture.rgb.tobytes(), picture.depth.tobytes(), picture.object_id.tobytes()]
    return b"".join(said)


def test_the_target_is_in_the_middle_after_a_reset_and_the_picture_shows_it():
    simulation = started(4)
    picture = Picture.create(4, 120, 160, subject=True)
    simulation.draw(np.arange(4, dtype=np.int32), picture)
    assert (simulation.snapshot.episodes.reward > 0.8).all()
    left, top, right, bottom = picture.subject_box.T
    assert (np.abs((left + right) / 2 - 80) < 12).all()
    assert (np.abs((top + bottom) / 2 - 60) < 12).all()
    assert simulation.snapshot.trackers.gimbal[:, 1] == pytest.approx(1.37)


def test_one_tracker_does_the_same_alone_and_among_sixteen():
    assert rollout(started(1), 0) == rollout(started(16), 0)


def test_same_seed_same_bytes_and_another_seed_others():
    first, again = rollout(started(2), 1), rollout(started(2), 1)
    other = started(2)
    other.reseed(7)
    other.reset()
    assert first == again
    assert rollout(other, 1) != first


def test_resetting_one_tracker_leaves_the_others_alone():
    simulation, untouched = started(3), started(3)
    simulation.reset(np.array([True, False, False]))
    assert rollout(simulation, 1) == rollout(untouched, 1)
    assert simulation.snapshot.episodes.number.tolist() == [1, 0, 0]


def test_carrying_keeps_the_offset_and_the_reward():
    simulation = started(2, shared=True)
    episodes, before = simulation.snapshot.episodes, simulation.snapshot.copy()
    result = simulation.carry(500)
    assert result.reward == pytest.approx(before.episodes.reward, abs=0.05)
    assert (episodes.tick == before.episodes.tick + 500).all()
    assert (before.episodes.tick * 0.002 == 0.62).all()
    assert (episodes.step_count == 500).all()
    offset = np.linalg.norm(
        simulation.snapshot.trackers.position - simulation.snapshot.targets.position, axis=1
    )
    asked = np.linalg.norm(episodes.start_offset[:, :3], axis=1)
    assert offset == pytest.approx(asked, abs=1e-9)


def test_trackers_in_one_world_follow_different_cars():
    simulation = started(8, shared=True)
    assert len(set(simulation.snapshot.targets.actor.tolist())) == 8


def test_flying_forward_for_a_second_moves_as_far_as_the_filtered_command_says():
    simulation = started(1)
    start = simulation.snapshot.trackers.position[0].copy()
    actions = np.array([[10.0, 0.0, 0.0, 0.0]])
    simulation.advance(actions, 500)
    moved = np.linalg.norm(simulation.snapshot.trackers.position[0] - start)
    # The low-pass delays a command by 2.81 samples of 2 ms.
    assert moved == pytest.approx(10.0 * (1.0 - 2.81 * 0.002), abs=1e-3)


def test_the_episode_ends_at_its_number_of_steps():
    config = CONFIG.model_copy(update={"done": DoneConfig(total_steps=200, no_reward_steps=10_000)})
    simulation = started(1, config=config)
    before = simulation.carry(199)
    assert not before.done[0]
    assert before.reason[0] == DoneReason.NONE
    after = simulation.carry(1)
    assert after.done[0]
    assert after.reason[0] == DoneReason.STEP_LIMIT


def test_an_episode_longer_than_the_recording_is_refused_in_one_line():
    config = CONFIG.model_copy(update={"done": DoneConfig(total_steps=2_000_000)})
    with pytest.raises(ConfigError, match=r"done\.total_steps: 2000000"):
        build_simulation(config, each_alone(1))


def test_depth_at_the_target_is_its_distance_along_the_axis():
    simulation = started(1)
    picture = Picture.create(1, 240, 320, depth=True, object_id=True, subject=True)
    simulation.draw(np.zeros(1, np.int32), picture)
    seen = picture.object_id[0] == 65536 + simulation.snapshot.targets.actor[0]
    assert seen.sum() == picture.subject_pixels[0, 0]
    offset = simulation.snapshot.targets.centre[0] - simulation.snapshot.cameras.position[0]
    along = offset @ simulation.snapshot.cameras.rotation[0, :, 0]
    assert np.median(picture.depth[0][seen]) == pytest.approx(along, abs=1.5)


def arrays_of(snapshot):
    """All arrays of a snapshot by path."""
    parts = {}
    for part in snapshot._fields:
        named = getattr(snapshot, part)._asdict().items()
        parts |= {f"{part}.{name}": array for name, array in named}
    return parts


def test_a_copied_snapshot_is_left_alone_by_later_steps():
    simulation = started(2)
    simulation.advance(np.full((2, 4), 0.5), 8)
    live, kept = simulation.snapshot, simulation.snapshot.copy()
    before = {name: array.copy() for name, array in arrays_of(kept).items()}
    simulation.advance(np.full((2, 4), -0.5), 300)
    simulation.reset(np.array([True, False]))
    for name, array in arrays_of(kept).items():
        np.testing.assert_array_equal(array, before[name], err_msg=name)
    changed = {name for name, array in arrays_of(live).items() if (array != before[name]).any()}
    assert {"trackers.position", "cameras.position", "targets.centre", "episodes.tick"} <= changed


def test_results_of_a_step_are_left_alone_by_later_ones():
    done = DoneConfig(total_steps=200, grace_steps=0)
    simulation = started(2, config=CONFIG.model_copy(update={"done": done}))
    result = simulation.advance(np.zeros((2, 4)), 4)
    flat = [result.reward, *result.terms.values(), result.reason, result.done]
    before = [array.copy() for array in flat]
    later = simulation.advance(np.full((2, 4), 3.0), 300)
    for array, kept in zip(flat, before, strict=True):
        np.testing.assert_array_equal(array, kept)
    assert (later.reward != result.reward).all()
    assert later.done.all()
    assert not result.done.any()
