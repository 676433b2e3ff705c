"""Textures of ground floors: each of the four storeys of the tile is one front of four bays."""

import numpy as np
from numpy.typing import NDArray

from eyas.render.textures.fields import SIZE, fractal, masonry, mixed, painted, source, white
from eyas.render.textures.windows import BAY, Opening, Wall

__all__ = ["ground_lobby", "ground_shop"]

Texture = NDArray[np.uint8]

_SIGNS = ((150.0, 44.0, 40.0), (36.0, 74.0, 112.0), (44.0, 92.0, 66.0), (206.0, 168.0, 66.0))


def ground_shop() -> Texture:
    """Return shop windows under sign boards and striped awnings."""
    rng = source("ground_shop")
    face = painted((150.0, 144.0, 136.0), 0.02 * white(rng) + 0.03 * fractal(rng, 1.1))
    wall = Wall(face, rng)
    for x, y in wall.everywhere():
        sign = _SIGNS[int(rng.integers(len(_SIGNS)))]
        wall.window(x, y, Opening(5, 20, 40, 56, (64.0, 62.0, 60.0), 2, 1, 0, curtained=0.2))
        wall.window(x, y, Opening(43, 20, 59, 63, (64.0, 62.0, 60.0), 2, 0, 0, curtained=0.1))
        wall.rect(x + 4, y + 8, x + 60, y + 18, sign)
        for letter in range(x + 14, x + 48, 5):
            wall.rect(
                letter, y + 11, letter + int(rng.integers(2, 5)), y + 15, (236.0, 232.0, 222.0)
            )
        if rng.random() < 0.4:
            for k, stripe in enumerate(range(x + 3, x + 61, 6)):
                pale = (234.0, 228.0, 214.0)
                wall.rect(stripe, y + 18, min(stripe + 6, x + 61), y + 31, sign if k % 2 else pale)
            wall.shade(x + 3, y + 28, x + 61, y + 31, 0.82)
            wall.shade(x + 3, y + 31, x + 61, y + 38, 0.6)
    _plinth(wall)
    return wall.finished()


def ground_lobby() -> Texture:
    """Return stone piers with tall panes and glass doors between them."""
    rng = source("ground_lobby")
    blocks = masonry(rng, 16, 8, joint=1.4)
    grain = 0.025 * white(rng) + 0.03 * fractal(rng, 1.0, longest=90.0)
    face = painted((176.0, 168.0, 156.0), grain + 0.04 * blocks.shade)
    wall = Wall(mixed(face, (118.0, 112.0, 104.0), 0.7 * blocks.joint), rng)
    for x, y in wall.everywhere():
        doors = (x // BAY) % 4 == 1
        bars = (72.0, 66.0, 58.0) if doors else (84.0, 86.0, 88.0)
        opening = Opening(
            9, 8, 55, 63 if doors else 54, bars, 2, 3 if doors else 1, 1, curtained=0.15
        )
        wall.window(x, y, opening)
        if not doors:
            wall.sill(x, y, opening, (194.0, 187.0, 176.0))
    _plinth(wall)
    return wall.finished()


def _plinth(wall: Wall) -> None:
    """Darken the feet of the walls, where rain splashes, except at doors."""
    for y in range(0, SIZE, BAY):
        wall.shade(0, y + 58, SIZE, y + BAY, 0.86)
