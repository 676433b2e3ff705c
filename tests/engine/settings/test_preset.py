"""Settings that come with Eyas."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.dat.settings.adapter import is_original
from eyas.dat.settings.layout import flat
from eyas.engine.core.errors import UnknownNameError
from eyas.engine.envs.choice import settings_of_kinds, steps_per_action
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.settings.file import PRESETS, load_settings, preset_file


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_an_environment_runs_with_each(name):
    env = TrackingEnv(name)
    env.reset(seed=0)
    env.action_space.seed(0)
    *_, info = env.step(env.action_space.sample())
    assert info["step"] == steps_per_action(env.config)
    assert env.config == settings_of_kinds(load_settings(preset_file(name)))[0]


def test_every_file_is_a_preset():
    beside = {path for name in PRESETS for path in preset_file(name).parent.iterdir()}
    assert beside == {preset_file(name) for name in PRESETS}


@pytest.mark.parametrize("name", ["dat-train", "dat-eval"])
def test_those_of_the_original_are_files_that_it_loads(name):
    values = json.loads(preset_file(name).read_text())
    assert is_original(values)
    shipped = Path(__file__).parents[2] / "kit" / "original_settings.json"
    assert flat(values).keys() == flat(json.loads(shipped.read_text())).keys()


def test_evaluation_is_as_published():
    config = load_settings(preset_file("dat-eval"))
    start = config.start
    assert (start.pitch, start.height, start.direction) == (1.37, 22.0, 0.0)
    assert (start.horizontal_bias, start.vertical_bias) == (0.0, 0.0)
    assert (config.reward.view_range, config.reward.view_scale) == (1.0, 4.0)
    assert config.done.no_reward_steps > config.done.total_steps == 1500
    assert config.traffic.seed is not None


def test_training_starts_from_every_side():
    config = load_settings(preset_file("dat-train"))
    assert config.start.direction.uniform == pytest.approx((-math.pi, math.pi))
    assert config.reward.view_range == 0.7


def test_the_flown_drone_is_that_of_the_protocol():
    config, rules = load_settings(preset_file("flown")), PROTOCOLS.get("flown").settings
    for name in ("tracker", "control", "reward", "camera"):
        assert getattr(config, name) == getattr(rules, name), name
    for name in ("pitch", "height", "velocity"):
        assert getattr(config.start, name) == getattr(rules.start, name), name
    assert config.traffic.demand is rules.traffic.demand
    assert config.done.total_steps == rules.done.total_steps


def test_the_flown_drone_begins_as_fast_as_its_target():
    env = TrackingEnv("flown")
    observation, info = env.reset(seed=0)
    assert set(observation) == {"image", "sensors"}
    assert np.linalg.norm(info["velocity"]) > 3.0
    assert info["relative_velocity"][:2] == pytest.approx([0.0, 0.0], abs=1e-6)


@pytest.mark.parametrize("name", sorted({*PRESETS} - {"lively", "noisy"}))
def test_nobody_walks_where_results_are_compared(name):
    assert load_settings(preset_file(name)).extras == ()


def test_an_unknown_name_is_told_with_the_nearest():
    with pytest.raises(UnknownNameError, match=r"^preset: 'dat-evl' .*did you mean 'dat-eval'"):
        TrackingEnv("dat-evl")
