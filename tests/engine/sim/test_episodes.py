"""Targets that leave, targets that are changed, rules that are changed."""

import numpy as np
import pytest

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.errors import ConfigError, SpawnError
from eyas.engine.core.rng import stream
from eyas.engine.core.variation import Mirrored, Uniform
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.catalogue import MODELS
from eyas.engine.task.config import DoneConfig, RewardConfig, RewardMode, RewardType, StartConfig
from eyas.engine.task.done import DoneReason
from eyas.engine.task.rules import BuiltinReward, make_rules
from eyas.engine.trackers.drone import DRONE

HOVER = np.zeros((1, 4))


def started(config, count=1):
    simulation = build_simulation(config, each_alone(count))
    simulation.reset()
    return simulation


def actors_at(replay, tick) -> ActorState:
    actors = ActorState.create(1, replay.actors)
    replay.at(np.array([tick * 0.002]), actors)
    return actors


def test_the_target_is_where_the_traffic_has_it(config, assets):
    simulation = started(config, 3)
    simulation.advance(np.zeros((3, 4)), 777)
    _, _, targets, episodes, _ = simulation.snapshot
    for n in range(3):
        actors = actors_at(assets.traffic, episodes.tick[n])
        here = 0, targets.actor[n]
        assert np.array_equal(targets.position[n, :2], actors.position[here][:2])
        assert (targets.yaw[n], targets.speed[n]) == (actors.yaw[here], actors.speed[here])
        model = MODELS[targets.model[n]]
        assert targets.size[n].tolist() == list(model.size)
        assert targets.position[n, 2] == targets.rise[n] == model.rise


def test_a_target_that_leaves_ends_the_episode_and_stays_where_it_was(config, assets_where):
    assets = assets_where((2.0, 3.0))
    # In a lasting world the time is given: a shorter stay will do if there is none for the whole.
    simulation = Simulation(config, assets, DRONE, together(1))
    simulation.reset()
    _, _, targets, episodes, _ = simulation.snapshot
    assert episodes.tick[0] == 310
    there = simulation.carry(1000 - 310)
    assert (there.reason[0], targets.lost[0]) == (DoneReason.NONE, False)
    last = targets.position[0].copy()
    gone = simulation.carry(1)
    assert (gone.reason[0], gone.done[0]) == (DoneReason.TARGET_LOST, True)
    assert targets.lost[0]
    assert targets.speed[0] == 0.0
    assert np.array_equal(targets.position[0], last)
    # Other vehicles come at 3 s, with the same numbers; the target stays lost.
    later = simulation.carry(700)
    assert later.reason[0] == DoneReason.TARGET_LOST
    assert np.array_equal(targets.position[0], last)
    simulation.reset()
    assert not targets.lost[0]
    assert simulation.carry(1).reason[0] == DoneReason.NONE
    assert not np.array_equal(targets.position[0], last)


def test_who_follows_another_target_has_lost_none(config, assets_where):
    simulation = Simulation(config, assets_where((2.0, 3.0)), DRONE, together(1))
    simulation.reset()
    assert simulation.carry(691).reason[0] == DoneReason.TARGET_LOST
    simulation.carry(600)
    actor = int(simulation.snapshot.targets.actor[0] + 1) % 40
    simulation.follow(0, actor)
    assert simulation.advance(HOVER).reason[0] == DoneReason.NONE
    assert simulation.snapshot.targets.speed[0] > 0.0


def test_a_lost_target_is_not_told_in_the_grace_of_a_young_episode(config, assets_where):
    simulation = Simulation(config, assets_where((0.7, 3.0)), DRONE, together(1))
    simulation.reset()
    reasons = [simulation.advance(HOVER).reason[0] for _ in range(100)]
    assert simulation.snapshot.targets.lost[0]
    assert reasons == [DoneReason.NONE] * 99 + [DoneReason.TARGET_LOST]


