"""The elevated railway: steel girders on columns, and two tracks."""

import numpy as np

from eyas.mesh.assembly import concatenate
from eyas.mesh.flat import quads
from eyas.mesh.solids import box
from eyas.state.mesh import Mesh
from eyas.state.scene import ObjectClass
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import material
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.maps.downtown.station import DARK, PLATFORM, SLAB, STEEL, add_station, level
from eyas.world.maps.downtown.trains import PITCH, add_train
from eyas.world.maps.downtown.viaduct import (
    COLUMNS,
    DECK_WIDTH,
    RAIL,
    SECTION,
    STATION,
    UNDER,
    Viaduct,
)

__all__ = ["add_railway"]

_DECK = 7.1
"""z of the ballast [m]."""
_TRACKS = (-1.95, 1.95)
_HALF = DECK_WIDTH / 2
_RAILING = 1.05
"""Height of the railings over the girders [m]."""

_BALLAST = material("roof_gravel", (0.50, 0.46, 0.43))
_TIE = material("plain", (0.17, 0.13, 0.11))
_IRON = material("plain", (0.42, 0.37, 0.34))
_PLANK = material("concrete", (0.66, 0.64, 0.60))


def add_railway(builder: SceneBuilder, line: Viaduct) -> None:
    """Add the railway with its station and two trains."""
    _add_deck(builder, line)
    _add_bents(builder, line)
    add_station(builder, line)
    first = line.station - 2 * PITCH
    add_train(builder, line, first, 5, _TRACKS[0])
    add_train(builder, line, float(line.over[-2]) - 1.5 * PITCH, 4, _TRACKS[1])


def _add_deck(builder: SceneBuilder, line: Viaduct) -> None:
    section = builder.prototype("railway section", lambda: (_section(2), _section(1), _section(0)))
    for k in range(int(line.length // SECTION)):
        low, high = k * SECTION, (k + 1) * SECTION
        spot = (*line.at(low + SECTION / 2).tolist(), 0.0)
        owner = builder.add_copy(ObjectClass.STRUCTURE, section, spot, line.turn, 1.0)
        outline = line.strip(low, high, -_HALF, _HALF)
        builder.add_prism(outline, UNDER, _DECK + 0.3 + _RAILING, owner)


def _section(detail: int) -> Mesh:
    """Return one section of the deck along x, its middle over the origin; 2 is the finest."""
    inner = _HALF - 0.3
    made = [box((SECTION, 0.3, 1.9), (0.0, s * (_HALF - 0.15), UNDER + 0.95), STEEL, 1.0)
            for s in (-1, 1)]  # fmt: skip
    made += [
        level(-SECTION / 2, SECTION / 2, -inner, inner, _DECK, _BALLAST),
        level(-SECTION / 2, SECTION / 2, -inner, inner, _DECK - 0.7, DARK, down=True),
    ]
    for side in (-1, 1):
        near, far = sorted((side * (inner - 0.75), side * inner))
        made.append(level(-SECTION / 2, SECTION / 2, near, far, _DECK + 0.16, _PLANK))
        low = (SECTION, 0.05, 0.08)
        heights = (0.5, _RAILING) if detail == 2 else (_RAILING,)
        made += [box(low, (0.0, side * (_HALF - 0.1), _DECK + 0.3 + z), DARK, 1.0)
                 for z in heights]  # fmt: skip
    if detail:
        made += _tracks(every=0.6 if detail == 2 else 1.2)
    if detail == 2:
        for x in np.arange(-SECTION / 2 + 1.0, SECTION / 2, 2.0).tolist():
            for side in (-1, 1):
                made.append(box((0.14, 0.12, 1.9), (x, side * _HALF, UNDER + 0.95), STEEL, 1.0))
                post = (x, side * (_HALF - 0.1), _DECK + 0.3 + _RAILING / 2)
                made.append(box((0.06, 0.06, _RAILING), post, DARK, 1.0))
    return concatenate(made)


def _tracks(every: float) -> list[Mesh]:
    """Return the ties and rails of both tracks in a section."""
    ties = np.arange(-SECTION / 2 + every / 2, SECTION / 2, every)
    wide = 0.22 if every < 1.0 else 0.4
    made = []
    for middle in _TRACKS:
        edge, end = np.array([-wide, wide, wide, -wide]) / 2, np.array([-1.25, -1.25, 1.25, 1.25])
        corners = np.empty((len(ties), 4, 3))
        corners[..., 0] = ties[:, None] + edge
        corners[..., 1] = middle + end
        corners[..., 2] = _DECK + 0.06
        made.append(quads(corners, np.zeros((len(corners), 4, 2)), _TIE))
        made += [box((SECTION, 0.09, 0.14), (0.0, middle + gauge, RAIL - 0.14), _IRON, 1.0)
                 for gauge in (-0.72, 0.72)]  # fmt: skip
    return made


def _add_bents(builder: SceneBuilder, line: Viaduct) -> None:
    """Add the columns, wider crossbeams where they carry platforms."""
    plain = builder.prototype("railway columns", lambda: (_bent(_HALF, fine=True), _bent(_HALF)))
    broad = builder.prototype(
        "station columns", lambda: (_bent(PLATFORM[1], fine=True), _bent(PLATFORM[1]))
    )
    for place in line.bents.tolist():
        wide = abs(place - line.station) < STATION / 2
        half = PLATFORM[1] if wide else _HALF
        spot = (*line.at(place).tolist(), 0.0)
        kind = broad if wide else plain
        owner = builder.add_copy(ObjectClass.STRUCTURE, kind, spot, line.turn, 1.0)
        for side in COLUMNS:
            builder.add_cylinder(line.at(place, side).tolist(), 0.4, FLOOR_HEIGHT, UNDER, owner)
        builder.add_prism(line.strip(place - 0.35, place + 0.35, -half, half), 4.6, UNDER, owner)


def _bent(half: float, *, fine: bool = False) -> Mesh:
    """Return two columns and the crossbeam that they carry, along y."""
    made = [box((0.6, 2 * half, 0.9), (0.0, 0.0, UNDER - 0.45), STEEL, 1.0)]
    high = UNDER - FLOOR_HEIGHT
    for y in COLUMNS:
        made.append(box((0.5, 0.5, high), (0.0, y, FLOOR_HEIGHT + high / 2), STEEL, 1.0))
        if fine:
            made.append(box((1.1, 1.1, 0.7), (0.0, y, FLOOR_HEIGHT + 0.35), SLAB, 6.0))
            foot = [(0.0, y, UNDER - 2.3), (0.0, y, UNDER - 1.9)]
            for lean in (-1.6, 1.6):
                tip = [(0.0, y + lean, UNDER - 0.9), (0.0, y + lean * 0.8, UNDER - 0.9)]
                strut = np.array([foot[0], tip[0], tip[1], foot[1]])
                apart = np.array([0.1, 0.0, 0.0])
                both = np.stack([strut + apart, strut[::-1] - apart])
                made.append(quads(both, np.zeros((2, 4, 2)), STEEL))
    return concatenate(made)
