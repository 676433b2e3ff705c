"""`checksums.sha256` of a recording, as `sha256sum` writes and checks it."""

import re
from collections.abc import Mapping
from pathlib import Path

from eyas.core.files import read_limited

__all__ = ["CHECKSUMS", "GROWING", "checksum_lines", "read_checksums"]

CHECKSUMS, GROWING = "checksums.sha256", ".checksums"
"""Names of the file, and of the one that grows during a recording, in the recording's folder."""

_LARGEST = 1 << 30

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
