"""RLlib learns in the environments, as `examples/learn_rllib.py` shows."""

import runpy
from pathlib import Path

import pytest

pytest.importorskip("ray.rllib")
EXAMPLE = Path(__file__).parents[2] / "examples/learn_rllib.py"


def test_the_example_learns(ray):
    algorithm = runpy.run_path(str(EXAMPLE))["config"](batch=64).build_algo()
    before = {name: value.clone() for name, value in algorithm.get_module().state_dict().items()}
    results = [algorithm.train() for _ in range(2)]
    after = algorithm.get_module().state_dict()
    algorithm.stop()
    assert results[-1]["env_runners"]["num_env_steps_sampled_lifetime"] >= 128
    assert any((before[name] != after[name]).any() for name in before)
