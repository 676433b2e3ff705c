"""The body of each model, as levels of detail."""

from eyas.state.mesh import Mesh
from eyas.targets.vehicles.car_body import car_levels
from eyas.targets.vehicles.cars import CAR_SHAPES
from eyas.targets.vehicles.heavy import truck_levels
from eyas.targets.vehicles.models import VehicleModel
from eyas.targets.vehicles.two_wheelers import two_wheeler_levels
from eyas.traffic.config import VehicleType

__all__ = ["body_levels"]


def body_levels(vehicle: VehicleModel) -> tuple[Mesh, ...]:
    """Return the meshes of a model without its wheels, the finest first, in the model's frame."""
    if vehicle.kind == VehicleType.MOTORCYCLE:
        return two_wheeler_levels(vehicle)
    if vehicle.kind in (VehicleType.TRUCK, VehicleType.TRAILER):
        return truck_levels(vehicle)
    return car_levels(vehicle, CAR_SHAPES[vehicle.name])
