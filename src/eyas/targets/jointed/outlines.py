"""Outlines and small shapes that bodies are made of."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.mesh.shell import Shell
from eyas.state.mesh import Material, Surface

__all__ = ["cylinder", "limb", "matt", "oval", "stack"]


def matt(red: float, green: float, blue: float) -> Material:
    """Return a matt material, sRGB 0 to 1."""
    return Material(tint=(red, green, blue), surface=Surface.MATT)


def oval(
    z: float,
    half: tuple[float, float],
    middle: tuple[float, float],
    sides: int,
    *,
    box: float = 0.0,
) -> NDArray[np.float64]:
    """Return a level oval, counter-clockwise as seen from above, shape (sides, 3).

    Args:
        z: Its height [m].
        half: Half its extent along x and y [m].
        middle: x and y of its middle [m].
        sides: Number of corners; one side faces forward.
        box: 0 for an ellipse, 1 for almost a rectangle.
    """
    angle = (np.arange(sides) + 0.5) * (2 * np.pi / sides)
    c, s = np.cos(angle), np.sin(angle)
    power = 1.0 - 0.7 * box
    x, y = np.sign(c) * np.abs(c) ** power, np.sign(s) * np.abs(s) ** power
    x, y = x / np.abs(x).max(), y / np.abs(y).max()
    return np.column_stack([middle[0] + half[0] * x, middle[1] + half[1] * y, np.full(sides, z)])


def stack(
    shell: Shell,
    rows: Sequence[tuple[float, float, float, float]],
    material: Material,
    sides: int,
    *,
    box: float = 0.0,
    caps: bool = True,
) -> None:
    """Add a body of level ovals, from the bottom up.

    Args:
        shell: Shell to add it to.
        rows: z, half its extent along x and along y, and x of the middle, of each oval [m].
        material: Material of all faces.
        sides: Corners of each oval.
        box: See `oval`.
        caps: Whether bottom and top are closed.
    """
    rings = [oval(z, (x, y), (ahead, 0.0), sides, box=box) for z, x, y, ahead in rows]
    shell.rings(rings, material, caps=caps)


def limb(
    shell: Shell, length: float, radii: Sequence[float], material: Material, sides: int
) -> None:
    """Add a round rod that hangs from the origin, with radii at even distances along it [m]."""
    path = [(0.0, 0.0, z) for z in np.linspace(0.0, -length, len(radii))]
    shell.tube(path, radii, material, sides=sides)


def cylinder(  # noqa: PLR0913  # as its neighbours
    shell: Shell,
    centre: Sequence[float],
    radius: float,
    width: float,
    material: Material,
    sides: int,
    *,
    axis: int = 1,
) -> None:
    """Add a cylinder about the x, y or z axis (0, 1, 2), with closed ends."""
    half = np.zeros(3)
    half[axis] = width / 2
    path = [np.asarray(centre) - half, np.asarray(centre) + half]
    shell.tube(path, (radius, radius), material, sides=sides)
