"""Settings of targets."""

from enum import StrEnum
from typing import Annotated

from pydantic import AfterValidator, Field

from eyas.engine.core.config import Config
from eyas.engine.core.errors import UnknownNameError
from eyas.engine.core.variation import Variation, within
from eyas.engine.targets.habit import Behaviour
from eyas.engine.traffic.config import VehicleType


class TargetName(StrEnum):
    """Types of targets; all but the last have the names of the original's `Tracking_Object`."""

    SUMO_VEHICLE = "SUMO_VEHICLE"
    PEDESTRIAN = "Pedestrian"
    SHRIMP = "Shrimp"
    CREATE = "Create"
    SOJOURNER = "Sojourner"
    MANTIS = "Mantis"
    BB_8 = "BB-8"
    AIBO_ERS7 = "AiboErs7"
    BIOLOID_DOG = "BioloidDog"
    FIRE_BIRD_6 = "FireBird6"
    SCOUT = "Scout"
    GHOST_DOG = "GhostDog"
    HOAP_2 = "Hoap2"
    QUADROTOR = "Quadrotor"  # Eyas' own: it flies

    @classmethod
    def elsewhere(cls, name: str) -> str:
        """Return how vehicles of a class become targets; empty if the name is of no such class."""
        kind = _COMMON.get(name.lower(), name.lower())
        return f"SUMO_VEHICLE with traffic.vehicle_type={kind}" if kind in _CLASSES else ""


_CLASSES = {str(kind) for kind in VehicleType}
_COMMON = {
    "buses": "bus",
    "car": "passenger",
    "cars": "passenger",
    "lorry": "truck",
    "motorbike": "motorcycle",
    "trucks": "truck",
    "van": "passenger",
}
"""Classes of vehicles by common names."""


def vehicle_class(name: str, where: str = "--classes") -> VehicleType:
    """Return the class of vehicles of a common name: car, bus, lorry, motorcycle, ...

    Args:
        name: The name, in any case.
        where: The option or setting that an error names.

    Raises:
        UnknownNameError: No class has it.
    """
    kind = _COMMON.get(name.lower(), name.lower())
    if kind not in _CLASSES:
        raise UnknownNameError(where, name, ["car", *VehicleType])
    return VehicleType(kind)


Offset = Annotated[Variation, AfterValidator(within(-1e4, 1e4))]


class ObjectsConfig(Config):
    """Placement of targets other than vehicles; the original's `Other_Params`."""

    max_count: Annotated[int, Field(ge=1, le=1000)] = 10
    """Largest number of objects at a time."""
    interval: Annotated[float, Field(gt=0, le=3600)] = 0.5
    """Time between groups [s]."""
    group_size: Annotated[int, Field(ge=1, le=1000)] = 4
    """Objects placed together."""
    offset: Offset = 0.0
    """Distance to the left of the middle of the road [m]; mirrored: on both sides."""
    behaviour: Behaviour | None = None
    """How they move; None: as their kind does."""
