"""Textures of roofs: terracotta tiles on slopes, terracotta slabs and bitumen on flat ones."""

import numpy as np
from numpy.typing import NDArray

from eyas.render.texture_fields import fractal, masonry, mixed, opaque, painted, source, white

__all__ = ["bitumen", "roof_terrace", "roof_tiles"]

Texture = NDArray[np.uint8]


def roof_tiles() -> Texture:
    """Return rows of curved terracotta tiles of a quarter metre, seen up the slope."""
    rng = source("roof_tiles")
    tiles = masonry(rng, 16, 16, joint=0.0, bond=0.0)
    curve = np.cos((tiles.across - 0.42) * 2 * np.pi)
    light = 0.16 * curve - 0.38 * (tiles.down > 0.86) + 0.1 * (tiles.down < 0.14)
    grain = 0.03 * white(rng) + 0.035 * fractal(rng, 0.9, longest=60.0)
    picture = painted((206.0, 101.0, 60.0), light + grain + 0.075 * tiles.shade)
    warm = masonry(rng, 16, 16, joint=0.0, bond=0.0).shade
    picture += warm[..., None] * np.array([3.0, 5.0, 4.0])
    moss = np.clip((fractal(rng, 1.1, longest=60.0) - 1.1) * 0.9, 0, 1)
    return opaque(mixed(picture, (112.0, 84.0, 62.0), 0.4 * moss))


def roof_terrace() -> Texture:
    """Return the slabs of a flat roof: bright terracotta of half a metre, weathered."""
    rng = source("roof_terrace")
    slabs = masonry(rng, 8, 8, joint=1.3, bond=0.0)
    grain = 0.03 * white(rng) + 0.035 * fractal(rng, 0.8, longest=70.0)
    picture = painted((203.0, 106.0, 67.0), grain + 0.04 * slabs.shade)
    warm = masonry(rng, 8, 8, joint=0.0, bond=0.0).shade
    picture += warm[..., None] * np.array([3.0, 5.0, 5.0])
    soot = np.clip(0.6 * fractal(rng, 1.3, longest=120.0) - 0.2, 0, 1)
    picture = mixed(picture, painted((150.0, 84.0, 60.0), grain), 0.5 * soot)
    lime = np.clip((fractal(rng, 1.0, longest=80.0) - 1.2) * 0.8, 0, 1)
    picture = mixed(picture, (222.0, 160.0, 128.0), 0.4 * lime)
    return opaque(mixed(picture, (138.0, 84.0, 62.0), 0.8 * slabs.joint))


def bitumen() -> Texture:
    """Return grey roofing felt in sheets of one metre, with seams and the marks of puddles."""
    rng = source("bitumen")
    sheets = masonry(rng, 2, 8, joint=0.0)
    grit = 0.06 * white(rng) + 0.03 * fractal(rng, 0.7, longest=40.0)
    picture = painted((112.0, 112.0, 112.0), grit + 0.02 * sheets.shade)
    seam = (sheets.across < 0.07) | (sheets.down < 0.014)
    picture = mixed(picture, (78.0, 78.0, 80.0), 0.55 * seam)
    picture = mixed(
        picture, (146.0, 146.0, 144.0), 0.3 * ((sheets.across > 0.07) & (sheets.across < 0.11))
    )
    puddle = fractal(rng, 1.9, longest=130.0)
    ring = np.clip(1 - np.abs(puddle - 1.0) * 7, 0, 1)
    picture = mixed(picture, (84.0, 83.0, 80.0), 0.2 * np.clip((puddle - 1.0) * 2, 0, 1))
    return opaque(mixed(picture, (152.0, 149.0, 140.0), 0.3 * ring))
