"""The items of an overlay, placed in the world of the picture."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.terrain import Plane

Colour = tuple[float, float, float]  # sRGB, each 0 to 1


@dataclass(frozen=True, slots=True)
class GroundArea:
    """A convex area, painted on the ground."""

    corners: NDArray[np.float64]
    """Corners on the ground [m], counter-clockwise seen from above, shape (K, 3)."""
    ground: Plane  # The ground there, approximated by a plane
    colour: Colour  # Colour of the fill and of the line along the inside of the edge
    fill: float = 0.0  # Opacity of the fill, 0 to 1


@dataclass(frozen=True, slots=True)
class ThinLine:
    """A thin straight line through the air."""

    start: NDArray[np.float64]  # World frame [m], shape (3,)
    end: NDArray[np.float64]  # World frame [m], shape (3,)
    colour: Colour


@dataclass(frozen=True, slots=True)
class Solid:
    """A small closed body of flat faces, drawn with an outline. V vertices."""

    positions: NDArray[np.float64]  # World frame [m], shape (V, 3)
    triangles: NDArray[np.int32]  # Vertices, counter-clockwise seen from outside, shape (T, 3)
    colours: NDArray[np.float64]  # Colour of each triangle, sRGB 0 to 1, shape (T, 3)


@dataclass(frozen=True, slots=True)
class Label:
    """Text to the right of a point; nothing hides it."""

    anchor: NDArray[np.float64]  # World frame [m], shape (3,)
    text: str
    colour: Colour
    clear: float = 0.0  # Radius around the point that the text keeps clear [m]
    always: bool = False
    """Whether the text is in the upper left corner if the point is outside the picture."""


@dataclass(frozen=True, slots=True)
class Overlay:
    """All items of one view, drawn in this order: ground areas, lines, solids, text."""

    areas: tuple[GroundArea, ...] = ()
    lines: tuple[ThinLine, ...] = ()
    solids: tuple[Solid, ...] = ()
    labels: tuple[Label, ...] = ()
