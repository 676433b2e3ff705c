"""Textures of aged roads: worn paint, tyre tracks, oil, repaired asphalt, manhole lids."""

import numpy as np
from numpy.typing import NDArray

from art.textures.fields import mixed, opaque, painted
from art.textures.ground import asphalt
from eyas.engine.render.textures.fields import SIZE, fractal, source, white
from eyas.engine.render.textures.mipmap import linear
from eyas.lanes import exact

Texture = NDArray[np.uint8]


def paint() -> Texture:
    """Return nearly white paint: worn through in specks, dirty in clouds."""
    rng = source("paint")
    dirt = fractal(rng, 0.9, longest=60.0)
    picture = painted((238.0, 237.0, 233.0), 0.022 * dirt + 0.02 * white(rng))
    picture = mixed(picture, (150.0, 147.0, 141.0), np.clip(0.3 * dirt - 0.05, 0, 0.6))
    wear = 0.75 * fractal(rng, 0.5, longest=20.0) + 0.65 * fractal(rng, 1.0, longest=70.0)
    return opaque(mixed(picture, (84.0, 84.0, 86.0), 0.75 * np.clip((wear - 0.9) * 2.0, 0, 1)))


def asphalt_paint() -> Texture:
    """Return the road's asphalt and, in alpha, how bright paint on it is: linear, 0 to 255."""
    picture = asphalt()
    bright = linear(paint()[..., 0] / 255.0)  # a repeat is 4 m wide, half of the asphalt's
    coarse = bright.reshape(SIZE // 2, 2, SIZE // 2, 2).mean(axis=(1, 3))
    picture[..., 3] = np.round(255.0 * np.tile(coarse, (2, 2)))
    return picture


def asphalt_patch() -> Texture:
    """Return newer, darker, finer asphalt than the road's."""
    rng = source("asphalt_patch")
    grain = 0.07 * white(rng) + 0.05 * fractal(rng, 0.8, longest=40.0)
    picture = painted((70.0, 69.5, 68.5), grain)
    stone = rng.random(grain.shape)
    return opaque(mixed(picture, (112.0, 110.0, 106.0), 0.4 * (stone > 0.99)))


def asphalt_lane() -> Texture:
    """Return the asphalt of one lane, u across it, with two tracks darkened and smoothed by tyres.

    At both edges it equals the texture `asphalt`.
    """
    rng = source("asphalt_lane")
    across = (np.arange(SIZE)[None] + 0.5) / SIZE * 2 - 1
    sway = 0.03 * fractal(rng, 1.5, longest=100.0)
    track = exact.exp(-np.square((np.abs(across + sway) - 0.5) / 0.17))
    # Twice as many texels per metre across as along: two make one grain of the road's asphalt.
    grain = np.repeat(exact.normal(rng, size=(SIZE, SIZE // 2)), 2, axis=1)
    lumps = fractal(rng, 0.8, longest=14.0, stretch=(0.5, 1.0))
    cloud = fractal(rng, 1.0, longest=70.0, stretch=(0.5, 1.0))
    picture = painted(
        (81.0, 80.5, 79.0), (1 - 0.3 * track) * (0.1 * grain + 0.06 * lumps) + 0.04 * cloud
    )
    stone = np.repeat(rng.random((SIZE, SIZE // 2)), 2, axis=1)
    picture = mixed(picture, (42.0, 42.0, 42.0), 0.5 * (stone < 0.03))
    picture = mixed(picture, (150.0, 147.0, 140.0), (1 - 0.5 * track) * 0.5 * (stone > 0.985))
    picture = mixed(picture, (64.0, 63.5, 62.5), 0.55 * track * (1 + 0.25 * cloud))
    drip = exact.exp(-np.square(across / 0.12)) * np.clip(0.5 + 0.4 * cloud, 0, 1)
    return opaque(mixed(picture, (56.0, 56.0, 56.0), 0.3 * drip))


def asphalt_oil() -> Texture:
    """Return the middle of a lane where cars wait, u across it: drops and clouds of oil."""
    rng = source("asphalt_oil")
    across = (np.arange(SIZE)[None] + 0.5) / SIZE * 2 - 1
    grain = 0.09 * white(rng) + 0.05 * fractal(rng, 0.8, longest=30.0)
    picture = painted((80.0, 79.5, 78.0), grain)
    where = np.clip(1.0 - np.abs(across), 0, 1)
    cloud = np.clip(0.55 + 0.45 * fractal(rng, 1.2, longest=60.0), 0, 1)
    picture = mixed(picture, painted((54.0, 53.5, 53.0), 0.6 * grain), 0.7 * where * cloud)
    drops = fractal(rng, 1.3, longest=16.0) * where
    return opaque(mixed(picture, (22.0, 22.0, 24.0), 0.6 * np.clip((drops - 1.2) * 3, 0, 1)))


def manhole() -> Texture:
    """Return a cast-iron lid in a square of new asphalt, from above: ring, gap, a grid of knobs."""
    rng = source("manhole")
    y, x = ((np.mgrid[:SIZE, :SIZE] + 0.5) / SIZE * 2 - 1) / 0.78
    radius = exact.hypot(x, y)
    picture = painted((78.0, 74.0, 70.0), 0.05 * white(rng))
    knob = (exact.sin(11 * np.pi * x) * exact.sin(11 * np.pi * y) > 0.1) & (radius < 0.72)
    picture = mixed(picture, (116.0, 110.0, 103.0), 0.8 * knob)
    ring = np.clip(1.5 - np.abs(radius - 0.88) / 0.06, 0, 1)
    picture = mixed(picture, (112.0, 107.0, 101.0), 0.8 * ring)
    gap = np.clip(1.5 - np.abs(radius - 0.77) / 0.025, 0, 1)
    picture = mixed(picture, (30.0, 29.0, 29.0), 0.9 * gap)
    rim = np.clip((radius - 0.97) / 0.03, 0, 1)
    grain = 0.08 * white(rng) + 0.05 * fractal(rng, 0.8, longest=40.0)
    return opaque(mixed(picture, painted((66.0, 65.5, 64.5), grain), rim))
