"""Meshes of what moves: those of its model, or a box of its size."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.exports.boxes import box_of
from eyas.engine.exports.frame import Subject
from eyas.engine.exports.resting import painted, resting_mesh
from eyas.engine.mesh.assembly import transformed
from eyas.engine.state.mesh import Mesh
from eyas.engine.targets.catalogue import MODELS
from eyas.lanes import exact
from eyas.maps.exports.gltf.boxes import box_mesh

__all__ = ["mover_mesh", "pose_of"]

_DETAIL = 1

Floats = NDArray[np.float64]


def pose_of(subject: Subject) -> tuple[Floats, Floats]:
    """Return where the point on the ground below the reference point is [m], shape (3,), and the
    axes of a moving object, columns forward, left and up, shape (3, 3).
    """
    motion = subject.motion
    slope = 0.0 if motion.upright else motion.slope
    c, s = float(exact.cos(subject.yaw)), float(exact.sin(subject.yaw))
    cp, sp = float(exact.cos(slope)), float(exact.sin(slope))
    axes = np.array([[c * cp, -s, -c * sp], [s * cp, c, -s * sp], [sp, 0.0, cp]])
    return subject.position - motion.rise * np.array([0.0, 0.0, 1.0]), axes


def mover_mesh(subject: Subject, colour: tuple[float, ...]) -> Mesh:
    """Return the mesh of a moving object in the frame of `pose_of`; its limbs and wheels rest.

    Args:
        subject: The object.
        colour: Of its body, sRGB.
    """
    if any(model.name == subject.type for model in MODELS):
        return painted(resting_mesh(subject.type, _DETAIL), colour)
    place, axes = pose_of(subject)
    box = box_of(subject.corners)
    length, width, height = subject.size.tolist()
    middle = exact.product(box.centre - place, axes)
    pose = np.column_stack([np.eye(3), middle])
    return transformed(box_mesh((length, width, height), subject.object_class), pose)
