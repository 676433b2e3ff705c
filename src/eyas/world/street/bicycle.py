"""A bicycle: two wheels, a diamond frame, handlebars and a saddle; parked ones and those ridden.

x is ahead, y to the left; the origin is on the ground below its middle. Lengths are in metres.
"""

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.mesh.assembly import concatenate
from eyas.mesh.flat import quads
from eyas.mesh.solids import box, tube
from eyas.state.mesh import Material, Mesh
from eyas.world.build.materials import material
from eyas.world.build.scene_builder import Levels

__all__ = ["AXLES", "CRANK", "WHEEL_RADIUS", "bicycle_levels", "frame", "wheel"]

WHEEL_RADIUS: Final = 0.34
"""Of a 28-inch wheel with its tyre (ISO 5775-1: 622 mm rim) [m]."""

AXLES: Final = (0.52, -0.52)
"""x of the front and of the rear axle: a wheelbase of 1.04 m [m]."""

CRANK: Final = (-0.10, 0.28)
"""x and z of the axle of the cranks [m]."""

_SEAT, _HEAD, _BARS = (-0.26, 0.0, 0.93), (0.36, 0.0, 0.90), (0.40, 0.0, 1.02)

_RUBBER = material("plain", (0.07, 0.07, 0.07))
_SPOKES = material("plain", (0.50, 0.51, 0.52))
_BLACK = material("plain", (0.10, 0.10, 0.10))
_LENS = material("plain", (0.62, 0.06, 0.05))
_PAINTS = ((0.10, 0.10, 0.11), (0.55, 0.09, 0.09), (0.12, 0.28, 0.48), (0.78, 0.78, 0.76))

Point = tuple[float, float, float]


def wheel(sides: int) -> Mesh:
    """Return a wheel in the plane of x and z around the origin: tyre, and spokes."""
    turn = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    round_ = np.column_stack([exact.cos(turn), np.zeros(sides), exact.sin(turn)])
    after = np.roll(round_, -1, axis=0)
    half = np.array([0.0, 0.02, 0.0])
    outer, inner = WHEEL_RADIUS, WHEEL_RADIUS - 0.05
    tread = np.stack(
        [outer * round_ - half, outer * round_ + half, outer * after + half, outer * after - half],
        1,
    )
    left = np.stack(
        [inner * round_ + half, inner * after + half, outer * after + half, outer * round_ + half],
        1,
    )
    right = left[:, ::-1] - 2.0 * half
    flat = np.zeros((3 * sides, 4, 2))
    tyre = quads(np.concatenate([tread[:, ::-1], left, right]), flat, _RUBBER)
    spokes = []
    for angle in np.arange(3) * np.pi / 3.0:
        along = inner * np.array([exact.cos(angle), 0.0, exact.sin(angle)])
        across = 0.008 * np.array([-exact.sin(angle), 0.0, exact.cos(angle)])
        face = np.array([across - along, -across - along, along - across, along + across])
        spokes += [face, face[::-1]]
    return concatenate([tyre, quads(spokes, np.zeros((6, 4, 2)), _SPOKES)])


def frame(paint: Material, sides: int) -> Mesh:
    """Return all but wheels and cranks; `paint` covers the tubes."""
    foot = (CRANK[0], 0.0, CRANK[1])
    rear, front = (AXLES[1], 0.0, WHEEL_RADIUS), (AXLES[0], 0.0, WHEEL_RADIUS)
    top = (-0.23, 0.0, 0.80)
    tubes = [
        _rod(foot, top, 0.022, sides, paint),
        _rod(foot, (0.34, 0.0, 0.70), 0.026, sides, paint),
        _rod(top, _HEAD, 0.02, sides, paint),
        _rod(foot, rear, 0.016, sides, paint),
        _rod(top, rear, 0.013, sides, paint),
        _rod(_HEAD, front, 0.02, sides, paint),
        _rod(top, _SEAT, 0.014, sides, _SPOKES),
        _rod(_HEAD, _BARS, 0.015, sides, _SPOKES),
    ]
    saddle = box((0.27, 0.16, 0.06), (-0.27, 0.0, 0.96), _BLACK, 1.0)
    bars = box((0.05, 0.58, 0.04), (0.40, 0.0, 1.04), _BLACK, 1.0)
    grips = [box((0.16, 0.04, 0.04), (0.33, y, 1.04), _BLACK, 1.0) for y in (-0.31, 0.31)]
    guard = box((0.36, 0.055, 0.02), (-0.62, 0.0, 0.72), _BLACK, 1.0)
    rack = box((0.34, 0.14, 0.02), (-0.52, 0.0, 0.80), _SPOKES, 1.0)
    lamp = box((0.03, 0.06, 0.05), (-0.71, 0.0, 0.79), _LENS, 1.0)
    return concatenate([*tubes, saddle, bars, *grips, guard, rack, lamp])


def bicycle_levels(which: int) -> Levels:
    """Return a parked bicycle, in one of several colours."""
    paint = material("plain", _PAINTS[which % len(_PAINTS)])
    return tuple(
        concatenate([frame(paint, tubes), *(_at(wheel(sides), x) for x in AXLES)])
        for tubes, sides in ((5, 14), (3, 8))
    )


def _at(mesh: Mesh, x: float) -> Mesh:
    moved: NDArray[np.float32] = mesh.positions + np.array([x, 0.0, WHEEL_RADIUS], np.float32)
    return replace(mesh, positions=moved)


def _rod(start: Point, end: Point, radius: float, sides: int, cover: Material) -> Mesh:
    return tube([start, end], [radius, radius], sides, cover)
