"""Machine code that comes with Eyas: used only where it is that of these sources and processors."""

import shutil
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from eyas.lanes import Held, entry, parallel_kernel, shipped
from eyas.lanes.identity import language_hash
from eyas.lanes.machine_code import SUFFIX, read_code, write_code

FEATURES = shipped.LEVELS["x86-64-v4"]


def double(parts, worker, workers):
    values = parts[0][0][0][0]
    for k in range(len(values)):
        values[k] *= 2.0


def doubled(dtype=np.float64) -> float:
    values = np.ones(1, dtype)
    parallel_kernel(double)(1, Held((values,)))
    return float(values[0])


@pytest.fixture
def compiled(monkeypatch):
    """Return the kernels that were compiled."""
    found, before = [], entry._compiled

    def counted(function, *others):
        found.append(function)
        return before(function, *others)

    monkeypatch.setattr(entry, "_compiled", counted)
    return found


@pytest.fixture
def machine(monkeypatch):
    """A machine whose processor can be changed; it does run the code of the real one."""
    has = SimpleNamespace(features=FEATURES, platform="linux", machine="x86_64")
    monkeypatch.setattr(shipped, "features", lambda: has.features)
    monkeypatch.setattr(shipped.platform, "machine", lambda: has.machine)
    monkeypatch.setattr(shipped, "sys", SimpleNamespace(platform=has.platform))
    for name in ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"):
        monkeypatch.delenv(name, raising=False)
    shipped._folder.cache_clear()
    yield has
    shipped._folder.cache_clear()


@pytest.fixture
def ships(tmp_path, monkeypatch, compiled, machine):
    """Return the folder of a level, in which the code of `double` is shipped; nothing is cached."""
    cache, folder = tmp_path / "cache", tmp_path / "shipped" / language_hash() / "x86-64-v3"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(cache))
    monkeypatch.setattr(shipped, "SHIPPED", tmp_path / "shipped")
    cache.mkdir()
    folder.mkdir(parents=True)
    doubled()
    (file,) = cache.iterdir()
    file.rename(folder / f"{file.stem.rpartition('-')[0]}{SUFFIX}")
    compiled.clear()
    shipped._folder.cache_clear()
    return folder


def test_shipped_code_is_used_and_nothing_is_compiled_or_cached(ships, compiled, tmp_path):
    assert doubled() == 2.0
    assert not compiled
    assert not list((tmp_path / "cache").iterdir())
    assert not entry.nothing_compiled(double)
    assert entry.nothing_compiled(doubled)


def test_code_of_another_language_of_kernels_is_passed_over(ships, compiled):
    ships.parent.rename(ships.parent.with_name("0123456789abcdef"))
    assert doubled() == 2.0
    assert len(compiled) == 1


def test_code_for_other_bundles_is_passed_over(ships, compiled):
    assert doubled(np.float32) == 2.0
    assert len(compiled) == 1


@pytest.mark.parametrize("damage", [lambda b: b[:-1], lambda b: b[:9] + b"x" + b[10:]])
def test_a_damaged_file_is_told_and_compiled_anew(ships, compiled, caplog, damage):
    (file,) = ships.iterdir()
    file.write_bytes(damage(file.read_bytes()))
    assert doubled() == 2.0
    assert len(compiled) == 1
    assert len(caplog.records) == 1


def test_code_that_this_llvm_cannot_link_is_compiled_anew(ships, compiled):
    (file,) = ships.iterdir()
    write_code(file, read_code(file, shipped=True)._replace(code=b"no object file"))
    assert doubled() == 2.0
    assert len(compiled) == 1


def test_the_best_level_that_the_processor_has_is_used(ships, compiled, machine):
    better = ships.with_name("x86-64-v4")
    shutil.copytree(ships, better)
    assert shipped._folder() == better
    machine.features = shipped.LEVELS["x86-64-v3"]
    shipped._folder.cache_clear()
    assert shipped._folder() == ships
    machine.features = shipped.LEVELS["x86-64-v3"] - {"fma"}
    shipped._folder.cache_clear()
    assert doubled() == 2.0
    assert len(compiled) == 1


def test_on_other_machines_kernels_are_compiled(ships, compiled, machine):
    machine.machine = "aarch64"
    assert doubled() == 2.0
    assert len(compiled) == 1


@pytest.mark.parametrize("variable", ["NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"])
def test_who_names_a_processor_gets_code_for_it(ships, monkeypatch, variable):
    monkeypatch.setenv(variable, "")
    assert shipped._folder() is None


def test_every_level_needs_what_the_level_below_it_needs():
    levels = list(shipped.LEVELS.values())
    assert all(above > below for above, below in pairwise(levels))
