"""A frame: the picture, and the state beside it."""

import io
import json
import struct
import threading
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

__all__ = ["Frame", "packed"]

QUALITY = 82
"""Of JPEG: 640 x 360 pixels take about 45 kB."""


class Frame:
    """A frame to send; each viewer gets the picture as it can take it.

    Attributes:
        number: From 1.
        state: What is told beside the picture, as a JSON object.
        rgb: The picture, shape (H, W, 3).

    Args:
        number: As above.
        state: As above, with at least one entry.
        rgb: As above; it is copied.
    """

    def __init__(self, number: int, state: dict[str, Any], rgb: NDArray[np.uint8]) -> None:
        self.number, self.rgb = number, rgb.copy()
        self.state = json.dumps(state, separators=(",", ":")).encode()
        self._jpeg: bytes | None = None
        self._coding = threading.Lock()

    def jpeg(self) -> bytes:
        """Return the picture as JPEG; it is coded once for all viewers."""
        with self._coding:
            if self._jpeg is None:
                picture = io.BytesIO()
                Image.fromarray(self.rgb).save(picture, "JPEG", quality=QUALITY)
                self._jpeg = picture.getvalue()
            return self._jpeg


def packed(frame: Frame, kind: str, picture: bytes) -> bytes:
    """Return what is sent: the state's length, the state as JSON, the picture.

    The length has 4 bytes, little-endian.

    Args:
        frame: The frame.
        kind: What the picture is, see `Viewer.coded`.
        picture: Its bytes.
    """
    text = frame.state[:-1] + f',"picture":"{kind}"}}'.encode()
    return struct.pack("<I", len(text)) + text + picture
