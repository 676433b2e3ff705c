"""The whole configuration: the rooms' settings under one root."""

from enum import StrEnum
from typing import Annotated

from pydantic import AfterValidator, Field

from eyas.core.config import Config
from eyas.core.variation import Variation, within
from eyas.sensors.config import CameraConfig
from eyas.task.config import DoneConfig, RewardConfig, StartConfig
from eyas.trackers.config import TrackerConfig
from eyas.traffic.config import TrafficConfig
from eyas.world.config import WorldConfig

__all__ = [
    "ControlConfig",
    "EyasConfig",
    "LightConfig",
    "Mode",
    "ObjectsConfig",
    "TargetName",
    "VideoConfig",
    "WireConfig",
]


class Mode(StrEnum):
    """What a configuration is meant for; the original's `Simulation_Mode`."""

    DEMO = "demo"
    VIDEO = "video"
    TRAIN = "train"


class TargetName(StrEnum):
    """What can be followed, as the original's `Tracking_Object` names it."""

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


Speed = Annotated[float, Field(ge=-1e4, le=1e4)]
TurnRate = Annotated[float, Field(ge=-1e3, le=1e3)]
Brightness = Annotated[Variation, AfterValidator(within(-100.0, 100.0))]
Visibility = Annotated[Variation, AfterValidator(within(0.1, 1e6))]
Offset = Annotated[Variation, AfterValidator(within(-1e4, 1e4))]


class ControlConfig(Config):
    """How often actions come."""

    frequency: Annotated[int, Field(ge=1, le=500)] = 125
    """Actions in a second [Hz]; each lasts 500 // frequency physics steps of 2 ms."""


class LightConfig(Config):
    """Changes of light and fog; the original's `Env_Params`."""

    each_reset: bool = True
    """Whether they are drawn anew at each reset, or once at the start."""
    background: Brightness = 0.0
    """Brightness of the sky and its light, a factor without unit."""
    background_replaces: bool = False
    """True: `background` is the brightness; False: it is added to the weather's own."""
    sun: Brightness = 0.0
    """Brightness of the sun, a factor without unit."""
    sun_replaces: bool = False
    """True: `sun` is the brightness; False: it is added to the weather's own."""
    visibility: Visibility | None = None
    """Visibility range in foggy weather [m]; None: the weather's own. Others have no fog."""
    flakes: bool = True
    """Whether flakes fall through the picture in snow."""


class ObjectsConfig(Config):
    """How targets other than vehicles are placed; the original's `Other_Params`."""

    max_count: Annotated[int, Field(ge=1, le=1000)] = 10
    """Most objects at a time."""
    interval: Annotated[float, Field(gt=0, le=3600)] = 0.5
    """Time between groups [s]."""
    group_size: Annotated[int, Field(ge=1, le=1000)] = 4
    """Objects placed together."""
    offset: Offset = 0.0
    """Distance from the middle of the road [m]."""


class WireConfig(Config):
    """What the wire server of the original's protocol speaks."""

    address: Annotated[str, Field(min_length=1)] = "127.0.0.1"
    """Network address to listen on."""
    port: Annotated[int, Field(ge=1, le=65535)] = 38711
    """UDP port on which the number of trackers is announced."""
    reward_packet: bool = True
    """Whether the custom reward packet is sent."""
    lidar: bool = False
    """Whether the lidar packet is sent."""


class VideoConfig(Config):
    """What is recorded."""

    channels: Annotated[int, Field(ge=1, le=1024)] = 4
    """Trackers that record side by side in one world."""
    fps: Annotated[float, Field(gt=0, le=500)] = 25.0
    """Pictures in a second of simulated time."""
    start_time: Annotated[float, Field(ge=0, le=1e6)] = 1.0
    """Simulated time at which recording begins [s]."""
    total_time: Annotated[float, Field(gt=0, le=1e6)] = 12.0
    """Simulated time that is recorded [s]."""
    warm_up_steps: Annotated[int, Field(ge=0, le=5_000_000)] = 30
    """2 ms steps after each reset that are not recorded."""
    target_direction: bool = False
    """Whether `mark.json` holds the target's direction instead of reward and action."""
    overlay: bool = False
    """Whether the pictures show what the camera sees, is rewarded for and looks for; labels stay
    the same."""
    random_action: bool = False
    """True: seeded random actions; False: the target is followed exactly."""
    forward_speed: Speed = 40.0
    """Random action 0 [m/s]."""
    backward_speed: Speed = -40.0
    """Random action 1 [m/s]."""
    left_speed: Speed = 40.0
    """Random action 2 [m/s]."""
    right_speed: Speed = -40.0
    """Random action 3 [m/s]."""
    counter_clockwise_rate: TurnRate = 2.0
    """Random action 4 [rad/s]; the original's `cw_omega`, whose sign is named the wrong way."""
    clockwise_rate: TurnRate = -2.0
    """Random action 5 [rad/s]; the original's `ccw_omega`."""


class EyasConfig(Config):
    """Everything that decides a run."""

    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    """The one seed of the run."""
    mode: Mode = Mode.VIDEO
    """What the configuration is meant for."""
    verbose: bool = False
    """Whether a log is written."""
    target: TargetName = TargetName.SUMO_VEHICLE
    """What is followed."""
    world: WorldConfig = WorldConfig()
    traffic: TrafficConfig = TrafficConfig()
    tracker: TrackerConfig = TrackerConfig()
    camera: CameraConfig = CameraConfig()
    control: ControlConfig = ControlConfig()
    start: StartConfig = StartConfig()
    reward: RewardConfig = RewardConfig()
    done: DoneConfig = DoneConfig()
    video: VideoConfig = VideoConfig()
    light: LightConfig = LightConfig()
    objects: ObjectsConfig = ObjectsConfig()
    wire: WireConfig = WireConfig()
