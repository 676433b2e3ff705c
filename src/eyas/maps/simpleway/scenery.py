"""Scenery of the simple maps: the kinds of ground, and what lies between the roads on each."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.lighting import Horizon
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.world.build.materials import material, without_snow
from eyas.engine.world.build.millimetres import rounded

Points = NDArray[np.float64]

_STRIP_REACH = 2000.0  # Distance from the middle of the map to the ends of coloured strips [m]
_OUTER_STRIP = 350.0  # Width of the strips beyond the outer roads [m]
_FROM_ROAD = (7.5, 16.0)  # From the middle of a road to the strips beside it, least and most [m]
_SQUARES, _SQUARE = 35, 300.0  # Number and side of the white squares in the desert's winter [m]
_SQUARE_ROWS = 7


@dataclass(frozen=True, slots=True)
class Patch:
    """A part of the ground that looks different."""

    area: shapely.Geometry  # [m]
    cover: Material
    in_winter: bool = False  # Whether it is there only in winter


@dataclass(frozen=True, slots=True)
class Skin:
    """A kind of ground."""

    ground: Material
    tints: tuple[tuple[float, float, float], ...] = ((0.93, 0.93, 0.93), (0.96, 0.94, 0.9))
    """Factors on its colour in patches."""
    patches: Callable[[Points, np.random.Generator], list[Patch]] = field(
        default=lambda lines, rng: []
    )
    """Returns what else lies between the roads, given their ends."""
    winter: Material = field(default_factory=lambda: material("snow"))
    """Ground in winter; sand under bars stays bare."""
    bars: bool = False  # Whether bars of sand lie across the roads
    horizon: Horizon = field(default_factory=Horizon)


def _coloured(material_name: str, tint: tuple[float, float, float]) -> Material:
    """Return a crop that snow leaves as it is: in the original's winter only the soil is white."""
    return without_snow(material(material_name, tint))


_WATER = Material("water", (0.38, 0.59, 0.85), Surface.WATER)
_PINK = _coloured("crops_lilac", (1.0, 0.90, 0.60))
_GREEN = _coloured("crops_green", (1.0, 1.0, 0.62))
_OCHRE = _coloured("crops_yellow", (0.86, 0.72, 0.42))
_BROWN = _coloured("crops_tan", (0.74, 0.72, 0.70))
_OLIVE = _coloured("crops_yellow", (0.78, 0.90, 0.80))
# order: bytes of plans depend on it, which draw a permutation of it
_STRIPS = (*(4 * [_WATER]), *(3 * [_PINK]), *(3 * [_GREEN]), *(3 * [_OCHRE]),
           *(2 * [_BROWN]), *(2 * [_OLIVE]))  # fmt: skip
"""What lies in the 17 strips of the farm, in any order."""


def _column(lines: Points, index: int, margins: tuple[float, float]) -> shapely.Polygon:
    """Return the ground from a road, or the edge of the map, to the next road in the east."""
    reached = []
    for south, north in lines:
        slope = (north[0] - south[0]) / (north[1] - south[1])
        ends = [south[0] + slope * (y - south[1]) for y in (-_STRIP_REACH, _STRIP_REACH)]
        reached.append(ends)
    x = np.array(reached)
    x = np.concatenate([x[:1] - _OUTER_STRIP, x, x[-1:] + _OUTER_STRIP])
    west, east = x[index] + margins[0], x[index + 1] - margins[1]
    return shapely.Polygon(
        rounded(
            [
                (west[0], -_STRIP_REACH),
                (east[0], -_STRIP_REACH),
                (east[1], _STRIP_REACH),
                (west[1], _STRIP_REACH),
            ]
        )
    )


def _farm_strips(lines: Points, rng: np.random.Generator) -> list[Patch]:
    covers = [_STRIPS[int(k)] for k in rng.permutation(len(_STRIPS))]
    sides = rng.uniform(*_FROM_ROAD, (len(covers), 2))
    return [
        Patch(_column(lines, index, (side[0], side[1])), cover)
        for index, (cover, side) in enumerate(zip(covers, sides, strict=True))
    ]


def _lake_strips(lines: Points, rng: np.random.Generator) -> list[Patch]:
    """Return water in every other column."""
    made = []
    for index in range(0, len(lines) + 1, 2):
        side = rng.uniform(*_FROM_ROAD, 2)
        made.append(Patch(_column(lines, index, (side[0], side[1])), _WATER))
    return made


def _white_squares(lines: Points, rng: np.random.Generator) -> list[Patch]:
    """Return squares that are white in winter."""
    snow = material("snow")
    rows = np.linspace(-1200.0, 1200.0, _SQUARE_ROWS)
    sites = rng.permutation((len(lines) - 1) * _SQUARE_ROWS)[:_SQUARES]
    made = []
    for site in np.sort(sites):
        column, row = divmod(int(site), _SQUARE_ROWS)
        middle = lines[column : column + 2, :, 0].mean() + rng.uniform(-22.0, 22.0)
        west, south = rounded([middle - _SQUARE / 2, rows[row] - _SQUARE / 2])
        square = shapely.box(west, south, west + _SQUARE, south + _SQUARE)
        made.append(Patch(square, snow, in_winter=True))
    return made


_LAWN = material("lawn")
_GREY_SNOW = material("snow", (0.90, 0.90, 0.89))
"""As in the original, snow is less white in the village and on fields."""
_SOIL = material("soil", (1.0, 0.92, 0.78))

SKINS: dict[str, Skin] = {
    "grass": Skin(_LAWN, ((0.97, 0.93, 0.80), (0.84, 0.91, 0.83))),
    "village": Skin(
        material("lawn", (0.78, 0.90, 0.86)),
        horizon=Horizon("green", 0.07, 0.6, 1.0),
        winter=_GREY_SNOW,
    ),
    "clinker": Skin(material("concrete", (0.86, 0.87, 0.88)), horizon=Horizon("plain", 0.0)),
    "desert": Skin(
        material("sand", (1.0, 0.93, 0.62)),
        ((0.96, 0.95, 0.93), (1.0, 0.97, 0.92)),
        _white_squares,
        bars=True,
        horizon=Horizon("dunes", 0.03, 0.1, 0.0),
    ),
    "farm": Skin(_SOIL, patches=_farm_strips, winter=_GREY_SNOW),
    "lake": Skin(_SOIL, patches=_lake_strips),
    "city": Skin(_LAWN, horizon=Horizon("plain", 0.0)),
}
"""The kinds of ground by the names of the original's simple maps."""
