"""Settings of the environments, and the speeds of the actions that they share with recordings."""

from typing import Annotated

from pydantic import Field

from eyas.core.config import Config

__all__ = ["ActionSpeeds", "EnvConfig", "EnvSpeeds"]

Speed = Annotated[float, Field(ge=-1e4, le=1e4)]
TurnRate = Annotated[float, Field(ge=-1e3, le=1e3)]


class ActionSpeeds(Config):
    """How fast each of the six actions is that move along one axis."""

    forward_speed: Speed = 40.0
    """Action 0 [m/s]."""
    backward_speed: Speed = -40.0
    """Action 1 [m/s]."""
    left_speed: Speed = 40.0
    """Action 2 [m/s]."""
    right_speed: Speed = -40.0
    """Action 3 [m/s]."""
    counter_clockwise_rate: TurnRate = 2.0
    """Action 4 [rad/s]; the original's `cw_omega`, whose sign is named the wrong way."""
    clockwise_rate: TurnRate = -2.0
    """Action 5 [rad/s]; the original's `ccw_omega`."""


class EnvSpeeds(ActionSpeeds):
    """How fast the actions are. Defaults are those of the original's algorithm side."""

    vertical_speed: Speed = 0.01
    """Up and down [m per 2 ms step]; only continuous actions use it."""


class EnvConfig(Config):
    """How the environments read an agent's actions."""

    speeds: EnvSpeeds = EnvSpeeds()
