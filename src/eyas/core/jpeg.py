"""Pictures in the JPEG format."""

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

__all__ = ["QUALITY", "jpeg_bytes"]

QUALITY = 100
"""The original's JPEG quality. Colours have the full resolution too (4:4:4), because a target may
be only a few pixels wide. A picture of 320 x 240 takes about 90 kB (36 kB at quality 95)."""


def jpeg_bytes(rgb: NDArray[np.uint8]) -> bytes:
    """Return a picture as a JPEG file; the same picture gives the same bytes.

    Args:
        rgb: The picture, shape (H, W, 3).
    """
    buffer = io.BytesIO()
    Image.fromarray(rgb).save(buffer, "JPEG", quality=QUALITY, subsampling=0)
    return buffer.getvalue()
