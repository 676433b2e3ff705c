"""An elevated road with walls, and the pairs of slender columns that carry it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.solids import box, cylinder
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import TEXTURES, material
from eyas.engine.world.build.millimetres import rounded, unit
from eyas.engine.world.roads.curves import arc
from eyas.maps.build.values import Place, Unit

DECK_WIDTH = 14.0  # Distance between the walls [m]

DECK_DEPTH = 1.5  # Distance from the surface down to the underside [m]

SOLID_BELOW = 7.0  # Height up to which a ramp has solid sides instead of columns [m]

_STATION = 4.5  # Distance between two cross-sections, and length of a dash and of a gap [m]
_PRISM = 4  # Number of stations in each solid of the deck
_WALL = 0.3
_SKIRT = 0.4  # Distance from the surface down to the top of the solid sides [m]

_HALF = DECK_WIDTH / 2
_OUT = _HALF + _WALL
# To the right of the centre and above the surface [m], from the left edge round the walls.
_SECTION = (
    *((-_HALF, 0.0), (_HALF, 0.0), (_HALF, 2.0), (_OUT, 2.0), (_OUT, -0.5)),
    *((4.5, -DECK_DEPTH), (-4.5, -DECK_DEPTH)),
    *((-_OUT, -0.5), (-_OUT, 2.0), (-_HALF, 2.0), (-_HALF, 0.0)),
)

_ASPHALT = material("asphalt")
_CONCRETE = material("concrete", (0.9, 0.9, 0.9))
_WHITE = material("plain", (0.93, 0.93, 0.91))

Points = NDArray[np.float64]


def path(
    corners: ArrayLike,  # Points where the straight pieces would meet [m], shape (C, 2)
    radii: Sequence[float],  # Radius of the arc at each corner except the first and last [m]
    # Share of the whole length and z there [m], with smooth transitions between
    profile: Sequence[tuple[float, float]],
) -> Points:
    """Return the centre line of a road of straight pieces and arcs, shape (K, 3)."""
    points = rounded(corners)
    pieces = [points[:1]]
    for before, corner, after, radius in zip(
        points[:-2], points[1:-1], points[2:], radii, strict=True
    ):
        pieces.append(arc(before, corner, after, radius))
    line = shapely.LineString(np.concatenate([*pieces, points[-1:]]))
    along = np.linspace(0.0, 1.0, round(line.length / _STATION) + 1)
    flat = shapely.get_coordinates(shapely.line_interpolate_point(line, along, normalized=True))
    share, height = np.array(profile).T
    index = np.clip(np.searchsorted(share, along, side="right") - 1, 0, len(share) - 2)
    t = (along - share[index]) / (share[index + 1] - share[index])
    eased = t * t * (3.0 - 2.0 * t)
    return np.column_stack([flat, height[index] + eased * (height[index + 1] - height[index])])


def deck_area(middle: Points) -> shapely.Polygon:
    """Return the area below the deck, in plan view."""
    return shapely.buffer(shapely.LineString(middle[:, :2]), _OUT, cap_style="flat")


def carriageway_mesh(middle: Points) -> Mesh:
    """Return the asphalt and the lines of a deck with this centre line, from `path`."""
    return concatenate(
        [
            _swept(middle, _SECTION[:2], _ASPHALT, TEXTURES["asphalt"]),
            *(_line(middle, offset, 0.15) for offset in (-_HALF + 0.4, 0.0, _HALF - 0.4)),
            *(_line(middle, offset, 0.15, dashed=True) for offset in (-_HALF / 2, _HALF / 2)),
        ]
    )


def sides_mesh(
    middle: Points,  # Centre line from `path`
    floor: float,  # z of the ground [m]
) -> Mesh:
    """Return the walls and the underside of a deck; low parts stand on solid sides."""
    pieces = [_swept(middle, _SECTION[1:], _CONCRETE, TEXTURES["concrete"])]
    # Where a ramp begins, the walls themselves reach into the floor.
    height = middle[:, 2] - floor
    low = np.flatnonzero((height > _SKIRT) & (height < SOLID_BELOW))
    if len(low) > 1:
        sides = middle[low[0] : low[-1] + 1]
        pieces += [_solid_side(sides, sign, floor) for sign in (1.0, -1.0)]
    return concatenate(pieces)


def deck_prisms(middle: Points, floor: float) -> list[tuple[Points, float, float]]:
    """Return solids along the deck: outline, bottom and top of each [m]."""
    across = _OUT * _across(middle)
    made = []
    for first in range(0, len(middle) - 1, _PRISM):
        last = min(first + _PRISM, len(middle) - 1)
        right = middle[first : last + 1, :2] + across[first : last + 1]
        left = middle[first : last + 1, :2] - across[first : last + 1]
        height = middle[first : last + 1, 2]
        bottom = height.min() - DECK_DEPTH
        if bottom < floor + SOLID_BELOW - DECK_DEPTH:
            bottom = floor
        made.append((np.concatenate([right, left[::-1]]), float(bottom), float(height.max() + 2)))
    return made


def _across(middle: Points) -> Points:
    """Return unit vectors to the right of the path, shape (K, 2)."""
    onwards = np.gradient(middle[:, :2], axis=0)
    onwards /= np.linalg.norm(onwards, axis=1, keepdims=True)
    return np.column_stack([onwards[:, 1], -onwards[:, 0]])


def _swept(
    middle: Points, section: Sequence[tuple[float, float]], stuff: Material, tile: float
) -> Mesh:
    """Return the surface that a cross-section (right, up) sweeps along the path."""
    outline = np.array(section)
    across = _across(middle)
    rows = np.empty((len(middle), len(outline), 3))
    rows[..., :2] = middle[:, None, :2] + across[:, None] * outline[:, 0, None]
    rows[..., 2] = middle[:, None, 2] + outline[:, 1]
    corners = np.stack([rows[:-1, :-1], rows[:-1, 1:], rows[1:, 1:], rows[1:, :-1]], axis=2)
    around = np.concatenate([[0.0], np.linalg.norm(np.diff(outline, axis=0), axis=1).cumsum()])
    along = np.arange(len(middle)) * _STATION
    u, v = np.meshgrid(around / tile, along / tile)
    grid = np.stack([u, v], axis=-1)
    uvs = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2)
    return quads(corners.reshape(-1, 4, 3), uvs.reshape(-1, 4, 2), stuff)


def _line(middle: Points, offset: float, width: float, *, dashed: bool = False) -> Mesh:
    section = ((offset - width / 2, 0.035), (offset + width / 2, 0.035))
    whole = _swept(middle, section, _WHITE, 1.0)
    if not dashed:
        return whole
    dashes = [_swept(middle[k : k + 2], section, _WHITE, 1.0) for k in range(0, len(middle) - 1, 2)]
    return concatenate(dashes)


def _solid_side(middle: Points, sign: float, floor: float) -> Mesh:
    line = middle[:, :2] + sign * (_OUT - 0.02) * _across(middle)
    top = middle[:, 2] - _SKIRT
    low = np.column_stack([line, np.full(len(line), floor)])
    high = np.column_stack([line, top])
    corners = np.stack([low[:-1], low[1:], high[1:], high[:-1]], axis=1)
    along = np.arange(len(line)) * _STATION
    flat = np.stack([np.column_stack([along, np.full(len(line), floor)]),
                     np.column_stack([along, top])], axis=1)  # fmt: skip
    uvs = np.stack([flat[:-1, 0], flat[1:, 0], flat[1:, 1], flat[:-1, 1]], axis=1)
    if sign < 0:
        corners, uvs = corners[:, ::-1], uvs[:, ::-1]
    return quads(corners, uvs / TEXTURES["concrete"], _CONCRETE)


COLUMN_RADIUS = 0.8
"""Radius of a column at the top [m]."""

BASE_HEIGHT = 1.4
"""Height of the stone base below a pair of columns [m]."""

_COLUMN_GAP = 5.0
_BASE = (9.0, 3.6, BASE_HEIGHT)

_STONE = material("stone", (0.85, 0.83, 0.8))


@dataclass(frozen=True, slots=True)
class Pillar:
    """Two columns on a base, below the deck."""

    place: Place
    """Middle on the ground [m], shape (2,)."""
    across: Unit
    """Unit vector from the left to the right column, shape (2,)."""
    top: float
    """z of the underside of the deck [m]."""

    @property
    def base(self) -> shapely.Polygon:
        """Outline of the base [m]."""
        along = np.array([-self.across[1], self.across[0]])
        x, y = _BASE[0] / 2 * self.across, _BASE[1] / 2 * along
        return shapely.Polygon([self.place + x * a + y * b
                                for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])  # fmt: skip

    @property
    def columns(self) -> Points:
        """Centres of both columns [m], shape (2, 2)."""
        return self.place + np.outer([-0.5, 0.5], _COLUMN_GAP * self.across)


def pillars(
    middle: Points,  # Centre line from `path`
    count: int,  # Number of pillars; those without room beside a road are left out
    floor: float,  # z of the ground [m]
    roads: shapely.Geometry,  # Area where none may stand
) -> list[Pillar]:
    """Return pillars below the high part of the deck, evenly spaced where no road is in the way."""
    high = np.flatnonzero(middle[:, 2] > floor + SOLID_BELOW + 1.0)
    if len(high) == 0:
        return []
    blocked = shapely.buffer(roads, 0.8)
    shapely.prepare(blocked)
    made = []
    for wish in np.linspace(high[0] + 1, high[-1] - 2, count).round().astype(int):
        for shift in (0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6):
            pillar = _pillar(middle, int(np.clip(wish + shift, high[0], high[-1])))
            if not shapely.intersects(blocked, pillar.base):
                made.append(pillar)
                break
    return made


def pillar_mesh(pillar: Pillar, floor: float) -> Mesh:
    """Return a pillar with its base and the beam below the deck."""
    x, y = pillar.across
    pose = np.array([[x, -y, 0, pillar.place[0]], [y, x, 0, pillar.place[1]], [0, 0, 1, 0.0]])
    column = cylinder(
        (1.15 * COLUMN_RADIUS, COLUMN_RADIUS),
        (floor + 1.0, pillar.top - 1.0),
        14,
        _CONCRETE,
        tile=TEXTURES["concrete"],
    )
    parts = [
        box(_BASE, (0, 0, floor + BASE_HEIGHT / 2), _STONE, TEXTURES["stone"]),
        box((9.4, 2.2, 1.5), (0, 0, pillar.top - 0.5), _CONCRETE, TEXTURES["concrete"]),
    ]
    for side in (-0.5, 0.5):
        aside = np.hstack([np.eye(3), [[side * _COLUMN_GAP], [0.0], [0.0]]])
        parts.append(transformed(column, aside))
    return transformed(concatenate(parts), pose)


def _pillar(middle: Points, station: int) -> Pillar:
    onwards = unit(middle[station + 1, :2] - middle[station - 1, :2])
    across = np.array([onwards[1], -onwards[0]])
    return Pillar(middle[station, :2].copy(), across, float(middle[station, 2] - DECK_DEPTH))
