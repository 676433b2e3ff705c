"""Autumn: leaves that turn, and crowns that lose them."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.world.build.scene_builder import Levels

__all__ = ["COLOURS", "in_autumn"]

Tint = tuple[float, float, float]

COLOURS: tuple[tuple[Tint, float], ...] = (
    ((0.93, 0.70, 0.20), 0.85),
    ((0.84, 0.44, 0.15), 0.75),
    ((0.66, 0.66, 0.27), 1.0),
    ((0.60, 0.42, 0.24), 0.22),
    ((0.72, 0.26, 0.15), 0.8),
    ((0.96, 0.78, 0.32), 0.5),
    ((0.50, 0.55, 0.27), 1.0),
    ((0.74, 0.52, 0.22), 0.6),
)
"""Colour of sunlit leaves, sRGB, and the share of them that is still on the tree: yellow as limes,
orange as maples, still green, nearly bare, red, ... Trees take them in turn."""

_PALE = {"leaves": "pale_leaves", "foliage": "pale_foliage"}

_TWIGS: Tint = (0.46, 0.40, 0.34)  # Colour of a crown without leaves, seen from afar


def in_autumn(levels: Levels, which: int) -> Levels:
    """Return a plant in autumn, drawn without random numbers: what stands beside it stays.

    Args:
        levels: The plant in summer, the finest level of detail first.
        which: Chooses one of `COLOURS`.
    """
    colour, share = COLOURS[which % len(COLOURS)]
    return tuple(_turned(mesh, colour, share) for mesh in levels)


def _turned(mesh: Mesh, colour: Tint, share: float) -> Mesh:
    cards = np.array([one.surface == Surface.FOLIAGE for one in mesh.palette])[mesh.materials]
    brightest = max((_brightness(one) for one in mesh.palette if one.texture in _PALE), default=1.0)
    palette = tuple(_coloured(one, colour, share, brightest) for one in mesh.palette)
    kept = ~cards
    kept[cards] = _left(mesh.triangles[cards], share)
    inner = np.array([one.surface == Surface.CROWN for one in mesh.palette])[mesh.materials]
    if share < 0.4 and cards.sum() > 100:  # else a crown seen from afar would be gone
        kept &= ~inner
    return replace(
        mesh, triangles=mesh.triangles[kept], materials=mesh.materials[kept], palette=palette
    )


def _left(triangles: NDArray[np.int32], share: float) -> NDArray[np.bool_]:
    """Return which triangles of leaves are on cards that are left; cards share no vertex."""
    first = triangles.min(axis=1)
    card = np.cumsum(np.diff(first, prepend=first[:1]) > 2)
    # Multiples of the golden ratio: evenly spread, and the same in all places.
    return np.asarray((card * 0.6180339887498949) % 1.0 < share, np.bool_)


def _brightness(one: Material) -> float:
    return sum(one.tint) / 3.0


def _coloured(one: Material, colour: Tint, share: float, brightest: float) -> Material:
    if one.texture not in _PALE:
        return one
    light = _brightness(one) / brightest
    if one.surface == Surface.CROWN:  # through a thin crown, twigs are seen
        red, green, blue = (
            part + (1.0 - share) * (twig - part) for part, twig in zip(colour, _TWIGS, strict=True)
        )
        colour = red, green, blue
    return replace(
        one,
        texture=_PALE[one.texture],
        tint=(light * colour[0], light * colour[1], light * colour[2]),
    )
