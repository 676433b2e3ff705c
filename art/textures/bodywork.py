"""Textures of the paint and the panes of vehicles: seams, frames, handles, grilles, dirt.

Each is painted on a body of the usual size, see `art.cars.regions`, in metres.
"""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from art.cars.regions import (
    BAND,
    BASE,
    BEAMS,
    BOX_DOORS,
    BOX_ROOF,
    BOX_SIDE,
    CAB_SIDE,
    COOLER,
    FRONT,
    REAR,
    REAR_WINDOW,
    SIDE,
    SIDE_PANE,
    SIDE_SHARES,
    STYLES,
    TOP,
    TOP_SHARES,
    WINDSCREEN,
)
from art.textures.brush import Line, Sheet, sheet_of, texture_of
from eyas.engine.render.textures.fields import SIZE, fractal, source

Texture = NDArray[np.uint8]

_SEAM = 0.02
_BLACK = 0.03
_SOFT = 0.5
"""Share of a texel's width that a seam darkens: seams are 5 mm wide and texels 2 cm, so that from
above a car has soft lines and no ink."""

_FILM = 0.06  # Deviation of the brightness of paint, as a share
_DUST = 0.02  # Deviation of what dust adds to the brightness of panes

_LONG = 4.6  # Length of the body that is painted [m]


def bodywork(style: str) -> Texture:
    """Return the paint of one of `STYLES`."""
    kind, _, look = style.partition("_")
    tones = np.full((SIZE, SIZE), BASE)
    side, top = sheet_of(tones, SIDE, (_LONG, 0.75)), sheet_of(tones, TOP, (_LONG, 0.8))
    _SIDES[kind](side)
    _TOPS[kind](top)
    gloss = np.zeros_like(tones)
    if look == "sunroof":
        _sunroof(top, 0.02)
        _sunroof(sheet_of(gloss, TOP, (_LONG, 0.8)), 1.0)
    _band(sheet_of(tones, BAND, (2.6, 0.42)))
    _rear(sheet_of(tones, REAR, (0.85, 0.75)), kind)
    _front(sheet_of(tones, FRONT, (0.85, 0.75)), kind, look)
    rng = source(f"bodywork {style}")
    # Dust and what a body mirrors: smooth even paint is what a telephone has, not a car. Texels are
    # longer along the body than across it.
    film = fractal(rng, 1.3, longest=40.0, stretch=(1.7, 1.0))
    if look == "worn":
        _wear(side, top)
        tones *= 1.0 - 0.06 * np.clip(fractal(rng, 1.3, longest=40.0) - 0.4, 0.0, 1.0)
    picture = texture_of(tones * np.maximum(1.0 + _FILM * film, 0.2))
    picture[..., 3] = np.maximum(picture[..., 3], np.round(255.0 * gloss[::-1]))
    return picture


def _wear(side: Sheet, top: Sheet) -> None:
    """Draw the black mouldings of an older car, and more dirt."""
    front, ahead = _LONG * SIDE_SHARES[2], _LONG * SIDE_SHARES[5]
    side.line([(front + 0.08, 0.36), (ahead - 0.06, 0.36)], 0.06, _BLACK)
    _dirt(side, 0.6, 0.35)
    nose = _LONG
    top.box((nose - 0.12, -0.1), (nose + 0.1, 0.9), 0.8 * BASE, 0.6)


def _dirt(sheet: Sheet, height: float, strength: float) -> None:
    """Darken what is low, where wheels throw dirt."""
    low = np.clip(1.0 - sheet.y / height, 0.0, 1.0)
    sheet.scale(1.0 - strength * low * np.sqrt(low))


def _doors(sheet: Sheet, seams: Sequence[Line], handles: Sequence[float]) -> None:
    for seam in seams:
        sheet.line(seam, 0.02, _SEAM, _SOFT)
    for x in handles:
        sheet.box((x, 0.585), (x + 0.2, 0.645), _SEAM, _SOFT)
        sheet.line([(x + 0.02, 0.63), (x + 0.18, 0.63)], 0.028, 1.0, 0.7)


