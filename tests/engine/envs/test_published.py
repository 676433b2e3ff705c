"""The example that computes the figures of published results."""

import math
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[3] / "examples" / "cr_tsr.py"


@pytest.fixture(scope="module")
def example():
    spec = spec_from_file_location("cr_tsr", EXAMPLE)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_drone_that_hovers_gets_some_of_both_figures_in_whole_episodes(example, capsys):
    made = []
    hover = example.hover

    def counted(observation):
        made.append(observation.shape)
        return hover(observation)

    ((cr, tsr),) = example.scores(counted, direction=math.pi, episodes=1)
    assert len(made) == example.STEPS
    assert 0.0 < cr < tsr * example.STEPS < example.STEPS
    example.main(episodes=1)
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["CR", "TSR"]
    assert all(line.endswith("(4 episodes)") for line in lines)
