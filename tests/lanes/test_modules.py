"""Modules of functions are kept: an edit compiles only what it touches."""

import importlib.util
import json
import sys
from typing import NamedTuple

import numba
import numpy as np
import pytest

from eyas.lanes import CompiledCall, compilation, kernel, modules, syntax
from eyas.lanes.container import Contents
from eyas.lanes.modules import SUFFIX, module_name
from eyas.lanes.vector.kinds import Lanes

PACKED = Contents(1, (2.0, 3))
"""A named tuple of a module that can be imported."""

SOURCE = """
from typing import NamedTuple
from eyas.lanes import kernel

FACTOR = 2.0

class Pair(NamedTuple):
    low: float
    high: float

@kernel
def ordered(x, y):
    return Pair(min(x, y), max(x, y))

@kernel(inline=True)
def scaled(x):
    return FACTOR * x

@kernel
def both(x, y):
    pair = ordered(x, scaled(y))
    return pair.high - pair.low

def work(values):
    values[0] = both(values[0], values[1])
"""


@pytest.fixture
def compiled(tmp_path, monkeypatch):
    """Compute `work` of a source as a new process does; return the result, and the compiled."""
    cache, source = tmp_path / "cache", tmp_path / "edited.py"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(cache))
    before, found = compilation._compile, []

    def counted(function, *others):
        found.append(function.__name__)
        return before(function, *others)

    monkeypatch.setattr(compilation, "_compile", counted)

    def compute(text=SOURCE, first=2.0, second=3.0):
        source.write_text(text)
        syntax.syntax_of.cache_clear()
        spec = importlib.util.spec_from_file_location("edited", source)
        edited = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, "edited", edited)
        exec(compile(text, source, "exec"), vars(edited))  # never the bytecode of the last text
        for file in cache.glob("*.eyk"):
            file.unlink()
        modules._LOADED.clear()
        found.clear()
        values = np.array([first, second])
        CompiledCall(edited.work)(values)
        return float(values[0]), sorted(found)

    return compute


def test_the_next_process_compiles_nothing_but_links_what_is_kept(compiled):
    assert compiled() == (4.0, ["both", "ordered", "scaled", "work"])
    assert compiled() == (4.0, [])
    assert compiled(first=5.0, second=1.0) == (3.0, [])


@pytest.mark.parametrize(
    ("old", "new", "result", "made"),
    [
        ("FACTOR = 2.0", "FACTOR = 10.0", 28.0, ["both", "scaled", "work"]),
        ("max(x, y)", "max(y, x)", 4.0, ["both", "ordered", "work"]),
        ("inline=True", "inline=False", 4.0, ["both", "scaled", "work"]),
        ("pair.low", "pair.high", 0.0, ["both", "work"]),
        ("    high: float", "    high: float\n    # A comment.", 4.0, []),
    ],
)
def test_an_edit_compiles_what_it_touches_and_its_callers(compiled, old, new, result, made):
    compiled()
    assert compiled(SOURCE.replace(old, new)) == (result, made)
    assert compiled(SOURCE.replace(old, new)) == (result, [])
    assert compiled() == (4.0, [])


def test_swapped_fields_are_another_record(compiled):
    compiled()
    swapped = SOURCE.replace("low: float\n    high", "high: float\n    low")
    assert compiled(swapped) == (-4.0, ["both", "ordered", "work"])


@pytest.mark.parametrize("damage", [lambda b: b[:-70], lambda b: b"", lambda b: b[:20] + b[21:]])
def test_a_damaged_module_is_told_and_it_and_its_callers_are_made_anew(
    compiled, damage, tmp_path, caplog
):
    compiled()
    (file,) = tmp_path.rglob(f"ordered-*{SUFFIX}")
    file.write_bytes(damage(file.read_bytes()))
    assert compiled() == (4.0, ["both", "ordered", "work"])
    assert {record.getMessage() for record in caplog.records} == {
        f"{file}: damaged or unreadable, so it is made anew"
    }
    assert compiled() == (4.0, [])


def test_modules_that_others_may_have_written_are_not_used(compiled, tmp_path):
    compiled()
    (tmp_path / "cache").chmod(0o777)
    assert compiled()[1] == ["both", "ordered", "scaled", "work"]


@pytest.mark.parametrize(
    "kind",
    [
        numba.types.float32,
        numba.types.boolean,
        numba.types.none,
        numba.types.Tuple([numba.types.int64, numba.types.UniTuple(numba.types.float64, 2)]),
        Lanes(numba.types.boolean),
        numba.typeof(PACKED),
        numba.typeof(np.zeros((2, 3), np.uint32)),
        numba.typeof(np.zeros((4, 4))[::2].T),
    ],
)
def test_the_types_that_kernels_return_are_told_and_understood(kind):
    assert modules._type_of(json.loads(json.dumps(modules._as_json(kind)))) == kind


def test_types_that_no_module_names_are_not_told():
    class Local(NamedTuple):
        x: float

    for value in (Local(1.0), (1.0, Local(1.0)), np.zeros(1, [("x", float)])):
        assert modules._as_json(numba.typeof(value)) is None


class Pair(NamedTuple):
    low: float
    high: float


class Swapped(NamedTuple):
    high: float
    low: float


def work(values): ...


def test_bundles_with_other_fields_have_other_modules():
    names = [
        module_name(work, (numba.types.CPointer(numba.typeof(value)),), "made of")
        for value in (Pair(1.0, 2.0), Swapped(1.0, 2.0), (1.0, 2.0), Pair(1, 2.0))
    ]
    assert len(set(names)) == 4


def test_what_cannot_be_told_from_others_has_no_name():
    assert module_name(work, (kernel(work)._numba_type_,), "made of") is None
    assert module_name(work, (), None) is None
