"""Several drones in one world, by PettingZoo's rules."""

import numpy as np
import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ObjectClass

pytest.importorskip("pettingzoo")
from eyas.engine.envs.pettingzoo import EyasParallelEnv

SMALL = {"observation": {"width": 24, "height": 20}}
SHORT = {"done": {"total_steps": 40, "grace_steps": 0, "no_reward_steps": 500}}
"""Episodes of ten actions."""


def test_pettingzoos_own_tests_pass(official):
    def make():
        return EyasParallelEnv(3, {"done": {"total_steps": 160}}, **SMALL)

    official.parallel_api_test(make(), num_cycles=50)
    official.parallel_seed_test(make, num_cycles=50)


def test_spaces_are_those_of_a_single_drone_and_each_drone_has_its_own():
    parts = {"parts": ["image", "sensors"], "width": 24, "height": 20}
    env = EyasParallelEnv(2, SHORT, actions="shares", observation=parts)
    single = TrackingEnv(SHORT, actions="shares", observation=parts)
    assert env.possible_agents == ["drone_0", "drone_1"]
    seen, info = env.reset(seed=1)
    for agent in env.agents:
        assert env.observation_space(agent) == single.observation_space
        assert env.action_space(agent) == single.action_space
        assert env.observation_space(agent).contains(seen[agent])
        assert info[agent].keys() == single.reset()[1].keys()
    first, second = (env.action_space(agent) for agent in env.agents)
    first.seed(0)
    second.seed(1)
    assert not np.array_equal(first.sample(), second.sample())


def test_a_drone_whose_episode_has_ended_leaves_and_hovers_while_the_others_fly():
    done = {"total_steps": 400, "grace_steps": 0, "no_reward_steps": 500, "max_height": 28.0}
    env = EyasParallelEnv(
        2,
        {"done": done, "start": {"height": 22.0}},
        actions="velocity",
        action_repeat=6,
        speeds={"vertical_speed": 0.04},
        **SMALL,
    )
    env.reset(seed=1)
    up, stay = np.array([0, 0, 20, 0], np.float32), np.zeros(4, np.float32)
    for _ in range(30):
        *_, terminated, truncated, info = env.step({"drone_0": up, "drone_1": stay})
        if terminated["drone_0"]:
            break
    assert info["drone_0"]["done_reason"] == "height"
    assert (terminated["drone_1"], truncated["drone_0"]) == (False, False)
    assert env.agents == ["drone_1"]
    with pytest.raises(EyasError, match=r"^actions: drone_0: not allowed: one .* drone_1$"):
        env.step({"drone_0": up, "drone_1": stay})
    where = env._batch._simulation.snapshot.trackers.position
    high, time = where[0].copy(), env._batch._simulation.snapshot.episodes.tick.copy()
    while env.agents:
        seen, rewards, terminated, truncated, info = env.step({"drone_1": stay})
        assert list(seen) == list(rewards) == list(terminated) == list(info) == ["drone_1"]
    assert truncated == {"drone_1": True}
    assert terminated == {"drone_1": False}
    assert info["drone_1"]["done_reason"] == "step_limit"
    assert np.allclose(where[0], high, atol=0.01)
    after = env._batch._simulation.snapshot.episodes.tick - time
    assert after[0] == after[1] > 0
    assert env.step({}) == ({}, {}, {}, {}, {})
    assert len(env.reset()[0]) == 2


def test_the_reason_of_an_end_is_told_also_if_it_is_over_before_the_action_is():
    done = {"grace_steps": 0, "no_reward_steps": 5000, "velocity": 10.0}
    env = EyasParallelEnv(2, {"done": done}, action_repeat=100, **SMALL)
    env.reset(seed=1)
    *_, terminated, _, info = env.step({"drone_0": 0, "drone_1": 6})
    assert terminated == {"drone_0": True, "drone_1": False}
    assert info["drone_0"]["done_reason"] == "velocity"
    assert info["drone_0"]["done_state"] != info["drone_0"]["done_reason"]
    assert np.linalg.norm(info["drone_0"]["velocity"]) < 10.0


