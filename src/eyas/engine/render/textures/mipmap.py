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


_LINEAR = linear(np.arange(256) / 255.0)  # Linear value of each byte of sRGB


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
    texels = image[::-1].astype(np.float64) / 255.0  # v grows upwards, rows grow downwards
    texels[..., :3] = _LINEAR[image[::-1, :, :3]]
    shifts = np.array([0, 8, 16, 24], np.uint32)
    sheet = np.zeros((TEXELS // TEXELS_IN_ROW, TEXELS_IN_ROW), np.uint32)
    top, left = 0, 0
    for level in range(LEVELS):
        if level > 0:
            texels = (texels[::2] + texels[1::2]) / 2
            texels = (texels[:, ::2] + texels[:, 1::2]) / 2
        encoded = np.concatenate([np.sqrt(texels[..., :3]), texels[..., 3:]], axis=-1)
        packed = np.bitwise_or.reduce(np.round(encoded * 255.0).astype(np.uint32) << shifts, axis=2)
        repeated = np.pad(packed, (0, 1), mode="wrap")
        size = len(repeated)
        sheet[top : top + size, left : left + size] = repeated
        top, left = SIDE + 1, left + size if level > 0 else 0
    return sheet.reshape(-1)
