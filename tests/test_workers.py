"""Tests in several processes: one that is lost ends them with a line."""

import subprocess
import sys
from pathlib import Path

import pytest

TESTS = """
import os, pytest

@pytest.mark.parametrize("number", range(4))
def test_it(number):
    if number == 2:
        os._exit(9)
"""


@pytest.mark.slow
def test_a_worker_that_is_lost_ends_the_tests_with_a_line(tmp_path):
    (tmp_path / "conftest.py").write_text(Path(__file__).with_name("conftest.py").read_text())
    (tmp_path / "test_lost.py").write_text(TESTS)
    command = [sys.executable, "-m", "pytest", "-n1", "--dist=loadfile", "-c", "/dev/null"]
    told = subprocess.run([*command, tmp_path], capture_output=True, text=True, timeout=100)
    assert told.returncode == 2
    assert "worker gw0 has ended while it ran test_lost.py::test_it[2]" in told.stdout
