"""The motion of a rigid body whose centre of mass is not its origin.

Its centre of mass moves as a point under all forces, and it turns about it. Rotors, air and ground
act on its origin, by `eyas.engine.trackers.rigid_body.loads`, and the step is the one of that
module.
"""

from collections.abc import Callable

from eyas.engine.core.frames import rotate, rotate_back
from eyas.engine.state.terrain import Terrain
from eyas.engine.trackers.equipment import Equipment, Symmetric
from eyas.engine.trackers.rigid_body import (
    Change,
    RigidBody,
    Thrusts,
    cross,
    loads,
    moved,
    plus,
    rotation_rate,
    stage,
)
from eyas.lanes import kernel, specialised

Vector = tuple[float, float, float]


@kernel
def moved_with_load(
    equipment: Equipment,
    body: RigidBody,
    thrusts: tuple[Thrusts, Thrusts, Thrusts],
    wind: Vector,
    terrain: Terrain,
    step: float,
) -> RigidBody:
    """Return the origin of a body after a time step; arguments as of `rigid_body.moved`."""
    start = _seen_from(body, equipment.centre, 1.0)
    end = _moved(equipment, start, thrusts, wind, terrain, step)
    return _seen_from(end, equipment.centre, -1.0)


@kernel
def _seen_from(body: RigidBody, place: Vector, sign: float) -> RigidBody:
    """Return the state of the point of a body at a place, body frame [m], times a sign."""
    x, y, z = cross(body.rate, place)
    return RigidBody(
        plus(body.position, rotate(body.attitude, place[0], place[1], place[2]), sign),
        plus(body.velocity, rotate(body.attitude, x, y, z), sign),
        body.attitude,
        body.rate,
    )


@kernel
def _change_about_centre(
    equipment: Equipment,
    body: RigidBody,
    rotation: Vector,
    thrusts: Thrusts,
    wind: Vector,
    terrain: Terrain,
) -> Change:
    """Return the rates of change of a body that is told by its centre of mass."""
    frame, centre = equipment.frame, equipment.centre
    origin = _seen_from(body, centre, -1.0)
    force, moment = loads(frame, origin, thrusts, wind, terrain)
    x, y, z = rotate_back(body.attitude, force[0], force[1], force[2])
    torque = plus(moment, cross(centre, (x, y, z)), -1.0)
    gyration = cross(body.rate, _times(equipment.inertia, body.rate))
    fx, fy, fz = force
    return Change(
        body.velocity,
        (fx / frame.mass, fy / frame.mass, fz / frame.mass - frame.gravity),
        rotation_rate(body.rate, rotation),
        _times(equipment.inverse, plus(torque, gyration, -1.0)),
    )


@kernel
def _times(matrix: Symmetric, vector: Vector) -> Vector:
    xx, yy, zz, xy, xz, yz = matrix
    x, y, z = vector
    return xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z


_stage = kernel(specialised(stage, change_of=_change_about_centre))
_moved: Callable[..., RigidBody] = kernel(
    specialised(moved, stage=_stage, change_of=_change_about_centre)
)
