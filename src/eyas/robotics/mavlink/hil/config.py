"""Settings of drones that PX4 or ArduPilot fly."""

from typing import Annotated

from pydantic import Field

from eyas.engine.core.config import Config

__all__ = ["HilConfig"]


class HilConfig(Config):
    """Settings of `eyas serve --px4` and `--ardupilot`; also used: `mavlink.latitude`,
    `longitude`, `altitude`, `video`, `picture_rate` and `video_quality`.
    """

    thrust_to_weight: Annotated[float, Field(gt=1.0, le=20.0)] = 2.0
    """Thrust of all rotors at full output over the drone's weight."""
    speed: Annotated[float, Field(ge=0.0, le=100.0)] = 1.0
    """Most simulated seconds in a second; 0: as many as autopilot and machine can."""
