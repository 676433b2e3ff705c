"""What a pilot holds down, and what the drone and its camera then do; values as in the original."""

import math
from collections.abc import Mapping
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray


class Control(StrEnum):
    """Something that can be held down."""

    FORWARD = "forward"
    BACK = "back"
    LEFT = "left"
    RIGHT = "right"
    CLIMB = "climb"
    SINK = "sink"
    TURN_LEFT = "turn_left"
    TURN_RIGHT = "turn_right"
    CAMERA_UP = "camera_up"
    CAMERA_DOWN = "camera_down"
    CAMERA_LEFT = "camera_left"
    CAMERA_RIGHT = "camera_right"
    CAMERA_CENTRE = "camera_centre"


Held = Mapping[Control, float]  # Deflection of each control, 0 to 1; 0 if not named

SPEED = 20.0  # Forward and sideways [m/s]
CLIMB = 0.01  # [m per physics step of 2 ms], 5 m/s
TURN = math.radians(90.0)  # [rad/s]

CAMERA_PITCH = (-0.5, 1.5)  # Limits of the camera's pitch, positive down [rad]
CAMERA_YAW = (-1.7, 1.7)  # Limits of its yaw relative to the body [rad]
PITCH_STEP, YAW_STEP = 0.003, 0.005  # Turn of the camera [rad per physics step]


def command_of(held: Held) -> NDArray[np.float64]:
    """Return the command of a drone, see `Simulation.advance`, shape (1, 4)."""
    command = [
        SPEED * _between(held, Control.FORWARD, Control.BACK),
        SPEED * _between(held, Control.LEFT, Control.RIGHT),
        CLIMB * _between(held, Control.CLIMB, Control.SINK),
        TURN * _between(held, Control.TURN_LEFT, Control.TURN_RIGHT),
    ]
    return np.array([command])


def camera_turn(held: Held) -> tuple[float, float]:
    """Return by how much pitch and yaw of the camera change in a physics step [rad]."""
    pitch = PITCH_STEP * _between(held, Control.CAMERA_DOWN, Control.CAMERA_UP)
    return pitch, YAW_STEP * _between(held, Control.CAMERA_LEFT, Control.CAMERA_RIGHT)


def _between(held: Held, more: Control, less: Control) -> float:
    return held.get(more, 0.0) - held.get(less, 0.0)
