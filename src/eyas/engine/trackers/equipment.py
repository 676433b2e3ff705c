"""What a flown drone carries: where it puts the centre of mass, and the constants of it all."""

from collections.abc import Iterable
from typing import NamedTuple

from eyas.engine.trackers.airframe import ORIGINAL, Airframe
from eyas.engine.trackers.battery import Battery
from eyas.engine.trackers.gimbal import PITCH_JOINT, ROLL_JOINT, YAW_JOINT

Vector = tuple[float, float, float]

Symmetric = tuple[float, float, float, float, float, float]
"""A symmetric matrix: its elements xx, yy, zz, xy, xz, yz."""


class Part(NamedTuple):
    """Something heavy and small."""

    mass: float  # [kg]
    place: Vector  # Its centre of mass, body frame [m]


def _joints() -> tuple[Vector, Vector, Vector]:
    """Return where the joints of yaw, pitch and roll are when the camera looks ahead [m]."""
    x, y, z = YAW_JOINT
    second = (x + PITCH_JOINT[0], y + PITCH_JOINT[1], z + PITCH_JOINT[2])
    third = (second[0] + ROLL_JOINT[0], second[1] + ROLL_JOINT[1], second[2] + ROLL_JOINT[2])
    return YAW_JOINT, second, third


MOUNTED = (*(Part(0.0333, place) for place in _joints()), Part(0.2, (0.0, 0.0, 0.02)))
"""The links of the original's gimbal, each at its joint, and its lidar, a cylinder of Webots'
`RpLidarA2` whose middle is 11 mm below its optical centre. `Airframe.mass` includes them."""


class Equipment(NamedTuple):
    """An airframe with what it carries."""

    frame: Airframe  # Its `mass` is that of all
    centre: Vector = (0.0, 0.0, 0.0)  # Centre of mass, body frame [m]
    inertia: Symmetric = (*ORIGINAL.inertia, 0.0, 0.0, 0.0)
    """Moments of inertia about the centre of mass, body frame [kg m^2]."""
    inverse: Symmetric = (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)  # Inverse of `inertia`
    radius: float = 0.0  # Of the rotors, for the ground effect [m]; 0: there is none
    battery: Battery = Battery()


def loaded(
    frame: Airframe,  # Its mass is that of its body alone, in whose middle its centre of mass is
    parts: Iterable[Part],  # What is fixed to it
) -> Equipment:
    """Return an airframe that carries some parts, which are points (Huygens-Steiner)."""
    mass, first = frame.mass, [0.0, 0.0, 0.0]
    moments = [*frame.inertia, 0.0, 0.0, 0.0]
    for part in parts:
        mass += part.mass
        for axis in range(3):
            first[axis] += part.mass * part.place[axis]
        moments = _plus(moments, part)
    centre = (first[0] / mass, first[1] / mass, first[2] / mass)
    xx, yy, zz, xy, xz, yz = _plus(moments, Part(-mass, centre))
    inertia = (xx, yy, zz, xy, xz, yz)
    return Equipment(frame._replace(mass=mass), centre, inertia, _inverse(inertia))


def _plus(moments: list[float], part: Part) -> list[float]:
    """Return moments of inertia about the origin, with those of a point."""
    x, y, z = part.place
    own = (y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z)
    return [moment + part.mass * each for moment, each in zip(moments, own, strict=True)]


def _inverse(matrix: Symmetric) -> Symmetric:
    xx, yy, zz, xy, xz, yz = matrix
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    size = xx * a + xy * b + xz * c
    return (
        a / size,
        (xx * zz - xz * xz) / size,
        (xx * yy - xy * xy) / size,
        b / size,
        c / size,
        (xy * xz - xx * yz) / size,
    )
