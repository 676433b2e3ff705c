"""What a model of a vehicle is."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from art.cars.frame import Axle
from art.cars.parked import COLOURS, KINDS
from art.model import DrawnModel
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Mesh
from eyas.engine.targets.kind import Colour, Section, Solid
from eyas.engine.traffic.config import VehicleType

CAB = 2.5  # Length of the cab of a truck above the wheels [m]

CHASSIS_BEHIND = 1.0  # From the rear axle of a truck with a trailer to the end of its chassis [m]

_EXHAUST = 0.25  # How far the exhaust is behind the cab [m]

_CHASSIS = 2.5, 1.26  # Width and height of a truck behind its cab [m]

BODY_COLOURS: tuple[Colour, ...] = tuple(COLOURS[kind.colour] for kind in KINDS)
"""Body colours of cars, buses and trucks, sRGB, as often as among those that are parked: three in
four white, black, grey or silver. The original has eight, half of them yellow, ochre, green and sky
blue. 32 take the same random bits as eight."""

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
class Trailer:
    """What a truck pulls."""

    size: tuple[float, float, float]  # Length, width and height [m]
    shape: "Callable[[Shell, VehicleModel, int], None]"
    """Adds it to a shell, where it is behind a truck that drives straight on, by the detail."""


@dataclass(frozen=True, slots=True, kw_only=True)
class VehicleModel(DrawnModel):
    """One model of a vehicle: model frame x forward, y left, z up, origin on the ground in the
    middle of the overall length and width.
    """

    wheelbase: float  # Distance from the steered axle to the driven one [m]
    wheel_radius: float  # Radius of all wheels [m]
    axles: tuple[Axle, ...]  # Axles, the front one first
    body: "Callable[[VehicleModel], tuple[Mesh, ...]]"
    """Returns the meshes of a model without its wheels, the finest first, in the model frame."""
    variants: "tuple[Callable[[VehicleModel], tuple[Mesh, ...]], ...]" = ()
    """Return further bodies of the model, of the same size, as `body` does."""
    lean: float = 0.0  # Largest lean in a curve [rad]
    trailer: Trailer | None = None

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
        length, width, height = self.trailer.size
        trailer = _block(-front, length - front, width, height)
        return Section("truck", *truck, 0, blocks), Section("trailer", *trailer, 1, (trailer,))


def vehicle(
    name: str,
    kind: VehicleType,
    *,
    size: tuple[float, float, float],
    wheel_radius: float,
    **more: Any,  # noqa: ANN401  # the other fields
) -> VehicleModel:
    """Return a vehicle; one with a trailer has the `typename` of the truck, its first part."""
    return VehicleModel(
        name=name,
        typename="TruckSimple" if kind is VehicleType.TRAILER else name,
        kind=kind.value,
        size=size,
        rise=wheel_radius,
        wheel_radius=wheel_radius,
        motion="drives in traffic, up to 20 m/s",
        speed=8.0,
        stride=2.0 * math.pi * wheel_radius,
        **more,
    )


def _block(back: float, front: float, width: float, height: float) -> Solid:
    return Solid(0.5 * (back + front), (front - back, width, height))
