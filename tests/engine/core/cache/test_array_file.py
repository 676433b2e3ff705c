"""Files of arrays: mapped, shared, and read only if not a bit is wrong."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.core.cache.array_file import Content, array_file, let_go, map_arrays
from eyas.lanes.machine_code import read_code

ARRAYS = [
    np.arange(12, dtype=np.float32).reshape(3, 4),
    np.zeros((0, 2), np.int64),
    np.array([[True], [False]]),
    np.array(7, np.uint16),
    np.random.default_rng(0).normal(size=(5, 2, 3)),
]
CONTENT = Content({"name": "town", "size": [1, 2.5, None]}, ARRAYS)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "arrays.npy"
    path.write_bytes(b"".join(array_file(CONTENT, path.name)))
    return path


def test_what_was_written_is_read_as_numba_wants_it(file):
    flat, arrays = map_arrays(file)
    assert flat == CONTENT.flat
    for read, written in zip(arrays, ARRAYS, strict=True):
        assert type(read) is np.ndarray
        assert (read.dtype, read.shape) == (written.dtype, written.shape)
        np.testing.assert_array_equal(read, written)
        assert read.flags.writeable
        assert read.flags.aligned
        assert read.flags.c_contiguous
        assert read.ctypes.data % 64 == 0


def test_what_is_written_into_an_array_stays_in_the_process(file):
    before = file.read_bytes()
    _, (first, *_) = map_arrays(file)
    first[:] = -1.0
    assert file.read_bytes() == before
    np.testing.assert_array_equal(map_arrays(file).arrays[0], ARRAYS[0])


def test_arrays_stay_readable_after_their_file_is_removed(file):
    _, arrays = map_arrays(file)
    file.unlink()
    for read, written in zip(arrays, ARRAYS, strict=True):
        np.testing.assert_array_equal(read, written)


def test_every_flipped_byte_and_every_cut_is_noticed(file):
    good = file.read_bytes()
    for place in range(len(good)):
        damaged = bytearray(good)
        damaged[place] ^= 0x10
        file.write_bytes(damaged)
        with pytest.raises(ValueError, match=r"damaged|cut off"):
            map_arrays(file)
    for length in range(len(good)):
        file.write_bytes(good[:length])
        with pytest.raises(ValueError, match=r"damaged|cut off|empty|unpack"):
            map_arrays(file)
    file.write_bytes(good + b"\0")
    with pytest.raises(ValueError, match=r"damaged|cut off"):
        map_arrays(file)


def test_a_file_in_the_place_of_another_is_noticed(file):
    other = file.rename(file.with_name("others.npy"))
    with pytest.raises(ValueError, match="in the place of another entry"):
        map_arrays(other)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes with names here")
@pytest.mark.parametrize("reader", [map_arrays, read_code])
def test_a_pipe_in_the_place_of_a_file_does_not_hang(tmp_path, reader):
    os.mkfifo(tmp_path / "pipe")
    if reader is read_code:
        assert read_code(tmp_path / "pipe") is None
    else:
        with pytest.raises(ValueError, match="no ordinary file"):
            map_arrays(tmp_path / "pipe")


SHARES = """
import sys
from pathlib import Path
from eyas.engine.core.cache.array_file import map_arrays
array = map_arrays(Path(sys.argv[1])).arrays[0]
assert array.sum() > 0
if sys.argv[2] == "write":
    array[0] = 0
print(*(int(line.split()[1])
    for part in Path("/proc/self/smaps").read_text().split("VmFlags")
    if sys.argv[1] in part
    for line in part.splitlines() if line.startswith(("Private_Dirty", "Anonymous"))))
"""


@pytest.mark.skipif(not Path("/proc/self/smaps").exists(), reason="Linux tells what is shared")
def test_processes_share_the_memory_of_what_they_only_read(tmp_path):
    path = tmp_path / "large.npy"
    with path.open("wb") as written:
        written.writelines(array_file(Content(None, [np.ones(1 << 20)]), path.name))
        os.fsync(written.fileno())  # what is not yet on the disk counts as changed

    def own(action):
        command = [sys.executable, "-c", SHARES, str(path), action]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()

    assert own("read") == ["0", "0"]
    assert set(own("write")) == {"4"}  # one page of 8 MiB, in KiB


def resident(path):
    """Return how much of a mapped file this process holds [KiB], from Linux's list."""
    inside = False
    for line in Path("/proc/self/smaps").read_text().splitlines():
        inside = str(path) in line if "-" in line.split()[0] else inside
        if inside and line.startswith("Rss:"):
            return int(line.split()[1])
    raise AssertionError(f"{path} is not mapped")


@pytest.mark.skipif(not Path("/proc/self/smaps").exists(), reason="Linux tells what is held")
def test_a_process_holds_what_it_uses_of_a_file(tmp_path):
    path = tmp_path / "a.npy"
    values = np.arange(1 << 22, dtype=np.float32)  # 16 MiB
    path.write_bytes(b"".join(array_file(Content(None, [values]), path.name)))
    (mapped,) = map_arrays(path).arrays
    assert mapped[1 << 20] == 1 << 20
    assert resident(path) <= 4096  # of a file just written, Linux may map 2 MiB at once


def test_pages_that_were_let_go_come_back(tmp_path):
    values = np.arange(1 << 20, dtype=np.float32)
    path = tmp_path / "a.npy"
    path.write_bytes(b"".join(array_file(Content(None, [values]), path.name)))
    (mapped,) = map_arrays(path).arrays
    let_go(mapped)
    let_go(mapped.view(np.int32)[::2])  # of any part of it
    np.testing.assert_array_equal(mapped, values)
    let_go(np.zeros(3))  # not mapped: nothing to do
