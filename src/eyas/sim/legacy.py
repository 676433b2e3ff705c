"""The one adapter between our settings and the original's `env_config.json`."""

import json
import re
from pathlib import Path
from typing import Any

from eyas.core.config import validated
from eyas.core.errors import ConfigError, UnknownNameError
from eyas.core.files import write_atomic
from eyas.core.variation import Choice, Mirrored, Uniform, Variation
from eyas.sim.config import EyasConfig
from eyas.sim.legacy_model import TRACKING_OBJECTS, LegacyConfig

__all__ = ["from_legacy", "is_legacy", "save_legacy", "to_legacy"]

_SAME = {
    # The original's key: ours, where the value means the same.
    "Simulation_Mode": "mode",
    "Drone_Supervisor_Ctrl": "tracker.supervised",
    "Socket_Ip": "wire.address",
    "Config_Agen_Num_Port": "wire.port",
    "Train_Total_Steps": "done.total_steps",
    "Init_No_Done_Steps": "done.grace_steps",
    "No_Reward_Done_Steps": "done.no_reward_steps",
    "Control_Frequence": "control.frequency",
    "Customized_Rewards": "wire.reward_packet",
    "Lidar_Enable": "wire.lidar",
    "Tracking_Object": "target",
    "Verbose": "verbose",
    "Done_Range.max_height": "done.max_height",
    "Done_Range.min_height": "done.min_height",
    "Done_Range.velocity": "done.velocity",
    "Done_Range.omiga": "done.yaw_rate",
    "Done_Range.roll": "done.roll",
    "Done_Range.pitch": "done.pitch",
    "Done_Range.distance_error": "done.distance_error",
    "Reward_Config.reward_type": "reward.type",
    "Reward_Config.reward_mode": "reward.mode",
    "Reward_Config.reward_cut_off": "reward.cut_off",
    "Reward_Config.distance_scale": "reward.distance_scale",
    "Reward_Config.distance_range": "reward.distance_range",
    "Reward_Config.view_scale": "reward.view_scale",
    "Reward_Config.view_range": "reward.view_range",
    "Sumo_Params.rou_update": "traffic.update_routes",
    "Sumo_Params.max_sumo_car": "traffic.max_vehicles",
    "Sumo_Params.car_import_interval": "traffic.group_interval",
    "Sumo_Params.car_type": "traffic.vehicle_type",
    "Sumo_Params.max_car_speed": "traffic.max_speed",
    "Sumo_Params.max_car_accel": "traffic.max_acceleration",
    "Sumo_Params.max_car_decel": "traffic.max_deceleration",
    "Sumo_Params.route_num": "traffic.route_count",
    "Other_Params.max_obj_num": "objects.max_count",
    "Other_Params.obj_import_interval": "objects.interval",
    "Other_Params.import_group_num": "objects.group_size",
    "Out_Video.channels": "video.channels",
    "Out_Video.fps": "video.fps",
    "Out_Video.start_time": "video.start_time",
    "Out_Video.total_time": "video.total_time",
    "Out_Video.warm_up_steps": "video.warm_up_steps",
    "Out_Video.output_car_dir": "video.target_direction",
    "Out_Video.random_action": "video.random_action",
    "Out_Video.forward_speed": "video.forward_speed",
    "Out_Video.backward_speed": "video.backward_speed",
    "Out_Video.left_speed": "video.left_speed",
    "Out_Video.right_speed": "video.right_speed",
    "Out_Video.cw_omega": "video.counter_clockwise_rate",
    "Out_Video.ccw_omega": "video.clockwise_rate",
    "Drone_Random_Config.start_time_bias_ms": "start.warm_up_steps",
    "Env_Params.enable_each_reset": "light.each_reset",
}

_VARIATIONS = {
    # The original's keys (random, fixed, least, most, multilateral or none): ours.
    **{
        f"Drone_Random_Config.{name}": (
            (f"{name}_random", f"{name}_fixed", f"{name}_random_min", f"{name}_random_max", sides),
            f"start.{ours}",
        )
        for name, ours, sides in (
            ("view_pitch", "pitch", None),
            ("height", "height", None),
            ("direction", "direction", "direction_random_multilateral"),
            ("horizon_bias", "horizontal_bias", "horizon_bias_multilateral"),
            ("verticle_bias", "vertical_bias", "verticle_bias_multilateral"),
        )
    },
    "Other_Params.offset": (
        (
            "obj_edge_distribution_random",
            "obj_edge_distribution_fixed",
            "obj_edge_distribution_min",
            "obj_edge_distribution_max",
            "obj_edge_distribution_multilateral",
        ),
        "objects.offset",
    ),
    "Env_Params.background": (
        ("background_luminosity_random", "bgl_incremental", "bgl_random_min", "bgl_random_max", None),
        "light.background",
    ),
    "Env_Params.sun": (
        (
            "backgroundLight_luminosity_random",
            "bgLl_incremental",
            "bgLl_random_min",
            "bgLl_random_max",
            None,
        ),
        "light.sun",
    ),
}

_FOG = (
    "foggy_visibility_range_random",
    "foggy_visibility_range_fixed",
    "foggy_visibility_range_min",
    "foggy_visibility_range_max",
    None,
)

_WORLD = re.compile(r"([a-z]+)-([a-z]+)\.wbt$")

Values = dict[str, Any]


def is_legacy(values: Values) -> bool:
    """Return whether settings read from JSON are the original's."""
    return any(key in LegacyConfig.model_fields for key in values)


