"""The original's `env_config.json`, key by key, spelt as it spells them.

Defaults are those of its manual; keys that the manual leaves out have the values it ships with.
"""

from typing import Annotated, Literal

from pydantic import Field

from eyas.core.config import Config

__all__ = ["TRACKING_OBJECTS", "LegacyConfig"]

TRACKING_OBJECTS = (
    "SUMO_VEHICLE",
    "Pedestrian",
    "Shrimp",
    "Create",
    "Sojourner",
    "Mantis",
    "BB-8",
    "AiboErs7",
    "BioloidDog",
    "FireBird6",
    "Scout",
    "GhostDog",
    "Hoap2",
)
"""Names that `Tracking_Object` takes."""

Steps = Annotated[int, Field(ge=0, le=2**31 - 1)]
Count = Annotated[int, Field(ge=1, le=10_000_000)]
Positive = Annotated[float, Field(gt=0)]
Share = Annotated[float, Field(ge=0, le=1)]
Pitch = Annotated[float, Field(ge=0.05, le=1.5707964)]
Turn = Annotated[float, Field(ge=-3.2, le=3.2)]


class DoneRange(Config):
    """`Done_Range`."""

    max_height: float = 50
    min_height: float = 2
    velocity: Positive = 100
    omiga: Positive = 6.283
    roll: Positive = 1.22
    pitch: Positive = 1.22
    distance_error: Positive = 50


class LegacyReward(Config):
    """`Reward_Config`."""

    reward_type: Literal["view", "distance"] = "view"
    reward_mode: Literal["continuous", "discrete"] = "continuous"
    reward_cut_off: Share = 0.001
    distance_scale: Positive = 0.01
    distance_range: Positive = 7
    view_scale: Positive = 4
    view_range: Annotated[float, Field(gt=0, le=10)] = 0.7


class SumoParams(Config):
    """`Sumo_Params`."""

    rou_update: bool = False
    max_sumo_car: Annotated[int, Field(ge=1, le=1000)] = 40
    fixed_car_group_num: bool = True
    car_group_num: Annotated[int, Field(ge=1, le=1000)] = 5
    car_import_interval: Annotated[float, Field(gt=0, le=3600)] = 52.0
    car_type: Literal["passenger", "bus", "truck", "trailer", "motorcycle"] = "passenger"
    fixed_color: bool = False
    normalize_color: tuple[Share, Share, Share] = (1, 0, 0)
    max_car_speed: Annotated[float, Field(gt=0, le=100)] = 20
    max_car_accel: Annotated[float, Field(gt=0, le=100)] = 25
    max_car_decel: Annotated[float, Field(gt=0, le=100)] = 25
    max_rou_distance: Positive = 7000
    min_rou_distance: Annotated[float, Field(ge=0)] = 500
    route_num: Count = 100000
    fixed_seed: bool = False
    random_seed: Annotated[int, Field(ge=0, lt=2**31)] = 1


class OtherParams(Config):
    """`Other_Params`."""

    max_obj_num: Annotated[int, Field(ge=1, le=1000)] = 10
    obj_import_interval: Annotated[float, Field(gt=0, le=3600)] = 0.5
    import_group_num: Annotated[int, Field(ge=1, le=1000)] = 4
    obj_edge_distribution_random: bool = False
    obj_edge_distribution_multilateral: bool = False
    obj_edge_distribution_fixed: float = 0
    obj_edge_distribution_max: float = 10
    obj_edge_distribution_min: float = -10


class OutVideo(Config):
    """`Out_Video`."""

    channels: Annotated[int, Field(ge=1, le=1024)] = 4
    fps: Annotated[float, Field(gt=0, le=500)] = 50.0
    start_time: Annotated[float, Field(ge=0)] = 1.0
    total_time: Positive = 50.0
    warm_up_steps: Steps = 30
    output_car_dir: bool = False
    random_action: bool = True
    forward_speed: float = 40
    backward_speed: float = -40
    left_speed: float = 40
    right_speed: float = -40
    cw_omega: float = 2
    ccw_omega: float = -2


class DroneRandomConfig(Config):
    """`Drone_Random_Config`."""

    start_time_bias_ms: Steps = 310
    view_pitch_random: bool = False
    view_pitch_fixed: Pitch = 1
    view_pitch_random_max: Pitch = 1.57
    view_pitch_random_min: Pitch = 0.7
    height_random: bool = True
    height_fixed: Positive = 15.0
    height_random_max: Positive = 25.0
    height_random_min: Positive = 13.0
    direction_random: bool = False
    direction_random_multilateral: bool = False
    direction_fixed: Turn = 0
    direction_random_max: Turn = 0.1
    direction_random_min: Turn = -0.1
    horizon_bias_random: bool = False
    horizon_bias_multilateral: bool = True
    horizon_bias_fixed: float = 0
    horizon_bias_random_max: float = 3
    horizon_bias_random_min: float = 0.1
    verticle_bias_random: bool = False
    verticle_bias_multilateral: bool = True
    verticle_bias_fixed: float = 0
    verticle_bias_random_max: float = 3
    verticle_bias_random_min: float = 0.1


class EnvParams(Config):
    """`Env_Params`."""

    enable_each_reset: bool = True
    background_luminosity_random: bool = False
    bgl_incremental: float = 0
    bgl_random_max: Annotated[float, Field(ge=0)] = 1
    bgl_random_min: Annotated[float, Field(ge=0)] = 0
    backgroundLight_luminosity_random: bool = False  # noqa: N815  # the original's spelling
    bgLl_incremental: float = 0  # noqa: N815
    bgLl_random_max: Annotated[float, Field(ge=0)] = 1  # noqa: N815
    bgLl_random_min: Annotated[float, Field(ge=0)] = 0  # noqa: N815
    foggy_use_default: bool = True
    foggy_visibility_range_random: bool = False
    foggy_visibility_range_fixed: Positive = 400
    foggy_visibility_range_max: Positive = 1000
    foggy_visibility_range_min: Positive = 300


class LegacyConfig(Config):
    """The whole file."""

    Simulation_Mode: Literal["demo", "video", "train"] = "demo"
    Tracker_Def: Literal["DRONE", "CAR"] = "DRONE"
    Drone_Supervisor_Ctrl: bool = True
    Socket_Ip: str = "127.0.0.1"
    Config_Agen_Num_Port: Annotated[int, Field(ge=1, le=65535)] = 38711
    Train_Total_Steps: Annotated[int, Field(ge=1, le=2**31 - 1)] = 1500
    Init_No_Done_Steps: Steps = 100
    No_Reward_Done_Steps: Steps = 100
    Control_Frequence: Annotated[int, Field(ge=1, le=500)] = 125
    Customized_Rewards: bool = True
    Lidar_Enable: bool = False
    Tracking_Object: str = "SUMO_VEHICLE"
    Verbose: bool = False
    Done_Range: DoneRange = DoneRange()
    Reward_Config: LegacyReward = LegacyReward()
    Sumo_Params: SumoParams = SumoParams()
    Other_Params: OtherParams = OtherParams()
    Out_Video: OutVideo = OutVideo()
    Drone_Random_Config: DroneRandomConfig = DroneRandomConfig()
    Env_Params: EnvParams = EnvParams()
    World_Path: str | None = None
