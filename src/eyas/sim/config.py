"""Settings of a simulation, composed of those of the packages below it."""

from typing import Annotated

from pydantic import Field

from eyas.core.config import Config
from eyas.sensors.config import CameraConfig, LidarConfig, SensorsConfig
from eyas.targets.config import ObjectsConfig, TargetName
from eyas.task.config import DoneConfig, RewardConfig, StartConfig
from eyas.trackers.config import TrackerConfig
from eyas.traffic.config import TrafficConfig
from eyas.world.config import LightConfig, WorldConfig

__all__ = ["ControlConfig", "SimConfig"]


class ControlConfig(Config):
    """The rate of actions."""

    frequency: Annotated[float, Field(ge=1, le=500)] = 125.0
    """Actions per second [Hz]; each lasts the whole part of 500 / frequency physics steps of 2
    ms."""


class SimConfig(Config):
    """All settings of a simulation, for any use of it."""

    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    """The one seed of the run."""
    target: TargetName = TargetName.SUMO_VEHICLE
    """Kind of target to follow."""
    same_target: bool = False
    """Whether all trackers of a world follow the same target; they start on different sides of
    it."""
    world: WorldConfig = WorldConfig()
    traffic: TrafficConfig = TrafficConfig()
    tracker: TrackerConfig = TrackerConfig()
    camera: CameraConfig = CameraConfig()
    lidar: LidarConfig = LidarConfig()
    sensors: SensorsConfig = SensorsConfig()
    control: ControlConfig = ControlConfig()
    start: StartConfig = StartConfig()
    reward: RewardConfig = RewardConfig()
    done: DoneConfig = DoneConfig()
    light: LightConfig = LightConfig()
    objects: ObjectsConfig = ObjectsConfig()
