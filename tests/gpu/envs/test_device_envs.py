"""Environments on a device, which here is this processor, against the usual ones: the same bytes.

Those of a graphics processor run the same kernels; what its tensors are is not tried here.
"""

import copy
import gc
import re

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from eyas.engine.core.errors import ActionError, ConfigError, EyasError
from eyas.engine.envs.actions import command_width, make_actions
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.settings.env import ActionKind, EnvConfig
from eyas.gpu.cuda import cuda_device
from eyas.gpu.envs.envs import DeviceActions, DeviceEnvs
from eyas.gpu.ptx import ptx_of
from eyas.gpu.sim.simulation import arrays_of
from eyas.lanes.device import HostDevice

from ...kit.walkers import FEW
from .apart import ApartDevice

SHORT = {"done": {"total_steps": 60, "grace_steps": 0, "no_reward_steps": 28}}
SMALL = {"width": 24, "height": 20}
CASES = {
    "plain": ({}, {}),
    "stacked": (
        {"target": "Pedestrian", "objects": FEW},
        {"observation": {**SMALL, "colours": "grey", "frames": 3, "layout": "chw"}},
    ),
    "dictionary": (
        {"tracker": {"supervised": False}},
        {
            "actions": "velocity",
            "observation": {**SMALL, "frames": 2, "parts": ["privileged", "image", "sensors"]},
        },
    ),
    "robot": ({"target": "BB-8", "objects": FEW}, {"actions": "shares", "action_repeat": 3}),
    "blind": ({"tracker": {"kind": "car"}}, {"observation": {"parts": ["privileged"]}}),
}
MODES = tuple(AutoresetMode)


@pytest.fixture
def freed():
    """Gives back at once the copy of the map that a device apart has, 150 MB."""
    yield
    gc.collect()


def pair(case, count, workers, mode=AutoresetMode.NEXT_STEP, **choices):
    settings, own = CASES[case]
    given = {"autoreset_mode": mode, "observation": SMALL, **own, **choices}
    usual = EyasVectorEnv(count, SHORT | settings, **given)
    return usual, EyasVectorEnv(count, SHORT | settings, device=HostDevice(workers), **given)


def assert_same(ours, usual):
    if isinstance(usual, dict):
        assert ours.keys() == usual.keys()
        for name, array in usual.items():
            assert_same(ours[name], array)
        return
    assert ours.dtype == usual.dtype
    assert ours.shape == usual.shape
    assert ours.tobytes() == usual.tobytes()


def actions_of(env, rng):
    if env.single_action_space.shape == ():
        return rng.integers(0, 7, env.num_envs)
    return (rng.normal(size=(env.num_envs, 4)) * (4.0, 4.0, 2.0, 1.5)).astype(np.float32)


def rows_of(observation, index):
    if isinstance(observation, dict):
        return {name: array[index] for name, array in observation.items()}
    return observation[index]


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(
    ("count", "workers", "mode"), [(1, 1, MODES[0]), (7, 3, MODES[1]), (7, 64, MODES[2])]
)
def test_they_give_what_the_usual_ones_give(case, count, workers, mode):
    usual, ours = pair(case, count, workers, mode, copy=mode is not AutoresetMode.SAME_STEP)
    assert ours.observation_space == usual.observation_space
    assert ours.action_space == usual.action_space
    assert_same(ours.reset(seed=5)[0], usual.reset(seed=5)[0])
    rng, ends = np.random.default_rng(count), 0
    for _ in range(25):
        actions = actions_of(usual, rng)
        theirs, mine = usual.step(actions), ours.step(actions)
        for array, expected in zip(mine[:4], theirs[:4], strict=True):
            assert_same(array, expected)
        ended = theirs[2] | theirs[3]
        ends += ended.sum()
        assert ("final_obs" in mine[4]) == ("final_obs" in theirs[4])
        if "final_obs" in mine[4]:
            assert np.array_equal(mine[4]["_final_obs"], ended)
            for index in np.flatnonzero(ended):
                last = rows_of(mine[4]["final_obs"], index)
                assert_same(last, theirs[4]["final_obs"][index])
        if mode is AutoresetMode.DISABLED and ended.any():
            masks = [{"reset_mask": ended.copy()} for _ in range(2)]
            assert_same(ours.reset(options=masks[0])[0], usual.reset(options=masks[1])[0])
    assert ends > 0


