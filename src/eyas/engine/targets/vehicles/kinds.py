"""The kinds of vehicles: one for each SUMO class."""

from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.kind import Kind
from eyas.engine.targets.vehicles.models import VEHICLES
from eyas.engine.targets.vehicles.rig import VehicleRig, trailers_of
from eyas.engine.targets.vehicles.vehicle import BODY_COLOURS, MOTORCYCLE_COLOURS, VEHICLE_AHEAD
from eyas.engine.traffic.config import VehicleType

_TWO_WHEELED = VehicleType.MOTORCYCLE


def _kind(vehicle_type: VehicleType, object_class: ObjectClass) -> Kind:
    models = tuple(model for model in VEHICLES if model.kind == vehicle_type)
    return Kind(
        name=vehicle_type.value,
        models=models,
        colours=MOTORCYCLE_COLOURS if vehicle_type is _TWO_WHEELED else BODY_COLOURS,
        object_class=object_class,
        rig=lambda: VehicleRig(models),
        ahead=VEHICLE_AHEAD,
        slowest=0.5,  # as in the original
        lamps=True,
        trailers=trailers_of(models),
        sections=tuple(model.sections for model in models) if trailers_of(models) else (),
        keeps_colours=vehicle_type is _TWO_WHEELED,
    )


VEHICLE_KINDS: tuple[Kind, ...] = (
    _kind(VehicleType.PASSENGER, ObjectClass.CAR),
    _kind(VehicleType.BUS, ObjectClass.BUS),
    _kind(VehicleType.TRUCK, ObjectClass.TRUCK),
    _kind(VehicleType.TRAILER, ObjectClass.TRUCK),
    _kind(VehicleType.MOTORCYCLE, ObjectClass.MOTORCYCLE),
)
"""All kinds of vehicles, in the order of `VehicleType`."""
