"""Rows of the two packets. Their columns are named in `eyas.task.packets`.

Numbers keep their full precision; the original's text streams round them to six digits.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.frames import wrap_angle
from eyas.lanes import compiled, kernel
from eyas.lanes.elementary import sin_cos, tan
from eyas.sensors.config import CameraConfig
from eyas.sensors.inertial import accelerometer, gyroscope
from eyas.state.episode import EpisodeState
from eyas.state.snapshot import CameraState, Snapshot, TargetState, TrackerState
from eyas.state.terrain import Terrain

__all__ = ["BASIC_COLUMNS", "REWARD_COLUMNS", "SENSOR_COLUMNS", "PacketRows"]

BASIC_COLUMNS = 22
REWARD_COLUMNS = 60

SENSOR_COLUMNS = slice(1, 20)
"""Columns of the basic packet that the sensors measure."""

_CAMERA_POSE, _TARGET_POSE = 7, 23
_VIEW_CENTRE, _TARGET_CENTRE, _CAMERA_POSITION = 39, 42, 45
_RELATIVE = 49


class PacketRows:
    """Packets of N trackers as rows of numbers.

    Args:
        snapshot: State of N trackers; read at each call.
        camera: Camera whose settings each reward packet holds.
        terrain: Ground of the map; its floor is z = 0 of the land frame.
    """

    def __init__(self, snapshot: Snapshot, camera: CameraConfig, terrain: Terrain) -> None:
        count = len(snapshot.episodes.number)
        self._basic = np.zeros((count, BASIC_COLUMNS))
        rows = self._reward = np.zeros((count, REWARD_COLUMNS))
        rows[:, 0], rows[:, 1] = camera.width, camera.height
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
    floor: float
    """z of the land frame's ground [m]."""
    basic: NDArray[np.float64]
    reward: NDArray[np.float64]


@compiled
def _fill_packets(packets: _Packets) -> None:
    """Fill the packets of all trackers."""
    trackers, cameras, targets, episodes, _ = packets.snapshot
    floor, basic, reward = packets.floor, packets.basic, packets.reward
    for n in range(basic.shape[0]):
        _fill_basic(trackers, episodes, n, basic[n])
        _fill_reward(trackers, cameras, targets, episodes, n, floor, reward[n])


@kernel(inline=True)
def _fill_basic(
    trackers: TrackerState, episodes: EpisodeState, n: int, row: NDArray[np.float64]
) -> None:
    row[0] = episodes.step_count[n]
    row[7], row[8], row[9] = accelerometer(trackers, n)
    row[10], row[11], row[12] = gyroscope(trackers, n)
    for axis in range(3):
        row[1 + axis] = trackers.position[n, axis]
        row[4 + axis] = trackers.velocity[n, axis]
        row[17 + axis] = trackers.euler[n, axis]
    for part in range(4):
        row[13 + part] = trackers.orientation[n, part]
    row[20] = episodes.reward[n]
    row[21] = 1.0 if episodes.reason[n] > 0 else 0.0


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
    row[2] = cameras.field_of_view[n]
    row[3] = 0.5 * row[0] / tan(0.5 * row[2])
    row[4] = trackers.commanded_gimbal[n, 0]
    row[5] = trackers.commanded_position[n, 2]
    row[6] = episodes.start_offset[n, 3]
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
        row[_RELATIVE + axis] = episodes.relative_position[n, axis]
        row[_RELATIVE + 3 + axis] = episodes.relative_velocity[n, axis]
        row[_RELATIVE + 6 + axis] = episodes.relative_acceleration[n, axis]
    row[48] = wrap_angle(targets.yaw[n] - trackers.euler[n, 2])
    row[58] = 1.0 if episodes.crash[n] else 0.0
    row[59] = episodes.direction[n]