def test_tensors_of_actions_mean_what_arrays_mean():
    torch = pytest.importorskip("torch")
    rng, device = np.random.default_rng(2), HostDevice(2)
    for kind in ActionKind:
        space = make_actions(EnvConfig(actions=kind))
        commands = np.zeros((40, command_width(kind)))
        taken = DeviceActions(space, device, commands)
        discrete, size = kind.numbered, kind.size
        actions = rng.integers(0, size, 40) if discrete else rng.normal(size=(40, size))
        for dtype in (np.int32, np.int64) if discrete else (np.float32, np.float64):
            given = actions.astype(dtype)
            taken.take(torch.from_numpy(given))
            assert commands.tobytes() == space.commands(given).tobytes()
        wrong = given.copy()
        wrong.flat[7] = size if discrete else np.nan
        for refused in (torch.from_numpy(wrong), torch.from_numpy(given[:5]), wrong):
            with pytest.raises(ActionError, match=re.escape(space.allowed)):
                taken.take(refused)


@pytest.mark.slow
def test_a_wrong_action_leaves_everything_as_it_is():
    usual, ours = pair("plain", 2, 1)
    usual.reset(seed=1)
    ours.reset(seed=1)
    with pytest.raises(ActionError):
        ours.step(np.array([0, 9]))
    for array, expected in zip(ours.step([0, 1])[:4], usual.step([0, 1])[:4], strict=True):
        assert_same(array, expected)


def test_results_are_new_arrays_unless_it_is_told_otherwise():
    for again in (True, False):
        ours = EyasVectorEnv(1, SHORT, observation=SMALL, device="host", copy=again)
        ours.reset(seed=1)
        first, second, third = (ours.step([0])[0] for _ in range(3))
        assert first is not second
        assert (first is third) == (not again)


@pytest.mark.parametrize(
    ("settings", "choices", "said"),
    [
        ({}, {"observation": {"parts": ["image", "depth"]}}, "env.observation.parts: 'depth'"),
        ({"verbose": True}, {}, "verbose: true"),
        ({}, {"mixture": [{"settings": {}}]}, "env.mixture"),
        ({}, {"device": "abacus"}, "device: 'abacus' is not allowed; known: cuda, host"),
    ],
)
def test_what_is_not_there_is_told_in_one_line(settings, choices, said):
    with pytest.raises(ConfigError) as told:
        EyasVectorEnv(1, settings, **{"device": "host", **choices})
    assert str(told.value).startswith(said)
    assert "\n" not in str(told.value)


def test_what_only_the_processor_knows_is_refused():
    ours = EyasVectorEnv(1, SHORT, observation=SMALL, device="host", render_mode="rgb_array")
    for ask in (ours.render, lambda: ours.words_of(0), lambda: copy.deepcopy(ours)):
        with pytest.raises(EyasError, match=r"^device: "):
            ask()
    assert ours.config_of(0) is ours.config
    ours.close()


