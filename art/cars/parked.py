"""Cars that never leave their car parks, as `eyas.maps.street.parked_cars` reads them.

Their types have the dimensions and lines of usual cars of each class.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from art.cars.bicycle import parked_bicycles
from art.cars.body import TRACK, body_levels
from art.cars.finishes import TRIM
from art.cars.frame import Axle
from art.cars.shape import CarShape
from art.cars.wheels import wheel_levels
from art.packing import Packer, joined
from eyas.engine.core.cache.flat import flatten
from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.mesh.shipped import digest_of
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.world.build.scene_builder import Levels
from eyas.lanes import exact
from eyas.maps.street.parked_cars import FILE, ParkedIndex


@dataclass(frozen=True, slots=True)
class CarType:
    """A type of car; it has all that `art.cars.frame.Frame` asks."""

    length: float  # Overall length [m]
    width: float  # Overall width, with mirrors [m]
    height: float  # Overall height [m]
    wheel_radius: float  # Radius of the wheels [m]
    axles: tuple[Axle, ...]  # Its axles, the front one first
    shape: CarShape  # Its lines


class _Roof(NamedTuple):
    """What is above the belt line: x as shares of half the length, from the middle."""

    cowl: float  # x of the foot of the windscreen, a share of half the length
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
    """Return a type of car."""
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
            (-half, 0.84), (0.09 - half, 0.94), (0.55 - half, 1.0), (half - 0.7, 1.0),
            (half - 0.2, 0.89), (half, 0.58),
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


COLOURS = {
    "white": (0.92, 0.92, 0.91),
    "black": (0.09, 0.09, 0.10),
    "grey": (0.34, 0.36, 0.39),
    "silver": (0.62, 0.64, 0.66),
    "blue": (0.12, 0.22, 0.42),
    "red": (0.52, 0.10, 0.10),
    "green": (0.16, 0.28, 0.22),
    "beige": (0.74, 0.70, 0.60),
}


class ParkedKind(NamedTuple):
    """A car as it stands there."""

    type: str  # A name in `TYPES`.
    colour: str  # Name of the paint's colour
    look: str = ""
    """What it has: `sunroof`, `worn`, `rack`, `dark` bumpers; `covered` by a tarpaulin; none."""
    steer: float = 0.0  # Angle of the front wheels, to the left [rad]
    rims: int = 0  # Design of its wheel discs


# order: bytes of plans depend on it, which draw an index of `CARS`
KINDS: tuple[ParkedKind, ...] = (
    ParkedKind("compact", "white", rims=1),
    ParkedKind("compact", "black", "sunroof", 0.22),
    ParkedKind("compact", "grey", "worn", rims=2),
    ParkedKind("compact", "silver", "dark", rims=2),
    ParkedKind("compact", "white", "sunroof", -0.2),
    ParkedKind("compact", "blue", rims=3),
    ParkedKind("estate", "grey", "rack", rims=1),
    ParkedKind("compact", "silver", "covered"),
    ParkedKind("small", "white", "dark", rims=2),
    ParkedKind("small", "red", rims=3),
    ParkedKind("small", "grey", steer=0.25),
    ParkedKind("small", "black", "worn", rims=2),
    ParkedKind("small", "white", rims=1),
    ParkedKind("small", "blue", "sunroof"),
    ParkedKind("saloon", "black", "sunroof", rims=1),
    ParkedKind("saloon", "silver", "worn", -0.22),
    ParkedKind("saloon", "white", rims=3),
    ParkedKind("estate", "black", "rack", rims=3),
    ParkedKind("compact", "blue", "sunroof", rims=1),
    ParkedKind("crossover", "white", "rack", rims=1),
    ParkedKind("crossover", "grey", "sunroof", 0.2),
    ParkedKind("crossover", "red", "dark", rims=3),
    ParkedKind("off-road", "black", "rack", rims=1),
    ParkedKind("off-road", "grey", "sunroof"),
    ParkedKind("mini", "white", rims=2),
    ParkedKind("mini", "green", steer=-0.25, rims=2),
    ParkedKind("people carrier", "blue", "rack"),
    ParkedKind("people carrier", "beige", "worn", rims=2),
    ParkedKind("delivery van", "white", "worn", rims=2),
    ParkedKind("minibus", "grey", rims=2),
    ParkedKind("minibus", "white", "worn", 0.2, 2),
    ParkedKind("pickup", "black", rims=3),
)
"""All kinds; each is as frequent as another.

