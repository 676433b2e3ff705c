"""Pictures as JPEG files."""

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from eyas.core.files import write_atomic

__all__ = ["QUALITY", "frame_name", "write_frame"]

QUALITY = 100
"""The original's JPEG quality. Colours keep the full resolution too (4:4:4), because a target may
be only a few pixels wide. A picture of 320 x 240 takes about 90 kB (36 kB at quality 95)."""


def frame_name(frame: int) -> str:
    """Return the key of a frame in `mark.json` and the stem of its file: six digits from 000000."""
    return f"{frame:06d}"


def write_frame(path: Path, rgb: NDArray[np.uint8]) -> None:
    """Write one picture, whole or not at all; the same picture gives the same bytes.

    Args:
        path: Where to.
        rgb: The picture, shape (H, W, 3).

    Raises:
        OutputError: The file system refused.
    """
    buffer = io.BytesIO()
    Image.fromarray(rgb).save(buffer, "JPEG", quality=QUALITY, subsampling=0)
    write_atomic(path, buffer.getvalue())
