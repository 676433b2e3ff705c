"""Settings of what moves by itself."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from eyas.core.config import Config
from eyas.targets.config import TargetName

__all__ = ["Behaviour", "ExtraConfig"]


class Behaviour(StrEnum):
    """How a pedestrian or a robot moves. None goes through walls, trees or water."""

    POLYLINE = "polyline"
    """Round and round through 2 to 4 random points within 30 m, as the original's pedestrians."""
    PAVEMENT = "pavement"
    """Round a block on its pavement, at 1.1 to 1.7 m/s."""
    CROSSING = "crossing"
    """As on pavements, and over the painted crossings, when no recorded vehicle comes."""
    STRAIGHT = "straight"
    """Straight on; turns away where something is in the way."""
    WANDER = "wander"
    """As straight, but also turns at random, every few metres."""
    WEAVE = "weave"
    """Straight on in a wave."""
    STOP = "stop"
    """Straight, perhaps a turn, and then stands still for good."""


class ExtraConfig(Config):
    """A group that shares the world with the targets, but is never drawn as one."""

    kind: TargetName = TargetName.PEDESTRIAN
    """What they are. `SUMO_VEHICLE`: vehicles of `traffic`, where the target is none of these."""
    count: Annotated[int, Field(ge=1, le=1000)] = 10
    """How many."""
    behaviour: Behaviour | None = None
    """How they move; None: as their kind does. Vehicles drive as SUMO has them drive."""

    @property
    def is_traffic(self) -> bool:
        """Whether they are vehicles of SUMO's."""
        return self.kind is TargetName.SUMO_VEHICLE
