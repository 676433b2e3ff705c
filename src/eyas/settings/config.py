"""The root of all settings: those of the simulation and those of each mode and interface."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from eyas.core.config import Config
from eyas.envs.config import EnvConfig
from eyas.learning.config import TrainConfig
from eyas.modes.video.config import VideoConfig
from eyas.sim.config import SimConfig

__all__ = ["EyasConfig", "Mode", "WireConfig"]

Value = bool | int | float | str | tuple[float, ...]
"""Value of one of the original's keys."""


class Mode(StrEnum):
    """Intended use of a configuration; the original's `Simulation_Mode`."""

    DEMO = "demo"
    VIDEO = "video"
    TRAIN = "train"


class WireConfig(Config):
    """Settings of the server for the original's network protocol."""

    address: Annotated[str, Field(min_length=1)] = "127.0.0.1"
    """Network address to listen on."""
    port: Annotated[int, Field(ge=1, le=65535)] = 38711
    """UDP port on which the number of trackers is announced."""
    reward_packet: bool = True
    """Whether the custom reward packet is sent."""
    lidar: bool = False
    """Whether the lidar packet is sent."""


class EyasConfig(SimConfig):
    """All settings of a run.

    A new mode or environment has its settings in a `config.py` beside its code, which imports
    only settings, and one line here.
    """

    mode: Mode = Mode.VIDEO
    """Intended use of the configuration."""
    verbose: bool = False
    """Whether each step is logged in the original's words: by `eyas video` in `<tracker>.log`, by
    environments to Python's logger `eyas.steps`."""
    env: EnvConfig = EnvConfig()
    video: VideoConfig = VideoConfig()
    train: TrainConfig = TrainConfig()
    wire: WireConfig = WireConfig()
    original: dict[str, Value] | None = None
    """Values of the original's `env_config.json` that no other setting holds, such as those whose
    switch is off: they are written back with it. None if the settings do not come from such a
    file."""
