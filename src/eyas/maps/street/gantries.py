"""Blue direction signs on gantries over roads."""

import numpy as np

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.solids import box, tube
from eyas.engine.state.mesh import Mesh
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import Levels

SPAN = 16.6  # Distance of the two posts, as in the original [m]

POST_RADIUS = 0.2
_BEAM = 6.0  # Height of the beam [m]
POST_TOP = _BEAM + 0.4  # z of the top of the solid posts [m]
_UNDER = 5.6  # z of the lowest edge of a board: higher than any vehicle [m]
_STEEL = material("plain", (0.62, 0.64, 0.66))
_BLUE = material("plain", (0.08, 0.22, 0.62))
_WHITE = material("plain", (0.95, 0.95, 0.95))

_BOARDS: tuple[tuple[tuple[float, float, float], ...], ...] = (
    ((-3.6, 6.0, 2.9),),
    ((-3.6, 6.0, 2.5), (3.9, 3.2, 2.1)),
    ((-4.2, 3.2, 2.1), (-0.6, 3.2, 2.1)),
)
"""Boards of each kind: middle across the road, width, height [m]."""

KINDS = len(_BOARDS)  # Number of kinds


def boards_of(number: int) -> tuple[float, float]:
    """Return z of the lowest and the highest edge of the boards of a kind [m]."""
    return _UNDER, max(height for _, _, height in _BOARDS[number]) + _UNDER


def gantry_levels(number: int) -> Levels:
    """Return a gantry over a road along x; its boards face backwards, to who drives along x."""
    return _gantry(number, 8, fine=True), _gantry(number, 4, fine=False)


def _gantry(number: int, sides: int, *, fine: bool) -> Mesh:
    half = SPAN / 2
    made = [box((0.28, SPAN, 0.3), (0.0, 0.0, _BEAM), _STEEL, 1.0)]
    made.append(box((0.2, SPAN, 0.16), (0.0, 0.0, _BEAM + 0.9), _STEEL, 1.0))
    for side in (-half, half):
        post = np.array([[0, side, -0.2], [0, side, 3.0], [0, side, _BEAM + 1.0]])
        made.append(tube(post, [POST_RADIUS, 0.17, 0.15], sides, _STEEL))
        if fine:
            made.append(box((0.9, 0.9, 0.25), (0.0, side, 0.02), material("concrete"), 6.0))
    if fine:
        made += [
            box((0.1, 0.1, 0.9), (0.0, y, _BEAM + 0.45), _STEEL, 1.0)
            for y in np.arange(-half + 1.2, half, 1.8)
        ]
    for middle, width, height in _BOARDS[number]:
        made += _board(middle, width, height, fine=fine)
    return concatenate(made)


def _board(middle: float, width: float, height: float, *, fine: bool) -> list[Mesh]:
    """Return a board with a white rim, an arrow and lines of writing."""
    centre = _UNDER + height / 2
    made = [
        box((0.10, width, height), (-0.22, middle, centre), _WHITE, 1.0),
        box((0.02, width - 0.24, height - 0.24), (-0.275, middle, centre), _BLUE, 1.0),
    ]
    if fine:
        rows = max(int(height / 0.75), 1)
        for row in range(rows):
            z = _UNDER + height - 0.55 - 0.68 * row
            wide = width * (0.55 if row % 2 else 0.66)
            at = (-0.29, middle - 0.06 * width, z)
            made.append(box((0.015, wide, 0.26), at, _WHITE, 1.0))
        beside = middle + 0.4 * width
        for across, tall, z in ((0.16, 0.6 * height, centre), (0.5, 0.16, centre + 0.3 * height)):
            made.append(box((0.015, across, tall), (-0.29, beside, z), _WHITE, 1.0))
    return made
