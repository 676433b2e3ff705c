"""Copies of environments go on where their originals are, in this process and in others."""

import copy
import multiprocessing
import pickle
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.sim.step import step_of
from eyas.engine.trackers.drone import DRONE
from eyas.lanes import Kernel

from ...kit.walkers import FEW

SMALL = {"height": 16, "width": 16}

EVERYTHING: dict[str, Any] = {
    "lidar": {"enabled": True, "points": 30},
    "sensors": {
        "gps_position": {"noise": 0.1, "drop_out": 0.1},
        "camera": {"rate": 50, "noise": 0.01, "bias": 0.01, "drop_out": 0.1},
    },
    "control": {
        "action_latency_steps": {"uniform": [1, 9]},
        "observation_latency_steps": {"uniform": [0, 5]},
    },
    "done": {"crash": "end"},
    "light": {"background": {"uniform": [-0.2, 0.2]}},
    "env": {
        "actions": "velocity",
        "observation": {
            **SMALL,
            "frames": 3,
            "parts": ["image", "classes", "depth", "sensors", "lidar", "privileged"],
        },
    },
}
"""Everything that remembers something."""


def kinds() -> dict[str, dict[str, Any]]:
    """Settings by name."""
    flown = {
        "tracker": {
            "supervised": False,
            "drag_area": 0.1,
            "wind": {"speed": 4.0, "turbulence": 2.0},
        }
    }
    return {
        "plain": {"env": {"observation": SMALL}},
        "everything": EVERYTHING,
        "flown": {**EVERYTHING, **flown},
        "car": {**EVERYTHING, "tracker": {"kind": "car"}},
        "walker": {"target": "Pedestrian", "objects": FEW, "env": {"observation": SMALL}},
    }


def goes_on_alike(env: Any, other: Any, steps: int = 12) -> None:
    """Check that two environments do the same from now on, over the end of an episode."""
    for number in range(steps):
        env.action_space.seed(number)
        action = env.action_space.sample()
        assert_same(env.step(action), other.step(action))
    assert_same(env.reset(), other.reset())
    assert_same(env.step(action), other.step(action))


def assert_same(one: Any, other: Any) -> None:
    """Check that two results are equal to the last bit."""
    assert type(one) is type(other)
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        for name, value in one.items():
            assert_same(value, other[name])
    elif isinstance(one, tuple | list):
        assert len(one) == len(other)
        for mine, others in zip(one, other, strict=True):
            assert_same(mine, others)
    else:
        np.testing.assert_array_equal(one, other)


@pytest.mark.slow
@pytest.mark.parametrize("kind", kinds())
def test_copies_go_on_where_the_environment_is(kind: str) -> None:
    env = TrackingEnv(kinds()[kind])
    env.reset(seed=5)
    for number in range(7):
        env.action_space.seed(number)
        env.step(env.action_space.sample())
    copied = copy.deepcopy(env)
    loaded = pickle.loads(pickle.dumps(env))
    goes_on_alike(env, copied)
    # The copies have nothing in common with the original, which has gone on.
    again = pickle.loads(pickle.dumps(loaded))
    goes_on_alike(loaded, again)


def test_a_copy_takes_the_random_numbers_of_its_actions_along() -> None:
    env = TrackingEnv({"env": {"observation": SMALL}})
    env.action_space.seed(3)
    env.action_space.sample()
    copied = pickle.loads(pickle.dumps(env))
    drawn = [env.action_space.sample() for _ in range(20)]
    assert drawn == [copied.action_space.sample() for _ in range(20)]


def test_a_pickle_is_small() -> None:
    env = TrackingEnv({"env": {"observation": SMALL}})
    env.reset(seed=0)
    assert len(pickle.dumps(env)) < 200_000


def test_kernels_compiled_in_this_process_are_no_part_of_a_copy() -> None:
    env = TrackingEnv({"env": {"observation": SMALL}})
    env.reset(seed=0)
    for kernel in step_of(DRONE)[3:]:
        assert isinstance(kernel, Kernel)
        assert kernel._numba_type_  # as compiling a function that calls it leaves there
    assert len(pickle.dumps(env)) < 200_000


def test_vector_environments_are_copied() -> None:
    mixture = [{"settings": {}}, {"settings": {"world": {"weather": "snow"}}}]
    env = EyasVectorEnv(
        3,
        {"env": {"observation": {**SMALL, "frames": 2}}, "done": {"total_steps": 40}},
        mixture=mixture,
    )
    env.reset(seed=5)
    actions = np.zeros(3, np.int64)
    env.step(actions)
    copied = copy.deepcopy(env)
    for _ in range(12):  # over the end of episodes
        assert_same(env.step(actions), copied.step(actions))
    env.close()
    copied.close()


def test_drones_in_one_world_are_copied() -> None:
    pytest.importorskip("pettingzoo")
    from eyas.engine.envs.pettingzoo import EyasParallelEnv

    env = EyasParallelEnv(2, {"env": {"observation": SMALL}})
    env.reset(seed=5)
    env.step({"drone_0": 1, "drone_1": 2})
    copied = pickle.loads(pickle.dumps(env))
    for _ in range(5):
        actions = {"drone_0": 1, "drone_1": 2}
        assert_same(env.step(actions), copied.step(actions))
    assert_same(env.reset(), copied.reset())


def _steps(env: TrackingEnv, pipe: Any) -> None:
    pipe.send([env.step(0) for _ in range(3)])


@pytest.mark.slow
def test_another_process_goes_on_with_a_copy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(Path(__file__).parents[3])  # where it finds `_steps`
    env = TrackingEnv({"env": {"observation": SMALL}})
    env.reset(seed=5)
    env.step(1)
    context = multiprocessing.get_context("spawn")
    mine, others = context.Pipe()
    process = context.Process(target=_steps, args=(env, others))
    process.start()
    assert mine.poll(100)
    assert_same([env.step(0) for _ in range(3)], mine.recv())
    process.join()


@pytest.mark.slow
def test_gymnasium_steps_copies_in_spawned_processes() -> None:
    env = gymnasium.vector.AsyncVectorEnv(
        [lambda: TrackingEnv({"env": {"observation": SMALL}})] * 2, context="spawn"
    )
    alike = TrackingEnv({"env": {"observation": SMALL}})
    observations, _ = env.reset(seed=5)
    assert_same(observations[0], alike.reset(seed=5)[0])
    env.close()


def test_what_writes_logs_is_not_copied(tmp_path: Any) -> None:
    env = TrackingEnv({"verbose": True, "env": {"log_folder": str(tmp_path)}})
    with pytest.raises(EyasError, match=r"env\.log_folder: an environment that writes logs"):
        pickle.dumps(env)
    env.close()
