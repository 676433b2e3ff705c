"""`eyas dataset make --ray`: parts recorded by workers of Ray, one of which is killed."""

import json
import os
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from eyas.datasets.layout import Plan
from eyas.datasets.making.make import Making, make
from eyas.datasets.making.spread import on_ray
from eyas.datasets.recipe import read_recipe

TINY = {
    "name": "tiny",
    "title": "A few frames",
    "frames": 24,
    "episode_frames": 4,
    "trackers": 2,
    "splits": {
        "train": {"share": 0.67, "maps": ["citystreet"]},
        "test": {"share": 0.33, "maps": ["lake"]},
    },
    "cameras": [{"width": 64, "height": 48}],
}


def contents(path):
    files = (inside for inside in path.rglob("*") if inside.is_file())
    return {inside.relative_to(path).as_posix(): inside.read_bytes() for inside in files}


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    path = tmp_path_factory.mktemp("recipe") / "tiny.json"
    path.write_text(json.dumps(TINY))
    return Plan.of(read_recipe(str(path)), str(path), sample=False, shard=None)


def kill_one(until: float) -> int:
    """Kill a worker that records a part, as soon as there is one; return its id."""
    while time.monotonic() < until:
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                told = (folder / "cmdline").read_bytes()
            except OSError:
                continue
            if told.startswith(b"ray::_archive_of"):
                os.kill(int(folder.name), signal.SIGKILL)
                return int(folder.name)
        time.sleep(0.01)
    return 0


@pytest.mark.usefixtures("ray")
def test_a_lost_workers_part_is_made_again_with_the_same_bytes(plan, tmp_path):
    make(plan, tmp_path / "here", Making(workers=1))
    with on_ray() as recorded, ThreadPoolExecutor(1) as threads:

        def with_a_loss(parts, root):
            killed = threads.submit(kill_one, time.monotonic() + 60)
            yield from recorded(parts, root)
            assert killed.result()

        make(plan, tmp_path / "there", Making(workers=1), with_a_loss)
    assert contents(tmp_path / "there") == contents(tmp_path / "here")