def test_where_nobody_is_there_is_no_start_and_one_line_says_so(config, assets_where):
    simulation = Simulation(config, assets_where((0.0, 13.0)), DRONE, together(1))
    with pytest.raises(SpawnError, match="no target is free: 0 in the world") as caught:
        simulation.reset()
    assert "traffic.group_interval" in str(caught.value)  # more trackers' targets would not help
    assert "\n" not in str(caught.value)


def test_where_nobody_stays_for_a_whole_episode_a_shorter_stay_is_enough(
    config, assets_where, staying
):
    done = config.done.model_copy(update={"total_steps": 5000})
    long = config.model_copy(update={"done": done})
    comings = assets_where((3.0, 4.0), (6.0, 7.0), (9.0, 10.0))
    simulation = Simulation(long, comings, DRONE, each_alone(3))
    simulation.reset()
    assert (simulation.snapshot.targets.actor >= 0).all()
    start = simulation.snapshot.episodes.tick * PHYSICS_STEP
    everybody = list(range(comings.traffic.actors))
    assert all(staying(comings.traffic, time, time + 1.0) == everybody for time in start)
    reason = DoneReason.NONE
    while reason == DoneReason.NONE:
        reason = simulation.carry(500).reason[0]
    assert reason == DoneReason.TARGET_LOST


def test_another_actor_can_be_followed_in_the_middle_of_an_episode(config, assets):
    simulation, untouched = started(config, 2), started(config, 2)
    _, _, targets, episodes, _ = simulation.snapshot
    commands = np.zeros((2, 4))
    simulation.advance(commands, 20)
    untouched.advance(commands, 20)
    actor = int(targets.actor[0] + 1) % 40
    simulation.follow(0, actor)
    after, other = simulation.advance(commands, 4), untouched.advance(commands, 4)
    actors = actors_at(assets.traffic, episodes.tick[0])
    assert targets.actor[0] == actor
    assert np.array_equal(targets.position[0, :2], actors.position[0, actor, :2])
    assert targets.size[0].tolist() == list(MODELS[targets.model[0]].size)
    assert episodes.step_count.tolist() == [24, 24]
    # The new target is somewhere else: the camera looks at the old one.
    assert after.reward[0] == 0.0 < other.reward[0]
    assert after.reward[1] == other.reward[1]
    same = untouched.snapshot.trackers
    for array, as_before in zip(simulation.snapshot.trackers, same, strict=True):
        assert np.array_equal(array, as_before)


@pytest.mark.parametrize("type_", RewardType)
@pytest.mark.parametrize("mode", RewardMode)
def test_rules_replaced_between_steps_are_those_of_the_next(config, type_, mode):
    """From then on all is as in a simulation that was built with these rules."""
    reward = RewardConfig(type=type_, mode=mode, view_range=0.9)
    built = started(config.model_copy(update={"reward": reward}))
    replaced = started(config)
    commands = np.array([[6.0, 2.0, 0.0, 0.3]])
    for step in range(40):
        if step == 20:
            replaced.rules = make_rules(reward, config.done, config.camera)
        expected, got = built.advance(commands, 4), replaced.advance(commands, 4)
        if step >= 20:
            assert got.reward == expected.reward
    replaced.reset()
    built.reset()
    assert replaced.advance(commands, 4).reward == built.advance(commands, 4).reward


def test_a_continuous_reward_becomes_a_discrete_one_in_the_next_step(config):
    simulation = started(config)
    commands = np.array([[3.0, 0.0, 0.0, 0.0]])
    assert 0.0 < simulation.advance(commands, 4).reward[0] < 1.0
    rules = simulation.rules._replace(reward=int(BuiltinReward.VIEW_DISCRETE))
    simulation.rules = rules
    assert simulation.advance(commands, 4).reward[0] == 1.0
    assert simulation.rules == rules


