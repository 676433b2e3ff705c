"""The state of a simulation, as one record of arrays that kernels, rewards and writers read.

Every array has a leading axis of N trackers. The simulation writes in place; `Snapshot.copy`
returns a record that later steps do not change.
"""

from copy import deepcopy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.lighting import LightState

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_UNKNOWN = np.zeros((0, 3))


class TrackerState(NamedTuple):
    """State of N trackers, world frame (east, north, up)."""

    position: Floats
    """Centre of the body [m], shape (N, 3)."""
    velocity: Floats
    """Velocity of the body; of one that follows commands exactly, the difference of its last two
    positions over 2 ms [m/s], shape (N, 3)."""
    acceleration: Floats
    """Difference of the last two velocities over 2 ms [m/s^2], shape (N, 3)."""
    orientation: Floats
    """Body to world, quaternion w, x, y, z, shape (N, 4)."""
    euler: Floats
    """Roll, pitch, yaw [rad], shape (N, 3)."""
    angular_velocity: Floats
    """Body frame [rad/s], shape (N, 3)."""
    smoothed: Floats
    """Velocity, world frame [m/s], and angular velocity, body frame [rad/s], behind the first and
    the second low-pass of the inertial sensors (`eyas.engine.sensors.inertial`), shape (N, 2,
    6)."""
    smoothed_acceleration: Floats
    """Change of the twice smoothed velocity, world frame [m/s^2], shape (N, 3)."""
    smoothed_lag: Floats
    """Heading minus that of the smoothed motion [rad], shape (N,)."""
    commanded_position: Floats
    """Integral of the commanded velocities [m], shape (N, 3)."""
    commanded_yaw: Floats
    """Integral of the commanded yaw rates, not wrapped [rad], shape (N,)."""
    gimbal: Floats
    """Roll, pitch, yaw of the gimbal's joints [rad], shape (N, 3)."""
    commanded_gimbal: Floats
    """Commanded pitch of the camera, positive down, and its yaw relative to the body [rad],
    shape (N, 2)."""

    @classmethod
    def create(cls, count: int) -> "TrackerState":
        """Return trackers at rest at the origin."""
        orientation = np.zeros((count, 4))
        orientation[:, 0] = 1.0
        vector = (count, 3)
        return cls(
            position=np.zeros(vector),
            velocity=np.zeros(vector),
            acceleration=np.zeros(vector),
            orientation=orientation,
            euler=np.zeros(vector),
            angular_velocity=np.zeros(vector),
            smoothed=np.zeros((count, 2, 6)),
            smoothed_acceleration=np.zeros(vector),
            smoothed_lag=np.zeros(count),
            commanded_position=np.zeros(vector),
            commanded_yaw=np.zeros(count),
            gimbal=np.zeros(vector),
            commanded_gimbal=np.zeros((count, 2)),
        )


class CameraState(NamedTuple):
    """State of N cameras."""

    position: Floats
    """Optical centre, world frame [m], shape (N, 3)."""
    rotation: Floats
    """Camera to world; columns are the camera's forward, left and up axes, shape (N, 3, 3)."""
    field_of_view: Floats
    """Horizontal [rad], shape (N,); that of a tracker is drawn at its reset."""
    velocity: Floats = _UNKNOWN
    """Difference of the last two positions over 2 ms, world frame [m/s], shape (N, 3). Of trackers
    it is kept up where something needs it (`camera.shutter`, `camera.events`) and else 0."""
    angular_velocity: Floats = _UNKNOWN
    """Difference of the last two rotations over 2 ms, world frame [rad/s], shape (N, 3)."""

    @classmethod
    def create(cls, count: int) -> "CameraState":
        """Return cameras at rest at the origin that look east, with a field of view of 1 rad."""
        return cls(
            position=np.zeros((count, 3)),
            rotation=np.tile(np.eye(3), (count, 1, 1)),
            field_of_view=np.ones(count),
            velocity=np.zeros((count, 3)),
            angular_velocity=np.zeros((count, 3)),
        )


class TargetState(NamedTuple):
    """The targets of N trackers."""

    actor: NDArray[np.int32]  # Actor of the tracker's world, -1 before the first reset, shape (N,)
    model: NDArray[np.int32]  # Index into `eyas.engine.targets.catalogue.MODELS`, shape (N,).
    size: Floats  # Length, width, height [m], shape (N, 3)
    rise: Floats  # Height of the reference point above the road [m], shape (N,)
    ahead: Floats  # Distance of the centre ahead of the reference point [m], shape (N,)
    position: Floats
    """Reference point: middle of the SUMO length, one wheel radius above the road [m],
    shape (N, 3)."""
    yaw: Floats  # Heading, counter-clockwise from east [rad], shape (N,)
    speed: Floats  # Horizontal [m/s], shape (N,)
    velocity: Floats  # Change of `position`, world frame [m/s], shape (N, 3)
    acceleration: Floats  # Change of `velocity`, world frame [m/s^2], shape (N, 3)
    yaw_rate: Floats  # [rad/s], shape (N,)
    slope: Floats  # Pitch of the ground along the heading, positive up [rad], shape (N,)
    hitch: Floats
    """Heading of its trailer less that of its truck [rad], shape (N,); 0 of all others."""
    travelled: Floats  # Way since it entered the world [m], shape (N,)
    slowest: Floats  # Speed below which it counts as standing [m/s], shape (N,)
    flies: NDArray[np.bool_]  # See `eyas.engine.targets.kind.Kind`, shape (N,)
    centre: Floats  # Visible middle of the target, the point that the reward uses [m], shape (N, 3)
    lost: NDArray[np.bool_]
    """Whether the target has left the world since the last reset, shape (N,)."""

    @classmethod
    def create(cls, count: int) -> "TargetState":
        """Return targets at the origin that belong to no actor yet."""
        return cls(
            actor=np.full(count, -1, np.int32),
            model=np.zeros(count, np.int32),
            size=np.zeros((count, 3)),
            rise=np.zeros(count),
            ahead=np.zeros(count),
            position=np.zeros((count, 3)),
            yaw=np.zeros(count),
            speed=np.zeros(count),
            velocity=np.zeros((count, 3)),
            acceleration=np.zeros((count, 3)),
            yaw_rate=np.zeros(count),
            slope=np.zeros(count),
            hitch=np.zeros(count),
            travelled=np.zeros(count),
            slowest=np.zeros(count),
            flies=np.zeros(count, np.bool_),
            centre=np.zeros((count, 3)),
            lost=np.zeros(count, np.bool_),
        )


class Snapshot(NamedTuple):
    """The complete state of N trackers at one instant."""

    trackers: TrackerState
    cameras: CameraState
    targets: TargetState
    episodes: EpisodeState
    light: LightState

    @classmethod
    def create(cls, count: int) -> "Snapshot":
        """Return the state of `count` trackers before their first reset."""
        return cls(
            TrackerState.create(count),
            CameraState.create(count),
            TargetState.create(count),
            EpisodeState.create(count),
            LightState.create(count),
        )

    def copy(self) -> "Snapshot":
        """Return a snapshot that later steps do not change."""
        return deepcopy(self)
