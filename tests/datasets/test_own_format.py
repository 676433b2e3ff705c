"""The format of docs/exports.md, and what the page says of the others."""

import re
from pathlib import Path

import pytest

from eyas.engine.core.own_code import imported
from eyas.engine.recordings.format import FORMATS

OF_MOTION = {"lerobot", "webdataset", "minari", "rerun", "mcap"}

DOC = (Path(__file__).parents[2] / "docs/exports.md").read_text()


@pytest.fixture
def my_formats(tmp_path, monkeypatch):
    (code,) = (c for c in re.findall(r"```python\n(.*?)```", DOC, re.DOTALL) if "my_formats" in c)
    (tmp_path / "my_formats.py").write_text(code)
    monkeypatch.syspath_prepend(tmp_path)


def test_the_format_of_the_page_exports(my_formats, exported, data):
    folder = exported("my_formats:BoxTable")
    rows = (folder / "episodes.csv").read_text().splitlines()
    assert rows == [f"{each.name},{each.split},{len(each) / 10.0}" for each in data]
    for episode in data:
        rows = (folder / f"{episode.name}.csv").read_text().splitlines()
        expected = [[frame.number, *frame.label["target_box"]] for frame in episode]
        assert [[int(value) for value in row.split(",")] for row in rows] == expected
    assert not (folder / ".kept").exists()
    assert imported("my_formats:BoxTable", "--format").needs == {"labels"}


@pytest.mark.parametrize("name", sorted(set(FORMATS.built_in) - OF_MOTION))
def test_the_page_has_a_row_for_each_format(name):
    assert f"\n| `{name}` |" in DOC
