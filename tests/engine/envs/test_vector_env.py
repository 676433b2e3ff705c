"""The vector environment, against Gymnasium's own over single environments."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from eyas.engine.core.errors import EyasError
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.envs.vector_env import EyasVectorEnv

NAME = "eyas/citystreet-day-v0"
SMALL = {"width": 24, "height": 20}
SHORT = {"done": {"total_steps": 40, "grace_steps": 0, "no_reward_steps": 28}}
"""Episodes of at most ten actions, that end earlier where the target is lost."""
COUNT = 5
WORDS = ("done_reason", "done_state", "target_type")
"""A single environment tells these in words, a vector environment in numbers."""


def both(mode, config=SHORT, **choices):
    choices = {"observation": SMALL, **choices}
    ours = EyasVectorEnv(COUNT, config, autoreset_mode=mode, **choices)
    singles = [lambda: TrackingEnv(config, **choices) for _ in range(COUNT)]
    return ours, SyncVectorEnv(singles, autoreset_mode=mode)


def same(ours, theirs):
    """Check that all that Gymnasium's environment tells is told by ours, where it is valid."""
    for name, value in theirs.items():
        if name.startswith("_") or name in WORDS:
            continue
        mask = theirs[f"_{name}"]
        assert np.array_equal(ours[f"_{name}"], mask), name
        if isinstance(value, dict):
            same(ours[name], value)
            continue
        for mine, other in zip(ours[name][mask], value[mask], strict=True):
            assert np.array_equal(mine, other), name


@pytest.mark.parametrize("mode", AutoresetMode)
@pytest.mark.parametrize("repeat", [1, 3])
def test_it_gives_what_single_environments_give(mode, repeat):
    ours, theirs = both(mode, action_repeat=repeat)
    rng, ends = np.random.default_rng(1), 0
    for mine, other in [(ours.reset(seed=3), theirs.reset(seed=3)), (ours.reset(), theirs.reset())]:
        assert np.array_equal(mine[0], other[0])
        same(mine[1], other[1])
    for _ in range(25):
        actions = rng.integers(0, 7, COUNT)
        mine, other = ours.step(actions), theirs.step(actions)
        for array, expected in zip(mine[:4], other[:4], strict=True):
            assert array.dtype == expected.dtype
            assert np.array_equal(array, expected)
        same(mine[4], other[4])
        ended = mine[2] | mine[3]
        ends += int(ended.sum())
        if mode == AutoresetMode.DISABLED and ended.any():
            results = [env.reset(options={"reset_mask": ended.copy()}) for env in (ours, theirs)]
            assert np.array_equal(results[0][0], results[1][0])
            same(results[0][1], results[1][1])
    assert ends > COUNT


def test_the_number_of_environments_changes_none_of_them():
    few, many = (EyasVectorEnv(count, observation=SMALL) for count in (2, 7))
    assert np.array_equal(few.reset(seed=5)[0], many.reset(seed=5)[0][:2])
    for action in range(7):
        results = [env.step(np.full(env.num_envs, action)) for env in (few, many)]
        assert np.array_equal(results[0][0], results[1][0][:2])
        assert np.array_equal(results[0][1], results[1][1][:2])


def test_a_list_of_seeds_and_none_continue_what_each_had():
    env = EyasVectorEnv(3, observation=SMALL)
    start, _ = env.reset(seed=[8, 8, 2])
    assert np.array_equal(start[0], start[1])
    assert not np.array_equal(start[0], start[2])
    later, _ = env.reset(seed=[None, 8, None])
    assert not np.array_equal(later[0], start[0])
    assert np.array_equal(later[1], start[1])
    with pytest.raises(EyasError, match=r"^seed: 2 are given for 3 environments$"):
        env.reset(seed=[1, 2])


def test_without_a_seed_it_begins_with_that_of_the_configuration():
    starts = [EyasVectorEnv(2, {"seed": 4}, observation=SMALL).reset()[0] for _ in range(2)]
    assert np.array_equal(*starts)
    seeded, _ = EyasVectorEnv(2, observation=SMALL).reset(seed=4)
    assert np.array_equal(seeded, starts[0])


def test_observations_are_new_arrays_unless_a_ring_is_wanted():
    env = EyasVectorEnv(2, observation=SMALL)
    first, _ = env.reset(seed=0)
    kept = first.copy()
    env.step([0, 1])
    assert np.array_equal(first, kept)
    ring = EyasVectorEnv(2, observation=SMALL, copy=False)
    arrays = [ring.reset(seed=0)[0], *(ring.step([0, 1])[0] for _ in range(3))]
    assert arrays[0] is arrays[2] is not arrays[1] is arrays[3]


