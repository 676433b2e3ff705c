"""Environments in several processes, against the same in one."""

import gc
import os
import signal
import subprocess
import sys
import time
from multiprocessing import active_children
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ClosedEnvironmentError
from gymnasium.vector import AutoresetMode

from eyas.core.errors import ActionError, EyasError
from eyas.envs.vector_env import EyasVectorEnv

sys.path.insert(0, str(Path(__file__).parent))

NAME = "eyas/citystreet-day-v0"
COUNT = 5
SHORT = {"done": {"total_steps": 40, "grace_steps": 0, "no_reward_steps": 28}}
"""Episodes of at most ten actions, that end earlier where the target is lost."""
MIXED = [
    {"weight": 2, "settings": {"reward": {"terms": {"own_terms:height": 0.5}}}},
    {"weight": 1, "settings": {"control": {"frequency": 62.5}}},
]
PARTS = {"parts": ["image", "sensors"], "width": 24, "height": 20}


def same(mine, other):
    """Check that two results are the same to the byte."""
    assert type(mine) is type(other)
    if isinstance(mine, dict):
        assert mine.keys() == other.keys()
        for name in mine:
            same(mine[name], other[name])
    elif isinstance(mine, tuple | list):
        for one, another in zip(mine, other, strict=True):
            same(one, another)
    elif isinstance(mine, np.ndarray) and mine.dtype == object:
        same(list(mine), list(other))
    elif isinstance(mine, np.ndarray):
        assert mine.dtype == other.dtype
        assert mine.tobytes() == other.tobytes()
    else:
        assert mine == other


@pytest.fixture(scope="module")
def pair():
    """The same environments in two processes and in this one, with kinds of different rewards."""
    made = [
        EyasVectorEnv(
            COUNT, SHORT, observation=PARTS, mixture=MIXED, render_mode="rgb_array", **more
        )
        for more in ({"workers": 2}, {})
    ]
    yield made
    for env in made:
        env.close()


@pytest.mark.parametrize("mode", AutoresetMode)
def test_they_give_the_same_bytes(pair, mode):
    for env in pair:
        env.autoreset_mode = mode
    rng, ends = np.random.default_rng(1), 0
    same(*(env.reset(seed=3) for env in pair))
    same(*(env.reset(seed=[None, 8, None, 8, 1]) for env in pair))
    for _ in range(25):
        actions = rng.integers(0, 7, COUNT)
        results = [env.step(actions) for env in pair]
        same(*results)
        ended = results[0][2] | results[0][3]
        ends += int(ended.sum())
        if mode == AutoresetMode.DISABLED and ended.any():
            same(*(env.reset(options={"reset_mask": ended.copy()}) for env in pair))
    assert ends > COUNT


def test_they_have_the_same_attributes_and_pictures(pair):
    for env in pair:
        env.reset(seed=2)
    same(pair[0].render(), pair[1].render())
    same(*(env.call("_max_episode_steps") for env in pair))
    same(*(env.get_attr("config") for env in pair))
    assert pair[0].config_of(0) != pair[0].config_of(1), "this tests kinds only if there are some"
    pair[0].set_attr("mark", list(range(COUNT)))
    assert pair[0].get_attr("mark") == tuple(range(COUNT))


def test_a_wrong_action_is_refused_before_any_environment_moves(pair):
    for env in pair:
        env.autoreset_mode = AutoresetMode.NEXT_STEP
        env.reset(seed=1)
        with pytest.raises(
            ActionError, match=r"^action of environment 4: 9 is not allowed: a whole"
        ):
            env.step([0, 0, 0, 0, 9])
        with pytest.raises(ActionError, match=r"^actions: an array of shape \(1,\)"):
            env.step([0])
    same(*(env.step([0, 1, 2, 3, 4]) for env in pair))


def test_gymnasium_makes_them_by_one_argument():
    env = gymnasium.make_vec(NAME, num_envs=2, workers=2, observation={"width": 8, "height": 8})
    assert len(active_children()) >= 2
    assert env.reset(seed=0)[0].shape == (2, 8, 8, 3)
    told = env.call("task_description")
    env.close()
    env.close()
    here = gymnasium.make_vec(NAME, num_envs=2, observation={"width": 8, "height": 8})
    here.reset(seed=0)
    assert told == here.call("task_description")
    with pytest.raises(ClosedEnvironmentError, match=r"^the environments are closed$"):
        env.reset()


