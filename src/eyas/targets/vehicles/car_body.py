"""Car bodies: surfaces through cross-sections, with windows, lamps and wheel arches."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.mesh.shell import Shell
from eyas.state.mesh import Material, Mesh
from eyas.targets.vehicles.car_shape import (
    CarShape,
    arch_radius,
    coarse_stations,
    fine_stations,
    height_at,
    middle_stations,
    sections,
)
from eyas.targets.vehicles.finishes import (
    GLASS,
    HEAD_LAMP,
    PAINT,
    PLATE,
    SKIN_WHITE,
    TAIL_LAMP,
    TRIM,
)
from eyas.targets.vehicles.vehicle import Axle, VehicleModel, vehicle
from eyas.traffic.config import VehicleType

__all__ = ["car"]


@dataclass(frozen=True, slots=True)
class _Detail:
    """Resolution of a body."""

    points: tuple[int, ...]
    """Points of the sections that are used."""
    columns: tuple[float, ...]
    """Limits of the columns of panels at the ends, as shares of the half width."""
    arches: bool


_FINE = _Detail((0, 1, 2, 3, 4, 5, 6, 7), (-1.0, -0.62, 0.62, 1.0), arches=True)
_MIDDLE = _Detail((0, 1, 2, 3, 4, 6, 7), (-1.0, -0.62, 0.62, 1.0), arches=False)
_COARSE = _Detail((1, 4, 6), (-1.0, 1.0), arches=False)


def car(
    name: str,
    kind: VehicleType = VehicleType.PASSENGER,
    *,
    size: tuple[float, float, float],
    wheels: tuple[float, float, float],
    mass: float,
    words: tuple[str, ...],
    shape: CarShape,
    axles: tuple[Axle, ...] | None = None,
) -> VehicleModel:
    """Return a car, van or bus.

    Args:
        name: The original's name.
        kind: SUMO's class.
        size: Length, width with mirrors, and height [m].
        wheels: Wheelbase, wheel radius and x of the front axle [m].
        mass: Empty [kg].
        words: See `Model.words`.
        shape: Its lines.
        axles: None: two with the wheels of a car.
    """
    wheelbase, radius, front = wheels
    track = size[1] - 0.36
    usual = Axle(front, track, 0.23, steered=True), Axle(front - wheelbase, track, 0.23)

    def body(model: VehicleModel) -> tuple[Mesh, ...]:
        return (
            _body(model, shape, _FINE, fine_stations(model, shape)),
            _body(model, shape, _MIDDLE, middle_stations(shape)),
            _body(model, shape, _COARSE, coarse_stations(shape)),
        )

    return vehicle(
        name,
        kind,
        size=size,
        wheelbase=wheelbase,
        wheel_radius=radius,
        axles=axles or usual,
        mass=mass,
        words=words,
        body=body,
    )


def _body(
    model: VehicleModel, shape: CarShape, detail: _Detail, stations: NDArray[np.float64]
) -> Mesh:
    shell = Shell()
    every = sections(model, shape, stations, arches=detail.arches)
    halves = every[:, detail.points]
    for i in range(len(stations) - 1):
        middle = (stations[i] + stations[i + 1]) / 2
        rise = halves[i : i + 2, -1, 2].mean() - height_at(shape.belt, middle)
        back, front = halves[i], halves[i + 1]
        for k, (low, high) in enumerate(zip(detail.points, detail.points[1:], strict=False)):
            quad = [back[k], back[k + 1], front[k + 1], front[k]]
            shell.quads(
                quad, _skin(model, shape, detail, middle, rise, (low, high)), both_sides=True
            )
        if detail.points[-1] != 7:
            mirror = [1.0, -1.0, 1.0]
            quad = [back[-1], back[-1] * mirror, front[-1] * mirror, front[-1]]
            shell.quads(quad, _skin(model, shape, detail, middle, rise, (6, 7)))
    _end(shell, shape, detail, halves[0], front=False)
    _end(shell, shape, detail, halves[-1], front=True)
    if 3 not in detail.points:
        _lamp_panels(shell, shape, every[1], every[0])
        _lamp_panels(shell, shape, every[-2], every[-1])
    if detail.arches:
        _trimmings(shell, model, shape)
    return shell.mesh()


def _skin(
    model: VehicleModel,
    shape: CarShape,
    detail: _Detail,
    x: float,
    rise: float,
    strip: tuple[int, int],
) -> Material:
    """Return the material of a panel.

    Args:
        model: The car.
        shape: Shape of the car.
        detail: Resolution of the body.
        x: Position of the panel's middle [m].
        rise: Height of the roof above the belt line there [m].
        strip: Lower and upper point of the section that the panel lies between.
    """
    low = strip[0]
    tail, nose = shape.top[0][0], shape.top[-1][0]
    if low >= 5:
        return _roof(shape, x, edge=low == 5)
    if low == 4 and rise > 0.1 and _glazed(shape, detail, x):
        return GLASS
    if strip == (3, 4) and x > nose - shape.head_lamps:
        return HEAD_LAMP
    if (strip == (3, 4) or (low == 4 and shape.tall_tail_lamps)) and x < tail + shape.tail_lamps:
        return TAIL_LAMP
    if strip == (1, 2) and detail.arches:
        # The dark lower edges of the bumpers go round the corners, to the wheels.
        return shape.sill if model.axles[1].x < x < model.axles[0].x else TRIM
    return TRIM if low == 0 else PAINT


def _roof(shape: CarShape, x: float, *, edge: bool) -> Material:
    """Return the material of roof, bonnet, boot and the windows between them."""
    if not shape.rear_window[0] < x < shape.windscreen[1]:
        return PAINT
    if edge:
        return shape.rails
    return shape.roof if shape.rear_window[1] < x < shape.windscreen[0] else GLASS


def _glazed(shape: CarShape, detail: _Detail, x: float) -> bool:
    """Return whether there is a side window at x; only the finest level has pillars."""
    if detail.arches:
        return any(start < x < end for start, end in shape.windows)
    return shape.windows[0][0] < x < shape.windows[-1][1]


def _end(
    shell: Shell, shape: CarShape, detail: _Detail, half: NDArray[np.float64], *, front: bool
) -> None:
    """Close one end with rows of panels between the points of its section."""
    columns = np.array(detail.columns)[:, None]
    for k in range(len(half) - 1):
        low, high = (half[j] * np.ones((len(columns), 1)) for j in (k, k + 1))
        low[:, 1:2] *= columns
        high[:, 1:2] *= columns
        for c in range(len(columns) - 1):
            quad = np.array([low[c], low[c + 1], high[c + 1], high[c]])
            outer = len(columns) > 2 and c in (0, len(columns) - 2)
            strip = detail.points[k : k + 2]
            material = _end_skin(shape, strip, outer=outer, front=front)
            if strip == (1, 2) and not detail.arches:
                material = PAINT  # at these levels the sills reach far up
            shell.quads(quad if front else quad[::-1], material)


def _end_skin(shape: CarShape, strip: tuple[int, ...], *, outer: bool, front: bool) -> Material:
    """Return the material of a piece of an end between two points of the section."""
    window = shape.nose_window if front else shape.tail_window
    low = strip[0]
    if strip == (1, 2):
        return TRIM
    if low == 3 and outer:
        return HEAD_LAMP if front else TAIL_LAMP
    if low == 4 and shape.tall_tail_lamps and outer and not front:
        return TAIL_LAMP
    if low == 4 and window:
        return GLASS
    return TRIM if low == 2 and front and not outer else PAINT


def _lamp_panels(
    shell: Shell, shape: CarShape, before: NDArray[np.float64], end: NDArray[np.float64]
) -> None:
    """Add panels for the lamps, 1 cm off the body and around its corner, to a coarse end.

    The coarsest sections have no points for lamps.

    Args:
        shell: Shell to add them to.
        shape: Shape of the car.
        before: All points of the section next to the end [m].
        end: All points of the section at the end [m].
    """
    front = end[0, 0] > before[0, 0]
    material, reach = (HEAD_LAMP, shape.head_lamps) if front else (TAIL_LAMP, shape.tail_lamps)
    low, high = end[3:5] + np.array([0.01 if front else -0.01, 0.0, 0.0])
    inwards = [1.0, _FINE.columns[2], 1.0]
    panels = [[low * inwards, low, high, high * inwards]]
    if abs(end[0, 0] - before[0, 0]) < 2 * reach:
        panels.append([low, before[3], before[4], high])
    quads = np.array(panels)
    shell.quads(quads if front else quads[:, ::-1], material, both_sides=True)


def _trimmings(shell: Shell, model: VehicleModel, shape: CarShape) -> None:
    """Add mirrors, boxes on the roof, number plates and the walls inside the wheel arches."""
    half = model.width / 2
    x = shape.windscreen[1] - 0.42
    z = height_at(shape.belt, x)
    low, high = (x - 0.06, half - 0.2, z + 0.02), (x + 0.08, half, z + 0.15)
    shell.box(low, high, PAINT, taper=0.015, both_sides=True)
    for start, end, top in shape.pods:
        shell.box((start, -0.8, top - 0.5), (end, 0.8, top), SKIN_WHITE, taper=0.06)
    tail, nose = shape.top[0][0], shape.top[-1][0]
    z = shape.clearance + 0.22
    shell.box((nose - 0.02, -0.26, z), (nose + 0.01, 0.26, z + 0.11), PLATE)
    shell.box((tail - 0.01, -0.26, z + 0.12), (tail + 0.02, 0.26, z + 0.23), PLATE)
    for axle in model.axles:
        y = (axle.track - axle.width) / 2 - 0.02
        reach = 1.1 * arch_radius(model.wheel_radius)
        angle = np.linspace(-0.3, np.pi + 0.3, 7)
        rise = np.maximum(model.wheel_radius + reach * exact.sin(angle), shape.clearance)
        wall = np.column_stack([axle.x - reach * exact.cos(angle), np.full(7, y), rise])
        fan = [[wall[0], wall[i], wall[i + 1]] for i in range(1, 6)]
        shell.triangles(fan, TRIM)
        shell.triangles(np.array(fan)[:, ::-1] * [1.0, -1.0, 1.0], TRIM)
