"""Outlines and small shapes that bodies are made of."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Surface
from eyas.lanes import exact


def matt(red: float, green: float, blue: float) -> Material:
    """Return a matt material, sRGB 0 to 1."""
    return Material(tint=(red, green, blue), surface=Surface.MATT)


def oval(
    z: float,  # Its height [m]
    half: tuple[float, float],  # Half its extent along x and y [m]
    middle: tuple[float, float],  # x and y of its middle [m]
    sides: int,  # Number of corners; one side faces forward
    *,
    box: float = 0.0,  # 0 for an ellipse, 1 for almost a rectangle
) -> NDArray[np.float64]:
    """Return a level oval, counter-clockwise as seen from above, shape (sides, 3)."""
    angle = (np.arange(sides) + 0.5) * (2 * np.pi / sides)
    c, s = exact.cos(angle), exact.sin(angle)
    power = 1.0 - 0.7 * box
    x, y = np.sign(c) * exact.power(np.abs(c), power), np.sign(s) * exact.power(np.abs(s), power)
    x, y = x / np.abs(x).max(), y / np.abs(y).max()
    return np.column_stack([middle[0] + half[0] * x, middle[1] + half[1] * y, np.full(sides, z)])


def stack(
    shell: Shell,  # Shell to add it to
    # z, half its extent along x and along y, and x of the middle, of each oval [m]
    rows: Sequence[tuple[float, float, float, float]],
    material: Material,  # Material of all faces
    sides: int,  # Corners of each oval
    *,
    box: float = 0.0,  # See `oval`
    caps: bool = True,  # Whether bottom and top are closed
) -> None:
    """Add a body of level ovals, from the bottom up."""
    rings = [oval(z, (x, y), (ahead, 0.0), sides, box=box) for z, x, y, ahead in rows]
    shell.rings(rings, material, caps=caps)


def limb(
    shell: Shell,  # Shell to add it to
    length: float,  # Its length, without the ends [m]
    radii: Sequence[float],  # Radii at even distances along it [m]
    material: Material,  # Material of all faces
    sides: int,  # Number of sides; with fewer than five, the ends are flat
) -> None:
    """Add a rod with round ends that hangs from the origin."""
    heights, sizes = np.linspace(0.0, -length, len(radii)).tolist(), list(radii)
    if sides >= 5:
        heights = [0.75 * sizes[0], *heights, -length - 0.75 * sizes[-1]]
        sizes = [0.5 * sizes[0], *sizes, 0.5 * sizes[-1]]
    shell.tube([(0.0, 0.0, z) for z in heights], sizes, material, sides=sides)


def wheel(
    shell: Shell,  # Shell to add them to
    radius: float,  # [m]
    width: float,  # [m]
    places: Sequence[float],  # y of the middle of each [m]
    # Of the tread, and of the hub, which has a bar that shows how it turns
    materials: tuple[Material, Material],
    detail: int,  # See `Shape`
) -> None:
    """Add wheels that turn about the y axis."""
    sides = (6, 9, 14)[detail]
    for y in places:
        cylinder(shell, (0.0, y, 0.0), radius, width, materials[0], sides)
        if detail == 0:
            continue
        cylinder(shell, (0.0, y, 0.0), 0.62 * radius, 1.08 * width, materials[1], sides)
        bar = (0.55 * radius, 0.58 * width, 0.12 * radius)
        low, high = [-bar[0], y - bar[1], -bar[2]], [bar[0], y + bar[1], bar[2]]
        shell.box(low, high, materials[0])


def bar(
    shell: Shell,
    start: Sequence[float],
    end: Sequence[float],
    thick: float,
    material: Material,
    *,
    sides: int = 4,
    both_sides: bool = False,
) -> None:
    """Add a straight rod of a radius [m] between two points."""
    shell.tube([start, end], (thick, thick), material, sides=sides, both_sides=both_sides)


def block(  # as its neighbours
    shell: Shell,
    centre: Sequence[float],
    size: Sequence[float],
    material: Material,
    *,
    both_sides: bool = False,
    taper: float = 0.0,
) -> None:
    """Add a box with its middle at a point [m]."""
    low = [p - s / 2 for p, s in zip(centre, size, strict=True)]
    high = [p + s / 2 for p, s in zip(centre, size, strict=True)]
    shell.box(low, high, material, taper=taper, both_sides=both_sides)


def cylinder(
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