def test_stable_baselines3_gets_the_same_from_processes():
    pytest.importorskip("stable_baselines3")
    from eyas.envs.sb3 import EyasVecEnv

    steps = []
    for workers in (0, 2):
        env = EyasVecEnv(2, workers=workers, observation={"width": 8, "height": 8})
        env.seed(3)
        steps.append([env.reset(), *env.step(np.array([0, 3]))[:3]])
        env.close()
    same(*steps)


def test_an_error_in_a_process_is_one_line_with_the_traceback_as_a_note():
    settings = {"reward": {"terms": {"own_terms:fails_after_two_steps": 1.0}}}
    env = EyasVectorEnv(2, settings, workers=1, observation={"width": 8, "height": 8})
    env.reset(seed=0)
    env.step([6, 6])
    env.step([6, 6])
    with pytest.raises(EyasError, match=r"no such") as caught:
        env.step([6, 6])
    assert str(caught.value) == "worker 0 (environments 0 to 1): ValueError: no such thing"
    assert "in fails_after_two_steps" in caught.value.__notes__[0]
    env.reset(seed=0)
    env.step([6, 6])  # the environments are still there
    env.close()


def test_a_killed_process_is_told_and_the_others_end():
    before = set(active_children())
    env = EyasVectorEnv(4, workers=2, observation={"width": 8, "height": 8})
    env.reset(seed=0)
    victim = env._fleet._workers._processes[1].pid
    os.kill(victim, signal.SIGKILL)
    line = r"^worker 1 \(environments 2 to 3\): its process has ended \(signal 9\)"
    with pytest.raises(EyasError, match=line):
        env.step([6] * 4)
    with pytest.raises(EyasError, match=line):
        env.reset()
    assert set(active_children()) <= before
    env.close()


def test_a_forgotten_environment_ends_its_processes():
    before = set(active_children())
    env = EyasVectorEnv(1, workers=1, observation={"width": 8, "height": 8})
    del env
    gc.collect()
    end = time.monotonic() + 30.0
    while set(active_children()) - before and time.monotonic() < end:
        time.sleep(0.02)
    assert set(active_children()) <= before


def test_a_process_ends_when_the_one_that_started_it_is_killed(tmp_path):
    program = """
import time
from eyas.envs.vector_env import EyasVectorEnv
if __name__ == "__main__":
    env = EyasVectorEnv(1, workers=1, observation={"width": 8, "height": 8})
    print(env._fleet._workers._processes[0].pid, flush=True)
    time.sleep(60)
"""
    path = tmp_path / "program.py"
    path.write_text(program)
    memory = set(os.listdir("/dev/shm"))
    started = subprocess.Popen([sys.executable, str(path)], stdout=subprocess.PIPE, text=True)
    worker = int(started.stdout.readline())
    started.kill()
    started.wait()
    started.stdout.close()
    end = time.monotonic() + 30.0
    while Path(f"/proc/{worker}").exists() and time.monotonic() < end:
        time.sleep(0.05)
    assert not Path(f"/proc/{worker}").exists()
    assert set(os.listdir("/dev/shm")) <= memory


@pytest.mark.parametrize("workers", [-1, 3])
def test_a_wrong_number_of_processes_is_one_line(workers):
    with pytest.raises(
        EyasError, match=f"^workers: {workers} is not allowed: 0 to num_envs, here 2"
    ):
        EyasVectorEnv(2, workers=workers)


def test_a_script_without_a_main_guard_is_told_so(tmp_path):
    path = tmp_path / "program.py"
    path.write_text("from eyas.envs.vector_env import EyasVectorEnv; EyasVectorEnv(1, workers=1)")
    done = subprocess.run([sys.executable, str(path)], capture_output=True, text=True)
    assert done.returncode == 1
    assert "must do so below `if __name__ == '__main__':`" in done.stderr.splitlines()[-1]
