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
class Gimbal:
    """Range and rates of the camera: those of the original's demo, the defaults of `env.gimbal`."""

    pitch_rate: float = 1.5  # Fastest turn up and down [rad/s]
    yaw_rate: float = 2.5  # Fastest turn to the left and right [rad/s]
    least_pitch: float = -0.5  # Highest look, positive down [rad]
    most_pitch: float = 1.5  # Lowest look [rad]
    most_yaw: float = 1.7  # Furthest look to each side of the body [rad]


@dataclass(frozen=True, slots=True)
class Envelope:
    """Limits of speeds, heights and of what turns the camera; the largest speeds are those of the
    original's code.

    Accelerations need none: they belong to the tracker, which is a setting of the protocol.
    """

    speed: float = 40.0  # Largest speed along and across [m/s]
    climb: float = 5.0  # Largest speed up and down [m/s]
    turn_rate: float = 2.0  # [rad/s]
    lowest: float = 12.0
    """Height above the ground below the drone, under which it is not let sink [m]."""
    highest: float = 25.0
    """Height over which it is not let climb [m]: 3 m above that of the start. From 50 m, a drone
    that only hovers had a TSR of .51 in `paper`, and one at 22 m .24."""
    gimbal: Gimbal | None = None
    """What policies may do with the camera; None: its angle is the start's. A drone that never
    moves and only points its camera had a TSR of 1.0 in `paper`."""

    def refuse(self, env: EnvConfig, protocol: str) -> None:
        """Refuse speeds of actions that leave it, and a camera that turns where it may not.

        Raises:
            ConfigError: A speed is too large, or the camera turns.
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
        if env.actions.gimbal:
            self._refuse_gimbal(env, protocol)

    def _refuse_gimbal(self, env: EnvConfig, protocol: str) -> None:
        allowed = self.gimbal
        if allowed is None:
            raise ConfigError(
                f"env.actions: '{env.actions}' is not allowed in protocol '{protocol}', in which "
                "the camera's angle is that of the start; a camera that turns has a protocol of "
                "its own, 'gimbal'"
            )
        for name, low, high in (
            ("pitch_rate", 0.0, allowed.pitch_rate),
            ("yaw_rate", 0.0, allowed.yaw_rate),
            ("least_pitch", allowed.least_pitch, allowed.most_pitch),
            ("most_pitch", allowed.least_pitch, allowed.most_pitch),
            ("most_yaw", 0.0, allowed.most_yaw),
        ):
            value = getattr(env.gimbal, name)
            if not low - 1e-9 <= value <= high + 1e-9:
                raise ConfigError(
                    f"env.gimbal.{name}: {value:g} is not allowed in protocol '{protocol}': "
                    f"{low:g} to {high:g}"
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
