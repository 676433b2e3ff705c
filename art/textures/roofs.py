"""Textures of roofs: terracotta tiles on slopes; slabs, bitumen, gravel, membranes on flat ones."""

import numpy as np
from numpy.typing import NDArray

from art.textures.fields import masonry, mixed, opaque, painted
from eyas.engine.render.textures.fields import fractal, source, white
from eyas.lanes import exact

Texture = NDArray[np.uint8]


def roof_tiles() -> Texture:
    """Return rows of curved terracotta tiles of a quarter metre, seen up the slope."""
    rng = source("roof_tiles")
    tiles = masonry(rng, 16, 16, joint=0.0, bond=0.0)
    curve = exact.cos((tiles.across - 0.42) * 2 * np.pi)
    light = 0.16 * curve - 0.38 * (tiles.down > 0.86) + 0.1 * (tiles.down < 0.14)
    grain = 0.03 * white(rng) + 0.035 * fractal(rng, 0.9, longest=60.0)
    picture = painted((188.0, 106.0, 76.0), light + grain + 0.075 * tiles.shade)
    warm = masonry(rng, 16, 16, joint=0.0, bond=0.0).shade
    picture += warm[..., None] * np.array([3.0, 5.0, 4.0])
    moss = np.clip((fractal(rng, 1.1, longest=60.0) - 1.1) * 0.9, 0, 1)
    return opaque(mixed(picture, (112.0, 84.0, 62.0), 0.4 * moss))


def roof_terrace() -> Texture:
    """Return the slabs of a flat roof: bright terracotta of half a metre, weathered."""
    rng = source("roof_terrace")
    slabs = masonry(rng, 16, 16, joint=0.9, bond=0.0)
    grain = 0.03 * white(rng) + 0.035 * fractal(rng, 0.8, longest=70.0)
    picture = painted((188.0, 110.0, 80.0), grain + 0.05 * slabs.shade)
    warm = masonry(rng, 16, 16, joint=0.0, bond=0.0).shade
    picture += warm[..., None] * np.array([3.0, 5.0, 5.0])
    soot = np.clip(0.6 * fractal(rng, 1.4, longest=130.0) - 0.15, 0, 1)
    picture = mixed(picture, painted((134.0, 86.0, 66.0), grain), 0.6 * soot)
    lime = np.clip((fractal(rng, 1.1, longest=90.0) - 0.9) * 0.8, 0, 1)
    picture = mixed(picture, (206.0, 156.0, 130.0), 0.4 * lime)
    return opaque(mixed(picture, (128.0, 84.0, 65.0), 0.65 * slabs.joint))


def roof_gravel() -> Texture:
    """Return pale gravel on felt, thin in some spots, with moss in others."""
    rng = source("roof_gravel")
    stones = 0.13 * white(rng) + 0.05 * fractal(rng, 0.8, longest=40.0)
    picture = painted((164.0, 158.0, 147.0), stones)
    thin = np.clip((fractal(rng, 1.5, longest=120.0) - 0.9) * 0.9, 0, 1)
    picture = mixed(picture, painted((112.0, 109.0, 104.0), 0.5 * stones), 0.6 * thin)
    moss = np.clip((fractal(rng, 1.3, longest=90.0) - 1.2) * 0.9, 0, 1)
    return opaque(mixed(picture, painted((112.0, 118.0, 82.0), stones), 0.5 * moss))


def roof_membrane() -> Texture:
    """Return a pale plastic membrane in sheets of two metres, dirty where water collects."""
    rng = source("roof_membrane")
    sheets = masonry(rng, 2, 4, joint=0.0, bond=0.0)
    dirt = fractal(rng, 1.4, longest=110.0)
    picture = painted(
        (205.0, 204.0, 199.0), 0.012 * white(rng) + 0.02 * dirt + 0.012 * sheets.shade
    )
    picture = mixed(picture, (150.0, 147.0, 138.0), 0.45 * np.clip(0.7 * dirt - 0.3, 0, 1))
    seam = (sheets.across < 0.02) | (sheets.down < 0.012)
    picture = mixed(picture, (160.0, 159.0, 155.0), 0.7 * seam)
    scuff = np.clip((fractal(rng, 0.9, longest=50.0) - 1.5) * 1.2, 0, 1)
    return opaque(mixed(picture, (128.0, 126.0, 120.0), 0.4 * scuff))


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
