"""Kernels made of other kernels, and how they are kept on disk."""

import json
import os
import subprocess
import sys

import pytest

from eyas.core.jit import kernel, specialised
from eyas.sim.step import step_of
from eyas.trackers.drone import DRONE


@kernel
def doubled(x):
    return 2.0 * x


@kernel
def tripled(x):
    return 3.0 * x


def applied(x):
    return doubled(x) + 0.5


def test_a_specialised_function_calls_the_other_kernel_and_leaves_the_first_as_it_is():
    other = specialised(applied, doubled=tripled)
    assert other(2.0) == kernel(other)(2.0) == 6.5
    assert applied(2.0) == kernel(applied)(2.0) == 4.5


def test_with_the_kernels_that_it_names_a_function_stays_itself():
    assert specialised(applied, doubled=doubled) is applied
    assert step_of(DRONE) is step_of(DRONE)
    assert step_of(DRONE).fly.function.__name__ == step_of(DRONE).fly.function.__qualname__


def test_the_same_kernels_give_the_same_name_and_others_another():
    names = [
        specialised(applied, doubled=other).__qualname__
        for other in (tripled, tripled, kernel(abs_))
    ]
    assert names[0] == names[1] != names[2]
    assert all(name.startswith("applied_") for name in names)


def abs_(x):
    return abs(x)


OWN = """
from typing import NamedTuple
import numpy as np
from eyas.core.jit import kernel

class Own(NamedTuple):
    values: np.ndarray

@kernel
def first(x):
    return 2.0 * x

@kernel
def other(x):
    return FACTOR * x

def applied(x):
    return first(x)
"""
SPECIALISED = """
import json
from eyas.core.jit import kernel, specialised
from own import {function}
made = kernel(specialised(applied, first=other))
print(json.dumps([made(2.0), sum(made.stats.cache_hits.values()), made.py_func.__qualname__]))
"""


@pytest.fixture
def run(tmp_path):
    """Run a program with a cache of its own; return what it prints."""

    def program(text, *folders):
        path = os.pathsep.join([*map(str, folders), *filter(None, sys.path)])
        settings = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": path}
        done = subprocess.run(
            [sys.executable, "-c", text],
            capture_output=True, text=True, check=False, env={**os.environ, **settings},
        )  # fmt: skip
        assert not done.returncode, done.stderr
        return json.loads(done.stdout)

    return program


def test_processes_share_what_was_compiled_until_the_source_of_a_kernel_changes(run, tmp_path):
    """The function stays in a file of its own, so numba itself would not notice the change."""
    (tmp_path / "function.py").write_text(
        "from own import first\n\ndef applied(x):\n    return first(x)\n"
    )
    text = SPECIALISED.format(function="other\nfrom function import applied")
    own = tmp_path / "own.py"
    own.write_text(OWN.replace("FACTOR", "3.0"))
    compiled, loaded = run(text, tmp_path), run(text, tmp_path)
    assert (compiled[:2], loaded[:2]) == ([6.0, 0], [6.0, 1])
    assert compiled[2] == loaded[2]
    own.write_text(OWN.replace("FACTOR", "5.0"))
    changed = run(text, tmp_path)
    assert changed[:2] == [10.0, 0]
    assert changed[2] != compiled[2]


HELD = "import numpy as np\nfrom eyas.core.parallel import Held\n"


def test_a_program_without_somebody_s_class_reads_the_kernels_that_worked_on_it(run, tmp_path):
    """As a tracker of one's own brings a record of its own, in kernels that all programs share."""
    (tmp_path / "own.py").write_text(OWN.replace("FACTOR", "3.0"))
    text = HELD + "from own import Own\nprint(Held((1.0, Own(np.zeros(2)))).layout)"
    assert run(text, tmp_path) > 0
    assert run(HELD + "print(Held((1.0, (np.zeros(2),))).layout)") > 0