def _car_side(sheet: Sheet) -> None:
    tail, arch, front, pillar, door, ahead, arch_end, nose = (_LONG * s for s in SIDE_SHARES)
    sheet.line([(tail, 0.715), (nose, 0.715)], 0.035, 1.0, 0.8)  # the shoulder
    sheet.line([(tail, 0.5), (arch, 0.56), (ahead, 0.5), (nose, 0.46)], 0.03, 1.0, 0.5)
    sheet.line([(tail, 0.45), (arch, 0.52), (ahead, 0.46), (nose, 0.42)], 0.06, 0.62 * BASE, 0.6)
    sheet.line([(front, 0.2), (ahead, 0.2)], 0.03, 1.0, 0.35)
    _dirt(sheet, 0.4, 0.5)
    sheet.line([(front, 0.05), (ahead, 0.05)], 0.07, _BLACK)
    sill = 0.095
    _doors(
        sheet,
        [
            [(pillar, 0.75), (pillar + 0.01, sill)],
            [(door, 0.75), (door + 0.02, 0.45), (door - 0.04, sill)],
            [(arch + 0.24, 0.75), (arch + 0.3, 0.6), (front + 0.02, 0.36), (front + 0.06, sill)],
            [(front + 0.06, sill), (door - 0.04, sill)],
        ],
        (pillar + 0.06, arch + 0.38),
    )
    # Joints of the bumpers, from the arches to the lamps; the flap of the tank.
    sheet.line([(arch - 0.02, 0.42), (tail, 0.47)], 0.02, _SEAM, _SOFT)
    sheet.line([(arch_end + 0.02, 0.42), (nose, 0.47)], 0.02, _SEAM, _SOFT)
    sheet.box((arch + 0.02, 0.55), (arch + 0.19, 0.7), _SEAM, _SOFT)
    sheet.box((arch + 0.045, 0.575), (arch + 0.165, 0.675), BASE)


def _van_side(sheet: Sheet) -> None:
    _, arch, front, pillar, door, ahead, arch_end, nose = (_LONG * s for s in SIDE_SHARES)
    sheet.line([(0.0, 0.43), (nose, 0.43)], 0.03, 1.0, 0.5)
    sheet.line([(0.0, 0.36), (pillar, 0.36)], 0.1, _BLACK)  # the rubbing strip
    _dirt(sheet, 0.4, 0.5)
    sheet.line([(front, 0.04), (ahead, 0.04)], 0.08, _BLACK)
    _doors(
        sheet,
        [
            [(pillar, 0.75), (pillar, 0.08)],
            [(door, 0.75), (door + 0.02, 0.3), (door - 0.04, 0.08)],
            [(front + 0.1, 0.75), (front + 0.1, 0.08)],
            [(front + 0.1, 0.08), (door - 0.04, 0.08)],
        ],
        (pillar + 0.06, front + 0.2),
    )
    sheet.line([(0.0, 0.69), (pillar, 0.69)], 0.03, _SEAM, 0.8)  # the rail of the sliding door
    sheet.line([(arch_end + 0.02, 0.42), (nose, 0.47)], 0.02, _SEAM, _SOFT)
    sheet.line([(arch - 0.02, 0.3), (0.0, 0.3)], 0.02, _SEAM, _SOFT)


def _bus_side(sheet: Sheet) -> None:
    sheet.line([(0.0, 0.7), (_LONG, 0.7)], 0.03, 1.0, 0.7)
    sheet.line([(0.0, 0.28), (_LONG, 0.28)], 0.035, _SEAM, 0.8)
    _dirt(sheet, 0.35, 0.5)
    for x in np.linspace(0.02, 0.98, 15) * _LONG:
        sheet.line([(float(x), 0.02), (float(x), 0.28)], 0.03, _SEAM, 0.8)
    for x in np.linspace(0.06, 0.94, 7) * _LONG:
        sheet.line([(float(x), 0.28), (float(x), 0.75)], 0.025, _SEAM, 0.6)
    sheet.line([(0.0, 0.03), (_LONG, 0.03)], 0.06, _BLACK)


def _bonnet(sheet: Sheet) -> None:
    _, _, _, _, screen, nose = (_LONG * s for s in TOP_SHARES)
    sheet.box((screen - 0.02, -0.1), (screen + 0.05, 0.71), _BLACK, 0.8)  # the well of the wipers
    end = nose - 0.14
    edge = [(screen + 0.05, 0.72), (end - 0.14, 0.67), (end, 0.54), (end, -0.1)]
    sheet.line([(x - 0.02, y - 0.03) for x, y in edge], 0.05, 1.0, 0.3)
    sheet.line(edge, 0.02, _SEAM, _SOFT)
    sheet.line([(screen + 0.12, 0.42), (end - 0.06, 0.26)], 0.06, 1.0, 0.4)  # creases
    sheet.line([(screen + 0.12, 0.48), (end - 0.06, 0.32)], 0.06, 0.6 * BASE, 0.4)
    sheet.box((nose - 0.07, -0.1), (nose + 0.1, 0.5), _BLACK, 0.8)  # the upper end of the grille


