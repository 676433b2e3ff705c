"""The packets of the original as named records: its input, and two of the three that it answers;
the third, of the lidar, is in `eyas.engine.task.radar_packet`.

Input packet, 5 numbers: four of the command and whether it is a reset.

Basic packet, 22 numbers (the original's names): t, position 3, linear 3, acc 3, angular 3,
orientation 4, angle 3, reward, done.

Reward packet, 60 numbers and the name of the target's type (the original's names): cameraWidth,
cameraHeight, Fov, focal length, pitch, trackerHeight, initDirection, T_ct 16, T_tw 16,
cameraMidGlobalPos 3, carMidGlobalPos 3, cameraMidPos 3, carDronePosOri 4, relative velocity 3,
relative acceleration 3, crash, carDir, typename. The original's manual counts 59 numbers and omits
initDirection.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sensors.original import ORIGINAL
from eyas.engine.task.direction import TargetDirection

Numbers = tuple[float, ...]
Columns = Mapping[str, int | slice]
"""Where the parts of a row stand: the column of a single number, the slice of several."""


def _columns_of(widths: Mapping[str, int]) -> Columns:
    columns: dict[str, int | slice] = {}
    first = 0
    for name, width in widths.items():
        columns[name] = first if width == 1 else slice(first, first + width)
        first += width
    return columns


BASIC_COLUMNS = _columns_of(
    {
        "step_count": 1,
        **{name: len(each) for sensor in ORIGINAL for name, each in sensor.parts.items()},
        **{"reward": 1, "done": 1},
    }
)
"""Columns of a basic packet by the names of `BasicPacket`: it is a selection of sensors."""

REWARD_COLUMNS = _columns_of(
    {
        **{"camera_width": 1, "camera_height": 1, "field_of_view": 1, "focal_length": 1},
        **{"camera_pitch": 1, "commanded_height": 1, "start_direction": 1},
        **{"camera_pose": 16, "target_pose": 16, "view_centre": 3, "target_centre": 3},
        **{"camera_position": 3, "relative_yaw": 1, "relative_position": 3},
        **{"relative_velocity": 3, "relative_acceleration": 3, "crash": 1, "target_direction": 1},
    }
)
"""Columns of a reward packet by the names of `RewardPacket`."""


def first_column(columns: Columns, name: str) -> int:
    """Return the first column of a part."""
    found = columns[name]
    return found.start if isinstance(found, slice) else found


def _parts_of(row: NDArray[np.float64], columns: Columns) -> dict[str, Any]:
    numbers = row.tolist()
    return {
        name: tuple(numbers[found]) if isinstance(found, slice) else numbers[found]
        for name, found in columns.items()
    }


def _named(name: str, parts: str) -> tuple[str, ...]:
    return tuple(f"{name}_{part}" for part in parts)


def _matrix(name: str) -> tuple[str, ...]:
    return tuple(f"{name}_{row}{column}" for row in range(4) for column in range(4))


INPUT_FIELDS = ("forward", "left", "up", "turn_rate", "reset")
"""Names of the columns of an input packet."""

BASIC_FIELDS = (
    "step_count",
    *(column for sensor in ORIGINAL for column in sensor.columns),
    "reward",
    "done",
)
"""Names of the columns of a basic packet."""

REWARD_FIELDS = (
    *("camera_width", "camera_height", "field_of_view", "focal_length"),
    *("camera_pitch", "commanded_height", "start_direction"),
    *_matrix("camera_pose"),
    *_matrix("target_pose"),
    *_named("view_centre", "xyz"),
    *_named("target_centre", "xyz"),
    *_named("camera_position", "xyz"),
    "relative_yaw",
    *_named("relative_position", "xyz"),
    *_named("relative_velocity", "xyz"),
    *_named("relative_acceleration", "xyz"),
    "crash",
    "target_direction",
)
"""Names of the columns of a reward packet; the name of the target's type follows."""


@dataclass(frozen=True, slots=True)
class InputPacket:
    """A command of one tracker: three speeds and a turn rate.

    The manual calls its numbers forward, backward, left and right.
    """

    forward: float = 0.0
    """Speed ahead in the heading frame [m/s]."""
    left: float = 0.0
    """Speed to the left [m/s]."""
    up: float = 0.0
    """Climb in each physics step [m per 2 ms]."""
    turn_rate: float = 0.0
    """Counter-clockwise, seen from above [rad/s]."""
    reset: bool = False
    """Whether a new episode is to begin instead."""

    names: ClassVar[tuple[str, ...]] = INPUT_FIELDS

    @classmethod
    def from_row(cls, row: NDArray[np.float64]) -> "InputPacket":
        """Return the packet of a row, shape (5,)."""
        forward, left, up, turn_rate, reset = row.tolist()
        return cls(forward, left, up, turn_rate, reset=bool(reset))

    def to_row(self) -> NDArray[np.float64]:
        """Return the numbers, shape (5,)."""
        return np.array([getattr(self, name) for name in INPUT_FIELDS], np.float64)


