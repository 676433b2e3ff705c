"""What a package of somebody else brings by entry points, in a program of its own: a command, and a
section of the settings."""

import os
import subprocess
import sys

import pytest

MODULE = '''
from typing import Annotated

import typer
from pydantic import Field

from eyas import Section, load_settings


class FleetConfig(Section):
    section = "fleet"

    boats: Annotated[int, Field(ge=0, le=9)] = 2


def patrol(set_: Annotated[list[str] | None, typer.Option("--set")] = None) -> None:
    """Send boats out."""
    print(FleetConfig.of(load_settings(None, set_ or ())).boats)
'''
POINTS = """[eyas.commands]
patrol = fleet_package:patrol

[eyas.settings]
fleet = fleet_package:FleetConfig
"""


@pytest.fixture
def eyas(tmp_path):
    (tmp_path / "fleet_package.py").write_text(MODULE)
    metadata = tmp_path / "fleet_package-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: fleet-package\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text(POINTS)

    def run(*words):
        return subprocess.run(
            [sys.executable, "-m", "eyas", *words],
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])},
            capture_output=True,
            text=True,
        )

    return run


@pytest.mark.slow
def test_a_package_brings_a_command_and_a_section(eyas):
    assert "patrol" in eyas("--help").stdout
    assert eyas("patrol").stdout == "2\n"
    assert eyas("patrol", "--set", "own.fleet.boats=7").stdout == "7\n"
    wrong = eyas("patrol", "--set", "own.fleet.boats=70")
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr.startswith("eyas: error: own.fleet.boats: 70 is not allowed")
    unknown = eyas("patrol", "--set", "own.flet.boats=7")
    assert "did you mean 'fleet'" in unknown.stderr
    assert len(unknown.stderr.splitlines()) == 1


@pytest.mark.slow
def test_a_command_that_cannot_be_imported_is_left_out_in_a_line(eyas, tmp_path):
    (tmp_path / "fleet_package.py").write_text("raise RuntimeError('no\\nboats')")
    done = eyas("maps", "--help")
    assert done.returncode == 0
    assert len(done.stderr.splitlines()) == 1
    assert "the command 'patrol' is left out" in done.stderr


@pytest.mark.slow
def test_a_command_whose_name_is_taken_is_told_in_a_line(eyas, tmp_path):
    (tmp_path / "fleet_package-1.0.dist-info/entry_points.txt").write_text(
        "[eyas.commands]\nvideo = fleet_package:patrol\n"
    )
    done = eyas("maps", "--help")
    assert done.returncode == 0
    assert len(done.stderr.splitlines()) == 1
    assert "'fleet-package' adds 'video', but that name is taken" in done.stderr