@pytest.mark.parametrize("repeat", [1, 5])
def test_a_longer_action_gets_the_rewards_of_shorter_ones(repeat):
    long, short = (EyasParallelEnv(2, SHORT, action_repeat=count, **SMALL) for count in (repeat, 1))
    seen, plain = long.reset(seed=3)[0], short.reset(seed=3)[0]
    actions = {"drone_0": 0, "drone_1": 4}
    for _ in range(10 // repeat):
        seen, rewards, *_, truncated, _ = long.step(actions)
        total = np.zeros(2)
        for _ in range(repeat):
            plain, parts, *_, ended, _ = short.step(actions)
            total += list(parts.values())
        assert list(rewards.values()) == pytest.approx(total.tolist())
        assert truncated == ended
        assert all(np.array_equal(seen[agent], plain[agent]) for agent in actions)


def test_targets_are_the_drones_own_or_one_for_all_whom_they_surround():
    env = EyasParallelEnv(3, SHORT, **SMALL)
    env.reset(seed=5)
    snapshot = env._batch._simulation.snapshot
    assert len(set(snapshot.targets.actor.tolist())) == 3
    start = {"height": 20.0, "pitch": 0.8}
    env = EyasParallelEnv(3, {**SHORT, "same_target": True, "start": start}, **SMALL)
    env.reset(seed=5)
    snapshot = env._batch._simulation.snapshot
    assert len(set(snapshot.targets.actor.tolist())) == 1
    aside = (snapshot.trackers.position - snapshot.targets.centre)[:, :2]
    # A metre, by which middle and reference point differ, is applied along each drone's heading.
    assert np.linalg.norm(aside, axis=1) == pytest.approx(3 * [20.0 / np.tan(0.8)], abs=2.0)
    angle = np.degrees(np.arctan2(aside[:, 1], aside[:, 0]))
    assert np.diff(angle) % 360.0 == pytest.approx([120.0, 120.0], abs=5.0)


def test_episodes_begin_at_times_of_their_own_and_seeds_repeat_them():
    env = EyasParallelEnv(2, SHORT, **SMALL)
    ticks = env._batch._simulation.snapshot.episodes.tick
    times = []
    for seed in (7, None, None, 7, None):
        env.reset(seed=seed)
        assert ticks[0] == ticks[1]
        times.append(int(ticks[0]))
    assert times[:2] == times[3:]
    assert len(set(times)) == 3


def test_a_drone_is_in_the_pictures_of_the_other_and_all_are_rendered_side_by_side():
    env = EyasParallelEnv(2, SHORT, render_mode="rgb_array", observation={"parts": ["classes"]})
    env.reset(seed=2)
    simulation = env._batch._simulation
    cameras, trackers = simulation.snapshot.cameras, simulation.snapshot.trackers
    trackers.position[1] = cameras.position[0] + 2.0 * cameras.rotation[0, :, 0]
    seen = env._look(begun=False)
    drones = {agent: int((classes == ObjectClass.ROBOT).sum()) for agent, classes in seen.items()}
    assert drones["drone_0"] > 30
    assert drones["drone_1"] == 0
    frames = env.render()
    assert frames.shape == (240, 640, 3)
    picture = Picture.create(1, 240, 320)
    simulation.draw(np.array([1], np.int32), picture)
    assert np.array_equal(frames[:, 320:], picture.rgb[0])


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"num_drones": 0}, r"^num_drones: 0 is not allowed: a whole number, at least 1$"),
        ({"render_mode": "text"}, r"^render_mode: 'text' is not allowed"),
        ({"wether": "day"}, r"keyword.*wether"),
    ],
)
def test_wrong_arguments_are_refused_in_one_line(wrong, message):
    with pytest.raises(EyasError, match=message):
        EyasParallelEnv(**wrong)


def test_wrong_actions_are_refused_in_one_line():
    env = EyasParallelEnv(2, SHORT, **SMALL)
    env.reset(seed=0)
    with pytest.raises(
        EyasError, match=r"^actions: no drone_1: not allowed: one for each of .*_1$"
    ):
        env.step({"drone_0": 1})
    with pytest.raises(EyasError, match=r"^action of environment 1: 9 is not allowed"):
        env.step({"drone_0": 1, "drone_1": 9})
