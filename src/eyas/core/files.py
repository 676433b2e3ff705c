"""Files that are whole or not there: written under a temporary name, then renamed."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from eyas.core.errors import OutputError

__all__ = ["PART_SUFFIX", "atomic_path", "part_path", "refusals", "write_atomic"]

PART_SUFFIX = ".part"
"""Ending of a file that is still being written; such a file may be deleted at any time."""


def part_path(path: Path) -> Path:
    """Return the hidden name beside `path` under which it is written until it is whole."""
    return path.with_name(f".{path.name}{PART_SUFFIX}")


@contextmanager
def refusals(path: Path) -> Iterator[None]:
    """Turn what the file system refuses inside the block into one line about `path`.

    Raises:
        OutputError: The file system refused (full disk, no permission, a folder in the way).
    """
    try:
        yield
    except OSError as error:
        raise OutputError(f"{path}: cannot write: {error.strerror or error}") from error


@contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`; rename it to `path` when the block ends well.

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
    """Write a whole file, or nothing.

    Raises:
        OutputError: The file system refused.
    """
    with atomic_path(path) as part:
        part.write_bytes(data)
