"""Layout of the farmland: squares of one crop each, in rows beside the roads."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from eyas.engine.state.mesh import Material
from eyas.engine.world.build.materials import material
from eyas.engine.world.weather import Season
from eyas.maps.farmland.roads import ROAD_WIDTH

FLOOR = (982.0, 998.0)  # Extent of the floor, as in the original [m]

SIDE = 80.0  # Largest side of a field [m]
VERGE = 1.6  # Soil between a road and a field, and the least between two fields [m]
_FEWEST = 64.0
"""A strip between roads gets another row of fields when each keeps at least this side [m]."""


@dataclass(frozen=True, slots=True)
class Crop:
    """A crop in both seasons."""

    name: str
    summer: Material
    winter: Material
    height: float  # z of its top [m]
    share: float  # Share of the fields on which it grows, as in the original

    def look(self, season: Season) -> Material:
        """Return its material in a season."""
        return self.winter if season is Season.WINTER else self.summer


_TAN, _YELLOW = material("crops_tan"), material("crops_yellow")

# order: bytes of plans depend on it, whose fields hold an index of it
CROPS = (
    Crop("green", material("crops_green"), material("snow", (0.97, 0.97, 0.98)), 0.22, 19 / 68),
    Crop("yellow", _YELLOW, _TAN, 0.42, 18 / 68),
    Crop("tan", _TAN, _TAN, 0.05, 18 / 68),
    Crop("lilac", material("crops_lilac"), material("crops_tan", (0.72, 0.82, 1.0)), 0.30, 13 / 68),
)
"""The four crops; taller ones stand out a little from the soil."""


@dataclass(frozen=True, slots=True)
class FieldLot:
    """A rectangular field."""

    area: shapely.Polygon  # [m]
    crop: int  # Index into `CROPS`
    north: bool  # Whether its rows run north, not east
    shade: float  # Factor on its colour, near 1


def lay_out(
    x: Sequence[float],  # Middles of the roads that run north, from the west [m]
    y: Sequence[float],  # Middles of the roads that run east, from the south [m]
    rng: np.random.Generator,
) -> list[FieldLot]:
    """Return the fields in the cells and in a ring around them; neighbours differ."""
    columns, rows = _spans(x), _spans(y)
    made: list[FieldLot] = []
    kinds = np.full((len(columns) + 1, len(rows) + 1), -1)
    for i, (west, east) in enumerate(columns):
        for j, (south, north) in enumerate(rows):
            odds = np.array([crop.share for crop in CROPS])
            odds[[kind for kind in (kinds[i - 1, j], kinds[i, j - 1]) if kind >= 0]] *= 0.06
            kinds[i, j] = rng.choice(len(CROPS), p=odds / odds.sum())
            made.append(
                FieldLot(
                    shapely.box(west, south, east, north),
                    int(kinds[i, j]),
                    bool(rng.integers(2)),
                    float(rng.uniform(0.9, 1.0)),
                )
            )
    return made


def _spans(roads: Sequence[float]) -> list[tuple[float, float]]:
    """Return the extents of fields along one axis; what soil is left over lies between them."""
    beside = ROAD_WIDTH / 2 + VERGE
    spans = [(roads[0] - beside - SIDE, roads[0] - beside)]
    for low, high in pairwise(roads):
        start, end = low + beside, high - beside
        count = int((end - start + VERGE) // (_FEWEST + VERGE))
        side = min(SIDE, (end - start - (count - 1) * VERGE) / count)
        gap = (end - start - count * side) / max(count - 1, 1)
        spans += [(start + k * (side + gap), start + k * (side + gap) + side) for k in range(count)]
    spans.append((roads[-1] + beside, roads[-1] + beside + SIDE))
    return [(round(low, 3), round(high, 3)) for low, high in spans]
