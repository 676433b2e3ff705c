"""Car bodies: surfaces through cross-sections, with windows, lamps and wheel arches."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from art.cars.finishes import (
    GLASS,
    HEAD_LAMP,
    INDICATOR_LEFT,
    INDICATOR_RIGHT,
    PAINT,
    PANE,
    TAIL_LAMP,
    TRIM,
)
from art.cars.frame import Frame
from art.cars.regions import BODYWORK, body_paint
from art.cars.shape import (
    CarShape,
    coarse_stations,
    fine_stations,
    height_at,
    middle_stations,
    sections,
)
from art.cars.trim import AHEAD, add_bumpers, add_trimmings
from art.cars.wrap import Wrap
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Mesh


@dataclass(frozen=True, slots=True)
class _Detail:
    """Resolution of a body."""

    points: tuple[int, ...]  # Points of the sections that are used
    columns: tuple[float, ...]
    """Limits of the columns of panels at the ends, as shares of the half width."""
    lamps: tuple[float, ...]  # Limits of those at the height of the lamps
    arches: bool


TRACK = 0.225
"""Distance between the middles of two wheels less the width with mirrors [m]: their sides stand out
from the body by half a centimetre, so that tyres are seen from above."""

_LAMPS, _INDICATORS = 0.62, 0.74
"""Inner limits of the lamps at the ends, and of those beside the indicators, as shares of the half
width."""

_TALL = 0.78  # Inner limit of lamps beside a rear window, likewise
_ENDS = (-1.0, -_LAMPS, _LAMPS, 1.0)
_LIT = (-1.0, -_INDICATORS, -_LAMPS, _LAMPS, _INDICATORS, 1.0)
_FINE = _Detail((0, 1, 2, 3, 4, 5, 6, 7), _ENDS, _LIT, arches=True)
_MIDDLE = _Detail((0, 1, 2, 3, 4, 6, 7), _ENDS, _LIT, arches=False)
_COARSE = _Detail((1, 4, 6), (-1.0, 1.0), (-1.0, 1.0), arches=False)


def body_levels(shape: CarShape, frame: Frame) -> tuple[Mesh, ...]:
    """Return the meshes of a car without its wheels, the finest level of detail first."""
    return (
        _body(frame, shape, _FINE, fine_stations(frame, shape)),
        _body(frame, shape, _MIDDLE, middle_stations(shape)),
        _body(frame, shape, _COARSE, coarse_stations(shape)),
    )


def _body(frame: Frame, shape: CarShape, detail: _Detail, stations: NDArray[np.float64]) -> Mesh:
    shell, wrap = Shell(), Wrap(frame, shape)
    paint = body_paint(f"bodywork_{shape.bodywork}")
    every = sections(frame, shape, stations, arches=detail.arches)
    if detail.arches:  # the bumpers are the ends
        every[0, :, 0] += AHEAD
        every[-1, :, 0] -= AHEAD
    halves = every[:, detail.points]
    for i in range(len(stations) - 1):
        middle = (stations[i] + stations[i + 1]) / 2
        rise = halves[i : i + 2, -1, 2].mean() - height_at(shape.belt, middle)
        pair = every[i : i + 2]
        for low, high in zip(detail.points, detail.points[1:], strict=False):
            skin = _skin(frame, shape, detail, middle, rise, (low, high))
            _panel(shell, wrap, pair, (low, high), skin, paint)
        if detail.points[-1] != 7:
            mirror = [1.0, -1.0, 1.0]
            back, front = halves[i, -1], halves[i + 1, -1]
            quad = np.array([back, back * mirror, front * mirror, front])
            skin = _skin(frame, shape, detail, middle, rise, (6, 7))
            edge = pair[[0, 0, 1, 1], 5, 1]
            if skin is PAINT or skin.texture in BODYWORK:
                # The middle of the roof has no points here, nor have its seams.
                shell.quads(quad, paint if skin is PAINT else skin, uvs=wrap.top(quad, edge))
            else:
                shell.quads(quad, skin)
    half = float(every[0, 3, 1]), float(every[-1, 3, 1])
    for front in (False, True):
        _end(shell, shape, detail, wrap, halves[-front], (half[front], front, paint))
    if 3 not in detail.points:
        _lamp_panels(shell, shape, every[1], every[0])
        _lamp_panels(shell, shape, every[-2], every[-1])
    for material, x, (right, left), (foot, top) in shape.fittings if 3 in detail.points else ():
        corners = [(x, left, foot), (x, right, foot), (x, right, top), (x, left, top)]
        shell.quads(corners, material, both_sides=True)
    if detail.arches:
        add_trimmings(shell, frame, shape)
        add_bumpers(shell, frame, shape, wrap, paint)
    return shell.mesh()


def _panel(
    shell: Shell,
    wrap: Wrap,
    pair: NDArray[np.float64],
    strip: tuple[int, int],
    skin: Material,
    paint: Material,
) -> None:
    """Add a panel between two sections, on both sides, with the texture that belongs there.

    `pair` has all points of both sections [m], shape (2, 8, 3); `strip` are the lower and the upper
    one between which it lies.
    """
    low, high = strip
    quad = np.array([pair[0, low], pair[0, high], pair[1, high], pair[1, low]])
    edge, up = pair[[0, 0, 1, 1], 5, 1], np.array([0.0, 1.0, 1.0, 0.0])
    middle = quad[:, 0].mean()
    if skin is GLASS:  # side windows
        pane = wrap.pane(quad, up) if high == 5 else None
        if pane is None:
            shell.quads(quad, paint, uvs=wrap.band(quad, up), both_sides=True)
        else:
            shell.quads(quad, PANE, uvs=pane, both_sides=True)
    elif skin is PANE:
        right = quad[::-1] * [1.0, -1.0, 1.0]
        front = middle > 0.0
        shell.quads(quad, PANE, uvs=wrap.screen(quad, edge, front=front))
        shell.quads(right, PANE, uvs=wrap.screen(right, edge[::-1], front=front))
    elif skin is PAINT:
        uvs = wrap.side(quad) if high <= 4 else wrap.top(quad, edge)
        shell.quads(quad, paint, uvs=uvs, both_sides=True)
    elif skin.texture in BODYWORK:
        shell.quads(quad, skin, uvs=wrap.top(quad, edge), both_sides=True)
    else:
        shell.quads(quad, skin, both_sides=True)


def _skin(
    frame: Frame, shape: CarShape, detail: _Detail, x: float, rise: float, strip: tuple[int, int]
) -> Material:
    """Return the material of a panel whose middle is at x [m], where the roof is `rise` above the
    belt line [m]; `strip` are the lower and the upper point of the section.
    """
    low = strip[0]
    tail, nose = shape.top[0][0], shape.top[-1][0]
    if low >= 5:
        return _roof(shape, x, edge=low == 5)
    if low == 4 and rise > 0.1 and shape.windows[0][0] < x < shape.windows[-1][1]:
        # Pillars between the doors are black, so that the windows are one dark band.
        return GLASS if _glazed(shape, detail, x) else TRIM
    if strip == (3, 4) and x > nose - shape.head_lamps:
        return HEAD_LAMP
    if (strip == (3, 4) or (low == 4 and shape.tall_tail_lamps)) and x < tail + shape.tail_lamps:
        return TAIL_LAMP
    if strip == (1, 2) and detail.arches:
        # The dark lower edges of the bumpers go round the corners, to the wheels.
        return shape.sill if frame.axles[1].x < x < frame.axles[0].x else TRIM
    return TRIM if low == 0 else PAINT


def _roof(shape: CarShape, x: float, *, edge: bool) -> Material:
    """Return the material of roof, bonnet, boot or bed, and of the windows between them."""
    if shape.bed and shape.bed[0] < x < shape.bed[1] and not edge:
        return TRIM
    if not shape.rear_window[0] < x < shape.windscreen[1]:
        return PAINT
    if edge:
        return shape.rails
    return shape.roof if shape.rear_window[1] < x < shape.windscreen[0] else PANE


def _glazed(shape: CarShape, detail: _Detail, x: float) -> bool:
    """Return whether there is a side window at x; only the finest level has pillars."""
    if detail.arches:
        return any(start < x < end for start, end in shape.windows)
    return shape.windows[0][0] < x < shape.windows[-1][1]


def _end(
    shell: Shell,
    shape: CarShape,
    detail: _Detail,
    wrap: Wrap,
    half: NDArray[np.float64],
    look: tuple[float, bool, Material],
) -> None:
    """Close one end with rows of panels between the points `half` of its section [m].

    `look`: half the width of the end [m], whether it is the front, and the car's paint.
    """
    wide, front, paint = look
    for k in range(len(half) - 1):
        strip = detail.points[k : k + 2]
        lamps = strip == (3, 4)
        limits = detail.lamps if lamps else detail.columns
        if strip[0] == 4 and shape.tail_window and len(limits) == 4:
            limits = (-1.0, -_TALL, _TALL, 1.0)
        columns = np.array(limits)[:, None]
        low, high = (half[j] * np.ones((len(columns), 1)) for j in (k, k + 1))
        low[:, 1:2] *= columns
        high[:, 1:2] *= columns
        for c in range(len(columns) - 1):
            quad = np.array([low[c], low[c + 1], high[c + 1], high[c]])
            quad = quad if front else quad[::-1]
            middle = 0.5 * (limits[c] + limits[c + 1])
            material = _end_skin(shape, strip, middle if len(columns) > 2 else 0.0, front=front)
            if material is PAINT:
                shell.quads(quad, paint, uvs=wrap.end(quad, wide, front=front))
            elif material is PANE:
                shell.quads(quad, PANE, uvs=wrap.upright(quad, wide))
            else:
                shell.quads(quad, material)


def _end_skin(shape: CarShape, strip: tuple[int, ...], across: float, *, front: bool) -> Material:
    """Return the material of a piece of an end between two points of the section (`strip`), at a
    place from right to left, -1 to 1.
    """
    window = shape.nose_window if front else shape.tail_window
    low, outer = strip[0], abs(across) > _LAMPS
    if low == 3 and outer:
        if abs(across) < _INDICATORS:
            return INDICATOR_LEFT if across > 0.0 else INDICATOR_RIGHT
        return HEAD_LAMP if front else TAIL_LAMP
    if low == 4 and shape.tall_tail_lamps and outer and not front:
        return TAIL_LAMP
    return PANE if low == 4 and window and (front or not outer) else PAINT


def _lamp_panels(
    shell: Shell, shape: CarShape, before: NDArray[np.float64], end: NDArray[np.float64]
) -> None:
    """Add panels for the lamps, 1.5 cm off the body and around its corner, to a coarse end.

    The coarsest sections have no points for lamps. `before` and `end` are all points of the section
    next to the end and of that at it [m].
    """
    front = end[0, 0] > before[0, 0]
    material, reach = (HEAD_LAMP, shape.head_lamps) if front else (TAIL_LAMP, shape.tail_lamps)
    low, high = end[3:5] + np.array([0.015 if front else -0.015, 0.0, 0.0])
    inwards = [1.0, _LAMPS, 1.0]
    panels = [[low * inwards, low, high, high * inwards]]
    if abs(end[0, 0] - before[0, 0]) < 2 * reach:
        panels.append([low, before[3], before[4], high])
    quads = np.array(panels)
    shell.quads(quads if front else quads[:, ::-1], material, both_sides=True)
