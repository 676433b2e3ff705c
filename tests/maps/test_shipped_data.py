"""Roads and recordings that ship are those that today's code makes."""

import runpy
from pathlib import Path

import pytest

from eyas.engine.world.maps import MAPS

TOOL = runpy.run_path(str(Path(__file__).parents[2] / "tools/shipped_data.py"))


def test_roads_and_recordings_are_those_of_today_s_code():
    notes, stale = TOOL["read_notes"](), []
    for recipe, path in TOOL["files"]():
        name = TOOL["name_of"](path)
        if notes.get(name) != TOOL["noted"](recipe, path):
            stale.append(name)
    assert not stale, (
        "made by other code: run `python tools/shipped_data.py --confirm`, which makes these again "
        "and compares; commit tools/shipped_data.json if all come out the same"
    )


@pytest.mark.parametrize("change", ["code", "content"])
def test_other_code_and_other_content_are_found(tmp_path, change):
    recipe, path = next(TOOL["files"]())
    before = TOOL["noted"](recipe, path)
    if change == "content":
        copy = tmp_path / path.name
        copy.write_bytes(path.read_bytes() + b" ")
        assert TOOL["noted"](recipe, copy) != before
    else:
        assert TOOL["code_of"](MAPS.get("village").roads) != TOOL["code_of"](recipe.roads)
