"""Names of colours, and the article before them."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

COLOUR_NAMES: dict[str, tuple[float, float, float]] = {
    "black": (0.10, 0.12, 0.14),
    "dark grey": (0.30, 0.30, 0.31),
    "grey": (0.60, 0.60, 0.60),
    "white": (0.93, 0.92, 0.90),
    "dark red": (0.43, 0.11, 0.10),
    "red": (0.74, 0.10, 0.09),
    "pink": (0.90, 0.45, 0.60),
    "magenta": (0.90, 0.10, 0.80),
    "brown": (0.35, 0.22, 0.13),
    "orange": (0.88, 0.44, 0.10),
    "ochre": (0.72, 0.52, 0.18),
    "beige": (0.72, 0.64, 0.50),
    "yellow": (0.87, 0.80, 0.08),
    "olive": (0.34, 0.35, 0.18),
    "green": (0.22, 0.52, 0.20),
    "light green": (0.45, 0.85, 0.40),
    "dark green": (0.12, 0.27, 0.14),
    "teal": (0.10, 0.46, 0.48),
    "sky blue": (0.20, 0.56, 0.80),
    "blue": (0.16, 0.28, 0.63),
    "dark blue": (0.08, 0.12, 0.34),
    "purple": (0.42, 0.17, 0.44),
}
"""Colours by their names, sRGB 0 to 1."""


def colour_name(colour: Sequence[float]) -> str:
    """Return the name nearest to a colour, sRGB 0 to 1.

    Distances weigh red and blue by the mean red, a cheap approximation of what people see
    (the `redmean` of T. Riemersma, CompuPhase).
    """
    return _nearest(tuple(colour))


@lru_cache(maxsize=4096)
def _nearest(colour: tuple[float, ...]) -> str:
    def away(name: str) -> float:
        red, green, blue = (a - b for a, b in zip(colour, COLOUR_NAMES[name], strict=True))
        mean = (colour[0] + COLOUR_NAMES[name][0]) / 2
        return (2.0 + mean) * red * red + 4.0 * green * green + (3.0 - mean) * blue * blue

    return min(COLOUR_NAMES, key=away)


def colour_distances(colours: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the squared distances of colours from those with names, as `colour_name` measures.

    Args:
        colours: sRGB 0 to 1, shape (A, 3).

    Returns:
        In the order of `COLOUR_NAMES`, shape (A, names).
    """
    own = np.asarray(colours, np.float64)[:, None]
    named = np.array(list(COLOUR_NAMES.values()))
    mean = (own[..., 0] + named[:, 0]) / 2
    squares = np.square(own - named)
    distances: NDArray[np.float64] = (
        (2.0 + mean) * squares[..., 0] + 4.0 * squares[..., 1] + (3.0 - mean) * squares[..., 2]
    )
    return distances


def with_article(noun: str) -> str:
    """Return a noun after its indefinite article."""
    return f"{'an' if noun[0].lower() in 'aeio' else 'a'} {noun}"
