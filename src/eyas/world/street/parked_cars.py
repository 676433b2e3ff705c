"""Cars that never leave their car parks: simple shapes, part of the scene, not of the traffic."""

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.mesh.assembly import concatenate, transformed
from eyas.mesh.flat import quads
from eyas.mesh.solids import box, cylinder
from eyas.state.mesh import Material, Mesh, Surface
from eyas.world.build.materials import material
from eyas.world.build.scene_builder import Levels

__all__ = ["CARS", "HIGH", "LONG", "VARIANTS", "WIDE", "parked_car"]

Points = NDArray[np.float64]

_COLOURS = (
    (0.92, 0.92, 0.91),
    (0.62, 0.64, 0.66),
    (0.09, 0.09, 0.10),
    (0.34, 0.36, 0.39),
    (0.52, 0.10, 0.10),
    (0.12, 0.22, 0.42),
    (0.74, 0.70, 0.60),
    (0.16, 0.28, 0.22),
)
VARIANTS = len(_COLOURS)
"""Number of kinds of cars."""
CARS = tuple(f"parked car {k}" for k in range(VARIANTS))
"""Names of these kinds."""

LONG, WIDE, HIGH = 2.28, 0.9, 1.5
"""Half the length, half the width and the height of their solid shape [m]."""

_GLASS = Material(tint=(0.105, 0.11, 0.115), surface=Surface.GLASS)
_RUBBER = material("plain", (0.09, 0.09, 0.09))
_LIGHT = material("plain", (0.86, 0.86, 0.82))
_REAR = material("plain", (0.55, 0.06, 0.05))

# Outlines of the lower body and of the cabin from the side: x, half width, z [m].
_SALOON = (
    ((-2.25, 0.74, 0.36), (-2.28, 0.80, 0.62), (-2.15, 0.80, 0.96), (-1.2, 0.87, 0.98),
     (0.95, 0.87, 0.94), (2.1, 0.80, 0.76), (2.25, 0.76, 0.58), (2.2, 0.72, 0.34)),
    ((-1.75, 0.76, 0.97), (-0.95, 0.60, 1.42), (0.1, 0.60, 1.44), (0.95, 0.76, 0.95)),
)  # fmt: skip
_ESTATE = (
    ((-2.2, 0.76, 0.38), (-2.25, 0.84, 0.66), (-2.18, 0.84, 1.06), (-1.2, 0.90, 1.06),
     (1.0, 0.90, 1.02), (2.05, 0.84, 0.90), (2.2, 0.80, 0.64), (2.15, 0.76, 0.36)),
    ((-2.1, 0.78, 1.06), (-1.85, 0.66, 1.62), (0.25, 0.66, 1.66), (1.05, 0.80, 1.04)),
)  # fmt: skip


def parked_car(variant: int) -> Levels:
    """Return a car, the finest level of detail first.

    It stands on the origin and faces along x; lengths are in metres.

    Args:
        variant: Index of the shape and colour, below `VARIANTS`.
    """
    paint = Material(tint=_COLOURS[variant], surface=Surface.PAINT)
    body, cabin = (np.array(part) for part in (_SALOON, _ESTATE)[variant % 2])
    fine = concatenate([_hull(body, paint), _cabin(cabin, paint), _lamps(body), *_wheels()])
    coarse = concatenate([_hull(body[[0, 2, 5, 7]], paint), _cabin(cabin, paint)])
    return fine, coarse


def _hull(outline: Points, paint: Material) -> Mesh:
    """Return the body over an outline from tail to nose, with its two sides down to the sills."""
    x, half, z = outline.T
    left, right = np.stack([x, half, z], axis=1), np.stack([x, -half, z], axis=1)
    top = np.stack([left[:-1], right[:-1], right[1:], left[1:]], axis=1)
    sill = float(z.min())
    low_left, low_right = (np.column_stack([side[:, :2], np.full(len(x), sill)])
                           for side in (left, right))  # fmt: skip
    sides = [
        np.stack([side[:-1], side[1:], low[1:], low[:-1]], axis=1)
        for side, low in ((left, low_left), (right, low_right))
    ]
    faces = np.concatenate([_outwards(side) for side in (top, *sides)])
    return quads(faces, np.zeros((len(faces), 4, 2)), paint)


def _cabin(outline: Points, paint: Material) -> Mesh:
    """Return windows all round and a painted roof."""
    x, half, z = outline.T
    left, right = np.stack([x, half, z], axis=1), np.stack([x, -half, z], axis=1)
    over = np.stack([left[:-1], right[:-1], right[1:], left[1:]], axis=1)
    sides = np.stack([left, right[::-1]])
    glass = _outwards(np.concatenate([over[[0, 2]], sides]))
    roof = _outwards(over[1:2])
    flat = np.zeros((1, 4, 2))
    return concatenate([quads(glass, np.repeat(flat, 4, 0), _GLASS), quads(roof, flat, paint)])


def _outwards(faces: Points) -> Points:
    """Return quadrilaterals turned so that they face away from the middle of the car."""
    middle = np.array([0.0, 0.0, 0.7])
    normal = np.cross(faces[:, 2] - faces[:, 0], faces[:, 3] - faces[:, 1])
    inwards = exact.dot(normal, faces.mean(axis=1) - middle) < 0
    return np.where(inwards[:, None, None], faces[:, ::-1], faces)


def _lamps(body: Points) -> Mesh:
    nose, tail = body[-2], body[1]
    front = [box((0.06, 0.36, 0.12), (nose[0] - 0.01, y, nose[2] + 0.02), _LIGHT, 1.0)
             for y in (-0.52, 0.52)]  # fmt: skip
    rear = [box((0.06, 0.3, 0.16), (tail[0] + 0.01, y, tail[2] + 0.1), _REAR, 1.0)
            for y in (-0.58, 0.58)]  # fmt: skip
    return concatenate([*front, *rear])


def _wheels() -> list[Mesh]:
    upright = cylinder((0.32, 0.32), (-0.1, 0.1), 9, _RUBBER, cap=True)
    return [
        transformed(upright, np.array([[1.0, 0, 0, x], [0, 0, -1.0, y], [0, 1.0, 0, 0.32]]))
        for x in (-1.38, 1.38)
        for y in (-0.78, 0.78)
    ]
