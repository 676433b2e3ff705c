"""Finished files: on the disk before a marker says so, and known by their checksums afterwards."""

import hashlib
import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import refusals

__all__ = ["flushed", "require_sum", "sum_of"]


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
