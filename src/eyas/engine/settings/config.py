"""The root of all settings: those of the simulation and those of each mode and interface."""

from collections.abc import Iterator, Mapping
from enum import StrEnum
from typing import Any, Self

from pydantic import model_validator

from eyas.dat.wire.config import WireConfig
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError
from eyas.engine.settings.env import EnvConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.sim.config import SimConfig
from eyas.learning.config import TrainConfig
from eyas.robotics.mavlink.config import MavlinkConfig

__all__ = ["EyasConfig", "Mode", "variants"]

Value = bool | int | float | str | tuple[float, ...]
"""Value of one of the original's keys."""


class Mode(StrEnum):
    """Intended use of a configuration; the original's `Simulation_Mode`."""

    DEMO = "demo"
    VIDEO = "video"
    TRAIN = "train"


class EyasConfig(SimConfig):
    """All settings of a run.

    A new mode or environment has its settings in a `config.py` beside its code, which imports
    only settings, and one line here.
    """

    mode: Mode = Mode.VIDEO
    """Intended use of the configuration."""
    verbose: bool = False
    """Whether each step is logged in the original's words: by `eyas video` in `<tracker>.log`,
    by `eyas serve` in the original's `logs/Agent<i>.log`, by environments to Python's logger
    `eyas.steps`."""
    env: EnvConfig = EnvConfig()
    video: VideoConfig = VideoConfig()
    train: TrainConfig = TrainConfig()
    wire: WireConfig = WireConfig()
    mavlink: MavlinkConfig = MavlinkConfig()
    original: dict[str, Value] | None = None
    """Values of the original's `env_config.json` that no other setting holds, such as those whose
    switch is off: they are written back with it. None if the settings do not come from such a
    file."""

    @model_validator(mode="after")
    def _gimbal_there(self) -> Self:
        if self.env.actions.gimbal and self.camera.mount is not None:
            raise ValueError(
                "env.actions must be without '+gimbal': camera.mount fixes the camera to the body"
            )
        return self

    @model_validator(mode="after")
    def _check_variants(self) -> Self:
        for _ in variants(self):
            pass
        return self


def variants(config: EyasConfig) -> Iterator[tuple[str, EyasConfig]]:
    """Yield the settings of each kind of a mixture and each stage of a curriculum, by their path.

    Mixture and curriculum themselves are left out of them.

    Raises:
        ConfigError: Some of them are wrong: one line.
    """
    parts: list[tuple[str, Mapping[str, Any]]] = [
        *((f"env.mixture.{at}", part.settings) for at, part in enumerate(config.env.mixture)),
        *(
            (f"train.stages.{at}", stage.changes(config.world))
            for at, stage in enumerate(config.train.stages)
        ),
    ]
    if not any(settings for _, settings in parts):
        return
    env = config.env.model_copy(update={"mixture": ()})
    train = config.train.model_copy(update={"stages": ()})
    common = config.model_copy(update={"env": env, "train": train})
    for path, settings in parts:
        try:
            variant = updated(common, settings)
        except ConfigError as error:
            raise ConfigError(f"{path}.settings.{error}") from None
        yield f"{path}.settings", variant
