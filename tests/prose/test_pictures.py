"""Pictures and films of the documents: what draws each, and whether that has changed since."""

import importlib
import json
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FILES = {
    path.name
    for folder in ("images", "films/films")
    for path in (ROOT / "docs" / folder).iterdir()
    if path.suffix != ".json"
}


@pytest.fixture
def tool(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "tools")
    yield importlib.import_module("docs_pictures")
    sys.modules.pop("docs_pictures")


def test_one_command_draws_each_picture(tool):
    assert FILES == tool.pictures().keys() | tool.UNDRAWN


def test_the_build_of_each_picture_is_on_record(tool):
    drawn = json.loads(tool.RECORD.read_text())
    assert drawn.keys() <= tool.pictures().keys()  # those that it lacks are older than the record
    assert all(len(one["build"]) == 12 and one["looks"] for one in drawn.values())


def test_no_picture_is_older_than_the_looks(tool):
    """It names them; they are drawn anew for a release, which `tools/release.py` checks."""
    if old := tool.stale():
        pytest.xfail(f"drawn before the looks of today: {', '.join(old)}")


def test_a_picture_is_stale_once_golden_pictures_are_drawn_anew(tool, monkeypatch, tmp_path):
    (tmp_path / "ahead.png").write_bytes(b"other")
    monkeypatch.setattr(tool, "GOLDEN", tmp_path)
    assert tool.stale() == sorted(tool.pictures())
