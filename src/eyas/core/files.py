"""Atomic writing of files: written under a temporary name, then renamed."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from eyas.core.errors import OutputError

__all__ = ["PART_SUFFIX", "atomic_path", "part_path", "refusals", "write_atomic"]

PART_SUFFIX = ".part"
"""Ending of a file that is still being written; such a file may be deleted at any time."""


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
        part.write_bytes(data)
