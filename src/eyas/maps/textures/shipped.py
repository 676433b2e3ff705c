"""The textures as they ship: what `art/textures` paints, packed by `python -m art.ship`.

To unpack them takes a seventh of the time of painting, and the engine needs no painter.
"""

import lzma
from hashlib import sha256
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import DataFileError
from eyas.engine.render.textures.fields import SIZE
from eyas.engine.world.build.materials import TEXTURES

FILE = Path(__file__).with_name("textures.xz")

SHA256 = "9192d095eaf274d90b0dc29c98b8fe22d706d0f9e968953f67366da04293b7ab"
"""Of the unpacked bytes: it stands for them in the keys of what is made of textures."""


def build_textures() -> dict[str, NDArray[np.uint8]]:
    """Return every texture of `eyas.engine.world.build.materials.TEXTURES`, by name.

    Each is sRGB and alpha, shape (256, 256, 4), and repeats without a seam. Row 0 of an array is
    the **top** of the tile, v = 1: code that samples with v upwards flips the rows. Alpha is 255
    except for the holes of `leaves`, the glass of facades, people and `cloth`, where it is 0.

    Raises:
        DataFileError: The installation is damaged.
    """
    count = len(TEXTURES) * SIZE * SIZE * 4
    try:
        content = lzma.LZMADecompressor().decompress(FILE.read_bytes(), count)
    except (OSError, lzma.LZMAError, EOFError) as error:
        raise DataFileError(f"{FILE}: cannot read: {error}; install Eyas again") from None
    if sha256(content).hexdigest() != SHA256:
        raise DataFileError(f"{FILE}: damaged; install Eyas again")
    # Order of the layers: that of the table of materials.
    layers = np.frombuffer(content, np.uint8).reshape(len(TEXTURES), SIZE, SIZE, 4)
    return dict(zip(TEXTURES, layers, strict=True))
