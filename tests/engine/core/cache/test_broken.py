"""Damaged entries and folders that cannot be used: one line, the right values, and no crash."""

import contextlib
import json
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from eyas.engine.core.cache.array_file import map_arrays
from eyas.engine.core.cache.folder import EntryKind
from eyas.lanes.machine_code import read_code
from eyas.lanes.trusted import cache_folder

PROGRAM = """
import json, os, sys
from functools import partial
import numpy as np
from eyas.engine.core.cache.cached import cached
from eyas.lanes import exact
from eyas.engine.core.cache.folder import EntryKind
from eyas.lanes import compiled, entry

def double(values):
    for k in range(len(values)):
        values[k] *= 2.0

compile, compilations = entry._compiled, []
entry._compiled = lambda *a, **b: compilations.append(a) or compile(*a, **b)
for folder in sys.argv[1:] or [None]:
    if folder is not None:
        os.environ["EYAS_CACHE_DIR"] = folder
    compilations.clear()
    values = np.array(cached(EntryKind.SKY, partial(exact.exp, np.zeros(3)), (1,), of=np.ndarray))
    compiled(double)(values)
    print(json.dumps([values.tolist(), bool(compilations)]))
assert compilations or len(sys.argv) > 2 or "numba" not in sys.modules
"""
UNPRIVILEGED = ["setpriv", "--bounding-set=-dac_override,-dac_read_search,-fowner"]
"""Root without its right to ignore permissions; for others it changes nothing."""


def run(cache, *before, **options):
    """Run the program; return whether it had to compile, and the lines that it said."""
    (compiled,), said = run_each([cache], *before, **options)
    return compiled, said


def run_each(caches, *before, **options):
    """Run the program in one process, with one cache after the other."""
    cache = caches[0]
    environment = {k: v for k, v in os.environ.items() if k not in ("NUMBA_CACHE_DIR", "HOME")}
    environment |= {"EYAS_CACHE_DIR": str(cache)} if cache else {}
    if not cache:
        environment.pop("EYAS_CACHE_DIR", None)
    done = subprocess.run(
        [*before, sys.executable, "-c", PROGRAM, *(map(str, caches) if cache else ())],
        capture_output=True, text=True, check=False, env=environment, **options,
    )  # fmt: skip
    assert not done.returncode, done.stderr
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert [values for values, _ in told] == [[2.0, 2.0, 2.0]] * len(caches)
    return [compiled for _, compiled in told], done.stderr.splitlines()


def cut_off(path):
    path.write_bytes(path.read_bytes()[:-5])


def emptied(path):
    path.write_bytes(b"")


def flipped(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0x10
    path.write_bytes(content)


def replaced(path):
    """By a pickle that would tell on itself."""
    path.write_bytes(b"cos\nsystem\n(S'touch unpickled'\ntR.")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A cache with one array and one kernel."""
    folder = tmp_path_factory.mktemp("made") / "cache"
    assert run(folder) == (True, [])
    assert run(folder) == (False, [])
    return folder


@pytest.fixture
def cache(made, tmp_path):
    return Path(shutil.copytree(made, tmp_path / "cache"))


@pytest.mark.slow
def test_damaged_entries_are_told_in_a_line_each_and_made_anew(made, tmp_path):
    caches = []
    for damage in (cut_off, emptied, flipped, replaced):
        cache = Path(shutil.copytree(made, tmp_path / damage.__name__))
        files = [path for path in cache.rglob("*") if path.suffix in (".eyk", ".eym", ".npy")]
        assert sorted(path.suffix for path in files) == [".eyk", ".eym", ".npy"]
        for path in files:
            damage(path)
        caches.append(cache)
        compiled, said = run(cache, cwd=tmp_path)
        assert compiled
        assert len(said) == 3
        for line, path in zip(sorted(said), sorted(map(str, files)), strict=True):
            assert line.startswith(f"{path}: damaged or unreadable")
    assert run_each(caches) == ([False] * len(caches), [])
    assert not (tmp_path / "unpickled").exists()


def test_what_can_only_be_read_is_used_without_a_word(cache):
    for path in (cache, *cache.rglob("*")):
        path.chmod(0o555 if path.is_dir() else 0o444)
    assert run(cache, *UNPRIVILEGED) == (False, [])


def check_unused(cache, *before, **options):
    compiled, said = run(cache, *before, **options)
    assert len(said) == 1, said
    (line,) = said
    assert compiled
    assert ": cannot write: " in line
    assert "so every start makes and compiles again what is missing" in line


@pytest.mark.slow
def test_a_folder_that_cannot_be_written_to_is_one_line(tmp_path):
    empty = tmp_path / "cache"
    empty.mkdir()
    empty.chmod(0o555)
    check_unused(empty, *UNPRIVILEGED)
    (tmp_path / "file").touch()
    check_unused(tmp_path / "file")


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give files to others")
def test_someone_else_s_folder_is_one_line(cache):
    for path in (cache, *cache.rglob("*")):
        os.chown(path, 54321, 54321)
        path.chmod(0o700)
    check_unused(cache, *UNPRIVILEGED)


@pytest.mark.skipif(os.getuid() != 0, reason="only root can become a user without a home")
def test_a_user_without_a_home_is_one_line():
    reading = "+dac_read_search"  # of this Python, which may lie in root's home
    check_unused(
        None, *("setpriv", "--reuid=54321", f"--inh-caps={reading}", f"--ambient-caps={reading}")
    )


def test_a_full_disk_is_one_line(tmp_path):
    def full():
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))

    check_unused(tmp_path / "cache", preexec_fn=full)
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


@pytest.mark.parametrize("damage", [cut_off, emptied, flipped, replaced])
@pytest.mark.parametrize(
    "kind", [kind for kind in EntryKind if kind not in (EntryKind.DEFINITIONS, EntryKind.TRAFFIC)]
)
def test_no_kind_of_real_entry_is_believed_when_damaged(kind, damage, tmp_path):
    """Of those that other tests have made."""
    found = sorted((cache_folder() / kind).rglob("*.eyk" if kind is EntryKind.KERNELS else "*.npy"))
    read = read_code if kind is EntryKind.KERNELS else map_arrays
    for entry in sorted(found, key=lambda path: path.stat().st_size):
        path = Path(shutil.copy(entry, tmp_path))
        with contextlib.suppress(ValueError):
            if read(path) is not None:
                break
    else:
        return
    damage(path)
    if kind is EntryKind.KERNELS:
        assert read_code(path) is None
    else:
        with pytest.raises(ValueError, match=r"."):
            map_arrays(path)