def _roof(sheet: Sheet, back: float, front: float) -> None:
    """Draw the ditches along the edges of a roof, and the rims of the windows ahead and behind."""
    sheet.line([(back, 0.74), (front, 0.74)], 0.03, _SEAM, _SOFT)
    sheet.line([(back, 0.69), (front, 0.69)], 0.04, 1.0, 0.3)
    for x in (back, front):
        sheet.line([(x, -0.1), (x, 0.8)], 0.03, _SEAM, 0.7)
    for y in (0.24, 0.5):  # swages along the roof
        sheet.line([(back + 0.14, y), (front - 0.14, y)], 0.05, 0.6 * BASE, 0.6)
        sheet.line([(back + 0.14, y + 0.045), (front - 0.14, y + 0.045)], 0.035, 1.0, 0.7)
    # A roof is a little lower at its edges and ends, and so a little darker there.
    sheet.line([(back + 0.1, 0.4), (back + 0.1, -0.1)], 0.14, 0.85 * BASE, 0.5)


def _saloon_top(sheet: Sheet) -> None:
    tail, low, back, front, _, _ = (_LONG * s for s in TOP_SHARES)
    _bonnet(sheet)
    _roof(sheet, back, front)
    sheet.box((back + 0.18, -0.1), (back + 0.3, 0.03), _BLACK)  # the aerial
    # Seams of the boot's lid.
    sheet.line([(low - 0.03, -0.1), (low - 0.03, 0.68)], 0.03, _SEAM, 0.7)
    sheet.line([(low, 0.7), (tail, 0.64)], 0.02, _SEAM, _SOFT)
    sheet.line([(tail + 0.02, -0.1), (tail + 0.02, 0.8)], 0.05, 1.0, 0.4)


def _hatch_top(sheet: Sheet) -> None:
    _, low, back, front, _, _ = (_LONG * s for s in TOP_SHARES)
    _bonnet(sheet)
    _roof(sheet, back, front)
    # The gap of the tailgate behind the roof, the aerial.
    sheet.line([(back + 0.16, -0.1), (back + 0.16, 0.68)], 0.02, _SEAM, _SOFT)
    sheet.box((back + 0.2, -0.1), (back + 0.3, 0.03), _BLACK)
    sheet.line([(low, -0.1), (low, 0.8)], 0.03, _SEAM, 0.7)


def _sunroof(sheet: Sheet, tone: float) -> None:
    front = _LONG * TOP_SHARES[3]
    sheet.box((front - 0.5, -0.1), (front - 0.14, 0.42), tone)


def _van_top(sheet: Sheet) -> None:
    _, _, back, front, _, _ = (_LONG * s for s in TOP_SHARES)
    _bonnet(sheet)
    _roof(sheet, back, front)
    for x in np.linspace(back + 0.15, front - 0.15, 7):  # ribs
        sheet.line([(float(x), -0.1), (float(x), 0.62)], 0.03, 1.0, 0.3)
        sheet.line([(float(x) + 0.04, -0.1), (float(x) + 0.04, 0.62)], 0.03, 0.6 * BASE, 0.3)


def _bus_top(sheet: Sheet) -> None:
    sheet.line([(0.0, 0.72), (_LONG, 0.72)], 0.03, _SEAM, 0.8)
    sheet.line([(0.0, 0.66), (_LONG, 0.66)], 0.03, 1.0, 0.7)
    for y in (0.16, 0.46):  # swages along the roof
        sheet.line([(0.0, y), (_LONG, y)], 0.05, 0.6 * BASE, 0.8)
        sheet.line([(0.0, y + 0.05), (_LONG, y + 0.05)], 0.04, 1.0, 0.8)
    for x in np.linspace(0.05, 0.95, 9) * _LONG:
        sheet.line([(float(x), -0.1), (float(x), 0.7)], 0.025, _SEAM, 0.8)
    for x in (0.42, 0.56, 0.9):  # hatches
        sheet.box((x * _LONG - 0.14, -0.2), (x * _LONG + 0.14, 0.26), _SEAM)
        sheet.box((x * _LONG - 0.115, -0.2), (x * _LONG + 0.115, 0.23), 1.0)
        sheet.box((x * _LONG - 0.085, -0.2), (x * _LONG + 0.085, 0.17), 0.35 * BASE)


