"""Whoever has no PyAV, which is an extra, can do without it."""

import json
import sys

import pytest
from PIL import Image

from eyas.demo.frame import Stream
from eyas.engine.core.codecs.pyav import has_pyav
from eyas.engine.core.errors import MissingExtraError
from eyas.engine.exports.mp4 import Mp4Episode
from eyas.engine.exports.registry import chosen_writers


@pytest.fixture
def missing(monkeypatch):
    for name in [name for name in sys.modules if name.split(".")[0] == "av"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "av", None)


@pytest.mark.usefixtures("missing")
def test_what_needs_it_says_so_in_one_line(run, tmp_path):
    (writer,) = chosen_writers(["mp4"])
    line = r"^video\.writers: 'mp4' needs the extra 'video': pip install .*\[video\]'?\Z"
    with pytest.raises(MissingExtraError, match=line):
        writer(run)
    with pytest.raises(MissingExtraError, match=r"^MP4 needs the extra 'video'"):
        Mp4Episode(tmp_path / "a.mp4", 48, 64, 25.0)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(MissingExtraError, match=r"^pictures: H\.264 needs the extra"):
        Stream(48, 64, 30)  # JPEG goes on then
    assert not has_pyav()


def test_it_is_found_where_it_is():
    assert has_pyav()


@pytest.fixture
def record(tmp_path, missing, eyas_command):
    """Records for a moment without it, into a folder of a name."""
    brief = {"video.channels": 1, "video.total_time": 0.2, "camera.width": 64, "camera.height": 48}
    sets = [f"--set={key}={value}" for key, value in brief.items()]
    return lambda name, *more: eyas_command("video", f"--out={tmp_path / name}", *sets, *more)


@pytest.mark.slow
def test_films_are_webp_without_it_and_go_on_as_such(record, tmp_path):
    done = record("out")
    assert done.returncode == 0, done.stderr
    line = "eyas: films are animated WebP; for MP4: pip install "
    assert sum(told.startswith(line) for told in done.stderr.splitlines()) == 1, done.stderr
    assert json.loads((tmp_path / "out/config.json").read_text())["video"]["writers"] == [
        *("jpeg", "webp", "labels", "mark")
    ]
    episode = tmp_path / "out/DRONE0/episode0"
    with Image.open(episode / "episode.webp") as film:
        assert (film.n_frames, film.size) == (len(list(episode.glob("*.jpeg"))), (64, 48))
    again = record("out", "--resume", "--quiet")
    assert (again.returncode, again.stderr) == (0, "")


@pytest.mark.slow
def test_who_asks_for_mp4_is_told_in_one_line_what_it_needs(record, tmp_path):
    done = record("out", '--set=video.writers=["mp4"]')
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert done.stderr.startswith("eyas: error: video.writers: 'mp4' needs the extra 'video': pip")
    assert not (tmp_path / "out/DRONE0").exists()
