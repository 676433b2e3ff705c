"""RLlib learns in the environments, as docs/training.md shows."""

import re
from pathlib import Path

import pytest

pytest.importorskip("ray.rllib")
PAGE = Path(__file__).parents[2] / "docs" / "training.md"


def test_the_example_of_the_page_learns(ray):
    example = re.search(r"### RLlib.*?```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    settings, last = example[1].rsplit("config.build_algo()", 1)
    assert last == ".train()\n"
    names = {}
    exec(settings, names)
    short = {"train_batch_size_per_learner": 64, "minibatch_size": 32, "num_epochs": 1}
    algorithm = names["config"].training(**short).build_algo()
    before = {name: value.clone() for name, value in algorithm.get_module().state_dict().items()}
    results = [algorithm.train() for _ in range(2)]
    after = algorithm.get_module().state_dict()
    algorithm.stop()
    assert results[-1]["env_runners"]["num_env_steps_sampled_lifetime"] >= 128
    assert any((before[name] != after[name]).any() for name in before)
