"""The gimbal: keeps the camera at its commanded angles when the body tilts."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.frames import rotate
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.trackers.lowpass import low_pass, settle
from eyas.lanes import kernel
from eyas.lanes.elementary import atan2, sin_cos

SIDEWAYS_LIMIT = 1.7  # Largest roll and yaw of the joints [rad]

Limits = tuple[float, float, float, float]
"""Least and largest pitch that may be commanded, then those of the joint, positive down [rad]."""

DRONE_LIMITS: Limits = (0.5, 1.5, -0.5, 1.5)
CAR_LIMITS: Limits = (-1.0, 1.5, -1.0, 1.5)

YAW_JOINT = (0.13, -0.00469654, -0.013)  # Position of the yaw joint, body frame [m]
PITCH_JOINT = (0.000625212, -0.00530346, -0.0207448)
"""Position of the pitch joint, frame of the yaw link [m]."""
ROLL_JOINT = (0.00754686, 0.0160388, -0.00586401)
"""Position of the roll joint and the camera, frame of the pitch link [m]."""


@kernel
def held_pitch(pitch: float, limits: Limits = DRONE_LIMITS) -> float:
    """Return a camera pitch limited to the range of the original's command [rad]."""
    return min(max(pitch, limits[0]), limits[1])


@kernel(inline=True)
def advance_gimbal(
    # Source of the body's attitude and the commanded angles; its joint angles are set
    trackers: TrackerState,
    # Low-pass filters of roll, pitch and yaw, shape (N, 3, 2); updated
    memory: NDArray[np.float64],
    n: int,  # Index of the tracker
    limits: Limits = DRONE_LIMITS,  # Of the pitch
) -> None:
    """Move gimbal `n` by one physics step of 2 ms."""
    commanded, euler, gimbal = trackers.commanded_gimbal[n], trackers.euler[n], trackers.gimbal[n]
    roll, pitch, yaw = desired_angles(commanded[0], commanded[1], euler[0], euler[1], limits)
    gimbal[0] = low_pass(memory[n, 0], roll)
    gimbal[1] = low_pass(memory[n, 1], pitch)
    gimbal[2] = low_pass(memory[n, 2], yaw)


@kernel(inline=True)
def reset_gimbal(
    # Source of the body's attitude; its commanded angles and joint angles are set
    trackers: TrackerState,
    memory: NDArray[np.float64],  # Low-pass filters of roll, pitch and yaw, shape (N, 3, 2); set
    n: int,  # Index of the tracker
    pitch: float,  # Commanded pitch, positive down [rad]
    yaw: float,  # Commanded yaw relative to the body [rad]
    limits: Limits = DRONE_LIMITS,  # Of the pitch
) -> None:
    """Command new angles and move the joints there at once.

    In the original, the filters start at zero, so the camera swings down from the horizon during
    the first pictures of an episode.
    """
    commanded, euler, gimbal = trackers.commanded_gimbal[n], trackers.euler[n], trackers.gimbal[n]
    commanded[0], commanded[1] = held_pitch(pitch, limits), yaw
    gimbal[0], gimbal[1], gimbal[2] = desired_angles(commanded[0], yaw, euler[0], euler[1], limits)
    for axis in range(3):
        settle(memory[n, axis], gimbal[axis])


@kernel
def camera_pose(
    position: NDArray[np.float64],  # Centre of the body, world frame [m], shape (3,)
    orientation: NDArray[np.float64],  # Body to world, shape (4,)
    gimbal: NDArray[np.float64],  # Roll, pitch, yaw of the joints [rad], shape (3,)
    camera_position: NDArray[np.float64],  # Optical centre, world frame [m], shape (3,); set
    # Camera to world; columns forward, left, up, shape (3, 3); set
    camera_rotation: NDArray[np.float64],
) -> None:
    """Compute the pose of the camera through body, yaw link, pitch link and roll link."""
    sp, cp = sin_cos(gimbal[1])
    sy, cy = sin_cos(gimbal[2])
    x = PITCH_JOINT[0] + cp * ROLL_JOINT[0] + sp * ROLL_JOINT[2]
    y = PITCH_JOINT[1] + ROLL_JOINT[1]
    z = PITCH_JOINT[2] - sp * ROLL_JOINT[0] + cp * ROLL_JOINT[2]
    x, y = YAW_JOINT[0] + cy * x - sy * y, YAW_JOINT[1] + sy * x + cy * y
    x, y, z = rotate(orientation, x, y, YAW_JOINT[2] + z)
    camera_position[0] = position[0] + x
    camera_position[1] = position[1] + y
    camera_position[2] = position[2] + z
    camera_axes(orientation, gimbal, camera_rotation)


@kernel
def camera_axes(
    orientation: NDArray[np.float64],
    gimbal: NDArray[np.float64],
    camera_rotation: NDArray[np.float64],
) -> None:
    """Compute the axes of the camera; arguments as in `camera_pose`."""
    sr, cr = sin_cos(gimbal[0])
    sp, cp = sin_cos(gimbal[1])
    sy, cy = sin_cos(gimbal[2])
    set_column(camera_rotation, 0, rotate(orientation, cy * cp, sy * cp, -sp))
    left = rotate(orientation, cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr)
    set_column(camera_rotation, 1, left)
    up = rotate(orientation, cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr)
    set_column(camera_rotation, 2, up)


@kernel
def set_column(
    matrix: NDArray[np.float64], column: int, vector: tuple[float, float, float]
) -> None:
    """Set a column of a matrix, shape (3, 3)."""
    matrix[0, column], matrix[1, column], matrix[2, column] = vector


@kernel
def desired_angles(
    pitch: float, yaw: float, body_roll: float, body_pitch: float, limits: Limits = DRONE_LIMITS
) -> tuple[float, float, float]:
    """Return the joints' roll, pitch and yaw that compensate the tilt of the body, within limits.

    From the original's Rx(-roll) Ry(-pitch) Rz(yaw) Ry(pitch), decomposed into yaw, pitch, roll.
    """
    roll = 0.0
    # A supervised body is level, which saves most of this function's time.
    if body_roll != 0.0 or body_pitch != 0.0:
        sp, cp = sin_cos(pitch)
        sy, cy = sin_cos(yaw)
        sb, cb = sin_cos(body_pitch)
        sa, ca = sin_cos(body_roll)
        # m = Ry(-body pitch) Rz(yaw) Ry(pitch); r = Rx(-body roll) m; mij, rij: row i, column j.
        m00, m20 = cb * cy * cp + sb * sp, sb * cy * cp - cb * sp
        m21 = -sb * sy
        m22 = sb * cy * sp + cb * cp
        r10 = ca * sy * cp + sa * m20
        r20 = ca * m20 - sa * sy * cp
        r21 = ca * m21 - sa * cy
        r22 = ca * m22 - sa * sy * sp
        roll = atan2(r21, r22)
        pitch = atan2(-r20, math.sqrt(r21 * r21 + r22 * r22))
        yaw = atan2(r10, m00)
    return (
        min(max(roll, -SIDEWAYS_LIMIT), SIDEWAYS_LIMIT),
        min(max(pitch, limits[2]), limits[3]),
        min(max(yaw, -SIDEWAYS_LIMIT), SIDEWAYS_LIMIT),
    )
