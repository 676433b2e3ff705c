"""Settings of a simulation, composed of those of the packages below it."""

from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from eyas.engine.behaviours.airborne import AirborneConfig
from eyas.engine.behaviours.config import ExtraConfig
from eyas.engine.behaviours.evader import EvaderConfig
from eyas.engine.camera.config import CameraConfig, FurtherCameraConfig
from eyas.engine.core.config import Config
from eyas.engine.core.variation import Variation, within
from eyas.engine.custom.config import CustomConfig
from eyas.engine.sensors.config import LidarConfig, SensorsConfig
from eyas.engine.targets.config import ObjectsConfig, TargetName
from eyas.engine.task.config import DoneConfig, RewardConfig, StartConfig
from eyas.engine.trackers.config import TrackerConfig
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.config import LightConfig, WorldConfig

Latency = Annotated[Variation, AfterValidator(within(0.0, 500.0))]


class ControlConfig(Config):
    """The rate of actions, and how late they and what agents see are."""

    frequency: Annotated[float, Field(ge=1, le=500)] = 125.0
    """Actions per second [Hz]; each lasts the whole part of 500 / frequency physics steps of 2
    ms."""
    action_latency_steps: Latency = 0.0
    """2 ms steps from an action to its effect; drones hover before that of the first. Drawn at each
    reset, rounded."""
    observation_latency_steps: Latency = 0.0
    """2 ms steps by which agents see pictures and sensors late; at the beginning of an episode
    they see its first state. Rewards, ends and `info` are on time, see docs/sensors.md. Drawn at
    each reset, rounded."""


class SimConfig(Config):
    """All settings of a simulation, for any use of it."""

    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    """The one seed of the run; environments whose settings leave it out begin with a fresh one."""
    target: TargetName = TargetName.SUMO_VEHICLE
    """Kind of target to follow."""
    same_target: bool = False
    """Whether all trackers of a world follow the same target; they start on different sides of
    it."""
    world: WorldConfig = WorldConfig()
    traffic: TrafficConfig = TrafficConfig()
    tracker: TrackerConfig = TrackerConfig()
    camera: CameraConfig = CameraConfig()
    cameras: tuple[FurtherCameraConfig, ...] = ()
    """Cameras that each tracker has beside its own, see docs/camera/further.md: each has all
    settings of `camera`, and those below."""
    lidar: LidarConfig = LidarConfig()
    sensors: SensorsConfig = SensorsConfig()
    control: ControlConfig = ControlConfig()
    start: StartConfig = StartConfig()
    reward: RewardConfig = RewardConfig()
    done: DoneConfig = DoneConfig()
    light: LightConfig = LightConfig()
    objects: ObjectsConfig = ObjectsConfig()
    custom: CustomConfig | None = None
    """Your own target, in the place of `target`."""
    extras: tuple[ExtraConfig, ...] | None = None
    """Groups that share the world with the targets as distractors; `null`: the pedestrians of the
    map, see docs/behaviours.md."""
    airborne: AirborneConfig = AirborneConfig()
    evader: EvaderConfig = EvaderConfig()

    @model_validator(mode="after")
    def _cameras_by_name(self) -> "SimConfig":
        names = [camera.name for camera in self.cameras]
        if len(names) != len({*names}):
            raise ValueError("cameras must have names of their own")
        return self

    @model_validator(mode="after")
    def _one_wind(self) -> "SimConfig":
        own = self.tracker.wind
        if self.world.wind is not None and (own.speed, own.direction) != (0.0, 0.0):
            raise ValueError("tracker.wind: speed and direction must be left out with world.wind")
        return self

    @property
    def needs_velocities(self) -> bool:
        """Whether the velocities of cameras must be known."""
        return any(camera.needs_velocities for camera in (self.camera, *self.cameras))

    @model_validator(mode="after")
    def _vehicles_once(self) -> "SimConfig":
        followed = self.custom is None and self.target is TargetName.SUMO_VEHICLE
        extras = self.extras or ()
        if followed and any(extra.is_traffic for extra in extras):
            raise ValueError("extras must not hold SUMO_VEHICLE (see traffic.max_vehicles)")
        if self.start.vehicles is not None and not followed:
            raise ValueError("start.vehicles must be left out: the target is no vehicle")
        return self
