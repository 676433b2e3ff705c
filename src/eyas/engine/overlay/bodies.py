"""Bodies that only an overlay shows: the marker over a target, and the drone."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.panels import cells, closed, fan, halves
from eyas.engine.overlay.items import Solid
from eyas.lanes import exact

__all__ = ["DRONE_SIZE", "GEM_GIRDLE", "GEM_RADIUS", "drone", "gem"]

DRONE_SIZE = 0.5
"""Distance between neighbouring motors [m]; larger than the real one, to be visible from far."""

GEM_SIDES = 6
GEM_RADIUS, GEM_GIRDLE = 0.42, 0.7  # Radius and height of its widest ring, as shares of its height

GEM_COLOUR = (1.0, 0.27, 0.5)
TABLE_COLOUR = (1.0, 0.5, 0.66)
BODY_COLOUR = (0.93, 0.94, 0.96)
ARM_COLOUR = (0.25, 0.27, 0.3)
ROTOR_COLOUR = (0.5, 0.54, 0.58)
NOSE_COLOUR = (1.0, 0.6, 0.1)

Triangles = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Corners [m], shape (T, 3, 3), and colours, shape (T, 3)."""


def gem(tip: NDArray[np.float64], height: float, turn: float) -> Solid:
    """Return a cut gem, standing on its tip.

    Args:
        tip: Its lowest point, world frame [m], shape (3,).
        height: Height of the gem [m].
        turn: Rotation about its axis [rad].
    """
    angles = turn + np.arange(GEM_SIDES) * (2.0 * np.pi / GEM_SIDES)
    girdle = np.column_stack([exact.cos(angles), exact.sin(angles), np.ones(GEM_SIDES)])
    girdle *= GEM_RADIUS, GEM_RADIUS, GEM_GIRDLE
    table = girdle * (0.55, 0.55, 1.0 / GEM_GIRDLE)
    parts = [
        _coloured(fan(girdle[::-1], (0.0, 0.0, 0.0)), GEM_COLOUR),
        _coloured(_skin(girdle, table), GEM_COLOUR),
        _coloured(fan(table, (0.0, 0.0, 1.0)), TABLE_COLOUR),
    ]
    return _solid(parts, np.eye(3) * height, tip)


def drone(position: NDArray[np.float64], rotation: NDArray[np.float64]) -> Solid:
    """Return a quadrotor.

    Args:
        position: Its middle, world frame [m], shape (3,).
        rotation: Body to world, shape (3, 3).
    """
    parts = [
        _prism(8, (0.0, 0.0), (0.3, 0.17), (-0.09, 0.07), BODY_COLOUR),
        _prism(8, (0.24, 0.0), (0.07, 0.08), (-0.05, 0.03), NOSE_COLOUR),
        _prism(6, (0.16, 0.0), (0.06, 0.06), (-0.2, -0.09), ARM_COLOUR),
    ]
    for x in (-1.0, 1.0):
        for y in (-1.0, 1.0):
            motor = 0.5 * np.array([x, y])
            parts.append(_arm(motor, ARM_COLOUR))
            parts.append(_prism(8, tuple(motor), (0.05, 0.05), (-0.03, 0.1), ARM_COLOUR))
            parts.append(_prism(14, tuple(motor), (0.27, 0.27), (0.1, 0.115), ROTOR_COLOUR))
    return _solid(parts, rotation * DRONE_SIZE, position)


def _solid(
    parts: list[Triangles], axes: NDArray[np.float64], position: NDArray[np.float64]
) -> Solid:
    corners = np.concatenate([part[0] for part in parts]).reshape(-1, 3)
    return Solid(
        positions=exact.product(corners, axes.T) + position,
        triangles=np.arange(len(corners), dtype=np.int32).reshape(-1, 3),
        colours=np.concatenate([part[1] for part in parts]),
    )


def _coloured(corners: NDArray[np.float64], colour: tuple[float, float, float]) -> Triangles:
    return corners, np.tile(colour, (len(corners), 1))


def _prism(
    sides: int,
    middle: tuple[float, ...],
    radius: tuple[float, float],
    span: tuple[float, float],
    colour: tuple[float, float, float],
) -> Triangles:
    """Return an upright prism, given middle and radii along x and y, lowest and highest z."""
    angles = (np.arange(sides) + 0.5) * (2.0 * np.pi / sides)
    ring = np.column_stack(
        [
            middle[0] + radius[0] * exact.cos(angles),
            middle[1] + radius[1] * exact.sin(angles),
            np.full(sides, span[0]),
        ]
    )
    return _closed(ring, span[1] - span[0], colour)


def _arm(motor: NDArray[np.float64], colour: tuple[float, float, float]) -> Triangles:
    """Return a bar from the middle to a motor."""
    along = motor / exact.hypot(*motor)
    side = 0.035 * np.array([-along[1], along[0]])
    ring = np.zeros((4, 3))
    ring[:, :2] = -side, motor - side, motor + side, side
    ring[:, 2] = -0.03
    return _closed(ring, 0.05, colour)


def _closed(
    ring: NDArray[np.float64], height: float, colour: tuple[float, float, float]
) -> Triangles:
    """Return the closed body on a convex ring, with lid and floor."""
    lid = ring.copy()
    lid[:, 2] += height
    low, high = ring.mean(axis=0), lid.mean(axis=0)
    faces = [_skin(ring, lid), fan(lid, tuple(high)), fan(ring[::-1], tuple(low))]
    return _coloured(np.concatenate(faces), colour)


def _skin(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the wall between two rings that run counter-clockwise seen from above."""
    return halves(cells(closed([low, high])))
