"""What is drawn over a finished picture, as things that stand in its world."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.state.terrain import Plane

__all__ = ["GroundArea", "Label", "Line", "Overlay", "Solid"]

Colour = tuple[float, float, float]
"""sRGB, each 0 to 1."""


@dataclass(frozen=True, slots=True)
class GroundArea:
    """A convex area, painted on whatever lies on the ground."""

    corners: NDArray[np.float64]
    """On the ground [m], counter-clockwise seen from above, shape (K, 3)."""
    ground: Plane
    """The ground there, taken for a plane."""
    colour: Colour
    """Of the line along its edge, which lies inside."""
    fill: float = 0.0
    """How much of the colour covers the area, 0 to 1."""


@dataclass(frozen=True, slots=True)
class Line:
    """A thin straight line through the air."""

    start: NDArray[np.float64]
    """World frame [m], shape (3,)."""
    end: NDArray[np.float64]
    """World frame [m], shape (3,)."""
    colour: Colour


@dataclass(frozen=True, slots=True)
class Solid:
    """A small closed body of flat faces, with an outline round its picture. V vertices."""

    positions: NDArray[np.float64]
    """World frame [m], shape (V, 3)."""
    triangles: NDArray[np.int32]
    """Vertices, counter-clockwise seen from outside, shape (T, 3)."""
    colours: NDArray[np.float64]
    """Of each triangle, sRGB 0 to 1, shape (T, 3)."""


@dataclass(frozen=True, slots=True)
class Label:
    """Words to the right of a point; nothing hides them."""

    anchor: NDArray[np.float64]
    """World frame [m], shape (3,)."""
    text: str
    colour: Colour
    clear: float = 0.0
    """Radius round the point that the words stay out of [m]."""
    always: bool = False
    """Whether the words are in the upper left corner if the point is not in the picture."""


@dataclass(frozen=True, slots=True)
class Overlay:
    """All that is drawn over one view: the ground first, then lines, solids and words."""

    areas: tuple[GroundArea, ...] = ()
    lines: tuple[Line, ...] = ()
    solids: tuple[Solid, ...] = ()
    labels: tuple[Label, ...] = ()
