"""Bridges for walkers: glazed passages, glazed storeys in frames of steel, storeys of stone."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.solids import box
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import TEXTURES, facade, material
from eyas.engine.world.build.millimetres import rounded, unit
from eyas.engine.world.build.scene_builder import SceneBuilder
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.build.values import Colour, Facade, Place, Positive
from eyas.maps.buildings.skyline import FLOOR

FLOORS_UNDER = 2
"""Storeys under it."""
RIM = 0.4
"""Height of the rim of a roof [m]."""

_BAY, _TILE = 3.0, 12.0
"""Width of a window and size of a repeat of a facade [m]."""
_STEEL = material("plain", (0.80, 0.82, 0.83))
_UNDER = material("concrete", (0.55, 0.55, 0.55))
_BEAM = material("plain", (0.30, 0.32, 0.33))
_STONE = material("concrete", (0.86, 0.84, 0.80))
_MEMBRANE = material("roof_membrane", (0.80, 0.84, 0.86))
_GRAVEL = material("roof_gravel", (0.90, 0.88, 0.85))
_SKYLIGHT = material("plain", (0.16, 0.24, 0.30))
_UNIT = material("plain", (0.66, 0.68, 0.69))

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Skyway:
    """A bridge from front to front, in the world frame."""

    start: Place
    """Middle of its end at a front [m], shape (2,)."""
    end: Place
    """Middle of its end at the front across the street [m], shape (2,)."""
    width: Positive
    """Width [m]."""
    floors: Annotated[int, Ge(1), Le(2)]
    """Storeys: 1 is a passage, 2 a part of the buildings that it joins."""
    facade: Facade
    """Its walls."""
    tint: Colour
    """Factor on their colour."""

    @property
    def bottom(self) -> float:
        """Height of its underside, as z [m]."""
        return FLOOR_HEIGHT + FLOOR * FLOORS_UNDER

    @property
    def top(self) -> float:
        """Height of its roof, as z [m]."""
        return self.bottom + FLOOR * self.floors

    def outline(self) -> Points:
        """Return its corners, counter-clockwise [m], shape (4, 2)."""
        along = unit(self.end - self.start)
        aside = 0.5 * self.width * np.array([-along[1], along[0]])
        corners = [self.start - aside, self.end - aside, self.end + aside, self.start + aside]
        return rounded(corners)


def add_skyway(builder: SceneBuilder, skyway: Skyway) -> None:
    """Add a skyway, an object of its own."""
    owner = builder.add(ObjectClass.STRUCTURE, _placed(skyway))
    builder.add_prism(skyway.outline(), skyway.bottom, skyway.top + RIM, owner)


def _placed(skyway: Skyway) -> Mesh:
    long = float(exact.length(skyway.end - skyway.start))
    (x, y), (c, s) = skyway.start, (skyway.end - skyway.start) / long
    pose = np.array([[c, -s, 0.0, x], [s, c, 0.0, y], [0.0, 0.0, 1.0, 0.0]])
    glazed = skyway.facade == "facade_glass"
    made = [*_walls(skyway, long), *_below(skyway, long)]
    if skyway.floors == 1:
        made += _passage_roof(skyway, long)
    else:
        made += _rim(skyway, long, steel=glazed)
        made += _frame(skyway, long) if glazed else _units(skyway, long)
    return transformed(concatenate(made), pose)


def _walls(skyway: Skyway, long: float) -> list[Mesh]:
    """Return both sides, with windows in whole bays."""
    half, low, top = skyway.width / 2, skyway.bottom, skyway.top
    bays = max(round(long / _BAY), 1) / 4
    rise = (top - low) / _TILE
    uvs = np.array([(0.0, 0.0), (bays, 0.0), (bays, rise), (0.0, rise)])
    right = [(0.0, -half, low), (long, -half, low), (long, -half, top), (0.0, -half, top)]
    left = [(long, half, low), (0.0, half, low), (0.0, half, top), (long, half, top)]
    wall = facade(skyway.facade, skyway.tint)
    return [quads([right, left], np.stack([uvs, uvs + np.array([0.25, 0.5])]), wall)]


def _below(skyway: Skyway, long: float) -> list[Mesh]:
    """Return the underside, and the girders at its edges."""
    half, z = skyway.width / 2, skyway.bottom
    face = np.array([(0.0, half, z), (long, half, z), (long, -half, z), (0.0, -half, z)])
    made = [quads(face[None], face[None, :, :2] / TEXTURES[_UNDER.texture], _UNDER)]
    made += [box((long, 0.24, 0.5), (long / 2, side * half, z + 0.2), _BEAM, 1.0)
             for side in (-1, 1)]  # fmt: skip
    return made


def _passage_roof(skyway: Skyway, long: float) -> list[Mesh]:
    """Return a roof of metal with two slopes, ribs across it, and a ridge."""
    half, low, top = skyway.width / 2 + 0.15, skyway.top, skyway.top + RIM
    slopes = np.array([
        [(0.0, -half, low), (long, -half, low), (long, 0.0, top), (0.0, 0.0, top)],
        [(long, half, low), (0.0, half, low), (0.0, 0.0, top), (long, 0.0, top)],
    ])  # fmt: skip
    made = [quads(slopes, slopes[..., :2] / TEXTURES[_MEMBRANE.texture], _MEMBRANE)]
    ribs = np.arange(1.5, long, 3.0).tolist()
    made += [box((0.14, 2 * half, 0.1), (x, 0.0, low + 0.05), _STEEL, 1.0) for x in ribs]
    made.append(box((long, 0.3, 0.1), (long / 2, 0.0, top), _STEEL, 1.0))
    made += [box((long, 0.16, 0.3), (long / 2, side * half, low), _STEEL, 1.0) for side in (-1, 1)]
    return made


def _rim(skyway: Skyway, long: float, *, steel: bool) -> list[Mesh]:
    """Return a flat roof with a rim."""
    half, z = skyway.width / 2, skyway.top
    cover, edge = (_MEMBRANE, _STEEL) if steel else (_GRAVEL, _STONE)
    face = np.array([(0.0, -half, z), (long, -half, z), (long, half, z), (0.0, half, z)])
    made = [quads(face[None], face[None, :, :2] / TEXTURES[cover.texture], cover)]
    made += [box((long, 0.3, RIM + 0.3), (long / 2, side * half, z + RIM / 2 - 0.15), edge, 6.0)
             for side in (-1, 1)]  # fmt: skip
    return made


def _frame(skyway: Skyway, long: float) -> list[Mesh]:
    """Return the diagonals of a frame over the glass of both sides, and a row of skylights."""
    half, low, top = skyway.width / 2 + 0.06, skyway.bottom, skyway.top
    count = max(round(long / 6.0), 2)
    at = np.linspace(0.0, long, count + 1)
    bars = []
    for k in range(count):
        foot, head = (low, top) if k % 2 else (top, low)
        bar = np.array([(at[k] - 0.16, foot), (at[k] + 0.16, foot),
                        (at[k + 1] + 0.16, head), (at[k + 1] - 0.16, head)])  # fmt: skip
        for side in (-1.0, 1.0):
            face = np.column_stack([bar[:, 0], np.full(4, side * half), bar[:, 1]])
            outwards = (side < 0) == (foot < head)
            bars.append(face if outwards else face[::-1])
    made = [quads(np.array(bars), np.zeros((len(bars), 4, 2)), _STEEL)]
    long_light = max(long - 7.0, 3.0)
    wide = 0.32 * skyway.width
    made.append(box((long_light, wide, 0.24), (long / 2, 0.0, top + 0.12), _STEEL, 1.0))
    panes = max(round(long_light / 2.4), 1)
    each = long_light / panes
    middles = 3.5 + each * (np.arange(panes) + 0.5)
    pane = (each - 0.2, wide - 0.2, 0.06)
    made += [box(pane, (x, 0.0, top + 0.25), _SKYLIGHT, 1.0) for x in middles.tolist()]
    return made


def _units(skyway: Skyway, long: float) -> list[Mesh]:
    """Return ventilators on the roof of a bridge of stone."""
    z = skyway.top
    places = ((0.3 * long, -0.18 * skyway.width, 2.2), (0.68 * long, 0.2 * skyway.width, 1.6))
    made = [box((size, 1.3, 0.36), (x, y, z + 0.18), _UNIT, 1.0) for x, y, size in places]
    made.append(box((0.5 * long, 0.3, 0.2), (0.5 * long, 0.02 * skyway.width, z + 0.1), _UNIT, 1.0))
    return made
