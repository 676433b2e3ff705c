"""The inertial sensors: an accelerometer and a gyroscope.

Supervised drones follow their commands at once, by jumps of velocity that no body could make: the
differences of two steps reach thousands of m/s^2. So these sensors read a smoothed motion, which
follows the true one through two equal low-passes. Both belong to the same smoothed body, so that
integrating them gives its motion. A time constant of 0 gives the differences themselves; so the
sensors of a flown drone, which cannot jump, read its own motion.
"""

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.frames import rotate_back
from eyas.engine.state.snapshot import TrackerState
from eyas.lanes import exact, kernel
from eyas.lanes.elementary import sin_cos

GRAVITY = 9.81  # [m/s^2]


def smoothing_share(
    time_constant: float,  # Of each of the two low-passes [s]; 0: no smoothing
) -> float:
    """Return the share of a difference by which a low-pass closes it in a physics step."""
    if time_constant == 0.0:
        return 1.0
    half = exact.tanh(0.5 * PHYSICS_STEP / time_constant)
    return 2.0 * half / (1.0 + half)  # 1 - exp(-PHYSICS_STEP / time_constant)


@kernel(inline=True)
def feel(trackers: TrackerState, n: int, share: float) -> None:
    """Let the smoothed motion of tracker `n` follow the true one for a physics step of 2 ms."""
    first, second = trackers.smoothed[n, 0], trackers.smoothed[n, 1]
    for axis in range(3):
        first[axis] += share * (trackers.velocity[n, axis] - first[axis])
        change = share * (first[axis] - second[axis])
        second[axis] += change
        trackers.smoothed_acceleration[n, axis] = change / PHYSICS_STEP
        turn = 3 + axis
        first[turn] += share * (trackers.angular_velocity[n, axis] - first[turn])
        second[turn] += share * (first[turn] - second[turn])
    # The sum of all differences of the turn rates so far: what both low-passes still hold back.
    trackers.smoothed_lag[n] = (1.0 / share - 1.0) * PHYSICS_STEP * (first[5] + second[5])


@kernel(inline=True)
def rest(trackers: TrackerState, n: int, share: float) -> None:
    """Begin the smoothed motion of tracker `n` as if it had moved for long as it does now."""
    for stage in range(2):
        for axis in range(3):
            trackers.smoothed[n, stage, axis] = trackers.velocity[n, axis]
            trackers.smoothed[n, stage, 3 + axis] = trackers.angular_velocity[n, axis]
    feel(trackers, n, share)


@kernel
def accelerometer(trackers: TrackerState, n: int) -> tuple[float, float, float]:
    """Return what an accelerometer reads, smoothed body's frame [m/s^2]: +9.81 up at rest.

    The original reads a physics body that falls between being teleported, so its readings are
    unrelated to the visible motion.
    """
    felt = trackers.smoothed_acceleration[n]
    x, y, z = rotate_back(trackers.orientation[n], felt[0], felt[1], felt[2] + GRAVITY)
    sine, cosine = sin_cos(trackers.smoothed_lag[n])
    return cosine * x - sine * y, sine * x + cosine * y, z


@kernel
def gyroscope(trackers: TrackerState, n: int) -> tuple[float, float, float]:
    """Return what a gyroscope reads, smoothed body's frame [rad/s]."""
    turn = trackers.smoothed[n, 1]
    return turn[3], turn[4], turn[5]
