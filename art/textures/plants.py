"""Textures of plants: bark, clusters of leaves with holes between them, and closed foliage."""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from art.textures.fields import mixed, opaque, painted
from eyas.engine.render.textures.fields import SIZE, fractal, source, white
from eyas.lanes import exact

_CLUSTER = 128  # Side of one cluster of leaves; the texture holds two by two [pixels]

_BEHIND = (46.0, 60.0, 28.0)  # Colour under the holes, which is mixed in at coarse levels of detail


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


@cache
def leaves() -> NDArray[np.uint8]:
    """Return two by two clusters of leaves, alpha 0 around and between them.

    Each cluster fills a quarter of the tile and touches none of its edges.
    """
    rng = source("leaves")
    picture = _shade_of_leaves(rng)
    picture[..., 3] = 0.0
    for row in range(2):
        for column in range(2):
            box = np.s_[
                row * _CLUSTER : (row + 1) * _CLUSTER, column * _CLUSTER : (column + 1) * _CLUSTER
            ]
            _cluster(picture[box], rng)
    return picture.astype(np.uint8)


@cache
def foliage() -> NDArray[np.uint8]:
    """Return leaves without holes: for clipped hedges and the inside of crowns."""
    rng = source("foliage")
    picture = _shade_of_leaves(rng)
    for lightness in (0.56, 0.7, 0.85, 1.0):
        for _ in range(900):
            middle, way = rng.uniform(0, SIZE, 2), rng.uniform(0, 2 * np.pi)
            colour = lightness * rng.uniform(0.84, 1.12) * _leaf_colour(rng)
            _paste(_leaf(middle, way, rng.uniform(4.0, 5.8), colour), picture)
    # Clusters and the clefts between them, visible even where single leaves are not.
    clusters = 1.0 + 0.3 * fractal(rng, 1.2, longest=70.0)
    return opaque(picture[..., :3] * np.clip(clusters, 0.35, 1.5)[..., None])


def pale_leaves() -> NDArray[np.uint8]:
    """Return the clusters of `leaves` in light grey, to be tinted like blossoms or frost."""
    return _paled(leaves())


def pale_foliage() -> NDArray[np.uint8]:
    """Return the closed leaves of `foliage` in light grey."""
    return _paled(foliage())


def _paled(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    grey = np.clip(np.round(2.1 * picture[..., :3].mean(axis=2, keepdims=True)), 0, 255)
    pale = np.concatenate([grey, grey, grey, picture[..., 3:]], axis=2)
    return pale.astype(np.uint8)


def _shade_of_leaves(rng: np.random.Generator) -> NDArray[np.float64]:
    """Return the dark colour between leaves, RGBA."""
    return opaque(painted(_BEHIND, 0.12 * fractal(rng, 0.6, longest=20.0))).astype(np.float64)


def _cluster(picture: NDArray[np.float64], rng: np.random.Generator) -> None:
    """Draw leaves along twigs that spread from the middle, the lowest first."""
    for lightness in (0.56, 0.7, 0.85, 1.0):
        for twig in np.linspace(0, 2 * np.pi, 12, endpoint=False) + rng.uniform(0, 1):
            reach = rng.uniform(44, 58)
            bend = rng.uniform(-0.5, 0.5)
            for step in np.arange(0.1, 1.0, 0.058):
                way = twig + bend * step
                middle = 64 + step * reach * np.array([exact.sin(way), exact.cos(way)])
                middle += exact.normal(rng, 0, 2.6, 2)
                side = way + rng.choice([-1, 1]) * rng.uniform(0.3, 1.1)
                length = rng.uniform(4.0, 5.8) * (1.1 - 0.25 * step)
                shade = lightness * rng.uniform(0.84, 1.12)
                leaf = _leaf(middle, side, length, shade * _leaf_colour(rng))
                rows, columns = leaf.rows[:, None], leaf.columns
                leaf.inside[(rows < 1) | (columns < 1)] = False
                leaf.inside[(rows >= _CLUSTER - 1) | (columns >= _CLUSTER - 1)] = False
                _paste(leaf, picture)


def _leaf_colour(rng: np.random.Generator) -> NDArray[np.float64]:
    """Return dark to olive green, occasionally light green or orange-brown."""
    kind = rng.random()
    if kind < 0.006:
        return np.array([184.0, 132.0, 60.0])
    if kind < 0.13:
        return np.array([140.0, 156.0, 84.0])
    olive = rng.random()
    return (1 - olive) * np.array([80.0, 105.0, 52.0]) + olive * np.array([110.0, 120.0, 62.0])


class _Leaf(NamedTuple):
    """A leaf within R x C pixels."""

    rows: NDArray[np.int64]  # Row indices, shape (R,)
    columns: NDArray[np.int64]  # Column indices, shape (C,)
    inside: NDArray[np.bool_]  # Pixels of the leaf, shape (R, C)
    colour: NDArray[np.float64]  # RGBA, shape (R, C, 4)


def _leaf(
    middle: NDArray[np.float64], way: float, half: float, colour: NDArray[np.float64]
) -> _Leaf:
    """Return a pointed leaf of length 2 `half`, lighter on one side of its rib."""
    low, high = np.floor(middle - half).astype(int), np.ceil(middle + half).astype(int) + 1
    rows, columns = np.arange(low[0], high[0]), np.arange(low[1], high[1])
    dy, dx = rows[:, None] - middle[0], columns - middle[1]
    cosine, sine = exact.cos(way), exact.sin(way)
    along = (dx * cosine + dy * sine) / half
    off = (-dx * sine + dy * cosine) / half
    aside = np.abs(off)
    inside = aside < 0.44 * (1 - np.square(along)) * (1 - 0.25 * along)
    shade = 1 + 0.16 * np.sign(off) * (aside > 0.06) + 0.1 * along
    shade = np.where(aside <= 0.06, 1.28, shade)
    rgba = np.full((len(rows), len(columns), 4), 255.0)
    rgba[..., :3] = np.clip(np.round(shade[..., None] * colour), 0.0, 255.0)
    return _Leaf(rows, columns, inside, rgba)


def _paste(leaf: _Leaf, picture: NDArray[np.float64]) -> None:
    """Draw a leaf; parts beyond one edge reappear at the opposite edge."""
    texels = np.ix_(leaf.rows % len(picture), leaf.columns % len(picture))
    picture[texels] = np.where(leaf.inside[..., None], leaf.colour, picture[texels])
