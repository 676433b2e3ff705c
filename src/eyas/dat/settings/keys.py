"""Every key of an `env_config.json`, and our setting for it."""

from eyas.dat.settings.entries import (
    Optional,
    OriginalEntry,
    Pitch,
    Same,
    Span,
    Switch,
    Varied,
    WorldPath,
)
from eyas.engine.traffic.config import Demand

KEEP_ALIVE = "Sumo_Params.keep_alive"
"""A key of ours, which the original ignores: without it, or false, its traffic is meant."""

GROUP_KEYS = frozenset(
    f"Sumo_Params.{name}"
    for name in (
        "fixed_car_group_num",
        "car_group_num",
        "car_import_interval",
        "max_rou_distance",
        "min_rou_distance",
        "route_num",
    )
)
"""Keys that have an effect on the original's traffic only."""


def _sampled(name: str, path: str, sides: str | None, kind: type[Varied] = Varied) -> Varied:
    group = "Drone_Random_Config"
    return kind(
        random=f"{group}.{name}_random",
        fixed=f"{group}.{name}_fixed",
        least=f"{group}.{name}_random_min",
        most=f"{group}.{name}_random_max",
        path=path,
        sides=f"{group}.{sides}" if sides else None,
    )


_BASIC = (
    Same("Simulation_Mode", "mode"),
    Same("Tracker_Def", "tracker.kind", upper_case=True),
    Same("Drone_Supervisor_Ctrl", "tracker.supervised"),
    Same("Socket_Ip", "wire.address"),
    Same("Config_Agen_Num_Port", "wire.port"),
    Same("Train_Total_Steps", "done.total_steps"),
    Same("Init_No_Done_Steps", "done.grace_steps"),
    Same("No_Reward_Done_Steps", "done.no_reward_steps"),
    Same("Control_Frequence", "control.frequency"),
    Same("Customized_Rewards", "wire.reward_packet"),
    Same("Lidar_Enable", "lidar.enabled"),
    Same("Tracking_Object", "target"),
    Same("Verbose", "verbose"),
    WorldPath("World_Path", "world.map", "world.weather"),
)

_TASK = (
    Same("Done_Range.max_height", "done.max_height"),
    Same("Done_Range.min_height", "done.min_height"),
    Same("Done_Range.velocity", "done.velocity"),
    Same("Done_Range.omiga", "done.yaw_rate"),
    Same("Done_Range.roll", "done.roll"),
    Same("Done_Range.pitch", "done.pitch"),
    Same("Done_Range.distance_error", "done.distance_error"),
    Same("Done_Range.crash", "done.crash"),  # ours, which the original ignores
    Same("Reward_Config.reward_type", "reward.type"),
    Same("Reward_Config.reward_mode", "reward.mode"),
    Same("Reward_Config.reward_cut_off", "reward.cut_off"),
    Same("Reward_Config.distance_scale", "reward.distance_scale"),
    Same("Reward_Config.distance_range", "reward.distance_range"),
    Same("Reward_Config.view_scale", "reward.view_scale"),
    Same("Reward_Config.view_range", "reward.view_range"),
)

_SUMO = (
    Switch(KEEP_ALIVE, "traffic.demand", on=Demand.KEEP_ALIVE.value, off=Demand.RESPAWN.value),
    Same("Sumo_Params.rou_update", "traffic.update_routes"),
    Same("Sumo_Params.max_sumo_car", "traffic.max_vehicles"),
    Optional("Sumo_Params.fixed_car_group_num", "Sumo_Params.car_group_num", "traffic.group_size"),
    Same("Sumo_Params.car_import_interval", "traffic.group_interval"),
    Same("Sumo_Params.car_type", "traffic.vehicle_type"),
    Optional("Sumo_Params.fixed_color", "Sumo_Params.normalize_color", "traffic.colour"),
    Same("Sumo_Params.max_car_speed", "traffic.max_speed"),
    Same("Sumo_Params.max_car_accel", "traffic.max_acceleration"),
    Same("Sumo_Params.max_car_decel", "traffic.max_deceleration"),
    Span("Sumo_Params.min_rou_distance", "Sumo_Params.max_rou_distance", "traffic.route_length"),
    Same("Sumo_Params.route_num", "traffic.route_count"),
    Optional("Sumo_Params.fixed_seed", "Sumo_Params.random_seed", "traffic.seed"),
)

_OBJECTS = (
    Same("Other_Params.max_obj_num", "objects.max_count"),
    Same("Other_Params.obj_import_interval", "objects.interval"),
    Same("Other_Params.import_group_num", "objects.group_size"),
    Varied(
        random="Other_Params.obj_edge_distribution_random",
        fixed="Other_Params.obj_edge_distribution_fixed",
        least="Other_Params.obj_edge_distribution_min",
        most="Other_Params.obj_edge_distribution_max",
        path="objects.offset",
        sides="Other_Params.obj_edge_distribution_multilateral",
    ),
)

_VIDEO = (
    Same("Out_Video.channels", "video.channels"),
    Same("Out_Video.fps", "video.fps"),
    Same("Out_Video.start_time", "video.start_time"),
    Same("Out_Video.total_time", "video.total_time"),
    Same("Out_Video.warm_up_steps", "video.warm_up_steps"),
    Same("Out_Video.output_car_dir", "video.target_direction"),
    Switch("Out_Video.random_action", "video.flight", on="random", off="exact"),
    Same("Out_Video.forward_speed", "video.forward_speed"),
    Same("Out_Video.backward_speed", "video.backward_speed"),
    Same("Out_Video.left_speed", "video.left_speed"),
    Same("Out_Video.right_speed", "video.right_speed"),
    # The original's names are swapped: positive turns counter-clockwise, seen from above.
    Same("Out_Video.cw_omega", "video.counter_clockwise_rate"),
    Same("Out_Video.ccw_omega", "video.clockwise_rate"),
)

_START = (
    # Steps of 2 ms, not milliseconds, in spite of its name.
    Same("Drone_Random_Config.start_time_bias_ms", "start.warm_up_steps"),
    _sampled("view_pitch", "start.pitch", None, Pitch),
    _sampled("height", "start.height", None),
    _sampled("direction", "start.direction", "direction_random_multilateral"),
    _sampled("horizon_bias", "start.horizontal_bias", "horizon_bias_multilateral"),
    _sampled("verticle_bias", "start.vertical_bias", "verticle_bias_multilateral"),
)

_LIGHT = (
    Same("Env_Params.enable_each_reset", "light.each_reset"),
    Varied(
        random="Env_Params.background_luminosity_random",
        fixed="Env_Params.bgl_incremental",
        least="Env_Params.bgl_random_min",
        most="Env_Params.bgl_random_max",
        path="light.background",
        replaces="light.background_replaces",
    ),
    Varied(
        random="Env_Params.backgroundLight_luminosity_random",
        fixed="Env_Params.bgLl_incremental",
        least="Env_Params.bgLl_random_min",
        most="Env_Params.bgLl_random_max",
        path="light.sun",
        replaces="light.sun_replaces",
    ),
    Varied(
        random="Env_Params.foggy_visibility_range_random",
        fixed="Env_Params.foggy_visibility_range_fixed",
        least="Env_Params.foggy_visibility_range_min",
        most="Env_Params.foggy_visibility_range_max",
        path="light.visibility",
        default="Env_Params.foggy_use_default",
    ),
)

ENTRIES: tuple[OriginalEntry, ...] = (*_BASIC, *_TASK, *_SUMO, *_OBJECTS, *_VIDEO, *_START, *_LIGHT)
"""Every key is in exactly one entry."""
