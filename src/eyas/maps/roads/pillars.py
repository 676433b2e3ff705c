"""Pairs of slender columns that carry an elevated road."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.mesh.solids import box, cylinder
from eyas.engine.state.mesh import Mesh
from eyas.engine.world.build.materials import TEXTURES, material
from eyas.engine.world.build.millimetres import unit
from eyas.maps.build.values import Place, Unit
from eyas.maps.roads.overpass import DECK_DEPTH, SOLID_BELOW

__all__ = ["BASE_HEIGHT", "COLUMN_RADIUS", "Pillar", "pillar_mesh", "pillars"]

COLUMN_RADIUS = 0.8
"""Radius of a column at the top [m]."""

BASE_HEIGHT = 1.4
"""Height of the stone base below a pair of columns [m]."""

_COLUMN_GAP = 5.0
_BASE = (9.0, 3.6, BASE_HEIGHT)
_CONCRETE = material("concrete", (0.9, 0.9, 0.9))
_STONE = material("stone", (0.85, 0.83, 0.8))

Points = NDArray[np.float64]


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


def pillars(middle: Points, count: int, floor: float, roads: shapely.Geometry) -> list[Pillar]:
    """Return pillars below the high part of the deck, evenly spaced where no road is in the way.

    Args:
        middle: Centre line from `path`.
        count: Number of pillars; those without room beside a road are left out.
        floor: z of the ground [m].
        roads: Area where none may stand.
    """
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
