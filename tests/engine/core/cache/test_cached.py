"""Values that are kept from run to run, by real processes too."""

import gc
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import weakref
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import eyas
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.flat import FlatError
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.errors import ConfigError


class Town(NamedTuple):
    name: str
    ground: NDArray[np.float32]


def abs_of(number):
    return abs(number)


class Maker:
    def __init__(self):
        self.calls = 0

    def __call__(self):
        self.calls += 1
        return Town("town", np.arange(1000, dtype=np.float32))


class Gives:
    def __init__(self, what):
        self.what = what

    def __call__(self):
        return self.what


def town(make, folder, inputs=(1,), of=Town):
    return cached(EntryKind.SCENE, make, inputs, of=of, folder=folder)


def files_in(folder):
    """Return the values that are kept; what sources say is kept beside them."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return sorted(path for path in files if path.parent.name != EntryKind.DEFINITIONS)


def test_a_value_is_made_once(tmp_path):
    make = Maker()
    first, again = town(make, tmp_path), town(make, tmp_path)
    assert make.calls == 1
    assert first.name == again.name == "town"
    np.testing.assert_array_equal(first.ground, again.ground)
    (file,) = files_in(tmp_path)
    assert file.parent == tmp_path / "scene"


@pytest.mark.parametrize(
    "other",
    [
        {"inputs": (2,)},
        {"inputs": ("1",)},
        {"inputs": (1, np.zeros(3))},
        {"inputs": ((1,),)},
        {"inputs": (1, abs_of)},
        {"inputs": (1, partial(abs_of, 2))},
        {"inputs": (1, Town("town", np.zeros(3, np.float32)))},
    ],
)
def test_other_inputs_are_another_entry(tmp_path, other):
    make = Maker()
    town(make, tmp_path)
    town(make, tmp_path, **other)
    assert make.calls == len(files_in(tmp_path)) == 2


def test_what_cannot_be_identified_is_made_each_time(tmp_path):
    make = Maker()
    made_of_text = eval("lambda: 1", {"__name__": "nowhere"})  # whose source is nowhere
    for unknown in (object(), made_of_text):
        calls = make.calls
        for _ in range(2):
            assert town(make, tmp_path, (unknown,)).name == "town"
        assert make.calls == calls + 2
    assert files_in(tmp_path) == []


def test_arrays_are_told_apart_by_what_is_in_them(tmp_path):
    make = Maker()
    large = np.zeros(5000)
    changed = large.copy()
    changed[2500] = 1.0  # which the array's `repr` leaves out
    for array in (large, changed, large.reshape(2, -1), large.astype(np.float32), large.copy()):
        town(make, tmp_path, (array,))
    assert make.calls == 4


def test_a_damaged_entry_is_made_anew_and_mended(tmp_path):
    make = Maker()
    whole = town(make, tmp_path).ground.copy()  # the file of which is damaged below
    (file,) = files_in(tmp_path)
    good = file.read_bytes()
    flipped = bytearray(good)
    flipped[-200] ^= 1
    for calls, damaged in enumerate((b"", b"no arrays", good[:-7], bytes(flipped)), start=2):
        file.write_bytes(damaged)
        np.testing.assert_array_equal(town(make, tmp_path).ground, whole)
        assert make.calls == calls
        assert file.read_bytes() == good


class Larger(NamedTuple):
    name: str
    ground: NDArray[np.float32]
    trees: int


class Renamed(NamedTuple):
    title: str
    ground: NDArray[np.float32]


class Precise(NamedTuple):
    name: str
    ground: NDArray[np.float64]


@pytest.mark.parametrize("kind", [Larger, Renamed, Precise])
def test_an_entry_of_another_type_is_made_anew(tmp_path, kind):
    town(Gives(Maker()()), tmp_path)
    made = kind(
        "town",
        np.zeros(3, np.float64 if kind is Precise else np.float32),
        *([4] if kind is Larger else []),
    )
    assert len(town(Gives(made), tmp_path, of=kind).ground) == 3
    assert len(town(Gives(None), tmp_path, of=kind).ground) == 3  # kept, so that no one is asked


def test_what_is_new_has_the_types_of_what_is_read(tmp_path):
    def make():
        return Town("town", np.arange(6, dtype=np.float32).reshape(2, 3).T)

    for town_ in (town(make, tmp_path), town(make, tmp_path)):
        assert town_.ground.flags.c_contiguous
        np.testing.assert_array_equal(town_.ground, [[0, 3], [1, 4], [2, 5]])


def test_a_maker_that_makes_something_else_is_told_at_once(tmp_path):
    with pytest.raises(FlatError):
        town(lambda: Precise("town", np.zeros(3)), tmp_path)


def test_a_folder_that_cannot_be_written_to_costs_only_time(tmp_path):
    make = Maker()
    (tmp_path / "file").write_text("in the way")
    for _ in range(2):
        assert town(make, tmp_path / "file" / "cache").name == "town"
    assert make.calls == 2
    assert len(files_in(tmp_path)) == 1


def test_a_full_disk_costs_only_time_and_leaves_nothing(tmp_path, monkeypatch):
    def full(self, target):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    assert town(Maker(), tmp_path).name == "town"
    assert files_in(tmp_path) == []


TOTAL = str(sum(range(1 << 16)))


def start(cache, before="", **kwargs):
    """Start a process that uses an entry; it waits for a line before it makes one."""
    return subprocess.Popen(
        [sys.executable, Path(__file__).with_name("keeping.py"), before],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "EYAS_CACHE_DIR": str(cache)},
        **kwargs,
    )


def told(process):
    """Let a process go on to its end; return what it says."""
    said = process.communicate("\n", timeout=60)[0].split()
    assert process.returncode == 0
    return said


def test_processes_that_make_the_same_at_once_do_not_disturb_each_other(tmp_path):
    both = [start(tmp_path) for _ in range(2)]
    for process in both:
        assert process.stdout.readline() == "making\n"  # both have found nothing
    for process in both:
        process.stdin.write("\n")
        process.stdin.flush()
    assert [told(process) for process in both] == [[TOTAL], [TOTAL]]
    assert len(files_in(tmp_path)) == 1
    assert told(start(tmp_path)) == [TOTAL]


def test_a_process_that_is_killed_while_it_writes_leaves_no_entry(tmp_path):
    waits = "Path.replace = lambda *_: (print('written', flush=True), time.sleep(60))"
    process = start(tmp_path, before=waits)
    process.stdin.write("\n")
    process.stdin.flush()
    assert [process.stdout.readline() for _ in range(2)] == ["making\n", "written\n"]
    process.kill()
    process.communicate()
    (part,) = files_in(tmp_path)
    assert part.name.endswith(".part")
    assert told(start(tmp_path)) == ["making", TOTAL]
    assert told(start(tmp_path)) == [TOTAL]
    assert len(files_in(tmp_path)) == 2  # the part may be of one that still writes ...
    os.utime(part, (0, 0))
    town(Maker(), tmp_path)
    assert part not in files_in(tmp_path)  # ... but not for a day


@pytest.fixture
def open_folder():
    """Return a folder that other users can reach."""
    folder = Path(tempfile.mkdtemp(prefix="eyas-test-"))
    folder.chmod(0o755)
    yield folder
    shutil.rmtree(folder)


def test_a_cache_that_only_others_may_write_to_is_read(open_folder):
    assert told(start(open_folder)) == ["making", TOTAL]
    (file,) = files_in(open_folder)
    content, used = file.read_bytes(), file.stat().st_mtime_ns
    for path in (*open_folder.rglob("*"), open_folder):
        path.chmod(0o555 if path.is_dir() else 0o444)
    # Modules that another user may not be allowed to read are imported before.
    demoted = "import mmap; os.setuid(65534) if os.geteuid() == 0 else None"
    assert told(start(open_folder, demoted)) == [TOTAL]
    assert told(start(open_folder, demoted + "; EntryKind = type('', (), {'SKY': 'parts'})")) == [
        "making",
        TOTAL,
    ]
    assert files_in(open_folder) == [file]
    assert (file.read_bytes(), file.stat().st_mtime_ns) == (content, used)
    for path in (open_folder, *open_folder.rglob("*")):
        path.chmod(0o755)


def test_use_is_remembered(tmp_path):
    town(Maker(), tmp_path)
    (file,) = files_in(tmp_path)
    os.utime(file, (0, 0))
    town(Maker(), tmp_path)
    assert time.time() - file.stat().st_mtime < 100


def test_the_limit_is_read_before_anything_is_made(tmp_path, monkeypatch):
    monkeypatch.setenv("EYAS_CACHE_LIMIT", "plenty")
    make = Maker()
    with pytest.raises(ConfigError, match=r"^EYAS_CACHE_LIMIT: 'plenty' is not allowed; allowed: "):
        town(make, tmp_path)
    assert make.calls == 0


def test_nothing_of_ours_is_unpickled():
    unpickles = re.compile(
        r"^\s*(import|from) +(pickle|cloudpickle|dill|joblib|shelve|marshal)\b|allow_pickle=True",
        re.M,
    )
    sources = list(Path(eyas.__file__).parent.rglob("*.py"))
    assert len(sources) > 100
    assert [path.name for path in sources if unpickles.search(path.read_text())] == []


def test_garbage_is_not_looked_for_while_a_value_is_made_and_is_again_after(tmp_path):
    seen = []

    class Watched(Maker):
        def __call__(self):
            seen.append(gc.isenabled())
            return super().__call__()

    town(Watched(), tmp_path)
    assert (seen, gc.isenabled()) == ([False], True)
    gc.disable()
    try:
        town(Watched(), tmp_path, (3,))
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_what_was_made_is_let_go_of_for_its_file(tmp_path):
    """So that a first start takes no more memory than a later one."""
    made = []

    def ground():
        array = np.arange(1000, dtype=np.float32)
        made.append(weakref.ref(array))
        return array

    found = cached(EntryKind.SCENE, ground, (1,), of=NDArray[np.float32], folder=tmp_path)
    assert made[0]() is None
    np.testing.assert_array_equal(found, np.arange(1000))


def test_what_cannot_be_kept_is_returned_as_it_was_made(tmp_path):
    (tmp_path / "scene").write_text("no folder")
    assert town(Maker(), tmp_path).name == "town"
