"""The cache stays below its limit, and nothing is removed but what Eyas made."""

import os
import time
from functools import partial
from pathlib import Path

import numpy as np
import platformdirs
import pytest
from numpy.typing import NDArray

from eyas.engine.core.cache.array_file import map_arrays
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.entries import clear, entries, prune, write_entry
from eyas.engine.core.cache.folder import EntryKind, cache_limit
from eyas.engine.core.errors import ConfigError
from eyas.lanes.trusted import cache_folder

DAY = 86_400.0
KEY = "0123456789abcdef" * 2
FOREIGN = [
    "notes.txt",
    "scene/notes.txt",
    f"scene/{KEY}.npy",
    f"scene/eyas-{KEY}.npy.bak",
    f"scene/eyas-{KEY[:-1]}.npy",
    f"mine/eyas-{KEY}.npy",
    "traffic/mine.npz",
    f".eyas-{KEY}.npy.0123456789abcdef.part",
    "scene/.mine.part",
    "kernels/mine/draw.eym",
    f"kernels/{KEY[:16]}/notes.txt",
    "made/model.pickle",
    "shadows/mine.npz",
]


def put(folder, name, size=1000, age=0.0):
    """Put a file into the cache that was used some time ago [s]."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"x" * size)
    used = time.time() - age
    os.utime(path, (used, used))
    return path


def kernels(folder, name, age, size=1000):
    path = folder / "kernels" / name
    put(path, "render_0123/draw.draw-7.py311.eyk", size // 2)
    put(path, "render_0123/draw.draw-7.py311.eym", size // 4)
    put(path, "draw-0123.eyk", size - size // 2 - size // 4)
    put(path, "started", 0)
    used = time.time() - age
    os.utime(path, (used, used))
    return path


def entry_name(kind, number):
    return f"{kind}/eyas-{number:032x}.npy"


def kept(folder):
    return {entry.path for entry in entries(folder)}


def test_what_was_not_used_for_longest_goes_first(tmp_path):
    files = [put(tmp_path, entry_name(EntryKind.SKY, i), age=100.0 * i) for i in range(5)]
    prune(tmp_path, 5000)
    assert kept(tmp_path) == set(files)
    prune(tmp_path, 4999)
    assert kept(tmp_path) == set(files[:4])
    prune(tmp_path, 2500)
    assert kept(tmp_path) == set(files[:2])
    prune(tmp_path, 0)
    assert kept(tmp_path) == set()


def test_writing_makes_room_and_use_counts(tmp_path, monkeypatch):
    monkeypatch.setenv("EYAS_CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("EYAS_CACHE_LIMIT", "40K")

    def use(i):
        cached(EntryKind.SKY, partial(np.full, 12_000, i, np.uint8), (i,), of=NDArray[np.uint8])
        time.sleep(0.02)
        return {int(map_arrays(path).arrays[0][0]) for path in kept(tmp_path)}

    assert [use(i) for i in (1, 2, 3)] == [{1}, {1, 2}, {1, 2, 3}]
    assert use(1) == {1, 2, 3}
    assert use(4) == {1, 3, 4}
    assert use(5) == {1, 4, 5}


def test_an_array_that_is_in_use_survives_its_entry(tmp_path):
    def use(limit_folder):
        return cached(
            EntryKind.SKY,
            partial(np.arange, 1 << 16),
            (),
            of=NDArray[np.int64],
            folder=limit_folder,
        )

    use(tmp_path)
    mapped = use(tmp_path)
    prune(tmp_path, 0)
    assert kept(tmp_path) == set()
    np.testing.assert_array_equal(mapped, np.arange(1 << 16))


def test_all_kinds_are_counted_and_removed(tmp_path):
    files = {
        put(tmp_path, entry_name(kind, 1))
        for kind in EntryKind
        if kind.value not in ("traffic", "kernels", "definitions")
    }
    files |= {
        put(tmp_path, f"traffic/citystreet-0-{KEY}.npz"),
        put(tmp_path, f"definitions/eyas-{KEY}.eyi"),
        kernels(tmp_path, KEY[:16], age=1.0),
    }
    found = entries(tmp_path)
    assert {entry.path for entry in found} == files
    assert {entry.kind for entry in found} == set(EntryKind)
    assert {entry.size for entry in found} == {1000}
    assert clear(tmp_path, EntryKind.TRAFFIC) == 1000
    assert clear(tmp_path) == sum(entry.size for entry in found) - 1000
    assert list(tmp_path.rglob("*")) == []


def test_kernels_of_other_versions_go_after_a_month_and_by_the_limit(tmp_path, monkeypatch):
    mine = kernels(tmp_path, "0" * 16, age=90 * DAY)
    stale = kernels(tmp_path, "1" * 16, age=31 * DAY)
    recent = kernels(tmp_path, "2" * 16, age=29 * DAY)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(mine))
    prune(tmp_path, 1 << 30)
    assert kept(tmp_path) == {mine, recent}
    assert not stale.exists()
    prune(tmp_path, 0)
    assert kept(tmp_path) == {mine}


def test_parts_of_processes_that_were_killed_go_after_a_day(tmp_path):
    fresh, stale = (
        put(tmp_path, f"{kind}/.eyas-{KEY}.npy.0123456789abcdef.part", age=age)
        for kind, age in (("sky", 0.9 * DAY), ("scene", 1.1 * DAY))
    )
    prune(tmp_path, 1 << 30)
    assert fresh.exists()
    assert not stale.exists()
    clear(tmp_path, EntryKind.SCENE)
    assert fresh.exists()
    clear(tmp_path)
    assert not fresh.exists()


@pytest.mark.parametrize("name", FOREIGN)
def test_what_eyas_did_not_make_is_never_removed(tmp_path, name):
    theirs = put(tmp_path, name, age=1000 * DAY)
    ours = put(tmp_path, entry_name(EntryKind.SCENE, 1))
    assert theirs not in kept(tmp_path)
    write_entry(ours, [b"x"], 0)
    assert not ours.exists()
    clear(tmp_path)
    assert theirs.read_bytes() == b"x" * 1000


def test_folders_and_links_in_the_place_of_entries_are_left_alone(tmp_path):
    theirs = put(tmp_path / "elsewhere", "theirs")
    folder = tmp_path / entry_name(EntryKind.SCENE, 1)
    folder.mkdir(parents=True)
    link = tmp_path / "kernels" / KEY[:16]
    link.parent.mkdir()
    link.symlink_to(theirs.parent, target_is_directory=True)
    assert kept(tmp_path) == set()
    prune(tmp_path, 0)
    clear(tmp_path)
    assert folder.is_dir()
    assert link.is_symlink()
    assert theirs.exists()


def test_a_failed_write_leaves_nothing_and_removes_nothing(tmp_path):
    old = put(tmp_path, entry_name(EntryKind.SKY, 1))

    def pieces():
        yield b"begun"
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_entry(tmp_path / entry_name(EntryKind.SKY, 2), pieces(), 0)
    assert list((tmp_path / "sky").iterdir()) == [old]


def test_a_cache_that_is_not_there_is_empty(tmp_path):
    assert entries(tmp_path / "nowhere") == []
    prune(tmp_path / "nowhere", 0)
    assert clear(tmp_path / "nowhere") == 0
    assert not (tmp_path / "nowhere").exists()


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("", 2 << 30),
        ("0", 0),
        ("12345", 12345),
        ("500M", 500 << 20),
        ("1.5 GiB", 3 << 29),
        ("2gb", 2 << 30),
        ("7k", 7 << 10),
        ("1T", 1 << 40),
    ],
)
def test_the_limit_is_a_size(monkeypatch, text, size):
    monkeypatch.setenv("EYAS_CACHE_LIMIT", text)
    assert cache_limit() == size


@pytest.mark.parametrize("text", ["-1", "2 GiBs", "much", "1e9", "2G 3M", "nan", "1.2.3"])
def test_what_is_no_size_is_refused(monkeypatch, text):
    monkeypatch.setenv("EYAS_CACHE_LIMIT", text)
    with pytest.raises(ConfigError, match=rf"^EYAS_CACHE_LIMIT: '{text}' is not allowed; allowed"):
        cache_limit()


def test_a_size_of_hundreds_of_digits_is_refused(monkeypatch):
    monkeypatch.setenv("EYAS_CACHE_LIMIT", "9" * 400)
    with pytest.raises(ConfigError, match=r"^EYAS_CACHE_LIMIT: '9+ \.\.\. 9+' is not allowed"):
        cache_limit()


def test_the_cache_is_the_users_unless_it_is_moved(monkeypatch, tmp_path):
    monkeypatch.delenv("EYAS_CACHE_DIR", raising=False)
    assert cache_folder() == Path(platformdirs.user_cache_dir("eyas"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("EYAS_CACHE_DIR", "here")
    assert cache_folder() == tmp_path / "here"
