"""A frame: the picture and the state beside it, as bytes for the pages."""

import io
import json
import struct
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

__all__ = ["Frame", "packed"]

QUALITY = 82
"""Of JPEG: 640 x 360 pixels take about 45 kB."""


class Frame(NamedTuple):
    """A frame to send."""

    number: int
    """From 1."""
    data: bytes
    """Length of the state [bytes] as a little-endian number of 4 bytes, the state as JSON, and the
    picture as JPEG."""


def packed(number: int, state: dict[str, Any], rgb: NDArray[np.uint8]) -> Frame:
    """Return a frame of a picture, shape (H, W, 3)."""
    picture = io.BytesIO()
    Image.fromarray(rgb).save(picture, "JPEG", quality=QUALITY)
    text = json.dumps(state, separators=(",", ":")).encode()
    return Frame(number, struct.pack("<I", len(text)) + text + picture.getvalue())
