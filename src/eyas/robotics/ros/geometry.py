"""Places, turns and boxes of frames in the conventions of ROS (REP 103): right-handed, metres,
radians; quaternions are x, y, z, w.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.exports.boxes import box_of, quaternion_of
from eyas.engine.exports.frame import CameraPose, RecordedBody, Subject
from eyas.lanes import exact

Floats = NDArray[np.float64]


class Pose(NamedTuple):
    """A place, and how what is there is turned."""

    position: Floats  # [m], shape (3,)
    rotation: Floats  # Columns are its axes in the frame of the parent, shape (3, 3)

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        """The rotation as x, y, z, w."""
        w, x, y, z = quaternion_of(self.rotation)
        return x, y, z, w

    def inside(self, vector: Floats) -> Floats:
        """Return a vector of the parent's frame in this one, shape (3,)."""
        found: Floats = exact.product(self.rotation.T, vector)
        return found


STILL = Pose(np.zeros(3), np.eye(3))  # At the origin of the parent, turned as it is

OPTICAL = Pose(np.zeros(3), np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]))
"""The optical frame (right, down, forward) in that of the camera (forward, left, up)."""


def rotation_of(quaternion: Floats) -> Floats:
    """Return the matrix of a quaternion w, x, y, z, shape (3, 3)."""
    w, x, y, z = quaternion.tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def pose_of_body(body: RecordedBody) -> Pose:
    """Return the pose of a tracker's body in the world: forward, left, up."""
    return Pose(body.position, rotation_of(body.orientation))


def camera_on_body(camera: CameraPose, body: Pose) -> Pose:
    """Return the pose of a camera, forward, left, up, in the frame of its tracker's body."""
    turn = exact.product(body.rotation.T, camera.rotation)
    return Pose(body.inside(camera.position - body.position), turn)


def pose_of_subject(subject: Subject) -> tuple[Pose, Floats]:
    """Return the middle and the axes of the 3D box of a moving object in the world, and its length,
    width and height [m], shape (3,).
    """
    box = box_of(subject.corners)
    return Pose(box.centre, box.rotation), box.size


def optical_matrix(camera: CameraPose) -> Floats:
    """Return the camera matrix for pictures whose pixel (0, 0) has its centre at (0, 0), as ROS and
    OpenCV have it, shape (3, 3).
    """
    matrix = camera.intrinsics.copy()
    matrix[:2, 2] -= 0.5
    return matrix


def picture_box(
    box: NDArray[np.int32],  # Left, top, right, bottom, the last two exclusive, shape (4,)
) -> tuple[float, float, float, float]:
    """Return the centre and the size of a box [pixels], x, y, width, height; the centre of pixel
    (0, 0) is at (0, 0).
    """
    left, top, right, bottom = box.tolist()
    return (
        0.5 * (left + right - 1),
        0.5 * (top + bottom - 1),
        float(right - left),
        float(bottom - top),
    )
