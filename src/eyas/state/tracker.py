"""State of what follows, of what is followed, and of the traffic, as arrays."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["ActorState", "CameraPose", "TargetState", "TrackerState"]


@dataclass(slots=True)
class TrackerState:
    """N trackers, world frame (east, north, up)."""

    position: NDArray[np.float64]
    """Centre of the body [m], shape (N, 3)."""
    velocity: NDArray[np.float64]
    """[m/s], shape (N, 3): difference of the last two positions over 2 ms."""
    acceleration: NDArray[np.float64]
    """[m/s^2], shape (N, 3): difference of the last two velocities over 2 ms."""
    orientation: NDArray[np.float64]
    """Body to world, quaternion w, x, y, z, shape (N, 4)."""
    euler: NDArray[np.float64]
    """Roll, pitch, yaw [rad], shape (N, 3)."""
    angular_velocity: NDArray[np.float64]
    """Body frame [rad/s], shape (N, 3)."""
    commanded_position: NDArray[np.float64]
    """Where the commands integrate to [m], shape (N, 3)."""
    gimbal: NDArray[np.float64]
    """Roll, pitch, yaw of the gimbal's joints [rad], shape (N, 3)."""

    @classmethod
    def create(cls, count: int) -> "TrackerState":
        """Return the state of `count` trackers at rest at the origin."""
        orientation = np.zeros((count, 4))
        orientation[:, 0] = 1.0
        return cls(
            position=np.zeros((count, 3)),
            velocity=np.zeros((count, 3)),
            acceleration=np.zeros((count, 3)),
            orientation=orientation,
            euler=np.zeros((count, 3)),
            angular_velocity=np.zeros((count, 3)),
            commanded_position=np.zeros((count, 3)),
            gimbal=np.zeros((count, 3)),
        )


@dataclass(slots=True)
class CameraPose:
    """N cameras."""

    position: NDArray[np.float64]
    """Optical centre, world frame [m], shape (N, 3)."""
    rotation: NDArray[np.float64]
    """Camera to world; columns are the camera's forward, left and up axes, shape (N, 3, 3)."""

    @classmethod
    def create(cls, count: int) -> "CameraPose":
        """Return `count` cameras at the origin that look east."""
        return cls(np.zeros((count, 3)), np.tile(np.eye(3), (count, 1, 1)))


@dataclass(slots=True)
class TargetState:
    """The targets of N trackers."""

    actor: NDArray[np.int32]
    """Which actor of the traffic, shape (N,)."""
    position: NDArray[np.float64]
    """Reference point of the actor: middle of its SUMO length on the road, z the wheel radius [m],
    shape (N, 3)."""
    yaw: NDArray[np.float64]
    """Heading, counter-clockwise from east [rad], shape (N,)."""
    speed: NDArray[np.float64]
    """[m/s], shape (N,)."""
    centre: NDArray[np.float64]
    """The point that the reward looks for [m], shape (N, 3): the visible middle of the target."""
    lost: NDArray[np.bool_]
    """The target has left the world; stays true until the next reset, shape (N,)."""

    @classmethod
    def create(cls, count: int) -> "TargetState":
        """Return `count` targets at the origin."""
        return cls(
            actor=np.zeros(count, np.int32),
            position=np.zeros((count, 3)),
            yaw=np.zeros(count),
            speed=np.zeros(count),
            centre=np.zeros((count, 3)),
            lost=np.zeros(count, np.bool_),
        )


@dataclass(slots=True)
class ActorState:
    """A actors in each of W worlds. Reference point as in `TargetState.position`, z = 0."""

    position: NDArray[np.float64]
    """East and north [m], shape (W, A, 2)."""
    yaw: NDArray[np.float64]
    """[rad], shape (W, A)."""
    speed: NDArray[np.float64]
    """[m/s], shape (W, A)."""
    yaw_rate: NDArray[np.float64]
    """[rad/s], shape (W, A)."""
    travelled: NDArray[np.float64]
    """Path length since the recording began, which turns the wheels [m], shape (W, A)."""
    present: NDArray[np.bool_]
    """Whether the actor is in the world, shape (W, A)."""

    @classmethod
    def create(cls, worlds: int, actors: int) -> "ActorState":
        """Return `actors` actors at the origin in each of `worlds` worlds."""
        plane = (worlds, actors)
        return cls(
            position=np.zeros((*plane, 2)),
            yaw=np.zeros(plane),
            speed=np.zeros(plane),
            yaw_rate=np.zeros(plane),
            travelled=np.zeros(plane),
            present=np.zeros(plane, np.bool_),
        )
