"""What simulations on a device cannot do yet, each told in one line."""

from collections.abc import Iterator
from itertools import chain

from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.errors import ConfigError
from eyas.engine.sensors.config import SensorsConfig
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.latency import is_always_0
from eyas.engine.targets.posing import PoseCall
from eyas.engine.task.config import Crash
from eyas.engine.trackers.tracker import Tracker

_CAMERA = ("width", "height", "field_of_view", "samples", "mount")
"""Settings of the camera that may have any value."""


def check_device(config: SimConfig, assets: Assets, tracker: Tracker) -> None:
    """Refuse settings that need the host in a step.

    Raises:
        ConfigError: There is such a setting.
    """
    refused = chain(_sensed(config), _simulated(config, assets, tracker), _drawn(assets))
    for setting, allowed in refused:
        raise ConfigError(f"{setting} is not there on a device; allowed: {allowed}")


Refused = Iterator[tuple[str, str]]
"""Settings with their values, and what is allowed in the place of each."""


def _sensed(config: SimConfig) -> Refused:
    for name in ("action_latency_steps", "observation_latency_steps"):
        value = getattr(config.control, name)
        if not is_always_0(value):
            yield f"control.{name}: {value}", "0"
    usual = CameraConfig()
    for name in CameraConfig.model_fields:
        if name not in _CAMERA and getattr(config.camera, name) != getattr(usual, name):
            yield f"camera.{name}: a value of its own", f"{getattr(usual, name)!r}"
    for name in SensorsConfig.model_fields:
        if getattr(config.sensors, name) != getattr(SensorsConfig(), name):
            what = "a sensor" if name == "further" else "an error, a rate or a delay"
            yield f"sensors.{name}: {what}", "none"
    if config.cameras:
        yield f"cameras: {', '.join(camera.name for camera in config.cameras)}", "none"
    if config.lidar.enabled:
        yield "lidar.enabled: true", "false"


def _simulated(config: SimConfig, assets: Assets, tracker: Tracker) -> Refused:
    if config.done.crash is not Crash.ORIGINAL:
        yield f"done.crash: '{config.done.crash}'", f"'{Crash.ORIGINAL}'"
    for name in config.reward.terms:
        yield f"reward.terms: '{name}'", "none, the built-in reward"
    if tracker.sample is not None and tracker.sampled is None:
        yield f"tracker.kind: a '{tracker.name}' with a sample", "one that tells what is sampled"
    if assets.traffic.live:
        yield "traffic.source: 'live'", "'recorded'"


def _drawn(assets: Assets) -> Refused:
    if assets.lighting.spray > 0.0:
        yield "world.spray: true on wet roads", "false"
    for kind, cast in zip(assets.rigs.kinds, assets.rigs.casts, strict=True):
        if not isinstance(cast.rig.pose, PoseCall):
            yield f"custom or airborne: a '{kind.name}'", "vehicles, people and robots"
