"""The shape of a bird: a body and two wings."""

from itertools import pairwise

from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Mesh, Surface

_FEATHERS = Material(surface=Surface.PAINT)
_TIPS = Material(tint=(0.20, 0.20, 0.21), surface=Surface.PAINT)
_BILL = Material(tint=(0.55, 0.38, 0.10))

_HULL = (
    (-0.26, 0.045, -0.005, 0.010),
    (-0.16, 0.025, -0.020, 0.025),
    (-0.02, 0.055, -0.055, 0.050),
    (0.12, 0.050, -0.050, 0.045),
    (0.19, 0.030, -0.025, 0.040),
    (0.235, 0.020, -0.010, 0.025),
)
"""Sections from the tail to the head: forward, half width, bottom, top [m]."""

_WING = ((0.0, 0.075, -0.065), (0.25, 0.085, -0.045), (0.42, 0.03, -0.075), (0.56, -0.075, -0.105))
"""Sections of a wing: left of the shoulder, leading and trailing edge forward of it [m]."""


def _body() -> Mesh:
    shell = Shell()
    shell.rings([_section(*section) for section in _HULL], _FEATHERS)
    shell.box((0.235, -0.008, 0.0), (0.27, 0.008, 0.014), _BILL)
    return shell.mesh()


def _section(x: float, half: float, low: float, high: float) -> list[tuple[float, float, float]]:
    """Return an outline, counter-clockwise as seen from ahead."""
    middle, edge = 0.5 * (low + high), 0.6 * half
    outline = [(-edge, high), (-half, middle), (-edge, low), (edge, low), (half, middle)]
    return [(x, y, z) for y, z in [*outline, (edge, high)]]


def _wing(side: float) -> Mesh:
    """Return the left wing (side 1) or the right one (-1), from its shoulder."""
    shell = Shell()
    for inner, outer in pairwise(_WING):
        (y, front, back), (over, front_over, back_over) = inner, outer
        colour = _TIPS if outer is _WING[-1] else _FEATHERS
        for up in (1.0, -1.0):
            z = 0.004 * up
            corners = [
                (front, side * y, z),
                (front_over, side * over, z),
                (back_over, side * over, z),
                (back, side * y, z),
            ]
            shell.quads(corners[::-1] if side * up < 0.0 else corners, colour)
    return shell.mesh()


def bird_parts() -> list[tuple[Mesh, ...]]:
    """Return the levels of detail of body, left and right wing."""
    return [(_body(),), (_wing(1.0),), (_wing(-1.0),)]
