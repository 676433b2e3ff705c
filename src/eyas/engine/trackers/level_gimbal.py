"""A gimbal whose joints turn in the order yaw, roll, pitch, as those of most drones do.

The original's turn in the order yaw, pitch, roll: with the camera near the body's vertical, yaw
and roll are one axis, and its joints swing through half a turn. Here each tilt of the body has a
joint of its own, so nothing swings. For a level body both hold the camera at the same place.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.frames import rotate
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.trackers.gimbal import (
    PITCH_JOINT,
    ROLL_JOINT,
    SIDEWAYS_LIMIT,
    YAW_JOINT,
    set_column,
)
from eyas.engine.trackers.lowpass import settle
from eyas.lanes import kernel
from eyas.lanes.elementary import asin, atan2, sin_cos

Vector = tuple[float, float, float]

_LEAST, _MOST = -0.5, 2.2
"""Ends of the pitch joint [rad]: beyond the largest command, 1.5, by the largest tilt, 0.63."""


@kernel
def level_angles(pitch: float, yaw: float, body_roll: float, body_pitch: float) -> Vector:
    """Return the joints' roll, pitch and yaw that compensate the tilt of the body, within limits.

    From Rx(-roll) Ry(-pitch) Rz(yaw) Ry(pitch), decomposed into yaw, roll, pitch.
    """
    sp, cp = sin_cos(pitch)
    sy, cy = sin_cos(yaw)
    sb, cb = sin_cos(body_pitch)
    sa, ca = sin_cos(body_roll)
    # m = Ry(-body pitch) Rz(yaw) Ry(pitch); r = Rx(-body roll) m; mij, rij: row i, column j.
    m20, m21 = sb * cy * cp - cb * sp, -sb * sy
    m22 = sb * cy * sp + cb * cp
    r01, r11 = -cb * sy, ca * cy + sa * m21
    r20 = ca * m20 - sa * sy * cp
    r21 = ca * m21 - sa * cy
    r22 = ca * m22 - sa * sy * sp
    return (
        min(max(asin(min(max(r21, -1.0), 1.0)), -SIDEWAYS_LIMIT), SIDEWAYS_LIMIT),
        min(max(atan2(-r20, r22), _LEAST), _MOST),
        min(max(atan2(-r01, r11), -SIDEWAYS_LIMIT), SIDEWAYS_LIMIT),
    )


@kernel(inline=True)
def reset_level(trackers: TrackerState, filters: NDArray[np.float64], n: int) -> None:
    """Move the joints of gimbal `n` to what its commanded angles need, at once.

    Args:
        trackers: Source of the body's attitude and the commanded angles; its joint angles are set.
        filters: Low-pass filters of roll, pitch and yaw, shape (N, 3, 2); set.
        n: Index of the tracker.
    """
    commanded, euler, gimbal = trackers.commanded_gimbal[n], trackers.euler[n], trackers.gimbal[n]
    gimbal[0], gimbal[1], gimbal[2] = level_angles(commanded[0], commanded[1], euler[0], euler[1])
    for axis in range(3):
        settle(filters[n, axis], gimbal[axis])


@kernel
def carried_along(
    gimbal: NDArray[np.float64],  # Angles of the joints [rad], shape (3,)
    change: Vector,  # Change of the body's angular velocity, body frame [rad/s]
) -> Vector:
    """Return what the body's turn is about the axes of roll, pitch and yaw joint."""
    sy, cy = sin_cos(gimbal[2])
    sr, cr = sin_cos(gimbal[0])
    left = cy * change[1] - sy * change[0]
    return cy * change[0] + sy * change[1], cr * left + sr * change[2], change[2]


@kernel
def level_pose(
    position: NDArray[np.float64],
    orientation: NDArray[np.float64],
    gimbal: NDArray[np.float64],
    camera_position: NDArray[np.float64],
    camera_rotation: NDArray[np.float64],
) -> None:
    """Compute the pose of the camera; arguments as in `eyas.engine.trackers.gimbal.camera_pose`."""
    sr, cr = sin_cos(gimbal[0])
    sp, cp = sin_cos(gimbal[1])
    sy, cy = sin_cos(gimbal[2])
    x = PITCH_JOINT[0] + cp * ROLL_JOINT[0] + sp * ROLL_JOINT[2]
    y = PITCH_JOINT[1] + ROLL_JOINT[1]
    z = PITCH_JOINT[2] - sp * ROLL_JOINT[0] + cp * ROLL_JOINT[2]
    y, z = cr * y - sr * z, sr * y + cr * z
    x, y = YAW_JOINT[0] + cy * x - sy * y, YAW_JOINT[1] + sy * x + cy * y
    x, y, z = rotate(orientation, x, y, YAW_JOINT[2] + z)
    camera_position[0] = position[0] + x
    camera_position[1] = position[1] + y
    camera_position[2] = position[2] + z
    ahead = rotate(orientation, cy * cp - sy * sr * sp, sy * cp + cy * sr * sp, -cr * sp)
    set_column(camera_rotation, 0, ahead)
    set_column(camera_rotation, 1, rotate(orientation, -sy * cr, cy * cr, sr))
    up = rotate(orientation, cy * sp + sy * sr * cp, sy * sp - cy * sr * cp, cr * cp)
    set_column(camera_rotation, 2, up)
