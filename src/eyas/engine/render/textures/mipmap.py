"""Textures as the kernels read them: linear light, mip levels, four bytes per texel."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import UnknownNameError
from eyas.engine.render.kernels.surface.texture import LEVELS, TEXELS, TEXELS_IN_ROW
from eyas.lanes import exact

SIDE = 256  # Texels along a side of a texture


def linear(values: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return linear values of sRGB values 0 to 1 (IEC 61966-2-1)."""
    values = np.asarray(values, np.float64)
    return np.where(values <= 0.04045, values / 12.92, exact.power((values + 0.055) / 1.055, 2.4))


def _kept(light: NDArray[np.float64]) -> NDArray[np.uint8]:
    return np.round(np.sqrt(light) * 255.0).astype(np.uint8)


_LINEAR = linear(np.arange(256) / 255.0)  # Linear value of each byte of sRGB
_KEPT = _kept(_LINEAR)  # What is kept of it


def packed_layers(
    # sRGB and alpha by name, row 0 on top, shape (256, 256, 4) each
    textures: Mapping[str, NDArray[np.uint8]],
    names: Sequence[str],  # Names of the textures, one for each layer
) -> NDArray[np.uint32]:
    """Return the named textures with their mip levels, see `Geometry.texture`.

    Colours are stored as square roots of linear light: eight bits then suffice in the dark, and
    one multiplication restores the light.

    Raises:
        UnknownNameError: There is no texture of that name.
    """
    layers = []
    for name in names:
        if name not in textures:
            raise UnknownNameError("texture", name, textures)
        layers.append(_packed(textures[name]))
    return np.stack(layers)


def _packed(image: NDArray[np.uint8]) -> NDArray[np.uint32]:
    image = image[::-1]  # v grows upwards, rows grow downwards
    texels, level = _LINEAR.take(image), _KEPT.take(image)
    texels[..., 3], level[..., 3] = image[..., 3] / 255.0, image[..., 3]
    sheet = np.zeros((TEXELS // TEXELS_IN_ROW, TEXELS_IN_ROW), np.uint32)
    top, left = 0, 0
    for number in range(LEVELS):
        if number > 0:
            texels = texels[::2] + texels[1::2]
            texels = (texels[:, ::2] + texels[:, 1::2]) * 0.25
            level = np.empty(texels.shape, np.uint8)
            level[..., :3], level[..., 3] = _kept(texels[..., :3]), np.round(texels[..., 3] * 255.0)
        packed = level.view("<u4")[..., 0]
        repeated = np.arange(len(packed) + 1) % len(packed)
        size = len(repeated)
        sheet[top : top + size, left : left + size] = packed[repeated][:, repeated]
        top, left = SIDE + 1, left + size if number > 0 else 0
    return sheet.reshape(-1)