def test_the_drivers_compile_for_cuda():
    from eyas.gpu.envs import observation

    _, ours = pair("dictionary", 2, 1)
    envs: DeviceEnvs = ours._there
    observer = envs._observer
    calls = [
        *((call, (given, envs._actions._held)) for call, given in envs._actions._calls),
        (observation._stack_pictures, (observer._held_seen, observer._stacking[False])),
        (observation._fill_rows, (observer._snapshot, observer._held_seen, observer._rows[False])),
    ]
    _, ours = pair("plain", 2, 1)
    taken = ours._there._actions
    calls += [(call, (given, taken._held)) for call, given in taken._calls]
    turning = make_actions(EnvConfig(actions="velocity+gimbal"))
    taken = DeviceActions(turning, HostDevice(1), np.zeros((2, 8)))
    calls += [(call, (given, taken._held)) for call, given in taken._calls]
    for call, bundles in calls:
        text = ptx_of(call, tuple(held.bundle for held in bundles), "kernel")
        assert "fma" not in text
        assert not re.search(r"\.extern \.func|vprintf", text)
        assert not re.search(r"\b(mad|mul|add|sub)\.(f32|f64)\b", text)


@pytest.mark.usefixtures("freed")
@pytest.mark.parametrize(("case", "mode"), [("plain", MODES[0]), ("dictionary", MODES[1])])
def test_nothing_is_read_here_that_is_there(case, mode):
    torch = pytest.importorskip("torch")
    usual, _ = pair(case, 3, 1, mode)
    settings, own = CASES[case]
    choices = {"autoreset_mode": mode, "observation": SMALL, **own}
    ours = EyasVectorEnv(3, SHORT | settings, device=ApartDevice(2), **choices)
    observation, _ = ours.reset(seed=2)
    assert_same(as_numpy(observation), usual.reset(seed=2)[0])
    rng = np.random.default_rng(0)
    for step in range(16):
        actions = actions_of(usual, rng)
        mine = ours.step(torch.from_numpy(actions) if step % 2 else actions)
        theirs = usual.step(actions)
        for told, expected in zip(mine[:4], theirs[:4], strict=True):
            assert_same(as_numpy(told), expected)


@pytest.mark.parametrize(("case", "mode"), [("plain", MODES[0]), ("plain", MODES[1])])
def test_a_card_gives_what_the_usual_ones_give(emulated, case, mode):
    torch = pytest.importorskip("torch")
    usual, _ = pair(case, 2, 1, mode)
    settings, own = CASES[case]
    choices = {"autoreset_mode": mode, "observation": SMALL, **own}
    with emulated(1):
        ours = EyasVectorEnv(2, SHORT | settings, device=cuda_device(), **choices)
        observation, _ = ours.reset(seed=2)
        assert_same(as_numpy(observation), usual.reset(seed=2)[0])
        rng = np.random.default_rng(0)
        for step in range(31):  # episodes end after 28
            actions = actions_of(usual, rng)
            mine = ours.step(torch.from_numpy(actions) if step % 2 else actions)
            for told, expected in zip(mine[:4], usual.step(actions)[:4], strict=True):
                assert_same(as_numpy(told), expected)


@pytest.mark.parametrize(
    ("device", "samples"), [(HostDevice, 1), (ApartDevice, 1), (ApartDevice, 4)]
)
@pytest.mark.usefixtures("freed")
def test_what_is_true_is_told_on_the_host(device, samples):
    pytest.importorskip("torch")
    settings = SHORT | {"camera": {"samples": samples}}
    choices = {"autoreset_mode": MODES[1], "observation": SMALL, "measures": True}
    usual = EyasVectorEnv(3, settings, **choices)
    ours = EyasVectorEnv(3, settings, device=device(2), **choices)
    usual.reset(seed=5)
    ours.reset(seed=5)
    rng, shares = np.random.default_rng(0), set()
    for _ in range(20):
        for told, expected in zip(arrays_of(ours.truth()), arrays_of(usual.truth()), strict=True):
            assert_same(told, expected)
        shares.update(ours.truth().visible.tolist())
        actions = actions_of(usual, rng)
        ours.step(actions)
        usual.step(actions)
    assert len(shares) > 3, "some are hidden in part, or leave the picture"


def as_numpy(told):
    if isinstance(told, dict):
        return {name: tensor.numpy() for name, tensor in told.items()}
    return told.numpy()
