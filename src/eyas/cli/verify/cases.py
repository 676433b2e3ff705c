"""The cases of the manifest, maps, weathers, presets and trackers, and what is hashed of each."""

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from gymnasium.spaces import Box, Discrete

from eyas.engine.core.cache.flat import flatten
from eyas.engine.core.config import updated
from eyas.engine.core.scratch import scratch
from eyas.engine.envs.information import Info
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.env import ObservationPart
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import PRESETS, preset_file
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.crowd import crowd_of
from eyas.engine.targets.catalogue import kind_index
from eyas.engine.targets.config import TargetName
from eyas.engine.video.run import run
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


_SEED = 5
_ACTIONS = 12
_SIZE = {"width": 160, "height": 120}
_SHORT = {"total_time": 0.25, "fps": 12.5, "flight": "random"}
_PARTS = ("image", "depth", "classes", "sensors", "privileged")
_KINDS = {".jpeg": "JPEG files", ".jsonl": "labels", ".json": "marks", ".csv": "lidar files"}
"""The files of an episode by their endings."""


class _Hashes:
    """Hashes of named things, each of whatever is added to it."""

    def __init__(self) -> None:
        self._digests: dict[str, Any] = {}

    def add(self, name: str, *parts: bytes) -> None:
        digest = self._digests.setdefault(name, hashlib.blake2b(digest_size=8))
        for part in parts:
            digest.update(part)

    def add_array(self, name: str, values: object) -> None:
        array = np.asarray(values, order="C")
        self.add(name, repr((array.dtype.str, array.shape)).encode(), array.tobytes())

    def told(self) -> dict[str, str]:
        return {name: digest.hexdigest() for name, digest in self._digests.items()}


def world_of(config: EyasConfig) -> dict[str, str]:
    """Return hashes of a map's scene, and of the ways of its vehicles and people."""
    assets, hashes = load_assets(config.world, config.traffic, 1, crowd_of(config)), _Hashes()
    flat, arrays = flatten(assets.scene)
    hashes.add("scene", json.dumps(flat, sort_keys=True).encode())
    for array in arrays:
        hashes.add_array("scene", array)
    motion, walker = assets.traffic.motion, kind_index(TargetName.PEDESTRIAN.value)
    whole = motion.sampled().table
    for name, chosen in (("people", motion.kind == walker), ("traffic", motion.kind != walker)):
        for field in whole.dtype.names or ():
            hashes.add_array(name, whole[field][:, chosen])
    return hashes.told()


def flight_of(config: EyasConfig) -> dict[str, str]:
    """Return hashes of what an agent with random actions gets: pictures, rewards, the rest."""
    parts = _PARTS + ((ObservationPart.LIDAR.value,) if config.lidar.enabled else ())
    parts += (ObservationPart.CAMERAS.value,) if config.cameras else ()
    settings = {"observation": {"parts": parts, **_SIZE}}
    hashes = _Hashes()
    env = TrackingEnv(updated(config, {"env": settings, "camera": _SIZE}))
    rng = np.random.default_rng(_SEED)
    _note(hashes, *env.reset(seed=_SEED))
    for _ in range(_ACTIONS):
        observation, reward, terminated, truncated, info = env.step(_action(env, rng))
        _note(hashes, observation, info)
        hashes.add("rewards", repr((reward, terminated, truncated)).encode())
        if terminated or truncated:
            _note(hashes, *env.reset())
    env.close()
    return hashes.told()


def _action(env: TrackingEnv, rng: np.random.Generator) -> object:
    space = env.action_space
    if isinstance(space, Discrete):
        return int(rng.integers(space.n))
    assert isinstance(space, Box)
    return rng.uniform(space.low, space.high)


def _note(hashes: _Hashes, observation: object, info: Info) -> None:
    assert isinstance(observation, Mapping)
    for part, values in sorted(observation.items()):
        picture = part in ("image", "depth", "classes", "cameras")
        hashes.add_array("pictures" if picture else "packets", values)
    for name, value in sorted(info.items()):
        if name != "seed":  # of the run, not of what it gives
            hashes.add_array("rewards" if name.startswith("reward") else "packets", value)


def recording_of(config: EyasConfig) -> dict[str, str]:
    """Return hashes of the files of a short recording, but for films: these hold versions."""
    writers = ["jpeg", "labels", "mark"] + ["lidar"] * config.lidar.enabled
    settings = updated(config, {"video": _SHORT | {"writers": writers}, "camera": _SIZE})
    settings = updated(settings, {"seed": _SEED, "start": {"warm_up_steps": 0}})
    settings = settings.model_copy(update={"original": None})  # which would begin later
    hashes = _Hashes()
    with scratch() as folder:
        run(settings, folder / "run", quiet=True)
        for path in _of_episodes(folder.rglob("*.*")):
            hashes.add(_KINDS[path.suffix], path.name.encode(), path.read_bytes())
    return hashes.told()


def _of_episodes(paths: Iterable[Path]) -> list[Path]:
    return sorted(path for path in paths if path.parent.name.startswith("episode"))
