"""Trunks of people: chest and garment, hips; their origin is between the hips."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from art.jointed.people.clothing import HIPS, LEG, TORSO, cloth
from art.jointed.people.person import Build, Carried, Garment, Lower
from art.jointed.people.surfaces import Row, wrapped
from art.parts import Shape
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material
from eyas.engine.targets.kind import Colour
from eyas.lanes import exact

Points = NDArray[np.float64]

_BODIES: dict[Build, tuple[Row, ...]] = {
    Build.MAN: (
        (0.0, 0.118, 0.122, 0.172), (0.14, 0.108, 0.108, 0.155), (0.30, 0.120, 0.116, 0.172),
        (0.40, 0.122, 0.118, 0.188), (0.465, 0.098, 0.112, 0.200), (0.505, 0.072, 0.094, 0.155),
        (0.53, 0.055, 0.082, 0.098), (0.555, 0.050, 0.066, 0.066),
    ),
    Build.WOMAN: (
        (0.0, 0.115, 0.130, 0.178), (0.15, 0.098, 0.098, 0.130), (0.28, 0.112, 0.108, 0.146),
        (0.37, 0.140, 0.108, 0.158), (0.455, 0.092, 0.100, 0.174), (0.500, 0.064, 0.084, 0.132),
        (0.525, 0.050, 0.074, 0.085), (0.55, 0.045, 0.060, 0.058),
    ),
    Build.STOUT: (
        (0.0, 0.165, 0.140, 0.200), (0.12, 0.200, 0.128, 0.200), (0.27, 0.182, 0.128, 0.198),
        (0.40, 0.150, 0.130, 0.205), (0.465, 0.108, 0.122, 0.212), (0.505, 0.080, 0.102, 0.165),
        (0.53, 0.062, 0.090, 0.108), (0.555, 0.055, 0.074, 0.074),
    ),
    Build.CHILD: (
        (0.0, 0.122, 0.122, 0.160), (0.14, 0.120, 0.108, 0.152), (0.30, 0.116, 0.108, 0.160),
        (0.40, 0.108, 0.104, 0.170), (0.465, 0.090, 0.098, 0.176), (0.505, 0.068, 0.086, 0.140),
        (0.53, 0.058, 0.078, 0.094), (0.555, 0.052, 0.066, 0.070),
    ),
}  # fmt: skip
"""Outlines of bodies from the hips to the neck."""

_MARKS = (0.0, 0.2, 0.45, 0.68, 0.82, 0.91, 0.96, 1.0)  # Where they are in `TORSO`

_EASE = {
    Garment.T_SHIRT: 0.004, Garment.SHIRT: 0.008, Garment.HOODIE: 0.02, Garment.JACKET: 0.02,
    Garment.OPEN_JACKET: 0.02, Garment.DOWN_JACKET: 0.04, Garment.COAT: 0.026, Garment.DRESS: 0.002,
}  # fmt: skip
"""How far a garment stands off the body [m]."""

_HEM = {Garment.T_SHIRT: -0.05, Garment.SHIRT: -0.06, Garment.OPEN_JACKET: -0.09}


@cache
def chest(
    garment: Garment,  # What it is
    build: Build,  # Of the body in it
    cut: str,  # See `Person.cut`
    inner: Colour,  # Colour of what shows under a collar
) -> Shape:
    """Return a garment from its hem to the neck."""

    def shape(shell: Shell, detail: int) -> None:
        sides = (5, 7, 10)[detail]
        rows, ups = _rows(garment, build)
        wrapped(shell, rows, ups, TORSO, cloth(cut), sides=sides, box=0.25)
        if detail == 0:
            return
        _collar(shell, garment, rows[-1], inner, sides)
        if garment is Garment.OPEN_JACKET:
            _opening(shell, rows, inner)

    return shape


def _rows(garment: Garment, build: Build) -> tuple[list[Row], list[float]]:
    """Return the outlines of a garment, and their places in the texture."""
    ease = _EASE[garment]
    body = [
        (z, ahead + ease * share, back + ease * share, half + ease * share)
        for (z, ahead, back, half), share in zip(
            _BODIES[build], (1.0, 1.0, 1.0, 1.0, 0.8, 0.8, 0.8, 0.6), strict=True
        )
    ]
    ups = list(_MARKS)
    _, ahead, back, half = body[0]
    if garment.is_long:
        flare = 0.1 if garment is Garment.DRESS else 0.075
        low = [
            (-0.38, ahead + flare, back + flare, half + 0.45 * flare),
            (-0.19, ahead + 0.5 * flare, back + 0.5 * flare, half + 0.25 * flare),
        ]
        end = -1 if garment is Garment.DRESS else None
        return [*low, *body[:end]], [0.0, 0.05, 0.1, *ups[1:end]]
    hem = _HEM.get(garment, -0.07)
    # It hangs before the thighs, which swing out below it.
    rows = [
        (hem, max(ahead, _BODIES[build][0][1] + 0.022) + 0.004, back + 0.006, half + 0.006),
        *body,
    ]
    ups = [0.0, 0.08, *ups[1:]]
    if garment in (Garment.T_SHIRT, Garment.SHIRT, Garment.HOODIE):
        return rows[:-1], ups[:-1]
    return rows, ups


def _collar(shell: Shell, garment: Garment, top: Row, inner: Colour, sides: int) -> None:
    """Add what lies around the neck: a collar, a hood that hangs down, a scarf."""
    z, ahead, back, half = top
    if garment is Garment.HOODIE:
        hood = [
            (z - 0.075, 0.0, back + 0.075, half + 0.06),
            (z - 0.02, 0.03, back + 0.09, half + 0.05),
            (z + 0.03, 0.03, back + 0.06, half + 0.03),
            (z + 0.02, 0.02, back, half),
        ]
        wrapped(shell, hood, (0.6, 0.8, 0.95, 0.5), TORSO, cloth(), sides=sides)
    elif garment in (Garment.JACKET, Garment.OPEN_JACKET, Garment.DOWN_JACKET, Garment.COAT):
        stand = [(z - 0.03, ahead + 0.012, back + 0.014, half + 0.014),
                 (z + 0.028, ahead + 0.014, back + 0.016, half + 0.012)]  # fmt: skip
        wrapped(shell, stand, (0.9, 1.0), TORSO, cloth(), sides=sides)
        shirt = [(z, ahead + 0.004, back - 0.01, half - 0.002),
                 (z + 0.012, ahead + 0.004, back - 0.012, half - 0.004)]  # fmt: skip
        wrapped(shell, shirt, (0.9, 1.0), TORSO, cloth(tint=inner), sides=sides)
    elif garment is Garment.SHIRT:
        stand = [(z - 0.022, ahead + 0.014, back + 0.008, half + 0.012),
                 (z + 0.03, ahead - 0.002, back - 0.002, half - 0.026)]  # fmt: skip
        wrapped(shell, stand, (0.97, 1.0), TORSO, cloth(), sides=sides)


def _front(rows: list[Row], sides: float, off: float) -> Points:
    """Return points on the front of outlines, beside its middle by `sides` of their width."""
    angle = np.pi * sides
    power = 1.0 - 0.7 * 0.25
    c = exact.power(exact.cos(np.array([abs(angle)])), power)[0]
    s = np.sign(angle) * exact.power(exact.sin(np.array([abs(angle)])), power)[0]
    return np.array([((a + off) * c, half * s, z) for z, a, _, half in rows])


def _opening(shell: Shell, rows: list[Row], inner: Colour) -> None:
    """Add the strip of a shirt that shows in an open jacket."""
    right, left = _front(rows[:-1], -0.07, 0.006), _front(rows[:-1], 0.07, 0.006)
    ups = np.linspace(0.05, 0.95, len(right))
    for k in range(len(right) - 1):
        corners = [right[k], left[k], left[k + 1], right[k + 1]]
        uvs = TORSO.at([0.45, 0.55, 0.55, 0.45], [ups[k], ups[k], ups[k + 1], ups[k + 1]])
        shell.quads(corners, cloth(tint=inner), uvs=uvs)


def straps(shell: Shell, build: Build, carried: Carried) -> None:
    """Add the straps of a bag over the shoulders, or one across the chest."""
    rows = list(_BODIES[build])
    dark = cloth(tint=(0.16, 0.16, 0.17))
    upper = [row for row in rows if row[0] >= 0.1]
    if carried is Carried.BACKPACK:
        for side in (-1.0, 1.0):
            inside, outside = (_front(upper[:-1], share * side, 0.032) for share in (0.15, 0.22))
            _strip(shell, *((inside, outside) if side > 0 else (outside, inside)), dark)
        return
    places = np.linspace(-0.42, 0.3, len(upper))
    right, left = (
        np.array([_front([row], p + d, 0.032)[0] for row, p in zip(upper, places, strict=True)])
        for d in (-0.035, 0.035)
    )
    _strip(shell, right, left, dark)


def _strip(shell: Shell, right: Points, left: Points, material: Material) -> None:
    for k in range(len(right) - 1):
        corners = [right[k], left[k], left[k + 1], right[k + 1]]
        shell.quads(corners, material, uvs=LEG.at([0.6, 0.7, 0.7, 0.6], [0.6, 0.6, 0.7, 0.7]))


@cache
def hips(lower: Lower, build: Build) -> Shape:
    """Return the upper end of trousers or a skirt, in the colour of the instance."""

    def shape(shell: Shell, detail: int) -> None:
        sides = (5, 7, 10)[detail]
        _, ahead, back, half = _BODIES[build][0]
        belt = (0.05, ahead - 0.008, back - 0.012, half - 0.012)
        if lower is Lower.SKIRT:
            rows = [
                (-0.36, ahead + 0.085, back + 0.07, half + 0.03),
                (-0.16, ahead + 0.03, back + 0.03, half + 0.01),
                (-0.03, ahead - 0.002, back - 0.002, half - 0.004),
                belt,
            ]
            wrapped(shell, rows, (0.0, 0.25, 0.45, 0.5), TORSO, cloth(), sides=sides, box=0.2)
            return
        rows = [(-0.13, 0.07, 0.075, 0.12), (-0.09, ahead - 0.022, back - 0.012, half - 0.012),
                (-0.02, ahead - 0.006, back - 0.004, half - 0.004), belt]  # fmt: skip
        wrapped(shell, rows, (0.0, 0.2, 0.6, 1.0), HIPS, cloth(), sides=sides, box=0.25)

    return shape
