"""Steering with the seven actions: towards what is not in the middle."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.settings.env import EnvConfig
from eyas.lanes import exact

Floats = NDArray[np.float64]

_FIELD_OF_VIEW, _ASPECT = 0.7854, 0.75
"""The camera of all protocols: horizontal [rad], and height of the picture over its width."""

PERIOD = 0.008  # Length of a control step of all protocols [s]
DEPTH = 22.0  # Distance of the ground that is assumed where only a picture is known [m]
_HALF_WIDTH = DEPTH * exact.tan(0.5 * _FIELD_OF_VIEW)
"""Half the width of the ground that is then in the picture [m]."""

_FORWARD, _BACKWARD, _LEFT, _RIGHT, _HOVER = 0, 1, 2, 3, 6  # Numbers of DAT's actions


def towards(offset: Floats, env: EnvConfig, period: float = PERIOD) -> NDArray[np.int64]:
    """Return the actions that bring the drones over points, one axis at a time.

    The axis with the larger offset is chosen, and none if the action would overshoot.

    Args:
        offset: Distance of each point ahead and to the left [m], shape (N, 2).
        env: Speeds of the actions, and how long they last.
        period: Length of a control step [s].
    """
    ahead, left = offset[:, 0], offset[:, 1]
    along = np.where(ahead > 0.0, _FORWARD, _BACKWARD)
    across = np.where(left > 0.0, _LEFT, _RIGHT)
    action = np.where(np.abs(ahead) >= np.abs(left), along, across)
    reach = 0.5 * abs(env.speeds.forward_speed) * period * env.action_repeat
    far = np.maximum(np.abs(ahead), np.abs(left)) >= reach
    return np.where(far, action, _HOVER).astype(np.int64)


def pixel_offset(
    column: Floats,  # From the left edge [pixels], shape (N,)
    row: Floats,  # From the upper edge [pixels], shape (N,)
    size: tuple[int, int],  # Height and width of the picture [pixels]
) -> Floats:
    """Return how far ahead and to the left of the picture's middle points are on the ground.

    The camera is taken to look straight down from 22 m.

    Returns:
        [m], shape (N, 2).
    """
    height, width = size
    ahead = (1.0 - 2.0 * row / height) * _HALF_WIDTH * _ASPECT
    left = (1.0 - 2.0 * column / width) * _HALF_WIDTH
    return np.stack((ahead, left), axis=-1)


def ground_offset(
    column: Floats,  # From the left edge [pixels], shape (N,)
    row: Floats,  # From the upper edge [pixels], shape (N,)
    size: tuple[int, int],  # Height and width of the picture [pixels]
    height: float = 45.0,  # Of the camera above the ground [m]; that of the protocol `referring`
    pitch: float = 1.37,  # Of the camera, positive down [rad]
) -> Floats:
    """Return how far ahead and to the left of the picture's middle points are on level ground.

    Returns:
        [m], shape (N, 2).
    """
    wide = exact.tan(0.5 * _FIELD_OF_VIEW)
    left = (1.0 - 2.0 * column / size[1]) * wide
    up = (1.0 - 2.0 * row / size[0]) * wide * _ASPECT
    cosine, sine = exact.cos(pitch), exact.sin(pitch)
    reach = height / (sine - up * cosine)
    return np.stack((reach * (cosine + up * sine) - height * cosine / sine, reach * left), axis=-1)


def ground_width(height: float = 45.0, pitch: float = 1.37) -> float:
    """Return the width of the ground in the middle row of a picture [m]; see `ground_offset`."""
    return 2.0 * height / exact.sin(pitch) * exact.tan(0.5 * _FIELD_OF_VIEW)
