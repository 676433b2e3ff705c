"""`eyas dataset make --ray`: parts recorded by workers of Ray, one of which is killed."""

import json
import os
import signal

import pytest

from eyas.datasets.layout import Plan
from eyas.datasets.recipe import read_recipe
from eyas.modes.dataset.make import Making, make
from eyas.modes.dataset.spread import on_ray

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


def test_a_lost_workers_part_is_made_again_with_the_same_bytes(ray, plan, tmp_path):
    make(plan, tmp_path / "here", Making(workers=1))

    @ray.remote
    class Killer:
        """Kills the worker that records the first part, once."""

        def kill(self, mine):
            import psutil

            for process in psutil.process_iter(["name", "pid"]):
                if "_archive_of" in " ".join(process.cmdline()) and process.pid != mine:
                    os.kill(process.pid, signal.SIGKILL)
                    return process.pid
            return 0

    killer, killed = Killer.remote(), 0
    with on_ray() as recorded:

        def with_a_loss(parts, root):
            nonlocal killed
            made = recorded(parts, root)
            import threading
            import time

            def kill():
                nonlocal killed
                until = time.monotonic() + 60
                while not killed and time.monotonic() < until:
                    killed = ray.get(killer.kill.remote(os.getpid()))

            thread = threading.Thread(target=kill)
            thread.start()
            yield from made
            thread.join()

        make(plan, tmp_path / "there", Making(), with_a_loss)
    assert killed
    assert contents(tmp_path / "there") == contents(tmp_path / "here")
