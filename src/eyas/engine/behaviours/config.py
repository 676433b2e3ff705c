"""Settings of what moves by itself."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from eyas.engine.core.config import Config
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour


class Rider(StrEnum):
    """Who rides, and is nobody's target."""

    CYCLIST = "Cyclist"


class ExtraConfig(Config):
    """A group that shares the world with the targets, but is never chosen as one."""

    kind: TargetName | Rider = TargetName.PEDESTRIAN
    """What they are. `SUMO_VEHICLE`: vehicles of `traffic`, where the target is none of these."""
    count: Annotated[int, Field(ge=1, le=1000)] = 10
    """How many."""
    behaviour: Behaviour | None = None
    """How they move; None: as their kind does. Vehicles drive as SUMO has them drive."""

    @property
    def is_traffic(self) -> bool:
        """Whether they are vehicles of SUMO's."""
        return self.kind is TargetName.SUMO_VEHICLE
