"""A data set of four recordings, made once, and what runs `eyas` in other processes."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from eyas.datasets.layout import Plan
from eyas.datasets.making.make import Making, make
from eyas.datasets.recipe import Recipe, read_recipe

TINY = {
    "name": "tiny",
    "title": "A few frames",
    "about": "For tests.",
    "date": "2026-11-24",
    "seed": 7,
    "frames": 48,
    "episode_frames": 6,
    "fps": 10.0,
    "trackers": 2,
    "splits": {
        "train": {"share": 0.5, "maps": ["citystreet"]},
        "val": {"share": 0.25, "maps": ["simpleway-grass"]},
        "test": {"share": 0.25, "maps": ["lake"]},
    },
    "weathers": ["day", "night"],
    "heights": [15.0, {"uniform": [13.0, 25.0]}],
    "cameras": [{"width": 64, "height": 48}, {"width": 48, "height": 64, "field_of_view": 1.2}],
    "writers": ["jpeg", "labels", "masks"],
    "formats": ["coco", "got10k"],
}


@pytest.fixture(scope="session")
def tiny() -> dict:
    return TINY


@pytest.fixture(scope="session")
def recipe_file(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("recipe") / "tiny.json"
    path.write_text(json.dumps(TINY))
    return path


@pytest.fixture(scope="session")
def plan(recipe_file) -> Plan:
    return Plan.of(read_recipe(str(recipe_file)), str(recipe_file), sample=False, shard=None)


@pytest.fixture(scope="session")
def shard(plan):
    def of(number: int, count: int) -> Plan:
        return plan.model_copy(update={"shard": (number, count)})

    return of


@pytest.fixture(scope="session")
def made(plan, tmp_path_factory) -> Path:
    """The data set, made by one process."""
    root = tmp_path_factory.mktemp("made") / "tiny"
    make(plan, root, Making(workers=1))
    return root


@pytest.fixture(scope="session")
def contents():
    def of(path: Path) -> dict[str, bytes]:
        return {
            inside.relative_to(path).as_posix(): inside.read_bytes()
            for inside in path.rglob("*")
            if inside.is_file()
        }

    return of


@pytest.fixture(scope="session")
def start():
    """Begin `eyas dataset ...` in another process."""

    def begin(*words: str | Path, before: list[str] | None = None) -> subprocess.Popen[str]:
        command = [*(before or []), sys.executable, "-m", "eyas", "dataset", *map(str, words)]
        return subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=dict(os.environ)
        )

    return begin


@pytest.fixture
def small_recipe(tiny) -> Recipe:
    return Recipe.model_validate(tiny)
