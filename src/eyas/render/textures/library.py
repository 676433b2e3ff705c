"""All textures, painted by formula: no picture has to be shipped or licensed."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from eyas.render.textures import facades as texture_facades
from eyas.render.textures import ground as texture_ground
from eyas.render.textures import land as texture_land
from eyas.render.textures import plants as texture_plants
from eyas.render.textures import roofs as texture_roofs
from eyas.render.textures import shops as texture_shops
from eyas.render.textures import walls as texture_walls
from eyas.render.textures import wear as texture_wear
from eyas.world.build.materials import TEXTURES

__all__ = ["build_textures"]

_ROOMS = (
    texture_ground,
    texture_land,
    texture_wear,
    texture_plants,
    texture_roofs,
    texture_walls,
    texture_facades,
    texture_shops,
)


def build_textures() -> dict[str, NDArray[np.uint8]]:
    """Return every texture of `eyas.world.build.materials.TEXTURES`, always the same bytes.

    Each is sRGB and alpha, shape (256, 256, 4), and repeats without a seam. Row 0 of an array is
    the **top** of the tile, v = 1: who samples with v upwards flips the rows. Alpha is 255 but for
    the holes of `leaves` and the glass of facades, where it is 0.
    """
    return {name: _painter(name)() for name in TEXTURES}


def _painter(name: str) -> Callable[[], NDArray[np.uint8]]:
    """Return the function that is called as the texture is."""
    if name == "plain":
        return _plain
    painters = [getattr(room, name) for room in _ROOMS if hasattr(room, name)]
    painter: Callable[[], NDArray[np.uint8]] = painters[0]
    return painter


def _plain() -> NDArray[np.uint8]:
    return np.full((256, 256, 4), 255, np.uint8)
