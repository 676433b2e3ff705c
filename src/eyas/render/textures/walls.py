"""Textures of walls without windows: concrete, brick, stone."""

import numpy as np
from numpy.typing import NDArray

from eyas.render.textures.fields import fractal, masonry, mixed, opaque, painted, source, white

__all__ = ["brick", "concrete", "stone"]

Texture = NDArray[np.uint8]


def concrete() -> Texture:
    """Return cast concrete: clouds, pores, streaks left by water."""
    rng = source("concrete")
    cloud = 0.035 * fractal(rng, 1.1, longest=90.0) + 0.03 * white(rng)
    streaks = fractal(rng, 1.0, longest=60.0, stretch=(7.0, 1.0))
    picture = painted((172.0, 168.0, 160.0), cloud + 0.025 * streaks)
    picture = mixed(picture, (128.0, 124.0, 116.0), 0.3 * np.clip(streaks - 1.0, 0, 1))
    pores = rng.random(cloud.shape) > 0.992
    return opaque(mixed(picture, (110.0, 106.0, 100.0), 0.5 * pores))


def brick() -> Texture:
    """Return red bricks in running bond with pale mortar."""
    rng = source("brick")
    bricks = masonry(rng, 32, 16, joint=1.4)
    grain = 0.05 * white(rng) + 0.04 * fractal(rng, 1.0, longest=70.0)
    picture = painted((158.0, 82.0, 62.0), grain + 0.1 * bricks.shade)
    burnt = masonry(rng, 32, 16, joint=0.0).shade
    picture = mixed(picture, painted((98.0, 62.0, 56.0), grain), 0.6 * (burnt > 1.5))
    picture = mixed(picture, painted((186.0, 116.0, 82.0), grain), 0.5 * (burnt < -1.5))
    return opaque(mixed(picture, painted((178.0, 166.0, 150.0), grain), 0.85 * bricks.joint))


def stone() -> Texture:
    """Return courses of dressed sandstone."""
    rng = source("stone")
    blocks = masonry(rng, 8, 4, joint=2.0)
    grain = 0.035 * white(rng) + 0.045 * fractal(rng, 0.9, longest=60.0)
    bed = 0.03 * fractal(rng, 1.0, longest=40.0, stretch=(0.6, 4.0))
    edge = 0.07 * (blocks.down < 0.08) - 0.09 * (blocks.down > 0.92)
    picture = painted((194.0, 180.0, 154.0), grain + bed + edge + 0.04 * blocks.shade)
    return opaque(mixed(picture, (112.0, 101.0, 86.0), 0.75 * blocks.joint))
