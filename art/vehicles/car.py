"""Cars, vans and buses as models of the catalogue."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from art.cars.body import TRACK, body_levels
from art.cars.frame import Axle
from art.cars.shape import CarShape
from art.vehicles.vehicle import VehicleModel, vehicle
from eyas.engine.traffic.config import VehicleType

_VARIANTS: Mapping[str, tuple[dict[str, Any], ...]] = {
    "saloon": (
        {"bodywork": "saloon_sunroof"},
        {"bodywork": "saloon_worn"},
        {"bodywork": "saloon_worn", "dark_bumpers": True},
    ),
    "hatch": (
        {"bodywork": "hatch_sunroof", "rack": False},
        {"bodywork": "hatch_worn", "dark_bumpers": True, "rack": False},
        {"bodywork": "hatch_sunroof", "rack": True},
    ),
    "van": ({"dark_bumpers": False, "rack": True}, {"bodywork": "van_worn", "rack": True}),
}
"""What each further body of a kind of bodywork has that the first has not."""


def variants_of(shape: CarShape) -> tuple[CarShape, ...]:
    """Return the shapes of the further bodies of a car."""
    return tuple(replace(shape, **changes) for changes in _VARIANTS.get(shape.bodywork, ()))


def car(
    name: str,  # The original's name
    kind: VehicleType = VehicleType.PASSENGER,  # SUMO's class
    *,
    size: tuple[float, float, float],  # Length, width with mirrors, and height [m]
    wheels: tuple[float, float, float],  # Wheelbase, wheel radius and x of the front axle [m]
    mass: float,  # Empty [kg]
    words: tuple[str, ...],  # See `Model.words`
    shape: CarShape,  # Its lines
    axles: tuple[Axle, ...] | None = None,  # None: two with the wheels of a car
) -> VehicleModel:
    """Return a car, van or bus."""
    wheelbase, radius, front = wheels
    track = size[1] - TRACK
    usual = Axle(front, track, 0.23, steered=True), Axle(front - wheelbase, track, 0.23)

    return vehicle(
        name,
        kind,
        size=size,
        wheelbase=wheelbase,
        wheel_radius=radius,
        axles=axles or usual,
        mass=mass,
        words=words,
        body=partial(body_levels, shape),
        variants=tuple(partial(body_levels, variant) for variant in variants_of(shape)),
    )
