"""The motion of everything that moves by itself: one table, whoever fills it."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["SAMPLE", "Motion"]

SAMPLE: Final = np.dtype(
    [
        ("x", np.float32),
        ("y", np.float32),
        ("z", np.float32),
        ("velocity_x", np.float32),
        ("velocity_y", np.float32),
        ("velocity_z", np.float32),
        ("yaw", np.float32),
        ("yaw_rate", np.float32),
        ("slope", np.float32),
        ("travelled", np.float32),
        ("present", np.float32),
    ]
)
"""One actor at one instant.

x, y, z: reference point on the road, world frame [m]; velocity: its change [m/s]; yaw: heading,
counter-clockwise from east, without jumps at ±180° [rad]; yaw_rate [rad/s]; slope: pitch of the
road along the heading, positive up [rad]; travelled: path length since the first sample [m];
present: 1 while the actor is in the world, else 0.

32 bits keep positions to 0.03 mm and halve the memory that each world's step touches.
"""


class Motion(NamedTuple):
    """Sampled motion of A actors: what kernels interpolate (`eyas.traffic.replay`)."""

    table: NDArray[np.void]
    """Of dtype `SAMPLE`, shape (S, A)."""
    kind: NDArray[np.int32]
    """What each actor is: index into `eyas.targets.catalogue.KINDS`, shape (A,)."""
    rate: float
    """Samples in a second [Hz]."""
    first_time: float
    """Time of sample 0 [s]; 0 for a recording, later for traffic that is simulated live."""
