"""The models of vehicles: names, kinds, sizes, axles and colours.

Sizes are the overall sizes of the original's simplified vehicle models. Model frame: x forward,
y left, z up, origin on the ground in the middle of the overall length and width.
"""

from dataclasses import dataclass

from eyas.targets.kind import Block, Colour, Section
from eyas.traffic.config import VehicleType
from eyas.traffic.trailer import BUMPER_AHEAD, REAR_AXLE, TAIL_BEHIND

__all__ = [
    "BODY_COLOURS",
    "CAB",
    "CHASSIS_BEHIND",
    "MOTORCYCLE_COLOURS",
    "VEHICLES",
    "VEHICLE_AHEAD",
    "Axle",
    "VehicleModel",
]

VEHICLE_AHEAD = -1.0
"""Distance of the middle of a vehicle, the point that the reward uses, ahead of the actor's
reference point [m]: the original rewards a point 1 m behind it; kernels read it."""

CAB = 2.5
"""Length of the cab of a truck above the wheels [m]."""

CHASSIS_BEHIND = 1.0
"""From the rear axle of a truck with a trailer to the end of its chassis [m]."""

_EXHAUST = 0.25
"""How far the exhaust is behind the cab [m]."""

_CHASSIS = 2.5, 1.26
"""Width and height of a truck behind its cab [m]."""

_OVERHANG = 1.35
"""From the front axle of a truck to its bumper [m]."""

LEAN_LIMIT = 0.2
"""Largest lean of two-wheelers in a curve [rad]; the original's limit of the yaw rate [rad/s]."""

BODY_COLOURS: tuple[Colour, ...] = (
    (0.43, 0.11, 0.10),
    (0.85, 0.85, 0.05),
    (0.10, 0.15, 0.18),
    (0.14, 0.29, 0.16),
    (0.18, 0.28, 0.64),
    (0.62, 0.62, 0.62),
    (0.72, 0.52, 0.18),
    (0.18, 0.50, 0.72),
)
"""The original's body colours of cars, buses and trucks, sRGB: dark red, yellow, blue-black, dark
green, blue, grey, ochre, sky blue."""

MOTORCYCLE_COLOURS: tuple[Colour, ...] = (
    (0.66, 0.10, 0.09),
    (0.13, 0.25, 0.62),
    (0.08, 0.45, 0.46),
    (0.72, 0.50, 0.16),
    (0.16, 0.40, 0.17),
    (0.40, 0.14, 0.36),
)
"""The main colours of the original's six colour pairs for two-wheelers, sRGB: red, blue, teal,
ochre, green, plum."""


@dataclass(frozen=True, slots=True)
class Axle:
    """One or two wheels that turn together."""

    x: float
    """Position along the vehicle [m]."""
    track: float
    """Distance between the middles of the two wheels [m]; 0 for a single wheel."""
    width: float
    """Width of a tyre [m]."""
    steered: bool = False
    """Whether the wheels steer."""
    towed: bool = False
    """Whether it is a trailer's."""


@dataclass(frozen=True, slots=True)
class VehicleModel:
    """One model of a vehicle."""

    name: str
    """The original's name of the model."""
    kind: VehicleType
    """SUMO class of the vehicle."""
    length: float
    """Overall length [m]."""
    width: float
    """Overall width, including mirrors [m]."""
    height: float
    """Overall height [m]."""
    wheelbase: float
    """Distance from the steered axle to the driven one [m]."""
    wheel_radius: float
    """Radius of all wheels [m]."""
    axles: tuple[Axle, ...]
    """Axles, the front one first."""
    lean: float = 0.0
    """Largest lean in a curve [rad]."""
    trailer: tuple[float, float, float] | None = None
    """Length, width and height of its trailer [m]."""

    @property
    def typename(self) -> str:
        """The original's `typename`; a trailer has that of the truck, its first part."""
        return "TruckSimple" if self.kind is VehicleType.TRAILER else self.name

    @property
    def articulated(self) -> bool:
        """Whether it has a trailer, which swings behind it."""
        return self.trailer is not None

    @property
    def sections(self) -> tuple[Section, ...]:
        """The truck, with the chassis under its trailer, and the trailer; none without one."""
        if self.trailer is None:
            return ()
        front, end = 0.5 * self.length, self.axles[1].x - CHASSIS_BEHIND
        cab = front - CAB - _EXHAUST
        truck = _block(end, front, self.width, self.height)
        blocks = _block(cab, front, *truck.size[1:]), _block(end, cab, *_CHASSIS)
        trailer = _block(-front, self.trailer[0] - front, *self.trailer[1:])
        return Section("truck", *truck, 0, blocks), Section("trailer", *trailer, 1, (trailer,))

    @property
    def rise(self) -> float:
        """Height of the reference point, and of the axles, above the road [m]."""
        return self.wheel_radius

    @property
    def size(self) -> tuple[float, float, float]:
        """Length, width and height [m]."""
        return self.length, self.width, self.height


