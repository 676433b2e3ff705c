"""Every reader of the package, fed with what nobody wrote for it, in one process with limits."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
from places import OWN, READERS, places  # beside this file
from rows import ROWS

sys.path.remove(str(HERE))

DEAR = ("checkpoint",)
"""Rows that are left to the thorough test: PyTorch alone takes 3 s."""

USUAL = tuple(name for name in ROWS if name not in DEAR)

FEW, MANY = 8, 400
"""Mutations of each file, beside the contents that are always tried."""


def test_every_place_that_reads_has_a_row_or_a_reason():
    found = set(places())
    assert not found - READERS.keys() - OWN.keys(), "add a row, or say why it needs none"
    assert not (READERS.keys() | OWN.keys()) - found, "gone: take it out of the table"
    assert not READERS.keys() & OWN.keys()


def test_every_row_is_there():
    assert set(READERS.values()) <= ROWS.keys()


def reported(folder: Path, most: int, seed: int, *names: str) -> dict[str, dict]:
    command = [sys.executable, HERE / "rows.py", folder, str(most), str(seed), *names]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def report(tmp_path_factory) -> dict[str, dict]:
    return reported(
        tmp_path_factory.mktemp("few"), FEW, 1, *(name for name in ROWS if name not in DEAR)
    )


def require_sound(told: dict) -> None:
    if "missing" in told:
        pytest.skip(told["missing"])
    assert told["faults"] == []
    assert told["tried"] >= 5
    assert told["refused"] > 0 or not told["refuses"]


@pytest.mark.slow
@pytest.mark.parametrize("name", USUAL)
def test_only_one_line_or_a_value_comes_out(report, name):
    require_sound(report[name])


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(2, 6))
def test_only_one_line_or_a_value_comes_out_of_many(tmp_path, seed):
    for told in reported(tmp_path, MANY, seed).values():
        if "missing" not in told:
            require_sound(told)
