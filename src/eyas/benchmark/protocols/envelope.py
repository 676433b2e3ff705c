"""The flight envelope: what a protocol lets drones do, whatever their policies choose inside it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.errors import ConfigError
from eyas.engine.settings.env import EnvConfig

Floats = NDArray[np.float64]

_RESPONSE = 0.5
"""Time in which a climb would use up the room that is left [s]: a flown drone cannot stop at once,
and stays inside."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """Limits of speeds and heights; the largest speeds are those of the original's code.

    Accelerations and the angle of the camera need none: both belong to the tracker and the start,
    which are settings of the protocol.
    """

    speed: float = 40.0  # Largest speed along and across [m/s]
    climb: float = 5.0  # Largest speed up and down [m/s]
    turn_rate: float = 2.0  # [rad/s]
    lowest: float = 12.0
    """Height above the ground below the drone, under which it is not let sink [m]."""
    highest: float = 25.0
    """Height over which it is not let climb [m]: 3 m above that of the start. From 50 m, a drone
    that only hovers had a TSR of .51 in `paper`, and one at 22 m .24."""

    def refuse(self, env: EnvConfig, protocol: str) -> None:
        """Refuse speeds of actions that leave it.

        Raises:
            ConfigError: A speed is too large.
        """
        limits = {
            **dict.fromkeys(("forward_speed", "backward_speed"), self.speed),
            **dict.fromkeys(("left_speed", "right_speed"), self.speed),
            **dict.fromkeys(("counter_clockwise_rate", "clockwise_rate"), self.turn_rate),
            "vertical_speed": self.climb * PHYSICS_STEP,
        }
        for name, limit in limits.items():
            value = getattr(env.speeds, name)
            if abs(value) > limit * (1.0 + 1e-9):
                raise ConfigError(
                    f"env.speeds.{name}: {value:g} is not allowed in protocol '{protocol}': "
                    f"{-limit:g} to {limit:g}"
                )

    def held(
        self,
        commands: Floats,  # Forward, left, up [m per 2 ms], turn, shape (N, 4)
        heights: Floats,  # Of the drones above the ground [m], shape (N,)
    ) -> Floats:
        """Return commands whose climbs and descents end at the limits of height."""
        steps = _RESPONSE / PHYSICS_STEP
        up, down = (
            np.maximum(room, 0.0) / steps
            for room in (self.highest - heights, heights - self.lowest)
        )
        held = commands.copy()
        held[:, 2] = np.clip(commands[:, 2], -down, up)
        return held


ENVELOPE = Envelope()  # Default flight limits, shared by every protocol
