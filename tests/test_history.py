"""The history of benchmarks: what counts as a change, and files that asv reads."""

import importlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
ROWS = {"time_import": 0.05, "peakmem_all": 3e8}


@pytest.fixture(scope="module")
def history():
    sys.path.insert(0, str(ROOT / "bench"))
    try:
        return importlib.import_module("history")
    finally:
        sys.path.pop(0)


def rounds(rng, factor, count=9, drift=0.0):
    """Return rounds of A and B of a machine that gets busier, with noise of 3 %."""
    busy = 1.0 + drift * np.arange(count)
    noise = rng.normal(1.0, 0.03, (2, count))
    first = [{"time_import": value} for value in busy * noise[0]]
    return first, [{"time_import": value} for value in factor * busy * noise[1]]


def test_a_tenth_more_is_seen_also_on_a_machine_that_gets_busier(history):
    rng = np.random.default_rng(1)
    (change,) = history.changes(*rounds(rng, 1.1, drift=0.3))
    assert change.beyond_noise
    assert change.ratio == pytest.approx(1.1, abs=0.04)


def test_no_change_is_seldom_taken_for_one(history):
    rng = np.random.default_rng(2)
    wrong = sum(history.changes(*rounds(rng, 1.0))[0].beyond_noise for _ in range(1000))
    assert 15 <= wrong <= 65  # 3.9 % of the intervals of nine rounds leave out the median


def test_few_rounds_show_nothing(history):
    rng = np.random.default_rng(3)
    (change,) = history.changes(*rounds(rng, 2.0, count=5))
    assert not change.beyond_noise


def test_what_is_written_is_what_the_page_shows(history, tmp_path):
    history.write(ROWS, "1" * 40, 1_700_000_000, tmp_path)
    history.write(ROWS | {"time_import": 0.04}, "2" * 40, 1_700_100_000, tmp_path)
    lines = history.page(tmp_path).splitlines()
    assert lines[0] == "| commit | day | peakmem_all | time_import |"
    assert lines[2] == "| `22222222` | 2023-11-16 | 286 MiB | 40.000 ms |"
    assert lines[3].startswith("| `11111111` |")


@pytest.mark.checker
def test_asv_reads_it(history, tmp_path):
    results = pytest.importorskip("asv.results", reason="asv is not installed")
    path = history.write(ROWS, "1" * 40, 1_700_000_000, tmp_path)
    told = results.Results.load(str(path))
    assert told.commit_hash == "1" * 40
    for name, value in ROWS.items():
        assert told.get_result_value(name, []) == [value]
    known = importlib.import_module("asv.benchmarks").Benchmarks
    said = json.loads((tmp_path / "benchmarks.json").read_text())
    assert said.pop("version") == known.api_version
    assert set(said) == set(ROWS)
