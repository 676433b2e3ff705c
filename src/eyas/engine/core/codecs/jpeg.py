"""Pictures in the JPEG format."""

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

QUALITY = 100  # The original's JPEG quality


def jpeg_bytes(
    rgb: NDArray[np.uint8],  # The picture, shape (H, W, 3)
    quality: int = QUALITY,  # 1 to 100
) -> bytes:
    """Return a picture as a JPEG file; the same picture gives the same bytes.

    Colours have the full resolution (4:4:4), because a target may be only a few pixels wide.
    """
    buffer = io.BytesIO()
    Image.fromarray(rgb).save(buffer, "JPEG", quality=quality, subsampling=0)
    return buffer.getvalue()
