"""Files that may come from anyone, and our own: limits, whole or not there, checksums."""

import os
from contextlib import suppress

import pytest

from eyas.engine.core.errors import DataFileError, OutputError
from eyas.engine.core.files import (
    atomic_path,
    flushed,
    read_limited,
    require_sum,
    sum_of,
    user_path,
    write_atomic,
)


def test_a_file_of_the_largest_size_is_read_and_a_larger_one_refused(tmp_path):
    file = tmp_path / "data"
    file.write_bytes(b"x" * (1 << 20))
    assert len(read_limited(file, 1 << 20)) == 1 << 20
    file.write_bytes(b"x" * ((1 << 20) + 1))
    with pytest.raises(DataFileError, match=r"data: cannot read: larger than 1 MiB$"):
        read_limited(file, 1 << 20)


def test_what_is_no_ordinary_file_is_refused_in_one_line(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(DataFileError, match="pipe: cannot read: not an ordinary file"):
        read_limited(tmp_path / "pipe", 1)
    with pytest.raises(DataFileError, match="absent: cannot read: No such file"):
        read_limited(tmp_path / "absent", 1)
    with pytest.raises(DataFileError, match="cannot read: embedded null"):
        read_limited(tmp_path / "a\0b", 1)


def test_a_file_is_written_whole_or_not_at_all(tmp_path):
    file = tmp_path / "data"
    write_atomic(file, b"first")
    with suppress(RuntimeError), atomic_path(file) as part:
        part.write_bytes(b"sec")
        raise RuntimeError
    assert (file.read_bytes(), [*tmp_path.iterdir()]) == (b"first", [file])
    with pytest.raises(OutputError, match="cannot write: No such file"):
        write_atomic(tmp_path / "absent" / "data", b"")


def test_a_file_is_known_by_its_checksum(tmp_path):
    file = tmp_path / "data"
    write_atomic(file, b"abc")
    flushed([file])
    known = {"data": sum_of(file)}
    assert known["data"].startswith("ba7816bf")  # SHA-256 of "abc" (FIPS 180-4)
    require_sum(file, known)
    require_sum(tmp_path / "other", known)
    write_atomic(file, b"abd")
    with pytest.raises(DataFileError, match="damaged: its SHA-256 is not the one noted"):
        require_sum(file, known)


def test_paths_are_as_in_a_shell(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    assert user_path("~/runs") == tmp_path / "runs"
    with pytest.raises(DataFileError, match="cannot read: Could not determine home"):
        user_path("~nobody-of-this-name/runs")
