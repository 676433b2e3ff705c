"""Textures of plants: bark, and clusters of leaves with holes between them."""

import numpy as np
from numpy.typing import NDArray

from eyas.render.texture_fields import SIZE, fractal, mixed, opaque, painted, source, white

__all__ = ["bark", "leaves"]

_CLUSTER = 128
"""Side of one cluster of leaves; the texture holds two by two [pixels]."""

_BEHIND = (46.0, 60.0, 28.0)
"""Colour under the holes, which small levels of detail mix in."""


def bark() -> NDArray[np.uint8]:
    """Return pale grey bark with upright ridges."""
    rng = source("bark")
    ridges = fractal(rng, 1.0, longest=48.0, stretch=(6.0, 1.0))
    fine = fractal(rng, 0.5, longest=16.0, stretch=(3.0, 1.0))
    picture = painted((158.0, 149.0, 136.0), 0.1 * ridges + 0.07 * fine + 0.03 * white(rng))
    furrow = np.clip((-ridges - 0.7) * 1.4, 0, 1)
    picture = mixed(picture, painted((84.0, 74.0, 63.0), 0.1 * fine), 0.8 * furrow)
    lichen = np.clip((fractal(rng, 1.1, longest=60.0) - 1.0) * 1.2, 0, 1)
    return opaque(mixed(picture, (150.0, 158.0, 128.0), 0.35 * lichen))


def leaves() -> NDArray[np.uint8]:
    """Return two by two clusters of leaves, alpha 0 around and between them.

    Each cluster fills a quarter of the tile and touches none of its edges.
    """
    rng = source("leaves")
    picture = painted(_BEHIND, 0.12 * fractal(rng, 0.6, longest=20.0))
    alpha = np.zeros((SIZE, SIZE))
    for row in range(2):
        for column in range(2):
            box = np.s_[
                row * _CLUSTER : (row + 1) * _CLUSTER, column * _CLUSTER : (column + 1) * _CLUSTER
            ]
            _cluster(picture[box], alpha[box], rng)
    rgba = opaque(picture)
    rgba[..., 3] = np.where(alpha > 0, 255, 0)
    return rgba


def _cluster(
    picture: NDArray[np.float64], alpha: NDArray[np.float64], rng: np.random.Generator
) -> None:
    """Draw leaves along twigs that spread from the middle, the lowest first."""
    for lightness in (0.56, 0.7, 0.85, 1.0):
        for twig in np.linspace(0, 2 * np.pi, 12, endpoint=False) + rng.uniform(0, 1):
            reach = rng.uniform(44, 58)
            bend = rng.uniform(-0.5, 0.5)
            for step in np.arange(0.1, 1.0, 0.058):
                way = twig + bend * step
                middle = 64 + step * reach * np.array([np.sin(way), np.cos(way)])
                middle += rng.normal(0, 2.6, 2)
                side = way + rng.choice([-1, 1]) * rng.uniform(0.3, 1.1)
                length = rng.uniform(4.0, 5.8) * (1.1 - 0.25 * step)
                shade = lightness * rng.uniform(0.84, 1.12)
                _leaf(picture, alpha, middle, side, length, shade * _leaf_colour(rng))


def _leaf_colour(rng: np.random.Generator) -> NDArray[np.float64]:
    """Return dark to olive green, now and then light green or an orange-brown speck."""
    kind = rng.random()
    if kind < 0.006:
        return np.array([184.0, 132.0, 60.0])
    if kind < 0.13:
        return np.array([140.0, 156.0, 84.0])
    olive = rng.random()
    return (1 - olive) * np.array([80.0, 105.0, 52.0]) + olive * np.array([110.0, 120.0, 62.0])


def _leaf(
    picture: NDArray[np.float64],
    alpha: NDArray[np.float64],
    middle: NDArray[np.float64],
    way: float,
    half: float,
    colour: NDArray[np.float64],
) -> None:
    """Draw one pointed leaf of length 2 `half`, lighter on one side of its rib."""
    low = np.maximum(np.floor(middle - half).astype(int), 1)
    high = np.minimum(np.ceil(middle + half).astype(int) + 1, _CLUSTER - 1)
    y, x = np.mgrid[low[0] : high[0], low[1] : high[1]]
    dy, dx = y - middle[0], x - middle[1]
    along = (dx * np.cos(way) + dy * np.sin(way)) / half
    off = (-dx * np.sin(way) + dy * np.cos(way)) / half
    inside = np.abs(off) < 0.44 * (1 - along**2) * (1 - 0.25 * along)
    shade = 1 + 0.16 * np.sign(off) * (np.abs(off) > 0.06) + 0.1 * along
    shade = np.where(np.abs(off) <= 0.06, 1.28, shade)
    box = np.s_[low[0] : high[0], low[1] : high[1]]
    picture[box] = np.where(inside[..., None], shade[..., None] * colour, picture[box])
    alpha[box] = np.where(inside, 1.0, alpha[box])
