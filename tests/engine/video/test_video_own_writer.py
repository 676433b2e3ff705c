"""The writer of docs/writers.md, chosen by its path, through `eyas video`."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from eyas.engine.exports.label import read_labels

DOC = (Path(__file__).parents[3] / "docs" / "writers.md").read_text()
SETTINGS = {
    "camera": {"width": 64, "height": 48},
    "video": {"channels": 2, "total_time": 0.2, "writers": ["labels", "my_writers:BoxTable"]},
}


@pytest.fixture(scope="module")
def work(tmp_path_factory) -> Path:
    """A folder with the page's module, settings that name it, and a recording."""
    folder = tmp_path_factory.mktemp("own")
    blocks = re.findall(r"```python\n(.*?)```", DOC, re.DOTALL)
    (code,) = (block for block in blocks if "class BoxTable" in block)
    (folder / "my_writers.py").write_text(code)
    (folder / "settings.json").write_text(json.dumps(SETTINGS))
    assert eyas(folder).returncode == 0
    return folder


ENDS = """
import sys
from eyas.engine.exports.writer import Files

class Writer:
    wants, files = frozenset(), Files(episode=("ends.json",))

    def __init__(self, run): ...
    def begin(self, episode): return self
    def add(self, frame): sys.exit(0)
    def abandon(self): ...
    def finish(self, *episodes): ...
    def read(self, folder): ...
"""


VIDEO = ("video", "--config", "settings.json", "--trust", "--out", "out")


def eyas(work: Path, *options: str, **variables: str) -> subprocess.CompletedProcess[str]:
    paths = [str(work), os.environ.get("PYTHONPATH", "")]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(paths)} | variables
    return subprocess.run(
        [sys.executable, "-m", "eyas.cli.main", *VIDEO, *options],
        cwd=work,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def contents(path: Path) -> dict[str, bytes]:
    return {
        inside.relative_to(path).as_posix(): inside.read_bytes()
        for inside in path.rglob("*")
        if inside.is_file()
    }


@pytest.mark.slow
def test_it_writes_what_the_labels_say(work):
    out = work / "out"
    assert (out / "episodes.csv").read_text() == "DRONE0,0,6\nDRONE1,0,6\n"
    for episode in sorted(out.glob("DRONE*/episode0")):
        assert sorted(path.name for path in episode.iterdir()) == ["boxes.csv", "labels.jsonl"]
        rows = [line.split(",") for line in (episode / "boxes.csv").read_text().splitlines()]
        labels = read_labels(episode / "labels.jsonl")
        assert [[int(cell) for cell in row[2:6]] for row in rows] == [
            label["target_box"] for label in labels
        ]


@pytest.mark.slow
def test_an_episode_that_misses_its_file_is_drawn_anew(work, eyas_command):
    whole = contents(work / "out")
    kept = work / "out" / "DRONE0" / "episode0" / "labels.jsonl"
    written_at = kept.stat().st_mtime_ns
    (work / "out" / "DRONE1" / "episode0" / "boxes.csv").unlink()
    assert eyas_command(*VIDEO, "--resume", folder=work).returncode == 0
    assert contents(work / "out") == whole
    assert kept.stat().st_mtime_ns == written_at


def test_a_recording_is_overwritten_where_its_writer_has_gone(work):
    without = ["--overwrite", "--set", 'video.writers=["mark"]', "--out", "out"]
    done = eyas(work, *without, PYTHONPATH=os.environ.get("PYTHONPATH", ""), PYTHONSAFEPATH="1")
    assert done.returncode == 0, done.stderr
    assert not list((work / "out").rglob("*.csv"))
    assert (work / "out" / "dir_info.json").exists()


@pytest.mark.slow
def test_a_writer_that_ends_the_program_is_an_error(tmp_path, eyas_command):
    (tmp_path / "ends.py").write_text(ENDS)
    (tmp_path / "settings.json").write_text(json.dumps({"video": {"channels": 1, "total_time": 1}}))
    writers = ("--set", 'video.writers=["labels", "ends:Writer"]', "--quiet")
    done = eyas_command(*VIDEO, *writers, folder=tmp_path)
    assert done.returncode == 2
    (line,) = [each for each in done.stderr.splitlines() if each.startswith("eyas: error: ")]
    assert "tried to end the program: SystemExit(0) in " in line
    assert "ends.py, line " in line
