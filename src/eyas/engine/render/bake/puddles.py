"""Hollows in which rain stands, as a picture that repeats over the land."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.textures.fields import fractal, source


@cache
def hollows() -> NDArray[np.uint16]:
    """Return the depth of the ground at each texel, in the next column, row, and both.

    A byte each, so that one look-up of a pair of numbers fetches all four; cloudy noise with a
    deviation of 1/8 of a byte's range, and a mean of half of it; shape (256, 512).
    """
    field = fractal(source("puddles"), 1.5, longest=60.0)[::4, ::4]
    depth = np.round(255.0 * np.clip(0.5 + field / 8.0, 0.0, 1.0)).astype(np.uint32)
    here = depth | (np.roll(depth, -1, axis=1) << 8)
    both = np.stack([here, np.roll(here, -1, axis=0)], axis=2)
    return both.astype(np.uint16).reshape(len(depth), -1)


def no_hollows() -> NDArray[np.uint16]:
    """Return the picture where no rain falls."""
    return np.zeros((1, 2), np.uint16)