def test_observations_are_written_into_the_arrays_of_the_caller():
    env, other = (EyasVectorEnv(2, observation=SMALL) for _ in range(2))
    out = np.zeros((4, 20, 24, 3), np.uint8)
    got, _ = env.reset(seed=0, out=out[1:3])
    assert np.shares_memory(got, out)
    assert np.array_equal(out[1:3], other.reset(seed=0)[0])
    env.step([1, 2], out=out[1:3])
    assert np.array_equal(out[1:3], other.step([1, 2])[0])
    assert not out[[0, 3]].any()


def test_a_users_change_of_an_observation_changes_no_later_one():
    env, other = (EyasVectorEnv(2, observation={**SMALL, "frames": 3}) for _ in range(2))
    for got, expected in [(env.reset(seed=0), other.reset(seed=0))] + [
        (env.step([0, 1]), other.step([0, 1])) for _ in range(3)
    ]:
        assert np.array_equal(got[0], expected[0])
        got[0][:] = 0


def test_libraries_find_the_attributes_that_they_ask_for():
    env = gymnasium.make_vec(NAME, num_envs=2, observation=SMALL, render_mode="rgb_array")
    env.reset(seed=0)
    assert env.metadata["autoreset_mode"] is env.autoreset_mode is AutoresetMode.NEXT_STEP
    assert env.call("_max_episode_steps") == (375, 375)
    assert env.get_attr("render_mode") == ("rgb_array", "rgb_array")
    assert "citystreet" in env.call("task_description")[1]
    assert env.call("task_description")[0].startswith("Keep the target, a")
    env.set_attr("mark", [3, 4])
    assert env.get_attr("mark") == (3, 4)
    frames, called = env.render(), env.call("render")
    assert [frame.shape for frame in frames] == [(240, 320, 3)] * 2
    assert all(map(np.array_equal, frames, called))
    assert not np.array_equal(*frames)


def test_gymnasiums_vector_wrappers_work():
    env = gymnasium.wrappers.vector.RecordEpisodeStatistics(
        EyasVectorEnv(3, SHORT, observation=SMALL)
    )
    env.reset(seed=0)
    lengths = []
    for _ in range(12):
        *_, infos = env.step(np.full(3, 6))
        lengths += infos["episode"]["l"][infos["_episode"]].tolist() if "episode" in infos else []
    assert len(lengths) == 3
    assert max(lengths) <= 10


def test_an_episode_can_be_limited_in_actions():
    env = gymnasium.make_vec(
        NAME, num_envs=1, observation=SMALL, max_episode_steps=3, action_repeat=2
    )
    env.reset(seed=0)
    cut = [bool(env.step([6])[3][0]) for _ in range(3)]
    # The default settings let no episode end in its first 100 physics steps.
    assert env.unwrapped.config.done.total_steps == 24
    assert cut == [False] * 3


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"num_envs": 0}, "num_envs: 0 is not allowed"),
        ({"render_mode": "human"}, "render_mode: 'human' is not allowed"),
        ({"wether": "day"}, "did you mean 'weather'"),
        ({"observation": {"widht": 3}}, r"env\.observation\.widht: unknown key"),
    ],
)
def test_wrong_choices_are_one_clear_line(wrong, message):
    with pytest.raises(EyasError, match=message) as caught:
        EyasVectorEnv(**wrong)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        ([0], r"^actions: an array of shape \(1,\) is not allowed"),
        ([0, 9, 3], "^action of environment 1: 9 is not allowed: a whole number from 0 to 6$"),
        ([0.5, 1, 2], "is not allowed: a whole number"),
    ],
)
def test_wrong_actions_are_one_clear_line_and_change_nothing(actions, message):
    env, other = (EyasVectorEnv(3, observation=SMALL) for _ in range(2))
    env.reset(seed=1), other.reset(seed=1)
    with pytest.raises(EyasError, match=message):
        env.step(actions)
    assert np.array_equal(env.step([0, 1, 2])[0], other.step([0, 1, 2])[0])


@pytest.mark.parametrize("mask", [[True, False], np.zeros(2, bool), np.ones(3, bool), np.ones(2)])
def test_a_wrong_mask_is_refused(mask):
    env = EyasVectorEnv(2, observation=SMALL)
    env.reset(seed=0)
    with pytest.raises(EyasError, match="reset_mask"):
        env.reset(options={"reset_mask": mask})
