"""A bicycle: two wheels, a diamond frame, handlebars and a saddle; parked ones and those ridden.

x is ahead, y to the left; the origin is on the ground below its middle. Lengths are in metres.
"""

from typing import Final

import numpy as np

from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import Levels
from eyas.lanes import exact

WHEEL_RADIUS: Final = 0.34  # 28-inch wheel with its tyre (ISO 5775-1: 622 mm rim) [m]
AXLES: Final = (0.52, -0.52)  # x of the front and of the rear axle: a wheelbase of 1.04 m [m].
CRANK: Final = (-0.10, 0.28)  # x and z of the axle of the cranks [m]
SADDLE: Final = (-0.27, 0.90)  # x and z of the middle of the saddle [m]
PAINTS: Final = ((0.10, 0.10, 0.11), (0.55, 0.09, 0.09), (0.12, 0.28, 0.48), (0.78, 0.78, 0.76))
"""Colours of frames, sRGB."""

_RUBBER = material("plain", (0.07, 0.07, 0.07))
_SPOKES = material("plain", (0.50, 0.51, 0.52))
_BLACK = material("plain", (0.10, 0.10, 0.10))
_LENS = material("plain", (0.62, 0.06, 0.05))
_TOP, _HEAD, _BARS = (-0.23, 0.0, 0.76), (0.36, 0.0, 0.90), (0.40, 0.0, 1.02)


def add_wheel(shell: Shell, detail: int, middle: tuple[float, float] = (0.0, 0.0)) -> None:
    """Add a wheel in the plane of x and z: a tyre, and spokes.

    Args:
        shell: Shell to add it to.
        detail: 2 from near, 1, or 0 from afar.
        middle: x and z of its axle [m].
    """
    sides = (8, 11, 16)[detail]
    turn = np.arange(sides) * (2.0 * np.pi / sides)
    out = np.column_stack([exact.cos(turn), np.zeros(sides), exact.sin(turn)])
    after, half = np.roll(out, -1, axis=0), np.array([0.0, 0.02, 0.0])
    at = np.array([middle[0], 0.0, middle[1]])
    outer, inner = WHEEL_RADIUS, WHEEL_RADIUS - 0.05
    tread = [outer * out - half, outer * after - half, outer * after + half, outer * out + half]
    left = [inner * out + half, outer * out + half, outer * after + half, inner * after + half]
    shell.quads(at + np.stack(tread, 1)[:, ::-1], _RUBBER)
    shell.quads(at + np.stack(left, 1)[:, ::-1], _RUBBER)
    shell.quads(at + np.stack(left, 1) - 2.0 * half, _RUBBER)
    for angle in np.arange(3) * (np.pi / 3.0):
        along = inner * np.array([exact.cos(angle), 0.0, exact.sin(angle)])
        across = 0.01 * np.array([-exact.sin(angle), 0.0, exact.cos(angle)])
        face = at + np.array([across - along, -across - along, along - across, along + across])
        shell.quads([face, face[::-1]], _SPOKES)


def add_frame(shell: Shell, paint: Material, detail: int) -> None:
    """Add all but wheels; `paint` covers the tubes."""
    sides = (3, 4, 6)[detail]
    foot, front = (CRANK[0], 0.0, CRANK[1]), (AXLES[0], 0.0, WHEEL_RADIUS)
    rear, seat = (AXLES[1], 0.0, WHEEL_RADIUS), (SADDLE[0], 0.0, SADDLE[1] - 0.02)
    for start, end, radius, cover in (
        (foot, _TOP, 0.022, paint),
        (foot, (0.34, 0.0, 0.70), 0.026, paint),
        (_TOP, _HEAD, 0.02, paint),
        (foot, rear, 0.016, paint),
        (_TOP, rear, 0.013, paint),
        (_HEAD, front, 0.02, paint),
        (_TOP, seat, 0.014, _SPOKES),
        (_HEAD, _BARS, 0.015, _SPOKES),
    ):
        shell.tube([start, end], (radius, radius), cover, sides=sides)
    x, z = SADDLE
    shell.box((x - 0.13, -0.08, z - 0.03), (x + 0.14, 0.08, z + 0.03), _BLACK)
    shell.box((0.375, -0.29, 1.02), (0.425, 0.29, 1.06), _BLACK)
    shell.box((0.25, 0.29, 1.02), (0.41, 0.33, 1.06), _BLACK, both_sides=True)
    if detail:
        shell.box((-0.70, -0.07, 0.79), (-0.35, 0.07, 0.81), _SPOKES)
        shell.box((-0.72, -0.03, 0.74), (-0.69, 0.03, 0.785), _LENS)


def parked_bicycles() -> list[Levels]:
    """Return a parked bicycle in each of `PAINTS`."""
    return [(_parked(paint, 1), _parked(paint, 0)) for paint in PAINTS]


def _parked(paint: tuple[float, float, float], detail: int) -> Mesh:
    shell = Shell()
    add_frame(shell, material("plain", paint), detail)
    for x in AXLES:
        add_wheel(shell, detail, (x, WHEEL_RADIUS))
    return shell.mesh()