Types: of the cars registered in Germany, 25 % are compact, 19 % small, 13 % of the middle class
(Kraftfahrt-Bundesamt, 1 January 2020) and 10 % sport utility vehicles (the same, 2021); estates are
counted there among the compact and the middle class, and the shares of the others are guesses.
Paint: of those built in 2020 for Europe, the Middle East and Africa, 28 % were white, 76 % white,
black, grey or silver, and 11 % blue (BASF Color Report 2020)."""

TAXI = ParkedKind("saloon", "taxi", rims=1)
_YELLOW = (0.93, 0.70, 0.08)
_TARPAULIN = Material(tint=(0.47, 0.48, 0.49))

_UNDERSIDE = 0.45  # What faces down below this height is not drawn [m]

_AGED = 0.97  # Factor on the tints of all that is not paint: materials of the traffic bear no snow

_UNLIT = {Surface.LAMP, *range(Surface.TAIL_LAMP, len(Surface))}
"""Surfaces that are matt on a car without anybody in it."""


def pack_parked() -> tuple[dict[Path, bytes], str]:
    """Return the file that ships, and the digest of its index."""
    packer = Packer()
    cars = packer.add(joined([levels_of(kind) for kind in (*KINDS, TAXI)]))
    bicycles = packer.add(joined(parked_bicycles()))
    index, _ = flatten(ParkedIndex(tuple(map(_solid_size, KINDS)), cars, bicycles))
    return {FILE: packer.file(index)}, digest_of(index)


def _solid_size(kind: ParkedKind) -> tuple[float, float, float]:
    """Return length, width and height of the solid shape of a kind [m]."""
    car = TYPES[kind.type]
    return car.length, car.width - 0.08, car.height


def levels_of(kind: ParkedKind) -> Levels:
    """Return a car, the finest level of detail first; it stands on the origin, along x [m]."""
    car = TYPES[kind.type]
    wheels = wheel_levels(car.wheel_radius, car.axles[0].width, 0.0, kind.rims)
    fine, middle, coarse = _bodies(car, kind)
    return (
        _painted(concatenate([_above(fine), *_wheels(car, wheels[0], kind.steer)]), kind),
        _painted(concatenate([middle, *_wheels(car, wheels[1], kind.steer)]), kind),
        _painted(coarse, kind),
    )


def _bodies(car: CarType, kind: ParkedKind) -> Levels:
    style = kind.look if kind.look in ("sunroof", "worn") else ""
    shape = replace(
        car.shape,
        bodywork=_bodywork(car.shape.bodywork, style),
        rack=kind.look == "rack",
        dark_bumpers=car.shape.dark_bumpers or kind.look == "dark",
    )
    return body_levels(shape, car)


def _bodywork(base: str, style: str) -> str:
    return f"{base}_{style}" if style and (base, style) != ("van", "sunroof") else base


def _wheels(car: CarType, wheel: Mesh, steer: float) -> list[Mesh]:
    made = []
    for axle in car.axles:
        turn = steer if axle.steered else 0.0
        cosine, sine = exact.cos(turn), exact.sin(turn)
        for side in (0.5, -0.5):
            place = (axle.x, side * axle.track, car.wheel_radius)
            rows = (cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0)
            pose = np.array([[*row, at] for row, at in zip(rows, place, strict=True)])
            made.append(transformed(_outer(wheel, side), pose))
    return made


def _outer(wheel: Mesh, side: float) -> Mesh:
    """Return a wheel without the side that faces the middle of the car, where nobody looks."""
    y = side * wheel.positions[wheel.triangles, 1].astype(np.float64).mean(axis=1)
    return _some(wheel, y > 0.5 * float(y.min()))


def _above(body: Mesh) -> Mesh:
    """Return a body without its underside, which is never seen."""
    corners = body.positions[body.triangles].astype(np.float64)
    face = exact.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    below = corners[..., 2].max(axis=1) < _UNDERSIDE
    return _some(body, ~below | (face[:, 2] > -0.7 * np.sqrt(exact.dot(face, face))))


def _some(mesh: Mesh, shown: NDArray[np.bool_]) -> Mesh:
    """Return some triangles of a mesh, and their corners."""
    triangles = mesh.triangles[shown]
    used, inverse = np.unique(triangles, return_inverse=True)
    return replace(
        mesh,
        positions=mesh.positions[used],
        normals=mesh.normals[used],
        uvs=mesh.uvs[used],
        triangles=inverse.reshape(-1, 3).astype(np.int32),
        materials=mesh.materials[shown],
    )


def _painted(mesh: Mesh, kind: ParkedKind) -> Mesh:
    """Return a mesh in the colour of a kind, with its lamps off."""
    colour = _YELLOW if kind.colour == "taxi" else COLOURS[kind.colour]
    if kind.look == "covered":
        return replace(mesh, palette=tuple(_covered(m) for m in mesh.palette))
    return replace(mesh, palette=tuple(_finish(m, colour) for m in mesh.palette))


@cache
def _finish(material: Material, colour: tuple[float, float, float]) -> Material:
    factors = colour if material.surface is Surface.PAINT else (_AGED,) * 3
    red, green, blue = (t * f for t, f in zip(material.tint, factors, strict=True))
    if material.surface in _UNLIT:
        return Material(tint=(red, green, blue))
    return replace(material, tint=(red, green, blue))


def _covered(material: Material) -> Material:
    """Return a tarpaulin instead of paint, panes and lamps."""
    shown = {Surface.PAINT, Surface.GLASS, *_UNLIT}
    return _TARPAULIN if material.surface in shown else _finish(material, (1.0, 1.0, 1.0))
