"""The root of all settings: those of the simulation, and those of each use of it."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from eyas.core.config import Config
from eyas.envs.config import EnvConfig
from eyas.modes.video.config import VideoConfig
from eyas.sim.config import SimConfig

__all__ = ["EyasConfig", "Mode", "WireConfig"]


class Mode(StrEnum):
    """What a configuration is meant for; the original's `Simulation_Mode`."""

    DEMO = "demo"
    VIDEO = "video"
    TRAIN = "train"


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


class EyasConfig(SimConfig):
    """Everything that decides a run.

    A new mode or environment keeps its settings in a `config.py` beside its code, which imports
    nothing but settings, and adds one line here.
    """

    mode: Mode = Mode.VIDEO
    """What the configuration is meant for."""
    verbose: bool = False
    """Whether a log is written."""
    env: EnvConfig = EnvConfig()
    video: VideoConfig = VideoConfig()
    wire: WireConfig = WireConfig()
