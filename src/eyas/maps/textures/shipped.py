"""The textures as they ship: what `art/textures` paints, packed by `python -m art.ship`.

A zip file with a lossless WebP picture of each, which any viewer opens. To unpack them takes a
twentieth of the time of painting, and the engine needs no painter.
"""

import zipfile
from hashlib import sha256
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import DataFileError
from eyas.engine.render.textures.fields import SIZE
from eyas.engine.world.build.materials import TEXTURES

FILE = Path(__file__).with_name("textures.zip")

SHA256 = "c82a760417226e01bfba7296bf4f52b0fbdfe4e798f85896c09e0e28ecf3ec32"
"""Of the unpacked bytes: it stands for them in the keys of what is made of textures."""


def build_textures() -> dict[str, NDArray[np.uint8]]:
    """Return every texture of `eyas.engine.world.build.materials.TEXTURES`, by name.

    Each is sRGB and alpha, shape (256, 256, 4), and repeats without a seam. Row 0 of an array is
    the **top** of the tile, v = 1: code that samples with v upwards flips the rows. Alpha is 255
    except for the holes of `leaves`, the glass of facades, people and `cloth`, where it is 0.

    Raises:
        DataFileError: The installation is damaged.
    """
    from PIL import Image  # not needed once scenes are in the cache, and slow to import

    # Order of the layers: that of the table of materials.
    layers = np.zeros((len(TEXTURES), SIZE, SIZE, 4), np.uint8)
    try:
        with zipfile.ZipFile(FILE) as packed:
            for layer, name in zip(layers, TEXTURES, strict=True):
                with packed.open(f"{name}.webp") as file, Image.open(file) as picture:
                    layer[:] = picture.convert("RGBA") if picture.size == (SIZE, SIZE) else 0
    except (OSError, KeyError, ValueError, SyntaxError, zipfile.BadZipFile) as error:
        raise DataFileError(f"{FILE}: cannot read: {error}; install Eyas again") from None
    if sha256(layers.tobytes()).hexdigest() != SHA256:
        raise DataFileError(f"{FILE}: damaged; install Eyas again")
    return dict(zip(TEXTURES, layers, strict=True))
