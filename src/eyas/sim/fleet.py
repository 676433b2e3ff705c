"""All that changes in a step, as arrays that kernels take in one bundle."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.sensors.config import CameraConfig
from eyas.state.tracker import CameraPose, TargetState, TrackerState
from eyas.task.columns import MEMORY_COLUMNS as TASK_COLUMNS
from eyas.task.packet_rows import BASIC_COLUMNS, reward_rows
from eyas.trackers.columns import MEMORY_COLUMNS as TRACKER_COLUMNS

__all__ = ["Fleet", "Traffic", "camera_view", "create_fleet", "target_view", "tracker_view"]

Floats = NDArray[np.float64]


class Fleet(NamedTuple):
    """N trackers, their cameras, targets and episodes. Units and frames: `eyas.state.tracker`."""

    position: Floats
    velocity: Floats
    acceleration: Floats
    orientation: Floats
    euler: Floats
    angular_velocity: Floats
    commanded_position: Floats
    gimbal: Floats
    camera_position: Floats
    camera_rotation: Floats
    target_actor: NDArray[np.int32]
    target_position: Floats
    target_yaw: Floats
    target_speed: Floats
    target_centre: Floats
    target_lost: NDArray[np.bool_]
    tracker_memory: Floats
    """Columns of `eyas.trackers.columns`."""
    task_memory: Floats
    """Columns of `eyas.task.columns`."""
    tick: NDArray[np.int64]
    """Time in the recording, in physics steps."""
    offset: Floats
    """Start relative to the target: forward, left, up [m], heading [rad]; for exact following."""
    basic: Floats
    """Basic packets, shape (N, 22)."""
    reward: Floats
    """Reward packets, shape (N, 60)."""


class Traffic(NamedTuple):
    """What the kernels need of a replay."""

    table: NDArray[np.float32]
    """Shape (S, A, 8)."""
    rate: float
    """Rows in a second [Hz]."""


def create_fleet(count: int, camera: CameraConfig) -> Fleet:
    """Return the arrays of `count` trackers."""
    trackers, cameras = TrackerState.create(count), CameraPose.create(count)
    targets = TargetState.create(count)
    targets.actor[:] = -1
    return Fleet(
        position=trackers.position,
        velocity=trackers.velocity,
        acceleration=trackers.acceleration,
        orientation=trackers.orientation,
        euler=trackers.euler,
        angular_velocity=trackers.angular_velocity,
        commanded_position=trackers.commanded_position,
        gimbal=trackers.gimbal,
        camera_position=cameras.position,
        camera_rotation=cameras.rotation,
        target_actor=targets.actor,
        target_position=targets.position,
        target_yaw=targets.yaw,
        target_speed=targets.speed,
        target_centre=targets.centre,
        target_lost=targets.lost,
        tracker_memory=np.zeros((count, TRACKER_COLUMNS)),
        task_memory=np.zeros((count, TASK_COLUMNS)),
        tick=np.zeros(count, np.int64),
        offset=np.zeros((count, 4)),
        basic=np.zeros((count, BASIC_COLUMNS)),
        reward=reward_rows(count, camera),
    )


def tracker_view(fleet: Fleet) -> TrackerState:
    """Return the trackers; the arrays are shared with the fleet."""
    return TrackerState(
        position=fleet.position,
        velocity=fleet.velocity,
        acceleration=fleet.acceleration,
        orientation=fleet.orientation,
        euler=fleet.euler,
        angular_velocity=fleet.angular_velocity,
        commanded_position=fleet.commanded_position,
        gimbal=fleet.gimbal,
    )


def camera_view(fleet: Fleet) -> CameraPose:
    """Return the cameras; the arrays are shared with the fleet."""
    return CameraPose(fleet.camera_position, fleet.camera_rotation)


def target_view(fleet: Fleet) -> TargetState:
    """Return the targets; the arrays are shared with the fleet."""
    return TargetState(
        actor=fleet.target_actor,
        position=fleet.target_position,
        yaw=fleet.target_yaw,
        speed=fleet.target_speed,
        centre=fleet.target_centre,
        lost=fleet.target_lost,
    )
