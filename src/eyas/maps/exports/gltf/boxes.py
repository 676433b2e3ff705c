"""Boxes that stand for what moves."""

import numpy as np

from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.state.scene import ObjectClass

__all__ = ["box_mesh"]

_TINTS = {
    ObjectClass.CAR: (0.85, 0.25, 0.2),
    ObjectClass.TRUCK: (0.9, 0.6, 0.2),
    ObjectClass.BUS: (0.95, 0.85, 0.25),
    ObjectClass.MOTORCYCLE: (0.7, 0.3, 0.7),
    ObjectClass.PERSON: (0.25, 0.6, 0.9),
    ObjectClass.ROBOT: (0.3, 0.8, 0.5),
    ObjectClass.BICYCLE: (0.5, 0.8, 0.9),
}
"""Colour of each class, sRGB."""

_SIDES = np.array([(axis, sign) for axis in range(3) for sign in (-1.0, 1.0)])


def box_mesh(size: tuple[float, float, float], kind: ObjectClass) -> Mesh:
    """Return a box about the origin, length along x, width along y, in the colour of a class.

    Args:
        size: Length, width, height [m].
        kind: The class.
    """
    positions, normals = [], []
    for axis, sign in _SIDES.tolist():
        normal = np.zeros(3)
        normal[int(axis)] = sign
        first, second = (np.eye(3)[(int(axis) + step) % 3] for step in (1, 2))
        second = second * sign  # counter-clockwise from outside
        for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            positions.append(0.5 * (normal + a * first + b * second) * size)
            normals.append(normal)
    faces = np.arange(24).reshape(6, 4)
    triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    return Mesh(
        positions=np.array(positions, np.float32),
        normals=np.array(normals, np.float32),
        uvs=np.zeros((24, 2), np.float32),
        triangles=triangles.astype(np.int32),
        materials=np.zeros(12, np.int32),
        palette=(Material(tint=_TINTS.get(kind, (0.6, 0.6, 0.6))),),
    )
