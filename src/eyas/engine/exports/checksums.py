"""`checksums.sha256` of a finished folder, as `sha256sum` writes and checks it."""

import re
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import flushed, read_limited, refusals, sum_of, write_atomic

SEALED = "contents"
"""Key of the SHA-256 of the checksums, in the file that says that a folder is complete."""

CHECKSUMS, GROWING = "checksums.sha256", ".checksums"
"""Names of the file, and of the one that grows during a recording, in the recording's folder."""

_LARGEST = 1 << 30  # Largest file of checksums: ten million files [bytes]
_LINE = re.compile(r"([0-9a-f]{64})  (.+/.+)")


def read_checksums(path: Path) -> dict[str, str]:
    """Return the checksum of each file, without a line that a kill has cut off.

    Raises:
        DataFileError: The file cannot be read.
    """
    text = read_limited(path, _LARGEST).decode(errors="replace")
    found = (_LINE.fullmatch(line) for line in text.split("\n")[:-1])
    return {line[2]: line[1] for line in found if line}


def checksum_lines(sums: Mapping[str, str]) -> bytes:
    """Return the content of the file, in the order of the names."""
    return "".join(f"{digest}  {name}\n" for name, digest in sorted(sums.items())).encode()


def seal_folder(
    folder: Path,  # The folder
    aside: Collection[str],  # Names of files and folders in it that are left out
) -> str:
    """Write the checksums of all files of a folder, which are then on the disk; return the SHA-256
    of that file.

    Raises:
        OutputError: The disk has not taken them.
        DataFileError: A file cannot be read.
    """
    with refusals(folder):
        paths = sorted(_files_in(folder, {*aside, CHECKSUMS}))
    sums = {f"./{path.relative_to(folder).as_posix()}": sum_of(path) for path in paths}
    write_atomic(folder / CHECKSUMS, checksum_lines(sums))
    # Others have the same content elsewhere, in the recording that they are a link to.
    flushed([*(path for path in paths if path.stat().st_nlink == 1), folder / CHECKSUMS])
    return sum_of(folder / CHECKSUMS)


def damaged_files(folder: Path, sealed: object) -> Iterator[Path]:
    """Yield the files that are missing or not as they were when the folder was finished.

    Args:
        folder: The folder.
        sealed: The SHA-256 of its checksums, from `seal_folder`; anything else: it is not known.
    """
    try:
        sums = read_checksums(folder / CHECKSUMS)
        whole = sum_of(folder / CHECKSUMS) == sealed
    except DataFileError:
        whole = False
    if not whole:
        yield folder / CHECKSUMS
        return
    for name, digest in sums.items():
        try:
            whole = sum_of(folder / name) == digest
        except DataFileError:
            whole = False
        if not whole:
            yield folder / name


def _files_in(folder: Path, aside: Collection[str]) -> Iterator[Path]:
    for inside in folder.iterdir():
        if inside.name in aside:
            continue
        if inside.is_dir():
            yield from _files_in(inside, ())
        else:
            yield inside
