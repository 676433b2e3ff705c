"""Velocities of cameras: what moves during an exposure, or between two pictures."""

from typing import NamedTuple

from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.state.snapshot import CameraState, TrackerState
from eyas.lanes import kernel

Vector = tuple[float, float, float]


class PoseBefore(NamedTuple):
    """The pose of a camera, in numbers that writing the next one leaves alone."""

    place: Vector
    forward: Vector
    left: Vector
    up: Vector


@kernel(inline=True)
def pose_before(cameras: CameraState, n: int) -> PoseBefore:
    """Return the pose that camera `n` has."""
    place, axes = cameras.position[n], cameras.rotation[n]
    return PoseBefore(
        (place[0], place[1], place[2]),
        (axes[0, 0], axes[1, 0], axes[2, 0]),
        (axes[0, 1], axes[1, 1], axes[2, 1]),
        (axes[0, 2], axes[1, 2], axes[2, 2]),
    )


@kernel(inline=True)
def moved_from(before: PoseBefore, cameras: CameraState, n: int) -> None:
    """Write the velocities of camera `n`, which had another pose a physics step before.

    A turn by the vector a moves each axis e by a x e up to the order of a^2, so half the sum of
    e x e' over the axes is a up to that of a^3: 0.01 % at 10 rad/s.
    """
    velocity, turning = cameras.velocity[n], cameras.angular_velocity[n]
    position, axes = cameras.position[n], cameras.rotation[n]
    for axis in range(3):
        velocity[axis] = (position[axis] - before.place[axis]) * PHYSICS_RATE
        turning[axis] = 0.0
    for column in range(3):
        old = before.forward
        if column == 1:
            old = before.left
        if column == 2:
            old = before.up
        x, y, z = axes[0, column], axes[1, column], axes[2, column]
        turning[0] += 0.5 * PHYSICS_RATE * (old[1] * z - old[2] * y)
        turning[1] += 0.5 * PHYSICS_RATE * (old[2] * x - old[0] * z)
        turning[2] += 0.5 * PHYSICS_RATE * (old[0] * y - old[1] * x)


@kernel(inline=True)
def begin_at_rest(trackers: TrackerState, cameras: CameraState, n: int) -> None:
    """Write the velocities of the camera of tracker `n` at the start of its episode: its body's,
    which does not turn.
    """
    for axis in range(3):
        cameras.velocity[n, axis] = trackers.velocity[n, axis]
        cameras.angular_velocity[n, axis] = 0.0


@kernel(inline=True)
def left_unknown(trackers: TrackerState, cameras: CameraState, n: int) -> None:
    """Leave the velocities of the camera of tracker `n` alone: nothing needs them."""
