"""Columns of a tracker's memory: one row of float64 for each tracker, shape (N, MEMORY_COLUMNS).

A low-pass owns two columns, of which the first is named. Numbers instead of an enumeration,
because kernels read them.
"""

__all__ = [
    "COMMANDED_YAW",
    "FORWARD_FILTER",
    "GIMBAL_PITCH",
    "GIMBAL_PITCH_FILTER",
    "GIMBAL_ROLL_FILTER",
    "GIMBAL_YAW",
    "GIMBAL_YAW_FILTER",
    "LATERAL_FILTER",
    "MEMORY_COLUMNS",
    "YAW_RATE_FILTER",
]

FORWARD_FILTER = 0
LATERAL_FILTER = 2
YAW_RATE_FILTER = 4
GIMBAL_ROLL_FILTER = 6
GIMBAL_PITCH_FILTER = 8
GIMBAL_YAW_FILTER = 10
COMMANDED_YAW = 12
"""What the yaw rates add up to, not wrapped [rad]."""
GIMBAL_PITCH = 13
"""Commanded pitch of the camera, positive down [rad]."""
GIMBAL_YAW = 14
"""Commanded yaw of the camera relative to the body [rad]."""
MEMORY_COLUMNS = 15
