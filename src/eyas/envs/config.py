"""Settings of the environments, and the speeds of the actions that they share with recordings."""

from typing import Annotated

from pydantic import Field

from eyas.core.config import Config

__all__ = ["ActionSpeeds", "EnvConfig", "EnvSpeeds"]

Speed = Annotated[float, Field(ge=-1e4, le=1e4)]
TurnRate = Annotated[float, Field(ge=-1e3, le=1e3)]


class ActionSpeeds(Config):
    """Speeds of the six actions, each of which moves along or turns about one axis."""

    forward_speed: Speed = 40.0
    """Action 0 [m/s]."""
    backward_speed: Speed = -40.0
    """Action 1 [m/s]."""
    left_speed: Speed = 40.0
    """Action 2 [m/s]."""
    right_speed: Speed = -40.0
    """Action 3 [m/s]."""
    counter_clockwise_rate: TurnRate = 2.0
    """Action 4 [rad/s]; the original's `cw_omega`, whose name states the opposite
    direction."""
    clockwise_rate: TurnRate = -2.0
    """Action 5 [rad/s]; the original's `ccw_omega`."""


class EnvSpeeds(ActionSpeeds):
    """Speeds of the actions. The defaults are those of the original's algorithm code."""

    vertical_speed: Speed = 0.01
    """Speed up and down [m per 2 ms step]; used by continuous actions only."""


class EnvConfig(Config):
    """Meaning of an agent's actions in the environments."""

    speeds: EnvSpeeds = EnvSpeeds()
