"""How a moving object moves, and the box in which it fits."""

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from eyas.task.direction import TargetDirection

__all__ = ["Movement", "box_corners"]

Floats: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Movement:
    """How a moving object moves, and stands on the ground."""

    acceleration: Floats
    """Change of the velocity, world frame [m/s^2], shape (3,)."""
    yaw_rate: float
    """Counter-clockwise [rad/s]."""
    slope: float
    """Pitch of the ground along its heading, positive up [rad]."""
    travelled: float
    """Way since it entered the world [m]."""
    direction: TargetDirection
    """Its turn."""
    rise: float
    """Height of its reference point above the ground [m]."""
    upright: bool = False
    """Whether it stays upright on slopes, like people; else it tilts with the ground."""


def box_corners(centre: Floats, size: Floats, yaw: float, motion: Movement) -> Floats:
    """Return the corners of a 3D box: four on the ground, counter-clockwise from the right of its
    tail, and those above them [m], shape (8, 3).

    Args:
        centre: Middle of the body, at the height of its reference point [m], shape (3,).
        size: Length, width, height [m], shape (3,).
        yaw: Heading [rad].
        motion: Slope of the ground, height of the reference point above it, and whether it tilts.
    """
    length, width, height = size.tolist()
    pitch, cosine, sine = motion.slope, math.cos(yaw), math.sin(yaw)
    ahead = np.array([cosine * math.cos(pitch), sine * math.cos(pitch), math.sin(pitch)])
    left, up = np.array([-sine, cosine, 0.0]), np.array([0.0, 0.0, 1.0])
    standing = up if motion.upright else np.cross(ahead, left)
    ends = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    plan = 0.5 * (length * ends[:, :1] * ahead + width * ends[:, 1:] * left)
    ground = centre - motion.rise * up + plan
    return np.concatenate([ground, ground + height * standing])
