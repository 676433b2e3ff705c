"""Detached houses as fixtures: white cubes with pyramid roofs, doors and chimneys.

The origin is on the ground in the middle of the house; the front faces along y.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import flat_polygon, quads, walls
from eyas.engine.mesh.solids import box
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.world.build.materials import TEXTURES, material
from eyas.engine.world.build.scene_builder import Levels
from eyas.lanes import exact
from eyas.maps.buildings import parts
from eyas.maps.buildings.skyline import FLOOR

SIDE = 20.0  # Length of the walls [m]

ROOF = 3.6  # Height of the roof above the eaves [m]
_EAVES = 0.9  # Distance from the wall to the edge of the roof [m]

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Cottage:
    """A house in plan view."""

    place: Points  # Its middle [m], shape (2,)
    turn: float  # Angle of its front from north, counter-clockwise [rad]
    storeys: int  # Number of storeys
    look: int  # Index of its look

    @property
    def outline(self) -> Points:
        """Corners of its walls, counter-clockwise [m], shape (4, 2)."""
        return outline_at(self.place, self.turn)


_SQUARE = 0.5 * SIDE * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
_DOOR = material("plain", (0.36, 0.22, 0.14))
_FRAME = material("plain", (0.93, 0.93, 0.91))
_CHIMNEY = material("brick", (0.95, 0.9, 0.86))
_DARK = material("plain", (0.12, 0.11, 0.10))
_PANE = Material(tint=(0.10, 0.13, 0.20), surface=Surface.GLASS)
_ON_ROOF = (
    *((x, 5.2, 1.3, 1.5, over) for x in (-4.6, -1.2, 2.4) for over in (0.05, 0.08)),
    *((1.75 * k - 2.6, -6.0, 1.65, 3.6, 0.1) for k in range(4)),
)
"""Windows with their frames on the front slope, solar panels on the back: middle, width, length
and height above the tiles [m]."""


def outline_at(place: Points, turn: float) -> Points:
    """Return the corners of the walls of a house, counter-clockwise [m], shape (4, 2)."""
    cosine, sine = exact.cos(turn), exact.sin(turn)
    turned = exact.product(_SQUARE, np.array([[cosine, sine], [-sine, cosine]]))
    return np.asarray(place + turned, np.float64)


def cottage_levels(storeys: int, wall: Material, tiles: Material) -> Levels:
    """Return a house in two levels of detail."""
    top = storeys * FLOOR
    rng = np.random.default_rng(storeys)
    shell = [
        parts.window_wall(_SQUARE, 0.0, top, wall, rng.integers(0, 4, (4, 2))),
        _roof(top, tiles),
        walls(_SQUARE * (1.0 + 2 * _EAVES / SIDE), top - 0.25, top, _FRAME, 4.0),
    ]
    return concatenate([*shell, *_details(top, storeys)]), concatenate(shell)


def _roof(top: float, tiles: Material) -> Mesh:
    """Return four slopes with their undersides."""
    eaves = _SQUARE * (1.0 + 2 * _EAVES / SIDE)
    rim = np.column_stack([eaves, np.full(4, top)])
    peak = np.array([0.0, 0.0, top + ROOF])
    half, slope = SIDE / 2 + _EAVES, float(exact.hypot(SIDE / 2 + _EAVES, ROOF))
    made = []
    for k in range(4):
        one, other = rim[k], rim[(k + 1) % 4]
        # A quadrilateral whose upper side is short, not a point: empty triangles have no normal.
        corners = [one, other, peak + 0.01 * (other - peak), peak + 0.01 * (one - peak)]
        uvs = np.array([(-half, 0.0), (half, 0.0), (0.01 * half, slope), (-0.01 * half, slope)])
        made.append(quads([corners], [uvs / TEXTURES[tiles.texture]], tiles))
    soffit = flat_polygon(shapely.Polygon(eaves), top - 0.25, _FRAME, 1.0)
    soffit.triangles = np.ascontiguousarray(soffit.triangles[:, ::-1])
    soffit.normals = -soffit.normals
    return concatenate([*made, soffit])


def _details(top: float, storeys: int) -> list[Mesh]:
    """Return door, porch, balconies and chimneys."""
    front = SIDE / 2
    made = [
        box((1.5, 0.12, 2.3), (0.0, front + 0.04, 1.15), _DOOR, 1.0),
        box((2.0, 0.08, 2.6), (0.0, front + 0.02, 1.3), _FRAME, 1.0),
        box((3.4, 1.7, 0.18), (0.0, front + 0.8, 2.85), _FRAME, 1.0),
        box((0.16, 0.16, 2.8), (-1.5, front + 1.5, 1.4), _FRAME, 1.0),
        box((0.16, 0.16, 2.8), (1.5, front + 1.5, 1.4), _FRAME, 1.0),
        box((3.0, 1.8, 0.16), (0.0, front + 0.9, 0.08), material("stone"), 4.0),
        box((1.3, 1.3, 2.6), (5.2, -3.4, top + 2.3), _CHIMNEY, 4.0),
        box((1.5, 1.5, 0.2), (5.2, -3.4, top + 3.65), _FRAME, 1.0),
        box((0.7, 0.7, 0.06), (5.2, -3.4, top + 3.78), _DARK, 1.0),
    ]
    for x, y, wide, long, over in _ON_ROOF[6 * (storeys % 2) :]:
        frame, way = 0.12 * (over < 0.06), float(np.sign(y))
        right, ends = way * (0.5 * wide + frame), y + way * np.array([1.0, -1.0]) * (0.5 * long)
        (low, high), rise = ends + way * np.array([frame, -frame]), top + over + ROOF
        slope = ROOF / (front + _EAVES)
        corners = [
            (x + side, at, rise - slope * abs(at))
            for side, at in ((right, low), (-right, low), (-right, high), (right, high))
        ]
        made.append(quads([corners], [np.zeros((4, 2))], _FRAME if frame else _PANE))
    for storey in range(1, storeys):
        floor = storey * FLOOR
        made += [
            box((5.6, 1.3, 0.14), (-5.4, front + 0.65, floor), _FRAME, 1.0),
            box((5.6, 0.06, 0.9), (-5.4, front + 1.27, floor + 0.5), _FRAME, 1.0),
        ]
    return made