def _block(back: float, front: float, width: float, height: float) -> Block:
    return Block(0.5 * (back + front), (front - back, width, height))


def _car(
    name: str, size: tuple[float, float, float], wheels: tuple[float, float, float]
) -> VehicleModel:
    """Return a car; `wheels` are wheelbase, wheel radius and x of the front axle [m]."""
    wheelbase, radius, front = wheels
    track = size[1] - 0.36
    axles = (Axle(front, track, 0.23, steered=True), Axle(front - wheelbase, track, 0.23))
    return VehicleModel(name, VehicleType.PASSENGER, *size, wheelbase, radius, axles)


def _truck(
    name: str, wheelbase: float, trailer: tuple[float, float, float] | None = None
) -> VehicleModel:
    """Return a truck, 4.5 m high; `trailer` holds length, width and height of its trailer [m]."""
    kind = VehicleType.TRAILER if trailer else VehicleType.TRUCK
    length = BUMPER_AHEAD + TAIL_BEHIND if trailer else 7.7
    front = length / 2 - _OVERHANG
    axles = (
        Axle(front, 2.14, 0.32, steered=True),
        Axle(front - wheelbase, 1.9, 0.56),
        *(Axle(x, 2.1, 0.38, towed=True) for x in (_TRAILER_AXLES if trailer else ())),
    )
    return VehicleModel(name, kind, length, 2.8, 4.5, wheelbase, 0.5, axles, trailer=trailer)


def _two_wheeler(
    name: str, size: tuple[float, float, float], wheels: tuple[float, float, float]
) -> VehicleModel:
    """Return a two-wheeler; `wheels` as for a car."""
    wheelbase, radius, front = wheels
    axles = (Axle(front, 0.0, 0.12, steered=True), Axle(front - wheelbase, 0.0, 0.15))
    return VehicleModel(name, VehicleType.MOTORCYCLE, *size, wheelbase, radius, axles, LEAN_LIMIT)


_BUS_AXLES = (Axle(2.3, 2.2, 0.3, steered=True), Axle(-2.2, 1.96, 0.54))
_TRAILER_AXLES = (-3.4, -4.7, -6.0)
_TRACTOR_BASE = BUMPER_AHEAD + REAR_AXLE - _OVERHANG

VEHICLES: tuple[VehicleModel, ...] = (
    _car("BmwX5Simple", (4.85, 1.9, 1.8), (3.0, 0.374, 1.53)),
    _car("CitroenCZeroSimple", (3.5, 1.5, 1.6), (2.55, 0.285, 1.26)),
    _car("ToyotaPriusSimple", (4.5, 1.8, 1.5), (2.8, 0.317, 1.37)),
    _car("LincolnMKZSimple", (5.0, 1.85, 1.5), (2.94, 0.358, 1.52)),
    _car("RangeRoverSportSVRSimple", (4.7, 1.95, 1.7), (2.71, 0.358, 1.45)),
    _car("TeslaModel3Simple", (4.8, 1.85, 1.5), (2.94, 0.36, 1.53)),
    _car("MercedesBenzSprinterSimple", (6.9, 2.0, 2.7), (4.33, 0.40, 2.45)),
    VehicleModel("BusSimple", VehicleType.BUS, 9.73, 2.64, 3.36, 4.5, 0.56, _BUS_AXLES),
    _truck("TruckSimple", 5.25),
    _truck("TruckTrailerSimple", _TRACTOR_BASE, (11.47, 2.52, 4.22)),
    _truck("TruckTankSimple", _TRACTOR_BASE, (11.1, 2.52, 4.22)),
    _two_wheeler("ScooterSimple", (1.95, 0.66, 1.7), (1.48, 0.23, 0.745)),
    _two_wheeler("MotorbikeSimple", (2.48, 1.1, 1.55), (1.78, 0.25, 0.94)),
)
"""All models of vehicles."""
