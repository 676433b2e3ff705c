"""The tool that tells how often intervals hold."""

import runpy
import sys
from pathlib import Path

import pytest

from eyas.benchmark.evaluation import run
from eyas.benchmark.plan.plan import EvaluationPlan

TOOL = Path(__file__).parents[2] / "tools" / "interval_coverage.py"


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cover")
    for name in ("hover", "random"):
        plan = EvaluationPlan(policy=name, maps=("simpleway-grass",), episodes=3)
        run(plan, folder / name, quiet=True)
    return folder


def table(monkeypatch, capsys, *words):
    monkeypatch.setattr(sys, "argv", ["interval_coverage.py", "--samples", "20", *words])
    runpy.run_path(str(TOOL), run_name="__main__")
    rows = [line.split("|")[1:-1] for line in capsys.readouterr().out.splitlines()]
    return {(row[0].strip(), row[1].strip()): [cell.strip() for cell in row[2:]] for row in rows}


def test_it_tells_each_figure_of_each_folder(flown, monkeypatch, capsys):
    found = table(monkeypatch, capsys, str(flown / "hover"), str(flown / "random"))
    for name in ("hover", "random"):
        for figure in ("tsr", "cr", "kept", "flawless", "worst_fifth", "percentile tsr"):
            truth, *shares = found[name, figure]
            assert float(truth) >= 0.0
            assert len(shares) == 3
    assert found["hover", "worst_fifth"][1] == "-"  # of 12 seeds none can be had
    assert float(found["hover", "tsr"][3].split()[0]) > 50.0


def test_several_folders_are_one_population_and_two_a_pair(flown, monkeypatch, capsys):
    both = f"{flown / 'hover'},{flown / 'random'}"
    assert ("hover, random", "tsr") in table(monkeypatch, capsys, both)
    pair = table(monkeypatch, capsys, "--differences", str(flown / "hover"), str(flown / "random"))
    assert ("random - hover", "cr") in pair
