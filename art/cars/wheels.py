"""Wheels: dark tyres with light discs; they turn about the y axis."""

import numpy as np
from numpy.typing import NDArray

from art.cars.finishes import RIM, TRIM, TYRE
from eyas.engine.mesh.panels import fan
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Mesh
from eyas.lanes import exact

DESIGNS = 4  # Number of designs of discs
_DISC = 0.66  # Radius of the disc, as a share of the wheel's radius
_SHOULDER = 0.92
"""Radius where the tread begins to bend into the side, as a share of the wheel's radius."""


def wheel_levels(radius: float, width: float, pair: float, design: int = 0) -> tuple[Mesh, ...]:
    """Return the levels of detail of one wheel, or of two on an axle, centred at the origin.

    Args:
        radius: Radius of the wheel [m].
        width: Width of the tyre [m].
        pair: Distance between the middles of two wheels [m]; 0 for one wheel.
        design: Of the discs, below `DESIGNS`.
    """
    centres = (pair / 2, -pair / 2) if pair else (0.0,)
    fine, coarse = Shell(), Shell()
    for y in centres:
        _fine(fine, (radius, width), y, design)
        _coarse(coarse, radius, width, y)
    return fine.mesh(), coarse.mesh()


def _ring(radius: float, y: float, sides: int) -> NDArray[np.float64]:
    """Return a circle, counter-clockwise as seen from the right; its first corner is the lowest."""
    angle = np.arange(sides) * (2 * np.pi / sides) - np.pi / 2
    return np.column_stack(
        [radius * exact.cos(angle), np.full(sides, y), radius * exact.sin(angle)]
    )


def _gaps(design: int, sides: int) -> NDArray[np.bool_]:
    """Return which parts of a disc are dark: between spokes, or none of a cover."""
    at = np.arange(sides)
    five, seven = at % 3 == 2, at % 2 == 1
    gaps: NDArray[np.bool_] = np.stack([five, seven, at < 0, ~five])[design]
    return gaps


def _fine(shell: Shell, size: tuple[float, float], y: float, design: int) -> None:
    radius, width = size
    sides, half = 15, width / 2
    # From left to right, because rings must be counter-clockwise as seen from beyond the last.
    sections = [
        (_DISC, half), (_SHOULDER, half), (1.0, 0.7 * half),
        (1.0, -0.7 * half), (_SHOULDER, -half), (_DISC, -half),
    ]  # fmt: skip
    rings = np.stack([_ring(radius * r, y + offset, sides) for r, offset in sections])
    shell.rings(rings, TYRE, caps=False)
    for side in (1.0, -1.0):
        rim = _ring(radius * _DISC, y + side * half, sides)[:: -int(side)]
        hub = [0.0, y + side * (half + 0.01), 0.0]
        follow = np.roll(rim, -1, axis=0)
        spokes = np.stack([rim, follow, np.broadcast_to(hub, rim.shape)], axis=1)
        gap = _gaps(design, sides)
        shell.triangles(spokes[~gap], RIM)
        shell.triangles(spokes[gap], TRIM)


def _coarse(shell: Shell, radius: float, width: float, y: float) -> None:
    sides, half = 8, width / 2
    shell.rings([_ring(radius, y + half, sides), _ring(radius, y - half, sides)], TYRE)
    for side in (1.0, -1.0):
        disc = _ring(0.62 * radius, y + side * (half + 0.012), sides)[:: -int(side)]
        shell.triangles(fan(disc), RIM)
