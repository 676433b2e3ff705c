"""Columns of the task's memory: one row of float64 for each tracker, shape (N, MEMORY_COLUMNS).

Counts and flags are whole numbers in float64, so that one array holds all and a step has little
to hand over. Numbers instead of an enumeration, because kernels read them.
"""

__all__ = [
    "BREACH",
    "DIRECTION",
    "LAST_TARGET",
    "LAST_TARGET_YAW",
    "LOST",
    "MEMORY_COLUMNS",
    "NOT_A_NUMBER",
    "NO_REWARD_COUNT",
    "REASON",
    "RELATIVE_ACCELERATION",
    "RELATIVE_POSITION",
    "RELATIVE_VELOCITY",
    "REWARD",
    "SAMPLES",
    "START_DIRECTION",
    "STEP_COUNT",
    "VIEW_CENTRE",
]

STEP_COUNT = 0
"""2 ms steps since the reset."""
NO_REWARD_COUNT = 1
"""2 ms steps since there was a reward."""
REWARD = 2
"""The built-in reward."""
REASON = 3
"""`DoneReason`, 0 while the episode goes on."""
BREACH = 4
"""`DoneReason` of the limit that the body breaks now, whether or not it ends the episode."""
LOST = 5
"""1 once the target has been lost."""
NOT_A_NUMBER = 6
"""1 once a value was not a finite number."""
DIRECTION = 7
"""`TargetDirection`."""
SAMPLES = 8
"""How often the target has been observed since the reset, at most 3."""
START_DIRECTION = 9
"""Heading at the start relative to the target's [rad]."""
VIEW_CENTRE = 10
"""Ground point that the camera looks at, east and north [m], 2 columns."""
LAST_TARGET = 12
"""Where the target was a step ago, east and north [m], 2 columns."""
LAST_TARGET_YAW = 14
"""Its heading then [rad]."""
RELATIVE_POSITION = 15
"""The target's centre, body frame [m], 3 columns."""
RELATIVE_VELOCITY = 18
"""Change of `RELATIVE_POSITION` [m/s], 3 columns."""
RELATIVE_ACCELERATION = 21
"""Change of `RELATIVE_VELOCITY` [m/s^2], 3 columns."""
MEMORY_COLUMNS = 24
