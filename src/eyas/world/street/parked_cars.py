"""Cars that never leave their car parks: simple shapes, part of the scene, not of the traffic."""

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.mesh.assembly import concatenate, transformed
from eyas.mesh.flat import quads
from eyas.mesh.solids import box, cylinder
from eyas.state.mesh import Material, Mesh, Surface
from eyas.world.build.bodywork import (
    BAND,
    FRONT,
    RAISED,
    REAR,
    REAR_WINDOW,
    SIDE,
    SIDE_SHARES,
    TOP,
    TOP_SHARES,
    WINDSCREEN,
    body_paint,
)
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

_GLASS = Material(texture="panes", tint=(0.5, 0.51, 0.53), surface=Surface.GLASS)
"""Not that of cars in traffic: snow lies on it."""
_RUBBER = material("plain", (0.09, 0.09, 0.09))
_LIGHT = material("plain", (0.86, 0.86, 0.82))
_LENS = material("plain", (0.55, 0.06, 0.05))
_RIM = material("plain", (0.62, 0.63, 0.65))
_PLATE = material("plain", (0.88, 0.88, 0.84))

_STYLES = tuple(
    f"bodywork_{style}"
    for style in (
        *("saloon", "hatch", "saloon_worn", "hatch_sunroof", "saloon_sunroof", "hatch_worn"),
        *("saloon", "hatch"),
    )
)
"""Bodywork of each kind; it fits the shape."""

_AXLE, _ARCH = 1.38, 0.37
"""Distance of the axles from the middle, and half the length of an arch [m]."""

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
    paint = replace(body_paint(_STYLES[variant]), tint=_raised(_COLOURS[variant]))
    body, cabin = (np.array(part) for part in (_SALOON, _ESTATE)[variant % 2])
    hull, top = partial(_hull, paint=paint, cabin=cabin), _cabin(cabin, paint)
    fine = concatenate([hull(body), top, _lamps(body), *_wheels()])
    coarse = concatenate([hull(body[[0, 2, 5, 7]]), top])
    return fine, coarse


def _raised(colour: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return a tint that gives plain paint a colour, see `body_paint`."""
    red, green, blue = (RAISED * part for part in colour)
    return red, green, blue


def _hull(outline: Points, *, paint: Material, cabin: Points) -> Mesh:
    """Return the body over an outline from tail to nose, with its two sides down to the sills."""
    x, half, z = outline.T
    left, middle = outline, outline * [1.0, 0.0, 1.0]
    over = np.stack([left[:-1], middle[:-1], middle[1:], left[1:]], axis=1)
    sill = float(z.min())
    low = np.column_stack([x, half, np.full(len(x), sill)])
    side = np.stack([left[:-1], left[1:], low[1:], low[:-1]], axis=1)
    uvs = TOP.at(
        np.interp(over[..., 0], [x.min(), *cabin[:, 0], x.max()], TOP_SHARES),
        over[..., 1] / half.max(),
    )
    count = len(outline) // 4  # panels of each end
    for rows, region, high in (
        (slice(0, count), REAR, z[count]),
        (slice(-count, None), FRONT, z[-count - 1]),
    ):
        end = over[rows]
        uvs[rows] = region.at(end[..., 1] / half.max(), (end[..., 2] - sill) / (high - sill))
    arches = [-_AXLE - _ARCH, -_AXLE + _ARCH, -0.2, 0.9, _AXLE - _ARCH, _AXLE + _ARCH]
    along = np.interp(side[..., 0], [x.min(), *arches, x.max()], SIDE_SHARES)
    belt = np.interp(side[..., 0], x[count:-count], z[count:-count])
    side_uvs = SIDE.at(along, (side[..., 2] - sill) / np.maximum(belt - sill, 0.05))
    faces, all_uvs = np.concatenate([over, side]), np.concatenate([uvs, side_uvs])
    return _both_sides(faces, all_uvs, paint)


def _both_sides(faces: Points, uvs: Points, skin: Material) -> Mesh:
    """Return faces of the left half, and the same mirrored."""
    out = _inwards(faces)
    faces = np.where(out[:, None, None], faces[:, ::-1], faces)
    uvs = np.where(out[:, None, None], uvs[:, ::-1], uvs)
    mirror = faces[:, ::-1] * [1.0, -1.0, 1.0]
    return quads(np.concatenate([faces, mirror]), np.concatenate([uvs, uvs[:, ::-1]]), skin)


def _cabin(outline: Points, paint: Material) -> Mesh:
    """Return windows all round and a painted roof."""
    x, _, z = outline.T
    across = np.array([1.0, 0.0, 0.0, 1.0])
    left, middle = outline, outline * [1.0, 0.0, 1.0]
    roof = np.array([left[1], middle[1], middle[2], left[2]])[None]
    roof_uvs = TOP.at(np.take(TOP_SHARES, [2, 2, 3, 3]), across)[None]
    up = (z - z.min()) / np.ptp(z)
    side_uvs = BAND.at((x - x[0]) / (x[3] - x[0]), up)[None]
    painted = _both_sides(
        np.concatenate([roof, outline[None]]), np.concatenate([roof_uvs, side_uvs]), paint
    )
    right = outline * [1.0, -1.0, 1.0]
    rear = np.array([left[0], right[0], right[1], left[1]])
    screen = np.array([right[3], left[3], left[2], right[2]])
    corners = [0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0]
    panes = quads([rear, screen], [REAR_WINDOW.at(*corners), WINDSCREEN.at(*corners)], _GLASS)
    return concatenate([painted, panes])


def _inwards(faces: Points) -> NDArray[np.bool_]:
    """Return which quadrilaterals face the middle of the car."""
    middle = np.array([0.0, 0.0, 0.7])
    normal = np.cross(faces[:, 2] - faces[:, 0], faces[:, 3] - faces[:, 1])
    inwards: NDArray[np.bool_] = exact.dot(normal, faces.mean(axis=1) - middle) < 0
    return inwards


def _lamps(body: Points) -> Mesh:
    nose, tail = body[-2], body[1]
    front = [box((0.06, 0.36, 0.12), (nose[0] - 0.01, y, nose[2] + 0.02), _LIGHT, 1.0)
             for y in (-0.52, 0.52)]  # fmt: skip
    rear = [box((0.06, 0.3, 0.16), (tail[0] + 0.01, y, tail[2] + 0.1), _LENS, 1.0)
            for y in (-0.58, 0.58)]  # fmt: skip
    plate = box((0.03, 0.5, 0.11), (tail[0] + 0.0, 0.0, tail[2] + 0.13), _PLATE, 1.0)
    return concatenate([*front, *rear, plate])


def _wheels() -> list[Mesh]:
    tyre = cylinder((0.32, 0.32), (-0.1, 0.1), 9, _RUBBER, cap=True)
    disc = cylinder((0.2, 0.0), (0.1, 0.115), 9, _RIM)
    wheel = concatenate([tyre, disc])
    return [
        transformed(wheel, np.array([[-side, 0, 0, x], [0, 0, side, 0.81 * side], [0, 1, 0, 0.32]]))
        for x in (-_AXLE, _AXLE)
        for side in (1.0, -1.0)
    ]
