"""Files that may come from anyone, read; our own, written under a temporary name and renamed;
finished ones, on the disk before a marker says so, and known by their checksums afterwards.
"""

import hashlib
import os
import stat
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from eyas.engine.core.errors import DataFileError, OutputError
from eyas.lanes.trusted import open_at_once

PART_SUFFIX = ".part"
"""Ending of a file that is still being written; such a file may be deleted at any time."""


_NEW = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0)


def part_path(path: Path) -> Path:
    """Return the hidden temporary path, beside `path`, under which the file is written."""
    return path.with_name(f".{path.name}{PART_SUFFIX}")


@contextmanager
def refusals(path: Path) -> Iterator[None]:
    """Turn errors of the file system inside the block into one line about `path`.

    Raises:
        OutputError: The file system refused (full disk, no permission, a folder in the way).
    """
    try:
        yield
    except OSError as error:
        raise OutputError(f"{path}: cannot write: {error.strerror or error}") from error


@contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`; rename it to `path` if the block succeeds.

    Raises:
        OutputError: The file system refused (full disk, no permission, a folder in the way).
    """
    part = part_path(path)
    with refusals(path):
        try:
            yield part
            os.replace(part, path)
        except BaseException:
            part.unlink(missing_ok=True)
            raise


def write_atomic(path: Path, data: bytes) -> None:
    """Write a file completely or not at all.

    Raises:
        OutputError: The file cannot be written.
    """
    with atomic_path(path) as part:
        # Without Python's file objects: half of the time, of which `eyas serve` has 12 in a round.
        file = os.open(part, _NEW, 0o666)
        try:
            left = memoryview(data)
            while left:
                left = left[os.write(file, left) :]
        finally:
            os.close(file)


def user_path(text: str) -> Path:
    """Return the path that a user has written, with `~` as in a shell.

    Raises:
        DataFileError: There is no such user.
    """
    try:
        return Path(text).expanduser()
    except RuntimeError as error:
        raise DataFileError(f"{text}: cannot read: {error}") from error


def read_limited(
    path: Path,  # The file
    largest: int,  # Largest allowed size [bytes]
) -> bytes:
    """Return the content of a file.

    Raises:
        DataFileError: The file is missing or unreadable, too large, or no ordinary file: a device
            or a pipe would be read for ever.
    """
    try:
        with open(path, "rb", opener=open_at_once) as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise DataFileError(f"{path}: cannot read: not an ordinary file")
            content = file.read(largest + 1)
    except OSError as error:
        raise DataFileError(f"{path}: cannot read: {error.strerror or error}") from error
    except ValueError as error:  # a character that no path can have
        raise DataFileError(f"{path}: cannot read: {error}") from error
    if len(content) > largest:
        raise DataFileError(f"{path}: cannot read: larger than {largest >> 20} MiB")
    refuse_pointer(path, content)
    return content


def refuse_pointer(path: Path, content: bytes | None = None) -> None:
    """Refuse what stands for a file where Git LFS has not fetched it.

    Args:
        content: Of the file, as far as it is known; None: it is read if it can be.

    Raises:
        DataFileError: It is such a pointer.
    """
    if content is None:
        try:
            with open(path, "rb", opener=open_at_once) as file:
                content = file.read(len(_POINTER))
        except (OSError, ValueError):  # who reads all of it says why
            return
    if content.startswith(_POINTER):
        raise DataFileError(
            f"{path}: a pointer of Git LFS in the place of the file; get it with git lfs pull"
        )


_POINTER = b"version https://git-lfs.github.com/spec/"


def sum_of(path: Path) -> str:
    """Return the SHA-256 of a file.

    Raises:
        DataFileError: It cannot be read.
    """
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise DataFileError(f"{path}: cannot read: {error.strerror or error}") from error


def flushed(paths: Iterable[Path]) -> None:
    """Return when files and their folders are on the disk: a power cut leaves them whole.

    Raises:
        OutputError: The disk has not taken them.
    """
    folders = set()
    for path in paths:
        _flush(path)
        folders.add(path.parent)
    if os.name == "posix":  # elsewhere folders cannot be opened
        for folder in sorted(folders):
            _flush(folder)


def _flush(path: Path) -> None:
    with refusals(path):
        file = os.open(path, os.O_RDONLY if os.name == "posix" else os.O_RDWR)
        try:
            os.fsync(file)
        finally:
            os.close(file)


def require_sum(path: Path, sums: Mapping[str, str]) -> None:
    """Refuse a file that is not as it was written; one whose name has no checksum is not looked at.

    Raises:
        DataFileError: Its SHA-256 is another, or it cannot be read.
    """
    expected = sums.get(path.name)
    if expected is not None and sum_of(path) != expected:
        raise DataFileError(f"{path}: damaged: its SHA-256 is not the one noted when it was made")