@dataclass(frozen=True, slots=True)
class BasicPacket:
    """State, reward and end of one tracker."""

    step_count: int
    """2 ms steps since the reset; the original's `t`."""
    position: Numbers
    """Centre of the body, world frame [m], 3 numbers."""
    velocity: Numbers
    """World frame [m/s], 3 numbers; the original's `linear`."""
    felt_acceleration: Numbers
    """Accelerometer, body frame [m/s^2], 3 numbers, +9.81 up at rest; the original's `acc`. Of a
    smoothed motion unless the drone is flown, see `tracker.inertial_time_constant`."""
    angular_velocity: Numbers
    """Gyroscope, body frame [rad/s], 3 numbers; the original's `angular`. Of the same smoothed
    motion."""
    orientation: Numbers
    """Body to world, w, x, y, z."""
    euler: Numbers
    """Roll, pitch, yaw [rad]; the original's `angle`."""
    reward: float
    """The built-in reward."""
    done: bool
    """Whether the episode has ended."""

    names: ClassVar[tuple[str, ...]] = BASIC_FIELDS

    @classmethod
    def from_row(cls, row: NDArray[np.float64]) -> "BasicPacket":
        """Return the packet of a row, shape (22,)."""
        parts = _parts_of(row, BASIC_COLUMNS)
        whole = {"step_count": int(parts["step_count"]), "done": bool(parts["done"])}
        return cls(**parts | whole)

    def to_row(self) -> NDArray[np.float64]:
        """Return the numbers, shape (22,)."""
        return np.hstack([getattr(self, field.name) for field in fields(self)]).astype(np.float64)


@dataclass(frozen=True, slots=True)
class RewardPacket:
    """Data for a user-defined reward. The land frame is the world with the floor at z = 0."""

    camera_width: int
    """[pixels]"""
    camera_height: int
    """[pixels]"""
    field_of_view: float
    """Horizontal [rad]."""
    focal_length: float
    """[pixels]"""
    camera_pitch: float
    """Commanded pitch, positive down [rad]."""
    commanded_height: float
    """Commanded z of the tracker [m]; the original's `trackerHeight`."""
    start_direction: float
    """Heading at the start relative to the target's [rad]; the original's `initDirection`."""
    camera_pose: Numbers
    """Camera to land frame, 4x4 row by row; the original's `T_ct`."""
    target_pose: Numbers
    """Target to land frame at its centre, 4x4 row by row; the original's `T_tw`."""
    view_centre: Numbers
    """Ground point in the middle of the picture, world frame [m], or the point below the camera if
    there is none; the original's `cameraMidGlobalPos`."""
    target_centre: Numbers
    """The point that the reward uses, land frame [m]; the original's `carMidGlobalPos`."""
    camera_position: Numbers
    """Optical centre, land frame [m]; the original's `cameraMidPos`."""
    relative_yaw: float
    """Heading of the target minus that of the tracker [rad]; the original's `carDronePosOri.w`."""
    relative_position: Numbers
    """The target's centre in the tracker's body frame [m]; the original's `carDronePosOri`."""
    relative_velocity: Numbers
    """Change of `relative_position` in 2 ms [m/s]; 0 at a reset."""
    relative_acceleration: Numbers
    """Change of `relative_velocity` in 2 ms [m/s^2]; 0 at a reset and one step after."""
    crash: bool
    """Whether the tracker has crashed, as `done.crash` means it: by default, whether it is too far
    from its commanded position or turns too fast."""
    target_direction: TargetDirection
    """Direction of the target's motion; the original's `carDir`."""
    target_type: str
    """The original's `typename`, for a trailer that of its truck."""

    names: ClassVar[tuple[str, ...]] = REWARD_FIELDS

    @classmethod
    def from_row(cls, row: NDArray[np.float64], target_type: str) -> "RewardPacket":
        """Return the packet of a row, shape (60,), with the name of the target's type."""
        parts = _parts_of(row, REWARD_COLUMNS)
        parts["camera_width"] = int(parts["camera_width"])
        parts["camera_height"] = int(parts["camera_height"])
        parts["crash"] = bool(parts["crash"])
        parts["target_direction"] = TargetDirection(int(parts["target_direction"]))
        return cls(**parts, target_type=target_type)

    def to_row(self) -> NDArray[np.float64]:
        """Return the numbers, shape (60,)."""
        numbers = [getattr(self, field.name) for field in fields(self)[:-1]]
        return np.hstack(numbers).astype(np.float64)

    def to_manual_row(self) -> NDArray[np.float64]:
        """Return the numbers that the original's manual lists, shape (59,): all but
        `start_direction`.
        """
        return np.delete(self.to_row(), REWARD_FIELDS.index("start_direction"))
