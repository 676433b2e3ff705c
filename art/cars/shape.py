"""The lines of a car, and the cross-sections that follow from them.

Every section has the same points on its left half, from bottom to top: 0 middle of the floor,
1 sill, 2 top of the sill, 3 widest point, 4 belt line, 5 upper edge of the side window, 6 edge of
the roof, 7 middle of the roof. Ahead of and behind the cabin, points 4 to 7 form the bonnet and
boot.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from art.cars.finishes import PAINT
from art.cars.frame import Frame
from eyas.engine.state.mesh import Material

Points = tuple[tuple[float, float], ...]
Range = tuple[float, float]

_WIDE_OF_BODY = 0.01  # Distance by which the mirrors stand out from the body on each side [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class CarShape:
    """Lines of a car. x forward from the middle [m], in increasing order."""

    top: Points  # Centre line of boot, roof and bonnet (x, z)
    belt: Points  # Lower edge of the side windows (x, z)
    plan: Points  # Half width as a share of the body's (x, share)
    windscreen: Range  # x at the roof and at the bonnet
    rear_window: Range  # x at its lower edge and at the roof
    windows: tuple[Range, ...]  # Side windows; pillars are between them
    lean: float = 0.28  # Inward lean of the side windows: width per height
    clearance: float = 0.2  # z of the floor [m]
    head_lamps: float = 0.3  # Length of the front lamps along the sides [m]
    tail_lamps: float = 0.2  # Length of the rear lamps along the sides [m]
    tall_tail_lamps: bool = False  # Whether the rear lamps reach up beside the rear window
    tail_window: bool = False  # Whether the rear end is upright and has a window
    nose_window: bool = False  # Whether the front end is upright and has a window
    roof: Material = PAINT  # Material of the roof
    rails: Material = PAINT  # Material of the edges of the roof and the pillars at its corners
    sill: Material = PAINT  # Material of the lowest part of the sides
    bodywork: str = "hatch"  # Texture of its paint, see `regions.py`
    dark_bumpers: bool = False  # Whether the bumpers are not painted
    rack: bool = False  # Whether it has rails on the roof
    bed: Range | None = None  # Extent in x of an open bed behind the cab, under a dark cover
    fittings: tuple[tuple[Material, float, Range, Range], ...] = ()
    """Upright rectangles behind it, on both sides: material, x, and ranges of y and z [m]."""
    pods: tuple[tuple[float, float, float], ...] = ()
    """Boxes on the roof: rear and front end (x) and top (z) [m]."""


def middle_stations(shape: CarShape) -> NDArray[np.float64]:
    """Return x of the sections of the middle level [m]: the kinks of the roof line."""
    plan = np.array(shape.plan)[:, 0]
    ends = (plan[0], plan[1], plan[-2], plan[-1])
    return _merged([*(x for x, _ in shape.top), *ends], 0.12)


def coarse_stations(shape: CarShape) -> NDArray[np.float64]:
    """Return x of the sections of the coarsest level [m]."""
    tail, nose, bend = shape.top[0][0], shape.top[-1][0], shape.plan[-2][0]
    return _merged([tail, *shape.rear_window, *shape.windscreen, bend, nose], 0.1)


def fine_stations(frame: Frame, shape: CarShape) -> NDArray[np.float64]:
    """Return x of the sections of the finest level [m]: one at each end of a panel."""
    tail, nose = shape.top[0][0], shape.top[-1][0]
    reach = arch_radius(frame.wheel_radius)
    cuts = np.array([-1.0, -0.96, -0.6, 0.6, 0.96, 1.0]) * reach
    arches = [float(axle.x + cut) for axle in frame.axles for cut in cuts]
    lamps = [tail + shape.tail_lamps, nose - shape.head_lamps]
    windows = [x for pair in shape.windows for x in pair]
    glass = [*windows, *shape.windscreen, *shape.rear_window]
    edges = [*glass, *lamps, *arches, *(shape.bed or ()), tail, nose]
    # Kinks of the outline may move slightly to the end of a panel nearby.
    kinks = [x for line in (shape.top, shape.plan) for x, _ in line]
    kinks = [x for x in kinks if min(abs(x - edge) for edge in edges) > 0.07]
    return _merged([*edges, *kinks], 0.004)


def _merged(stations: list[float], least: float) -> NDArray[np.float64]:
    """Return the stations sorted, without those closer than `least` to the one before."""
    kept: list[float] = []
    ordered = sorted(stations)
    for x in ordered:
        if not kept or x - kept[-1] > least:
            kept.append(x)
    kept[-1] = ordered[-1]
    return np.array(kept)


def arch_radius(wheel_radius: float) -> float:
    """Return the radius of the wheel arch [m]."""
    return 1.14 * wheel_radius + 0.02


def _line(points: Points, x: NDArray[np.float64]) -> NDArray[np.float64]:
    table = np.array(points)
    return np.asarray(np.interp(x, table[:, 0], table[:, 1]), np.float64)


def height_at(points: Points, x: float) -> float:
    """Return the height of a line (x, z) at x [m]."""
    return float(_line(points, np.array([x]))[0])


def _floor(frame: Frame, shape: CarShape, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return z of the lower edge of the sides, with wheel arches [m]."""
    z = np.full(len(x), shape.clearance)
    reach = arch_radius(frame.wheel_radius)
    for axle in frame.axles:
        away = np.abs(x - axle.x) / reach
        arch = frame.wheel_radius + reach * np.sqrt(np.maximum(1.0 - np.square(away), 0.0))
        z = np.where(away < 0.99, np.maximum(z, arch), z)
    return z


def half_widths(frame: Frame, shape: CarShape, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return half the widths of the body at its widest points [m]."""
    return (frame.width / 2 - _WIDE_OF_BODY) * _line(shape.plan, x)


def sections(
    frame: Frame, shape: CarShape, x: NDArray[np.float64], *, arches: bool
) -> NDArray[np.float64]:
    """Return the left halves of the sections, all eight points, shape (S, 8, 3)."""
    wide = half_widths(frame, shape, x)
    top = _line(shape.top, x)
    belt = np.minimum(_line(shape.belt, x), top - 0.012)
    rise = top - belt
    floor = _floor(frame, shape, x) if arches else np.full(len(x), shape.clearance)
    floor = np.minimum(floor, belt - 0.07)
    tucked = 0.06 if arches else 0.055  # without arches the wheels protrude from the sides
    sill = wide - np.where(floor > shape.clearance, 0.0, tucked)
    sill_top = np.maximum(floor, shape.clearance + 0.12) if arches else 0.65 * belt
    # Mostly above the arches, so that its line runs straight above them.
    waist = np.maximum(0.84 * belt, floor + 0.02)
    belt_y = wide - 0.045
    window_y = belt_y - 0.06 * np.minimum(rise / 0.3, 1.0) - shape.lean * 0.86 * rise
    window_y = np.minimum(window_y, 0.94 * belt_y)
    roof_y = window_y - 0.085
    halves = [
        (np.zeros(len(x)), floor),
        (sill, floor),
        (wide if arches else sill, sill_top),
        (wide, waist),
        (belt_y, belt),
        (window_y, belt + 0.84 * rise),
        (roof_y, belt + 0.94 * rise),
        (np.zeros(len(x)), top),
    ]
    return np.stack([np.column_stack([x, y, z]) for y, z in halves], axis=1)
