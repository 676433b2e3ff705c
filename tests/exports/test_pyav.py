"""Whoever may not install PyAV can do without it."""

import os
import subprocess
import sys

import pytest

from eyas.core.errors import ConfigError
from eyas.exports.mp4 import Mp4Episode
from eyas.exports.registry import chosen_writers
from eyas.modes.demo.frame import Stream


@pytest.fixture
def missing(monkeypatch):
    for name in [name for name in sys.modules if name.split(".")[0] == "av"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "av", None)


@pytest.mark.usefixtures("missing")
def test_what_needs_it_says_so_in_one_line(run, tmp_path):
    (writer,) = chosen_writers(["mp4"])
    line = r"^video\.writers: 'mp4' needs PyAV, which is not installed; pip install av, .*\Z"
    with pytest.raises(ConfigError, match=line):
        writer(run)
    with pytest.raises(ConfigError, match=r"^MP4 needs PyAV"):
        Mp4Episode(tmp_path / "a.mp4", 48, 64, 25.0)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(ConfigError, match=r"^pictures: H\.264 needs PyAV"):  # JPEG goes on then
        Stream(48, 64, 30)


@pytest.mark.slow
def test_recordings_without_films_import_it_nowhere(tmp_path):
    (tmp_path / "av.py").write_text("raise ImportError('not here')")
    command = ["video", "--quiet"]
    brief = {"video.channels": 1, "video.total_time": 0.2, "camera.width": 64, "camera.height": 48}
    sets = [f"--set={key}={value}" for key, value in brief.items()]
    eyas = [sys.executable, "-m", "eyas", *command, *sets]
    path = os.pathsep.join([str(tmp_path), *filter(None, sys.path)])
    for writers, code in (('["jpeg","labels","mark"]', 0), ('["mp4"]', 2)):
        done = subprocess.run(
            [*eyas, f"--out={tmp_path / str(code)}", f"--set=video.writers={writers}"],
            env={**os.environ, "PYTHONPATH": path},
            check=False,
            capture_output=True,
            text=True,
        )
        assert done.returncode == code, done.stderr
    assert done.stderr.startswith("eyas: error: video.writers: 'mp4' needs PyAV")
    assert len(list(tmp_path.glob("0/DRONE0/episode0/*.jpeg"))) > 0
