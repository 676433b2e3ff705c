"""What an edit of the sources changes: kernels that compute something else, and no others."""

import itertools
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import eyas
from eyas.lanes import kernel
from eyas.lanes.identity import LANGUAGE, identity, language_files

ROOT = Path(eyas.__file__).parent

TELLS = """
import importlib, json, pkgutil
import eyas
from eyas.lanes.identity import identity, language_hash
from eyas.lanes import CompiledCall
from eyas.engine.sim.step import step_of
from eyas.engine.trackers.drone import DRONE

found = list(step_of(DRONE))
rooms = ("render.kernels.draw", "traffic.interpolation", "sensors.lidar")
for name in (*rooms, "sim.views.visible_actors"):
    found += vars(importlib.import_module("eyas.engine." + name)).values()
told = {k.function.__name__: identity(k.function) for k in found if isinstance(k, CompiledCall)}
print(json.dumps(told | {"language": language_hash()}))
"""


@pytest.fixture(scope="module")
def edited(tmp_path_factory):
    """Edit a copy of the package; return which kernels are then others."""
    copy = tmp_path_factory.mktemp("copy") / "eyas"
    shutil.copytree(ROOT, copy, ignore=lambda _, names: {n for n in names if "__pycache__" in n})

    def told():
        done = subprocess.run(
            [sys.executable, "-c", TELLS],
            env={**os.environ, "PYTHONPATH": str(copy.parent)},
            check=True,
            capture_output=True,
            text=True,
        )
        return json.loads(done.stdout)

    before = told()
    assert {"_fly", "_carry", "_begin", "draw_views", "_list_actors"} <= set(before)

    seconds = itertools.count(1)

    def write(path, text):
        """Write a file with a time of its own.

        Python takes an old .pyc of the same size and second for current.
        """
        path.write_text(text)
        os.utime(path, (second := next(seconds), second))

    def others(edits):
        texts = {copy / name: (copy / name).read_text() for name in edits}
        for path, text in texts.items():
            for old, new in edits[path.relative_to(copy).as_posix()].items():
                assert old in text
                text = text.replace(old, new, 1)
            write(path, text)
        after = told()
        for path, text in texts.items():
            write(path, text)
        assert set(after) == set(before)
        return {name for name in after if after[name] != before[name]}

    return others


def test_comments_docstrings_annotations_and_blank_lines_change_nothing(edited):
    assert not edited(
        {
            "engine/task/reward.py": {
                '"""': '"""Another word. ',
                "\nimport numpy as np\n": "\n\n# A comment.\n\nimport numpy as np\n",
                "-> float:": "-> 'float':",
            },
            "engine/render/kernels/surface/shade.py": {"\nfrom ": "\n# A comment.\nfrom "},
            "lanes/compilation.py": {'"""': '"""Another word. '},
            "cli/tools.py": {'"""': '"""The word kernel. '},
        }
    )


def test_a_constant_changes_the_kernels_that_read_it(edited):
    step = {"_fly", "_carry", "_begin"}
    assert edited({"engine/task/reward.py": {"0.5": "0.25"}}) == step
    assert edited({"engine/core/clock.py": {"RATE = 500": "RATE = 400"}}) >= step
    assert edited({"engine/render/kernels/surface/snow.py": {"0.": "1."}}) == {"draw_views"}


def test_what_decides_how_kernels_are_compiled_changes_their_folder(edited):
    assert "language" in edited({"lanes/machine_code.py": {"speed_level=3": "speed_level=2"}})
    for path in ROOT.joinpath("lanes").rglob("*.py"):
        extends = any(
            f"{how} {what}" in path.read_text()
            for what in ("numba.core", "numba.extending", "llvmlite")
            for how in ("import", "from")
        )
        own = path.relative_to(ROOT / "lanes").as_posix()
        # None of these compiles for this processor.
        if extends and own not in ("shipped.py",):
            assert path in language_files(), f"{own}: is it part of {LANGUAGE}?"


def test_values_of_all_kinds_are_told_apart():
    def of(value):
        names = {"VALUE": value, "__name__": "here"}
        exec("def reads(x):\n    return x + VALUE", names)
        return identity(names["reads"])

    values = [1, 1.0, True, "1", (1,), [1], None, np.float32(1), np.float64(1), np.ones(1)]
    values += [np.ones(1, np.int8), np.dtype(np.int8), np.int8, {1: 2}, frozenset({1}), -0.0, 0.0]
    assert len({of(value) for value in values}) == len(values)
    assert of((1, 2.5)) == of((1, 2.5))


def test_users_kernels_are_known_by_what_they_say(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    told = []
    for number, text in enumerate(("x + HALF", "x + HALF  # a comment", "x * HALF")):
        path = tmp_path / f"mine{number}.py"
        path.write_text(f"HALF = 0.5\n\ndef plus(x):\n    return {text}\n")
        made = __import__(f"mine{number}").plus
        made.__module__ = "mine"
        told.append(identity(kernel(made)))
    assert told[0] == told[1] != told[2]
