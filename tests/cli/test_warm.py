"""`eyas cache warm`: nothing is left to be made afterwards."""

import os
import subprocess
import sys

import pytest

from eyas.cli.cache import run_warm
from eyas.engine.core.errors import OutputError, UnknownNameError
from eyas.engine.sim.scenes import load_scene
from eyas.engine.world.weather import Season

MAP = "farmland-bare"
SMALL = ("camera.width=64", "camera.height=48")


def eyas(folder, *arguments):
    return subprocess.run(
        [sys.executable, "-m", "eyas", *map(str, arguments)],
        env={**os.environ, "EYAS_CACHE_DIR": str(folder)},
        check=True,
        capture_output=True,
        text=True,
    )


@pytest.mark.slow
def test_what_a_first_recording_needs_is_there(tmp_path, empty_cache):
    cache, out = empty_cache, tmp_path / "out"
    told = eyas(cache, "cache", "warm", "--map", MAP, "--weather", "day").stdout.splitlines()
    assert told[0].startswith(f"{MAP}, day: ")
    assert told[1].startswith(f"{cache}: ")
    made = set(cache.rglob("*.npy"))
    assert {path.parent.name for path in made} >= {"scene", "geometry", "motion"}
    brief = [f"--set={name}" for name in ("video.total_time=0.1", "video.channels=1", *SMALL)]
    eyas(cache, "video", "--map", MAP, "--out", out, "--quiet", *brief)
    assert set(cache.rglob("*.npy")) == made


def test_a_cache_that_cannot_be_written_to_is_one_line(monkeypatch):
    monkeypatch.setenv("EYAS_CACHE_DIR", "/dev/null/x")
    with pytest.raises(OutputError, match=r"^/dev/null/x: cannot write: Not a directory\Z"):
        run_warm([MAP], ["day"])


def test_unknown_maps_are_refused_before_anything_is_made():
    with pytest.raises(UnknownNameError, match="did you mean 'farmland-bare'"):
        run_warm([MAP, "farmland-bar"])


def test_a_map_is_built_once_whether_or_not_its_season_is_named():
    assert load_scene(MAP) is load_scene(MAP, 0, Season.SUMMER) is load_scene(MAP, seed=0)
