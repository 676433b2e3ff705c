"""Textures of what age leaves on roads: worn paint, repaired asphalt, lids."""

import numpy as np
from numpy.typing import NDArray

from eyas.render.texture_fields import (
    SIZE,
    fractal,
    mixed,
    opaque,
    painted,
    source,
    white,
)

__all__ = ["asphalt_patch", "manhole", "paint"]

Texture = NDArray[np.uint8]


def paint() -> Texture:
    """Return nearly white paint: worn through in specks, dirty in clouds."""
    rng = source("paint")
    dirt = fractal(rng, 0.9, longest=60.0)
    picture = painted((238.0, 237.0, 233.0), 0.022 * dirt + 0.02 * white(rng))
    picture = mixed(picture, (176.0, 172.0, 164.0), np.clip(0.22 * dirt - 0.1, 0, 0.4))
    wear = 0.75 * fractal(rng, 0.5, longest=20.0) + 0.65 * fractal(rng, 1.0, longest=70.0)
    return opaque(mixed(picture, (84.0, 84.0, 86.0), 0.6 * np.clip((wear - 1.5) * 3.0, 0, 1)))


def asphalt_patch() -> Texture:
    """Return newer, darker, finer asphalt than the road's."""
    rng = source("asphalt_patch")
    grain = 0.07 * white(rng) + 0.05 * fractal(rng, 0.8, longest=40.0)
    picture = painted((52.0, 53.0, 56.0), grain)
    stone = rng.random(grain.shape)
    return opaque(mixed(picture, (112.0, 110.0, 106.0), 0.4 * (stone > 0.99)))


def manhole() -> Texture:
    """Return one round cast-iron lid, seen from above: ring, gap, a grid of knobs."""
    rng = source("manhole")
    y, x = (np.mgrid[:SIZE, :SIZE] + 0.5) / SIZE * 2 - 1
    radius = np.hypot(x, y)
    picture = painted((78.0, 74.0, 70.0), 0.05 * white(rng))
    knob = (np.sin(11 * np.pi * x) * np.sin(11 * np.pi * y) > 0.1) & (radius < 0.72)
    picture = mixed(picture, (116.0, 110.0, 103.0), 0.8 * knob)
    ring = np.clip(1.5 - np.abs(radius - 0.88) / 0.06, 0, 1)
    picture = mixed(picture, (112.0, 107.0, 101.0), 0.8 * ring)
    gap = np.clip(1.5 - np.abs(radius - 0.77) / 0.025, 0, 1)
    picture = mixed(picture, (30.0, 29.0, 29.0), 0.9 * gap)
    rim = np.clip((radius - 0.97) / 0.03, 0, 1)
    return opaque(mixed(picture, (44.0, 44.0, 46.0), 0.9 * rim))