def test_another_step_limit_ends_a_running_episode(config):
    simulation = started(config)
    assert simulation.advance(HOVER, 150).reason[0] == DoneReason.NONE
    simulation.rules = make_rules(
        config.reward, DoneConfig(total_steps=152, no_reward_steps=10_000), config.camera
    )
    assert simulation.advance(HOVER).reason[0] == DoneReason.NONE
    assert simulation.advance(HOVER).reason[0] == DoneReason.STEP_LIMIT


@pytest.mark.parametrize("actor", [-1, 40, 999])
def test_an_actor_that_is_not_there_cannot_be_followed(config, actor):
    simulation = started(config.model_copy(update={"extras": ()}))
    with pytest.raises(SpawnError, match=f"^target: there is no actor {actor}; allowed: 0 to 39$"):
        simulation.follow(0, actor)


def test_starts_are_drawn_from_a_stream_in_the_originals_order(config, assets):
    start = StartConfig(
        pitch=Uniform(uniform=(0.6, 1.38)),
        height=Uniform(uniform=(13.0, 22.0)),
        direction=Uniform(uniform=(-3.0, 3.0)),
        horizontal_bias=Uniform(uniform=(-4.0, 4.0)),
        vertical_bias=Mirrored(mirrored=(2.5, 4.5)),
    )
    varied = config.model_copy(update={"start": start, "seed": 11})
    simulation = Simulation(varied, assets, DRONE, each_alone(2))
    simulation.reset()
    simulation.reset()
    trackers, _, targets, episodes, _ = simulation.snapshot
    rng = stream(11, "episode", 1, 1)
    first, last = varied.start.warm_up_steps, int(assets.traffic.duration / PHYSICS_STEP)
    assert episodes.tick[1] == rng.integers(first, last - varied.done.total_steps + 1)
    assert targets.actor[1] == rng.integers(assets.traffic.actors)  # all stay
    pitch, left = rng.uniform(0.6, 1.38), rng.uniform(-4.0, 4.0)
    sign = 1.0 if rng.random() < 0.5 else -1.0
    bias, height = sign * rng.uniform(2.5, 4.5), rng.uniform(13.0, 22.0)
    ahead = targets.ahead[1] + bias - np.tan(np.pi / 2 - pitch) * height
    offset = [ahead, left, height, rng.uniform(-3.0, 3.0)]
    np.testing.assert_allclose(episodes.start_offset[1], offset, rtol=1e-12)
    assert trackers.commanded_gimbal[1, 0] == pytest.approx(pitch)


def test_each_free_target_is_as_likely(config, assets_where):
    simulation = Simulation(config, assets_where((0.0, 13.0)), DRONE, together(2))
    simulation.traffic.stays().enters[:] = 0.0  # all are there, and some stay
    simulation.traffic.stays().leaves[4:] = 0.1
    simulation.traffic.stays().leaves[:4] = 13.0
    counts = np.zeros(40, int)
    for seed in range(1500):
        simulation.reseed(seed)
        simulation.rewind()
        simulation.reset()
        actors = simulation.snapshot.targets.actor
        assert actors[0] != actors[1]
        counts[actors] += 1
    assert counts[4:].sum() == 0
    assert counts[:4] == pytest.approx(750, abs=100)


def test_trackers_without_enough_targets_are_one_line_that_counts_them(config, assets_where):
    simulation = Simulation(config, assets_where(), DRONE, together(3))
    simulation.traffic.stays().leaves[2:] = 0.1
    with pytest.raises(SpawnError) as caught:
        simulation.reset()
    assert str(caught.value).startswith("start: no target is free: 2 in the world, 2 followed;")
    assert str(caught.value).endswith("as trackers, or same_target")
    assert "\n" not in str(caught.value)


def test_a_shared_world_whose_traffic_has_ended_is_told(config, assets):
    simulation = Simulation(config, assets, DRONE, together(1))
    simulation.reset()
    simulation.snapshot.episodes.tick[:] = int(assets.traffic.duration / PHYSICS_STEP) + 500
    with pytest.raises(ConfigError, match=r"the recording lasts .* s was asked for"):
        simulation.reset()
    simulation.rewind()
    simulation.reset()
