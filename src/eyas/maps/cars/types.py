"""The types of cars that stand in car parks: dimensions and lines of usual cars of each class."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from eyas.engine.world.cars.body import TRACK
from eyas.engine.world.cars.finishes import TRIM
from eyas.engine.world.cars.frame import Axle
from eyas.engine.world.cars.shape import CarShape

__all__ = ["TYPES", "CarType"]


@dataclass(frozen=True, slots=True)
class CarType:
    """A type of car; it has all that `eyas.engine.world.cars.frame.Frame` asks."""

    length: float  # Overall length [m]
    width: float  # Overall width, with mirrors [m]
    height: float  # Overall height [m]
    wheel_radius: float  # Radius of the wheels [m]
    axles: tuple[Axle, ...]  # Its axles, the front one first
    shape: CarShape  # Its lines


class _Roof(NamedTuple):
    """What is above the belt line: x as shares of half the length, from the middle."""

    cowl: float  # Where the windscreen begins
    front: float  # Front edge of the roof
    back: float  # Rear edge of the roof
    low: float  # Lower edge of the rear window


def _car(
    size: tuple[float, float, float],
    wheels: tuple[float, float, float],
    heights: tuple[float, float, float],
    roof: _Roof,
    **more: Any,  # noqa: ANN401  # other lines of `CarShape`
) -> CarType:
    """Return a type of car.

    Args:
        size: Length, width with mirrors, height [m].
        wheels: Wheelbase, radius, and x of the front axle as a share of half the length [m].
        heights: Lower edge of the rear window, belt line, lower edge of the windscreen [m].
        more: Other lines.
    """
    (length, width, high), (base, radius, share) = size, wheels
    half, (low, belt, cowl) = length / 2, heights
    x = _Roof(*(half * part for part in roof))
    front = share * half
    track = width - TRACK
    axles = Axle(front, track, 0.21, steered=True), Axle(front - base, track, 0.21)
    upright = x.low < 0.02 - half
    tail = [(-half, high - 0.2), (0.06 - half, high - 0.09)]
    if not upright:
        tail = [(-half, low - 0.1), (0.06 - half, low - 0.02), (x.low, low)]
    top = (
        *tail,
        (x.back, high - 0.05),
        (0.5 * (x.front + x.back), high),
        (x.front, high - 0.03),
        (x.cowl, cowl),
        (half - 0.5, cowl - 0.1),
        (half - 0.13, cowl - 0.21),
        (half, cowl - 0.36),
    )
    shape = CarShape(
        top=top,
        belt=(
            (-half, low - 0.12), (0.4 - half, belt), (x.cowl - 0.2, belt - 0.05),
            (half - 0.6, cowl - 0.14), (half, cowl - 0.42),
        ),
        plan=(
            (-half, 0.84), (0.09 - half, 0.94), (0.55 - half, 1.0), (half - 0.6, 1.0),
            (half - 0.16, 0.91), (half, 0.68),
        ),
        windscreen=(x.front, x.cowl + 0.06),
        rear_window=(0.001 - half,) * 2 if upright else (x.low, x.back),
        **more,
    )  # fmt: skip
    return CarType(length, width, high, radius, axles, shape)


TYPES: Mapping[str, CarType] = {
    "mini": _car(
        (3.6, 1.66, 1.49),
        (2.42, 0.285, 0.69),
        (0.98, 0.92, 0.96),
        _Roof(0.60, 0.16, -0.80, -0.965),
        windows=((-1.28, -0.66), (-0.56, 0.62), (0.70, 0.86)),
        lean=0.24,
        tail_lamps=0.12,
        tall_tail_lamps=True,
        head_lamps=0.34,
    ),
    "small": _car(
        (4.0, 1.76, 1.46),
        (2.52, 0.305, 0.64),
        (0.98, 0.92, 0.96),
        _Roof(0.54, 0.10, -0.74, -0.955),
        windows=((-1.42, -0.62), (-0.52, 0.86)),
        lean=0.28,
        head_lamps=0.42,
    ),
    "compact": _car(
        (4.3, 1.81, 1.47),
        (2.64, 0.315, 0.61),
        (1.0, 0.93, 0.96),
        _Roof(0.50, 0.07, -0.70, -0.95),
        windows=((-1.60, -1.08), (-0.98, -0.16), (-0.06, 0.84)),
        lean=0.28,
        head_lamps=0.42,
    ),
    "estate": _car(
        (4.68, 1.84, 1.48),
        (2.72, 0.32, 0.63),
        (1.0, 0.94, 0.96),
        _Roof(0.46, 0.06, -0.79, -0.95),
        windows=((-2.0, -1.16), (-1.06, -0.18), (-0.08, 0.84)),
        lean=0.27,
        head_lamps=0.42,
    ),
    "saloon": _car(
        (4.68, 1.84, 1.45),
        (2.78, 0.32, 0.63),
        (1.03, 0.94, 0.96),
        _Roof(0.45, 0.05, -0.44, -0.74),
        windows=((-1.26, -0.34), (-0.24, 0.84)),
        lean=0.32,
        head_lamps=0.42,
        tail_lamps=0.3,
        bodywork="saloon",
    ),
    "crossover": _car(
        (4.35, 1.83, 1.62),
        (2.63, 0.335, 0.62),
        (1.10, 1.03, 1.07),
        _Roof(0.50, 0.10, -0.74, -0.95),
        windows=((-1.66, -1.10), (-1.0, -0.16), (-0.06, 0.82)),
        clearance=0.24,
        sill=TRIM,
        lean=0.27,
    ),
    "off-road": _car(
        (4.68, 1.92, 1.72),
        (2.75, 0.365, 0.62),
        (1.12, 1.06, 1.12),
        _Roof(0.46, 0.10, -0.80, -0.955),
        windows=((-1.92, -1.22), (-1.12, -0.20), (-0.10, 0.80)),
        clearance=0.27,
        sill=TRIM,
        lean=0.22,
        tall_tail_lamps=True,
    ),
    "people carrier": _car(
        (4.45, 1.85, 1.66),
        (2.76, 0.32, 0.66),
        (1.05, 0.97, 1.03),
        _Roof(0.64, 0.14, -0.82, -0.96),
        windows=((-1.86, -1.10), (-1.0, -0.10), (0.0, 0.98), (1.06, 1.28)),
        lean=0.24,
        tall_tail_lamps=True,
        head_lamps=0.45,
    ),
    "minibus": _car(
        (4.85, 1.98, 1.94),
        (3.0, 0.335, 0.66),
        (1.10, 1.08, 1.10),
        _Roof(0.71, 0.34, -0.93, -0.995),
        windows=((-2.2, -1.28), (-1.18, -0.02), (0.08, 1.30)),
        lean=0.10,
        tail_window=True,
        tail_lamps=0.08,
        clearance=0.24,
        bodywork="van",
    ),
    "delivery van": _car(
        (4.45, 1.87, 1.83),
        (2.72, 0.315, 0.63),
        (1.06, 1.05, 1.08),
        _Roof(0.62, 0.22, -0.92, -0.995),
        windows=((0.12, 1.02),),
        lean=0.10,
        tail_window=True,
        tail_lamps=0.08,
        clearance=0.22,
        bodywork="van",
        dark_bumpers=True,
    ),
    "pickup": _car(
        (4.95, 1.92, 1.76),
        (3.0, 0.37, 0.62),
        (1.06, 1.03, 1.10),
        _Roof(0.42, 0.10, -0.22, -0.29),
        windows=((-0.62, 0.02), (0.12, 0.78)),
        clearance=0.30,
        lean=0.22,
        sill=TRIM,
        tail_lamps=0.1,
        bodywork="saloon",
        bed=(-2.36, -0.78),
    ),
}
"""Types of cars by name. Dimensions are those of usual cars of these classes."""
