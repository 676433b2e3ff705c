"""Rows of the two packets. Their columns are named in `eyas.engine.task.packets`.

Numbers keep their full precision; the original's text streams round them to six digits.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.frames import wrap_angle
from eyas.engine.sensors.inertial import accelerometer, gyroscope
from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.snapshot import CameraState, Snapshot, TargetState, TrackerState
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.packets import (
    BASIC_COLUMNS,
    BASIC_FIELDS,
    REWARD_COLUMNS,
    REWARD_FIELDS,
    first_column,
)
from eyas.lanes import compiled, kernel
from eyas.lanes.elementary import sin_cos, tan

_STEP_COUNT = first_column(BASIC_COLUMNS, "step_count")
_POSITION = first_column(BASIC_COLUMNS, "position")
_VELOCITY = first_column(BASIC_COLUMNS, "velocity")
_FELT_ACCELERATION = first_column(BASIC_COLUMNS, "felt_acceleration")
_ANGULAR_VELOCITY = first_column(BASIC_COLUMNS, "angular_velocity")
_ORIENTATION = first_column(BASIC_COLUMNS, "orientation")
_EULER = first_column(BASIC_COLUMNS, "euler")
_REWARD = first_column(BASIC_COLUMNS, "reward")
_DONE = first_column(BASIC_COLUMNS, "done")

SENSOR_COLUMNS = slice(_POSITION, _REWARD)  # Columns of the basic packet that the sensors measure
SENSOR_COUNT = _REWARD - _POSITION
FLOWN_STATE = [
    first + part - _POSITION
    for first, parts in ((_POSITION, 3), (_VELOCITY, 3), (_ORIENTATION, 4))
    for part in range(parts)
]
"""Those of them that are the state of data sets for robots: position [m], velocity [m/s] and
orientation (w, x, y, z), world frame; their order is that of `eyas.datasets.motion.STATE_NAMES`."""

_WIDTH = first_column(REWARD_COLUMNS, "camera_width")
_HEIGHT = first_column(REWARD_COLUMNS, "camera_height")
_FIELD_OF_VIEW = first_column(REWARD_COLUMNS, "field_of_view")
_FOCAL_LENGTH = first_column(REWARD_COLUMNS, "focal_length")
_CAMERA_PITCH = first_column(REWARD_COLUMNS, "camera_pitch")
_COMMANDED_HEIGHT = first_column(REWARD_COLUMNS, "commanded_height")
_START_DIRECTION = first_column(REWARD_COLUMNS, "start_direction")
_CAMERA_POSE = first_column(REWARD_COLUMNS, "camera_pose")
_TARGET_POSE = first_column(REWARD_COLUMNS, "target_pose")
_VIEW_CENTRE = first_column(REWARD_COLUMNS, "view_centre")
_TARGET_CENTRE = first_column(REWARD_COLUMNS, "target_centre")
_CAMERA_POSITION = first_column(REWARD_COLUMNS, "camera_position")
_RELATIVE_YAW = first_column(REWARD_COLUMNS, "relative_yaw")
_RELATIVE_POSITION = first_column(REWARD_COLUMNS, "relative_position")
_RELATIVE_VELOCITY = first_column(REWARD_COLUMNS, "relative_velocity")
_RELATIVE_ACCELERATION = first_column(REWARD_COLUMNS, "relative_acceleration")
_CRASH = first_column(REWARD_COLUMNS, "crash")
_TARGET_DIRECTION = first_column(REWARD_COLUMNS, "target_direction")


class PacketRows:
    """Packets of N trackers as rows of numbers."""

    def __init__(
        self,
        snapshot: Snapshot,  # State of N trackers; read at each call
        camera: CameraConfig,  # Camera whose settings each reward packet holds
        terrain: Terrain,  # Ground of the map; its floor is z = 0 of the land frame
    ) -> None:
        count = len(snapshot.episodes.number)
        self._basic = np.zeros((count, len(BASIC_FIELDS)))
        rows = self._reward = np.zeros((count, len(REWARD_FIELDS)))
        rows[:, _WIDTH], rows[:, _HEIGHT] = camera.width, camera.height
        rows[:, _CAMERA_POSE + 15] = rows[:, _TARGET_POSE + 15] = 1.0
        rows[:, _TARGET_POSE + 10] = 1.0
        packets = _Packets(snapshot, terrain.floor, self._basic, self._reward)
        self._fill = _fill_packets.bind(packets)

    def now(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the basic packets, shape (N, 22), and the reward packets, shape (N, 60)."""
        self._fill()
        return self._basic.copy(), self._reward.copy()


