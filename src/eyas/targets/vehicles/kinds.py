"""The kinds of vehicles: one for each SUMO class."""

from eyas.state.scene import ObjectClass
from eyas.targets.kind import Kind
from eyas.targets.vehicles.models import (
    BODY_COLOURS,
    MOTORCYCLE_COLOURS,
    VEHICLE_AHEAD,
    VEHICLES,
)
from eyas.targets.vehicles.rig import VehicleRig, trailers_of
from eyas.traffic.config import VehicleType

__all__ = ["VEHICLE_KINDS"]

_CLASSES = {
    VehicleType.PASSENGER: ObjectClass.CAR,
    VehicleType.BUS: ObjectClass.BUS,
    VehicleType.TRUCK: ObjectClass.TRUCK,
    VehicleType.TRAILER: ObjectClass.TRUCK,
    VehicleType.MOTORCYCLE: ObjectClass.MOTORCYCLE,
}


def _kind(vehicle_type: VehicleType) -> Kind:
    models = tuple(model for model in VEHICLES if model.kind == vehicle_type)
    two_wheeled = vehicle_type is VehicleType.MOTORCYCLE
    return Kind(
        name=vehicle_type.value,
        models=models,
        colours=MOTORCYCLE_COLOURS if two_wheeled else BODY_COLOURS,
        object_class=_CLASSES[vehicle_type],
        rig=lambda: VehicleRig(models),
        ahead=VEHICLE_AHEAD,
        slowest=0.5,  # as in the original
        lamps=True,
        trailers=trailers_of(models),
        sections=tuple(model.sections for model in models) if trailers_of(models) else (),
        keeps_colours=two_wheeled,
    )


VEHICLE_KINDS: tuple[Kind, ...] = tuple(_kind(vehicle_type) for vehicle_type in VehicleType)
"""All kinds of vehicles, in the order of `VehicleType`."""