def _band(sheet: Sheet) -> None:
    """Draw the side windows as they look from afar: one dark band."""
    sheet.box((2.6 * BEAMS[0], -0.1), (2.6 * BEAMS[-1], 0.4), 0.03)


def _rear(sheet: Sheet, kind: str) -> None:
    side = 0.85
    _dirt(sheet, 0.3, 0.4)
    sheet.line([(0.0, 0.43), (side, 0.43)], 0.045, _SEAM)  # above the bumper
    sheet.line([(0.0, 0.385), (side, 0.385)], 0.035, 1.0, 0.8)
    sheet.box((-0.1, -0.1), (side + 0.1, 0.11), _BLACK)
    sheet.box((0.42, 0.04), (0.6, 0.1), 0.5)  # an exhaust
    sheet.line([(0.53, 0.44), (0.53, 0.75)], 0.03, _SEAM)
    if kind == "bus":  # the engine's grille, and lamps in a column
        sheet.box((-0.1, 0.17), (0.46, 0.4), _BLACK)
        for y in np.linspace(0.2, 0.37, 5):
            sheet.line([(0.0, float(y)), (0.44, float(y))], 0.016, 0.45 * BASE)
        sheet.line([(0.58, 0.14), (0.58, 0.75)], 0.02, _SEAM, 0.8)
    elif kind == "van":
        sheet.line([(0.0, 0.1), (0.0, 0.75)], 0.04, _SEAM)
    else:
        sheet.box((-0.1, 0.455), (0.32, 0.615), 0.25 * BASE)  # around the plate
        sheet.line([(0.0, 0.64), (0.4, 0.64)], 0.03, 1.0)


def _front(sheet: Sheet, kind: str, look: str) -> None:
    side = 0.85
    _dirt(sheet, 0.25, 0.3)
    if kind == "bus":
        sheet.box((-0.1, -0.1), (side + 0.1, 0.14), _BLACK)
        sheet.line([(0.0, 0.3), (side, 0.3)], 0.03, _SEAM)
        return
    if look == "sunroof":  # a grille in two halves, or one with bars
        sheet.box((0.06, 0.45), (0.4, 0.66), 1.0)
        sheet.box((0.09, 0.47), (0.37, 0.64), _BLACK)
    else:
        sheet.box((-0.1, 0.44), (0.48, 0.62), _BLACK)
        for y in (0.48, 0.53, 0.58):
            sheet.line([(0.0, y), (0.46, y)], 0.02, 0.3, 0.8)
        sheet.line([(0.0, 0.63), (0.5, 0.63)], 0.03, 1.0)
    sheet.line([(0.0, 0.43), (side, 0.43)], 0.035, _SEAM)
    sheet.box((-0.1, 0.06), (0.56, 0.2), _BLACK)  # the intakes
    sheet.box((0.62, 0.1), (0.8, 0.24), _BLACK)
    sheet.box((0.68, 0.14), (0.76, 0.21), 0.9)
    sheet.line([(0.0, 0.02), (side, 0.02)], 0.05, _BLACK)


_SIDES = {"saloon": _car_side, "hatch": _car_side, "van": _van_side, "bus": _bus_side}
_TOPS = {"saloon": _saloon_top, "hatch": _hatch_top, "van": _van_top, "bus": _bus_top}

_GLASS = 0.05  # Brightness of what is seen through a pane, as a share of the tint