class _Packets(NamedTuple):
    """Inputs and outputs of the kernel."""

    snapshot: Snapshot
    floor: float  # z of the land frame's ground [m]
    basic: NDArray[np.float64]
    reward: NDArray[np.float64]


@compiled
def _fill_packets(packets: _Packets) -> None:
    """Fill the packets of all trackers."""
    trackers, cameras, targets, episodes, _ = packets.snapshot
    floor, basic, reward = packets.floor, packets.basic, packets.reward
    for n in range(basic.shape[0]):
        fill_basic(trackers, episodes, n, basic[n])
        _fill_reward(trackers, cameras, targets, episodes, n, floor, reward[n])


@kernel(inline=True)
def fill_basic(
    trackers: TrackerState, episodes: EpisodeState, n: int, row: NDArray[np.float64]
) -> None:
    """Fill one basic packet."""
    row[_STEP_COUNT] = episodes.step_count[n]
    felt, turning = accelerometer(trackers, n), gyroscope(trackers, n)
    for axis in range(3):
        row[_FELT_ACCELERATION + axis] = felt[axis]
        row[_ANGULAR_VELOCITY + axis] = turning[axis]
        row[_POSITION + axis] = trackers.position[n, axis]
        row[_VELOCITY + axis] = trackers.velocity[n, axis]
        row[_EULER + axis] = trackers.euler[n, axis]
    for part in range(4):
        row[_ORIENTATION + part] = trackers.orientation[n, part]
    row[_REWARD] = episodes.reward[n]
    row[_DONE] = 1.0 if episodes.reason[n] > 0 else 0.0


@kernel(inline=True)
def _fill_reward(
    trackers: TrackerState,
    cameras: CameraState,
    targets: TargetState,
    episodes: EpisodeState,
    n: int,
    floor: float,
    row: NDArray[np.float64],
) -> None:
    """Fill the changing columns of one reward packet.

    Poses and points are in the land frame, the world raised so that the floor is z = 0, except for
    the view centre, which is in the world frame, as in the original.
    """
    centre, rotation = targets.centre[n], cameras.rotation[n]
    row[_FIELD_OF_VIEW] = cameras.field_of_view[n]
    row[_FOCAL_LENGTH] = 0.5 * row[_WIDTH] / tan(0.5 * row[_FIELD_OF_VIEW])
    row[_CAMERA_PITCH] = trackers.commanded_gimbal[n, 0]
    row[_COMMANDED_HEIGHT] = trackers.commanded_position[n, 2]
    row[_START_DIRECTION] = episodes.start_offset[n, 3]
    sine, cosine = sin_cos(targets.yaw[n])
    row[_TARGET_POSE], row[_TARGET_POSE + 1] = cosine, -sine
    row[_TARGET_POSE + 4], row[_TARGET_POSE + 5] = sine, cosine
    for axis in range(3):
        lift = -floor if axis == 2 else 0.0
        for column in range(3):
            row[_CAMERA_POSE + 4 * axis + column] = rotation[axis, column]
        row[_CAMERA_POSE + 4 * axis + 3] = cameras.position[n, axis] + lift
        row[_TARGET_POSE + 4 * axis + 3] = centre[axis] + lift
        row[_TARGET_CENTRE + axis] = centre[axis] + lift
        row[_CAMERA_POSITION + axis] = cameras.position[n, axis] + lift
        row[_VIEW_CENTRE + axis] = episodes.view_centre[n, axis]
        row[_RELATIVE_POSITION + axis] = episodes.relative_position[n, axis]
        row[_RELATIVE_VELOCITY + axis] = episodes.relative_velocity[n, axis]
        row[_RELATIVE_ACCELERATION + axis] = episodes.relative_acceleration[n, axis]
    row[_RELATIVE_YAW] = wrap_angle(targets.yaw[n] - trackers.euler[n, 2])
    row[_CRASH] = 1.0 if episodes.crash[n] else 0.0
    row[_TARGET_DIRECTION] = episodes.direction[n]