def from_legacy(values: Values, base: EyasConfig | None = None) -> EyasConfig:
    """Return settings with what an `env_config.json` says.

    Args:
        values: Its content; groups and keys that are missing have the manual's defaults.
        base: Where what it cannot say comes from (map, camera, demand, ...).

    Raises:
        ConfigError: An unknown key, a wrong type or value; one line with the original's path.
    """
    legacy = validated(LegacyConfig, values)
    if legacy.Tracking_Object not in TRACKING_OBJECTS:
        raise UnknownNameError("Tracking_Object", legacy.Tracking_Object, TRACKING_OBJECTS)
    theirs = legacy.model_dump(mode="json")
    ours = (base or EyasConfig()).model_dump(mode="json")
    for key, path in _SAME.items():
        _put(ours, path, _get(theirs, key))
    for prefix, (names, path) in _VARIATIONS.items():
        _put(ours, path, _read_variation(theirs[prefix.partition(".")[0]], names))
    light, traffic = theirs["Env_Params"], theirs["Sumo_Params"]
    _put(ours, "light.background_random", light["background_luminosity_random"])
    _put(ours, "light.sun_random", light["backgroundLight_luminosity_random"])
    fog = None if light["foggy_use_default"] else _read_variation(light, _FOG)
    _put(ours, "light.visibility", fog)
    _put(ours, "tracker.kind", theirs["Tracker_Def"].lower())
    _put(ours, "traffic.route_length", [traffic["min_rou_distance"], traffic["max_rou_distance"]])
    fixed = traffic["fixed_car_group_num"]
    _put(ours, "traffic.group_size", traffic["car_group_num"] if fixed else None)
    _put(ours, "traffic.colour", traffic["normalize_color"] if traffic["fixed_color"] else None)
    _put(ours, "traffic.seed", traffic["random_seed"] if traffic["fixed_seed"] else None)
    if world := _WORLD.search(legacy.World_Path or ""):
        ours["world"].update(map=world[1], weather=world[2])
    return validated(EyasConfig, ours)


def to_legacy(config: EyasConfig) -> Values:
    """Return settings as an `env_config.json`, all groups and keys.

    Raises:
        ConfigError: A choice among values, which the original cannot say.
    """
    ours = config.model_dump(mode="json")
    theirs = LegacyConfig().model_dump(mode="json", exclude={"World_Path"})
    for key, path in _SAME.items():
        _put(theirs, key, _get(ours, path))
    for prefix, (names, path) in _VARIATIONS.items():
        group = theirs[prefix.partition(".")[0]]
        _write_variation(group, names, _variation(config, path), path)
    light, traffic = theirs["Env_Params"], theirs["Sumo_Params"]
    light["background_luminosity_random"] = config.light.background_random
    light["backgroundLight_luminosity_random"] = config.light.sun_random
    light["foggy_use_default"] = config.light.visibility is None
    if config.light.visibility is not None:
        _write_variation(light, _FOG, config.light.visibility, "light.visibility")
    theirs["Tracker_Def"] = config.tracker.kind.upper()
    traffic["min_rou_distance"], traffic["max_rou_distance"] = config.traffic.route_length
    _write_optional(traffic, "fixed_car_group_num", "car_group_num", config.traffic.group_size)
    _write_optional(traffic, "fixed_color", "normalize_color", config.traffic.colour)
    _write_optional(traffic, "fixed_seed", "random_seed", config.traffic.seed)
    return theirs


def save_legacy(config: EyasConfig, path: Path) -> bool:
    """Write an `env_config.json`; return False, and write none, where it cannot say all.

    Raises:
        OutputError: The file system refused.
    """
    try:
        text = json.dumps(to_legacy(config), indent=4)
    except ConfigError:
        return False
    write_atomic(path, text.encode())
    return True


Names = tuple[str, str, str, str, str | None]


def _read_variation(group: Values, names: Names) -> Any:  # noqa: ANN401  # JSON
    random, fixed, least, most, sides = names
    if not group[random]:
        return group[fixed]
    return {"mirrored" if sides and group[sides] else "uniform": [group[least], group[most]]}


def _write_variation(group: Values, names: Names, value: Variation, path: str) -> None:
    random, fixed, least, most, sides = names
    group[random] = not isinstance(value, float | int)
    if sides is not None and group[random]:
        group[sides] = isinstance(value, Mirrored)
    match value:
        case Uniform(uniform=pair):
            group[least], group[most] = pair
        case Mirrored(mirrored=pair) if sides is not None:
            group[least], group[most] = pair
        case Choice() | Mirrored():
            raise ConfigError(f"{path}: env_config.json cannot say {value.model_dump_json()}")
        case _:
            group[fixed] = value


def _write_optional(group: Values, switch: str, key: str, value: object) -> None:
    group[switch] = value is not None
    if value is not None:
        group[key] = list(value) if isinstance(value, tuple) else value


def _variation(config: EyasConfig, path: str) -> Variation:
    room, name = path.split(".")
    value: Variation = getattr(getattr(config, room), name)
    return value


def _get(values: Values, path: str) -> Any:  # noqa: ANN401  # JSON
    for part in path.split("."):
        values = values[part]
    return values


def _put(values: Values, path: str, value: Any) -> None:  # noqa: ANN401  # JSON
    *groups, name = path.split(".")
    for group in groups:
        values = values[group]
    values[name] = value