def panes() -> Texture:
    """Return the panes of a car, with their frames and what is seen behind them, which is dim: by
    day a pane mirrors more light than comes out through it.
    """
    tones = np.full((SIZE, SIZE), _GLASS)
    screen = sheet_of(tones, WINDSCREEN, (1.3, 0.75))
    screen.box((-0.1, -0.1), (1.4, 0.22), 0.22)  # dashboard
    for x in (0.37, 0.93):
        screen.box((x - 0.2, 0.27), (x + 0.2, 0.56), 0.26, round_=0.08)  # seats
        screen.box((x - 0.11, 0.58), (x + 0.11, 0.68), 0.3, round_=0.05)
    screen.line([(0.8, 0.2), (0.84, 0.3), (1.02, 0.3), (1.06, 0.2)], 0.035, 0.01)  # wheel
    screen.box((0.59, 0.62), (0.71, 0.68), 0.01)  # mirror
    for x in (0.25, 0.75):  # wipers
        screen.line([(x, 0.03), (x + 0.45, 0.08)], 0.02, 0.0)
    rear = sheet_of(tones, REAR_WINDOW, (1.2, 0.6))
    rear.box((-0.1, -0.1), (1.3, 0.16), 0.08)  # shelf
    for x in (0.3, 0.6, 0.9):
        rear.box((x - 0.11, 0.2), (x + 0.11, 0.36), 0.12, round_=0.05)
    side = sheet_of(tones, SIDE_PANE, (0.95, 0.4))
    side.box((0.28, -0.1), (0.56, 0.2), 0.22, round_=0.08)
    side.box((0.34, 0.2), (0.5, 0.31), 0.26, round_=0.05)
    for sheet, size, width in (
        (screen, (1.3, 0.75), 0.05), (rear, (1.2, 0.6), 0.07), (side, (0.95, 0.4), 0.035),
    ):  # fmt: skip
        sheet.frame((0.0, 0.0), size, width, 0.004)
    return texture_of(tones + _DUST * np.abs(fractal(source("panes"), 1.3, longest=60.0)))


def freight() -> Texture:
    """Return the sides, roof and doors of a box, the side of a cab, and a cooler on a roof."""
    tones = np.full((SIZE, SIZE), BASE)
    long, high, wide = 11.0, 3.0, 2.5
    side = sheet_of(tones, BOX_SIDE, (long, high))
    side.line([(0.0, 0.06), (long, 0.06)], 0.14, 0.3 * BASE)
    side.line([(0.0, high - 0.05), (long, high - 0.05)], 0.12, 0.6 * BASE)
    for x in np.linspace(0.0, long, 10):
        side.line([(float(x), 0.0), (float(x), high)], 0.05, 0.35 * BASE)
    _dirt(side, 1.2, 0.35)
    roof = sheet_of(tones, BOX_ROOF, (long, 0.5 * wide))
    for x in np.linspace(0.0, long, 10):
        roof.line([(float(x), -0.1), (float(x), 1.3)], 0.06, 0.5 * BASE)
    roof.line([(0.0, 1.2), (long, 1.2)], 0.07, 0.45 * BASE)
    roof.scale(1.0 - 0.12 * np.clip(1.0 - roof.y / 0.9, 0.0, 1.0))
    doors = sheet_of(tones, BOX_DOORS, (wide, high))
    doors.frame((0.0, 0.0), (wide, high), 0.07, 0.3 * BASE)
    doors.line([(0.5 * wide, 0.0), (0.5 * wide, high)], 0.05, _SEAM)
    for x in (0.35, 1.0, 1.5, 2.15):  # locking bars
        doors.line([(x, 0.1), (x, high - 0.1)], 0.05, 0.4 * BASE)
    for y in (0.4, 1.1, 1.9, 2.6):  # hinges
        doors.box((0.05, y - 0.05), (0.3, y + 0.05), 0.5 * BASE)
        doors.box((wide - 0.3, y - 0.05), (wide - 0.05, y + 0.05), 0.5 * BASE)
    _dirt(doors, 0.9, 0.4)
    cab = sheet_of(tones, CAB_SIDE, (2.5, 2.56))
    cab.line([(0.9, 0.0), (0.9, 2.1), (2.1, 2.1), (2.3, 1.0), (2.3, 0.0)], 0.04, _SEAM)
    cab.line([(0.0, 1.98), (2.5, 1.98)], 0.05, 1.0, 0.6)
    cab.box((0.98, 0.72), (1.22, 0.8), _SEAM)
    cab.box((0.1, 1.1), (0.7, 1.75), _SEAM)  # a window of the berth
    for y in (0.15, 0.3):
        cab.line([(0.1, y), (0.75, y)], 0.05, 0.3 * BASE)
    _dirt(cab, 0.8, 0.4)
    unit = sheet_of(tones, COOLER, (2.0, 1.6))
    for x in np.linspace(0.2, 1.8, 9):  # slats
        unit.line([(float(x), 0.18), (float(x), 1.42)], 0.09, 0.2 * BASE)
    unit.line([(0.1, 0.8), (1.9, 0.8)], 0.12, BASE)
    unit.frame((0.0, 0.0), (2.0, 1.6), 0.05, 0.5 * BASE)
    return texture_of(tones)


PAINTERS: dict[str, Callable[[], Texture]] = {
    **{f"bodywork_{style}": partial(bodywork, style) for style in STYLES},
    "panes": panes,
    "freight": freight,
}
