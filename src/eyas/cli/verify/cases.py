"""The cases of the manifest: every map in every weather, every preset, every kind of tracker."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, NamedTuple

from eyas.cli.verify.measures import flight_of, recording_of, world_of
from eyas.engine.core.config import updated
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import PRESETS, preset_file
from eyas.engine.world.maps import MAPS

_QUICK = {
    "citystreet",
    "citystreet day",
    "citystreet snow",
    "village",
    "village night",
    "citystreet night, 4 samples",
    "preset noisy",
    "preset lively",
    "flown drone",
    "lidar",
}

_EVERYWHERE = ("day", "foggy", "night", "snow")
"""Weathers that are looked at on every map: each other one has shadows or a scene of its own there,
which takes minutes, and is looked at on one."""

_ALONE = {"channels": 1}
_SHARP: dict[str, Any] = {"camera": {"samples": 4}}
_GUSTS = {"speed": {"uniform": [0.0, 8.0]}, "turbulence": 5.0}
_BARREL = {"model": "brown", "k1": -0.2, "vignetting": 0.3, "red": 0.003}

_SETTINGS: dict[str, dict[str, Any]] = {
    "flown drone": {
        "tracker": {
            "supervised": False,
            "motor_time_constant": 0.05,
            "drag_area": 0.02,
            "ground_contact": True,
            "wind": _GUSTS,
        }
    },
    "car": {"tracker": {"kind": "car"}},
    "lidar": {
        "lidar": {"enabled": True},
        "sensors": {"camera": {"noise": 2.5}, "imu": {"rate": 100.0, "noise": 0.01}},
        "start": {"height": 6.0},
    },
    "late": {"control": {"action_latency_steps": 20, "observation_latency_steps": 15}},
    "camera of a small drone": {"camera": {"model": "small-drone", "lens": _BARREL}},
    "other cameras": {
        "camera": {"imager": {"mosaic": "malvar"}, "link": {}, "vibration": {"angle": 0.002}},
        "cameras": [{"name": "heat", "spectrum": "thermal"}],
    },
    "rain behind a fisheye": {
        "world": {"weather": "rain"},
        "camera": {"lens": {"model": "fisheye"}, "field_of_view": 2.0, "dirt": {}},
    },
    "two drones": {"video": {"channels": 2}},
    "Pedestrian as target": {"target": "Pedestrian"},
    "AiboErs7 as target": {"target": "AiboErs7"},
}


class Case(NamedTuple):
    """Something that is computed and hashed."""

    name: str
    map: str
    quick: bool  # Whether `eyas verify --quick` looks at it
    measure: Callable[[], dict[str, str]]  # Returns hashes by the names of what they are of


def cases() -> list[Case]:
    """Return all cases, those of a map one after the other."""
    return sorted([*_of_maps(), *_others()], key=lambda case: case.map)


def _of_maps() -> Iterator[Case]:
    for name in MAPS.names():
        recipe = MAPS.get(name)
        if not (recipe.package or "").startswith("eyas."):
            continue  # a user's own
        yield Case(name, name, name in _QUICK, partial(world_of, _in(name)))
        for weather in recipe.weathers:
            if weather in _EVERYWHERE or name == "citystreet":
                yield _flown(f"{name} {weather}", _in(name, weather))


def _others() -> Iterator[Case]:
    for weather in ("day", "night", "snow"):
        config = updated(_in("citystreet", weather), _SHARP)
        yield _flown(f"citystreet {weather}, 4 samples", config)
    for words, settings in _SETTINGS.items():
        yield _flown(words, updated(_in("citystreet"), settings))
    for preset in PRESETS:
        config = load_settings(preset_file(preset))
        yield _flown(f"preset {preset}", updated(config, {"video": _ALONE}))


def _in(name: str, weather: str | None = None) -> EyasConfig:
    chosen = MAPS.get(name).weathers[0] if weather is None else weather
    return updated(EyasConfig(), {"world": {"map": name, "weather": chosen}, "video": _ALONE})


def _flown(name: str, config: EyasConfig) -> Case:
    return Case(name, config.world.map, name in _QUICK, partial(_flights, config))


def _flights(config: EyasConfig) -> dict[str, str]:
    return flight_of(config) | recording_of(config)
