"""The shape of a quadrotor: what the trackers of a shared world look like to each other."""

import math

import numpy as np

from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.lanes import exact

_BODY = Material(tint=(0.46, 0.47, 0.49))
_DARK = Material(tint=(0.17, 0.17, 0.18))
_BLADE = Material(tint=(0.30, 0.30, 0.31))
_LENS = Material(tint=(0.08, 0.08, 0.10), surface=Surface.GLASS)

_FRONT, _REAR = (0.118, 0.134), (-0.118, 0.130)
"""Forward and left of a motor, the other side mirrored: 0.35 m from corner to corner [m]."""
_FRONT_TOP, _REAR_TOP = 0.045, 0.03  # Height of the rotors [m]
_FRONT_TURN, _REAR_TURN = 0.5, 2.2
"""Where their blades stand [rad]. Discs, as blurred by the turning, hide four times too much."""
_TIP = 0.11  # Length of a blade [m]

_ACROSS, _LIFT = np.array([-1.0, 1.0, 1.0, -1.0]), np.array([0.0, -0.004, 0.001, 0.005])
"""Corners of a section of a blade: aside, in half chords, and up [m]; it is pitched."""

_HULL = (
    (-0.105, 0.026, -0.030, 0.012),
    (-0.085, 0.042, -0.040, 0.030),
    (0.050, 0.046, -0.042, 0.036),
    (0.100, 0.040, -0.030, 0.024),
    (0.116, 0.026, -0.018, 0.008),
)
"""Sections of the hull: forward, half width, bottom, top [m]."""


def quadrotor_levels() -> tuple[Mesh, ...]:
    """Return the levels of detail, the finest first; x is forward, the origin in the middle."""
    return _mesh(8), _mesh(5), _mesh(3)


def _mesh(sides: int) -> Mesh:
    """Return the mesh with so many sides of its rods."""
    shell = Shell()
    shell.rings([_section(*section) for section in _HULL], _BODY)
    shell.box((0.112, -0.02, -0.055), (0.146, 0.02, -0.015), _DARK)
    shell.ball((0.146, 0.0, -0.036), (0.014, 0.014, 0.014), _LENS, rows=4, sides=sides + 1)
    _arm(shell, (0.085, 0.035, 0.0), (*_FRONT, _FRONT_TOP), _FRONT_TURN, sides)
    _arm(shell, (-0.07, 0.035, 0.0), (*_REAR, _REAR_TOP), _REAR_TURN, sides)
    x, y = _FRONT
    leg = [(x, y, _FRONT_TOP - 0.04), (x + 0.01, y, -0.06)]
    shell.tube(leg, (0.010, 0.006), _DARK, sides=sides, both_sides=True)
    return shell.mesh()


def _section(x: float, half: float, low: float, high: float) -> list[tuple[float, float, float]]:
    """Return an outline with bevelled edges, counter-clockwise as seen from ahead."""
    edge, rim = 0.65 * half, 0.3 * (high - low)
    right = [(-edge, high), (-half, high - rim), (-half, low + rim), (-edge, low)]
    left = [(-y, z) for y, z in reversed(right)]
    return [(x, y, z) for y, z in right + left]


def _arm(
    shell: Shell,
    root: tuple[float, float, float],
    hub: tuple[float, float, float],
    turn: float,
    sides: int,
) -> None:
    """Add an arm on both sides, with its motor and its rotor of two blades."""
    x, y, top = hub
    shell.tube([root, (x, y, top - 0.03)], (0.017, 0.012), _BODY, sides=sides, both_sides=True)
    motor = [(x, y, top - 0.045), (x, y, top - 0.005)]
    shell.tube(motor, (0.016, 0.016), _DARK, sides=sides + 1, both_sides=True)
    for angle in (turn, turn + math.pi):
        along = np.array([exact.cos(angle), exact.sin(angle), 0.0])
        aside, up = np.array([-along[1], along[0], 0.0]), np.array([0.0, 0.0, 1.0])
        rings = [
            np.array(hub) + reach * along + np.outer(half * _ACROSS, aside) + np.outer(_LIFT, up)
            for reach, half in ((0.0, 0.006), (0.35 * _TIP, 0.013), (_TIP, 0.006))
        ]
        shell.rings(rings, _BLADE, both_sides=True)
