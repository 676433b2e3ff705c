"""Where sensors are fixed to the body."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import MountConfig
from eyas.engine.core.frames import rotate
from eyas.engine.state.snapshot import CameraState, TrackerState
from eyas.lanes import exact, kernel

Floats = NDArray[np.float64]


class Mount(NamedTuple):
    """The place of a sensor, for kernels."""

    place: Floats  # Body frame [m], shape (3,)
    turn: Floats  # Sensor to body, shape (3, 3)
    pitch: float  # Positive down [rad]
    yaw: float  # [rad]


def mount_of(config: MountConfig) -> Mount:
    """Return the mount of some settings."""
    place = np.array([config.x, config.y, config.z], np.float64)
    return Mount(place, turn_of(config), float(config.pitch), float(config.yaw))


def turn_of(config: MountConfig) -> Floats:
    """Return the rotation of a mount, sensor to body, shape (3, 3)."""
    cr, sr = exact.cos(config.roll), exact.sin(config.roll)
    cp, sp = exact.cos(config.pitch), exact.sin(config.pitch)
    cy, sy = exact.cos(config.yaw), exact.sin(config.yaw)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    about_y = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    about_z = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    turn: Floats = exact.product(exact.product(about_z, about_y), about_x)
    return turn


@kernel(inline=True)
def fixed(trackers: TrackerState, cameras: CameraState, n: int, mount: Mount) -> None:
    """Write the pose of a camera that is fixed to the body of tracker `n`."""
    orientation, place, turn = trackers.orientation[n], mount.place, mount.turn
    off = rotate(orientation, place[0], place[1], place[2])
    for axis in range(3):
        cameras.position[n, axis] = trackers.position[n, axis] + off[axis]
        column = rotate(orientation, turn[0, axis], turn[1, axis], turn[2, axis])
        for row in range(3):
            cameras.rotation[n, row, axis] = column[row]
    commanded = trackers.commanded_gimbal[n]
    commanded[0], commanded[1] = mount.pitch, mount.yaw


@kernel(inline=True)
def left_on_gimbal(trackers: TrackerState, cameras: CameraState, n: int, mount: Mount) -> None:
    """Leave the camera of tracker `n` where its tracker has aimed it."""


CARRIED = {False: left_on_gimbal, True: fixed}
"""What carries a camera, by whether it is fixed to the body."""
