"""The motion of a rigid body under the thrusts of four rotors, gravity, air and the ground."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.frames import rotate, rotate_back
from eyas.engine.state.terrain import Terrain, ground_at
from eyas.engine.trackers.airframe import Airframe
from eyas.lanes import kernel
from eyas.lanes.elementary import exp, sin_cos

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Thrusts = tuple[float, float, float, float]


class RigidBody(NamedTuple):
    """State of a rigid body."""

    position: Vector  # World frame [m]
    velocity: Vector  # World frame [m/s]
    attitude: Quaternion  # Body to world, w, x, y, z
    rate: Vector  # Angular velocity, body frame [rad/s]


class Change(NamedTuple):
    """Rates of change of a body; those of the attitude as a rotation vector since the step began.

    The change of a rotation vector is that of Bortz, "A new mathematical formulation for strapdown
    inertial navigation" (IEEE Transactions AES 7, 1971), to second order in the vector.
    """

    position: Vector
    velocity: Vector
    rotation: Vector
    rate: Vector


@kernel
def moved(
    frame: Airframe,  # Constants of the body
    body: RigidBody,  # State at the beginning
    # Of the rotors at the beginning, in the middle and at the end of the step [N]
    thrusts: tuple[Thrusts, Thrusts, Thrusts],
    wind: Vector,  # Velocity of the air, world frame [m/s]
    terrain: Terrain,  # The ground
    step: float,  # Length of the time step [s]
) -> RigidBody:
    """Return a body after a time step.

    The step is the Runge-Kutta method of order 4 in the form of Munthe-Kaas ("High order
    Runge-Kutta methods on manifolds", Applied Numerical Mathematics 29, 1999): each stage turns the
    first attitude by a rotation vector, so that it stays a rotation.
    """
    first, middle, last = thrusts
    still = (0.0, 0.0, 0.0)
    a = change_of(frame, body, still, first, wind, terrain)
    half = 0.5 * step
    b = stage(frame, body, a, half, middle, wind, terrain)
    c = stage(frame, body, b, half, middle, wind, terrain)
    d = stage(frame, body, c, step, last, wind, terrain)
    attitude = turned(
        body.attitude, _sum(still, a.rotation, b.rotation, c.rotation, d.rotation, step)
    )
    return RigidBody(
        _sum(body.position, a.position, b.position, c.position, d.position, step),
        _sum(body.velocity, a.velocity, b.velocity, c.velocity, d.velocity, step),
        _normalised(attitude),
        _sum(body.rate, a.rate, b.rate, c.rate, d.rate, step),
    )


@kernel
def turned(attitude: Quaternion, rotation: Vector) -> Quaternion:
    """Return an attitude turned by a rotation vector, body frame [rad]."""
    x, y, z = rotation
    square = x * x + y * y + z * z
    if square < 0.01:  # as exact as sine and cosine, in a third of their time
        real = 1.0 - square / 8.0 * (1.0 - square / 48.0 * (1.0 - square / 120.0))
        share = 0.5 - square / 48.0 * (1.0 - square / 80.0 * (1.0 - square / 168.0))
    else:
        angle = math.sqrt(square)
        sine, real = sin_cos(0.5 * angle)
        share = sine / angle
    x, y, z = share * x, share * y, share * z
    w, i, j, k = attitude
    return (
        w * real - i * x - j * y - k * z,
        w * x + i * real + j * z - k * y,
        w * y - i * z + j * real + k * x,
        w * z + i * y - j * x + k * real,
    )


@kernel
def stage(
    frame: Airframe,
    body: RigidBody,
    change: Change,
    step: float,
    thrusts: Thrusts,
    wind: Vector,
    terrain: Terrain,
) -> Change:
    """Return the rates of change of a body that has changed for a time at other rates."""
    rotation = plus((0.0, 0.0, 0.0), change.rotation, step)
    there = RigidBody(
        plus(body.position, change.position, step),
        plus(body.velocity, change.velocity, step),
        turned(body.attitude, rotation),
        plus(body.rate, change.rate, step),
    )
    return change_of(frame, there, rotation, thrusts, wind, terrain)


@kernel
def change_of(
    frame: Airframe,
    body: RigidBody,
    rotation: Vector,
    thrusts: Thrusts,
    wind: Vector,
    terrain: Terrain,
) -> Change:
    """Return the rates of change of a body whose centre of mass is its origin."""
    (fx, fy, fz), torque = loads(frame, body, thrusts, wind, terrain)
    p, q, r = body.rate
    jx, jy, jz = frame.inertia
    return Change(
        body.velocity,
        (fx / frame.mass, fy / frame.mass, fz / frame.mass - frame.gravity),
        rotation_rate(body.rate, rotation),
        (
            (torque[0] - (jz - jy) * q * r) / jx,
            (torque[1] - (jx - jz) * r * p) / jy,
            (torque[2] - (jy - jx) * p * q) / jz,
        ),
    )


@kernel
def rotation_rate(rate: Vector, rotation: Vector) -> Vector:
    """Return the rate of change of a rotation vector [rad/s], body frame, see `Change`."""
    once = cross(rotation, rate)
    twice = cross(rotation, once)
    return plus(plus(rate, once, 0.5), twice, 1.0 / 12.0)


@kernel
def loads(
    frame: Airframe,  # Constants of the body
    body: RigidBody,  # State of its origin
    thrusts: Thrusts,  # Of the rotors [N]
    wind: Vector,  # Velocity of the air, world frame [m/s]
    terrain: Terrain,  # The ground
) -> tuple[Vector, Vector]:
    """Return what acts on a body but its weight: force, world frame [N], and torque about its
    origin, body frame [N m].
    """
    front_right, front_left, rear_left, rear_right = thrusts
    right, left = front_right + rear_right, front_left + rear_left
    front, rear = front_right + front_left, rear_left + rear_right
    fx, fy, fz = rotate(body.attitude, 0.0, 0.0, front + rear)
    torque = (
        frame.arm * (left - right),
        frame.arm * (rear - front),
        frame.torque_constant
        / frame.thrust_constant
        * (front_left - front_right + rear_right - rear_left),
    )
    if frame.drag_area > 0.0:
        x, y, z = plus(wind, body.velocity, -1.0)
        drag = 0.5 * frame.air_density * frame.drag_area * math.sqrt(x * x + y * y + z * z)
        fx, fy, fz = fx + drag * x, fy + drag * y, fz + drag * z
    if frame.contact_stiffness > 0.0:
        force, moment = _contact(frame, body, terrain)
        fx, fy, fz = fx + force[0], fy + force[1], fz + force[2]
        torque = plus(torque, moment, 1.0)
    return (fx, fy, fz), torque


@kernel
def _contact(frame: Airframe, body: RigidBody, terrain: Terrain) -> tuple[Vector, Vector]:
    """Return force, world frame [N], and torque, body frame [N m], of the ground on four feet.

    Each stands on a spring with a damper, and slides if the force along the ground would exceed
    its friction. The ground is taken as level below each foot.
    """
    fx = fy = fz = tx = ty = tz = 0.0
    for foot in range(4):
        x = frame.arm if foot < 2 else -frame.arm
        y = frame.arm if foot == 1 or foot == 2 else -frame.arm
        place = (x, y, -frame.feet)
        east, north, up = rotate(body.attitude, x, y, -frame.feet)
        ground = ground_at(terrain, body.position[0] + east, body.position[1] + north)
        depth = ground - (body.position[2] + up)
        if depth <= 0.0:
            continue
        turning = cross(body.rate, place)
        slip = rotate(body.attitude, turning[0], turning[1], turning[2])
        vx, vy, vz = plus(slip, body.velocity, 1.0)
        push = max(0.0, frame.contact_stiffness * depth - frame.contact_damping * vz)
        speed = math.sqrt(vx * vx + vy * vy)
        hold = min(frame.contact_damping, frame.contact_friction * push / max(speed, 1e-9))
        fx, fy, fz = fx - hold * vx, fy - hold * vy, fz + push
        moment = cross(place, rotate_back(body.attitude, -hold * vx, -hold * vy, push))
        tx, ty, tz = tx + moment[0], ty + moment[1], tz + moment[2]
    return (fx, fy, fz), (tx, ty, tz)


@kernel
def _normalised(quaternion: Quaternion) -> Quaternion:
    """Return a rotation of length 1, from which rounding leads away."""
    w, x, y, z = quaternion
    scale = 1.0 / math.sqrt(w * w + x * x + y * y + z * z)
    return scale * w, scale * x, scale * y, scale * z


@kernel
def _sum(start: Vector, a: Vector, b: Vector, c: Vector, d: Vector, step: float) -> Vector:
    """Return a vector after a step, from its rates of change in the four stages."""
    share = step / 6.0
    return (
        start[0] + share * (a[0] + 2.0 * (b[0] + c[0]) + d[0]),
        start[1] + share * (a[1] + 2.0 * (b[1] + c[1]) + d[1]),
        start[2] + share * (a[2] + 2.0 * (b[2] + c[2]) + d[2]),
    )


@kernel
def plus(a: Vector, b: Vector, factor: float) -> Vector:
    """Return a vector and a multiple of another, added."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@kernel
def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@kernel
def spun_up(
    frame: Airframe,  # Its motors' constants are used
    rotor: NDArray[np.float64],  # Rates of the rotors [rad/s], shape (4,); updated
    wanted: Thrusts,  # Thrusts that the controller asks for [N]
) -> tuple[Thrusts, Thrusts, Thrusts]:
    """Return the thrusts at the beginning, in the middle and at the end of a step [N].

    Each rotor's rate approaches the one for its wanted thrust by a low-pass of first order.
    """
    if frame.motor_time_constant <= 0.0:
        return wanted, wanted, wanted
    left = exp(-0.5 * PHYSICS_STEP / frame.motor_time_constant)
    a = _spun(frame, rotor, 0, wanted[0], left)
    b = _spun(frame, rotor, 1, wanted[1], left)
    c = _spun(frame, rotor, 2, wanted[2], left)
    d = _spun(frame, rotor, 3, wanted[3], left)
    return (a[0], b[0], c[0], d[0]), (a[1], b[1], c[1], d[1]), (a[2], b[2], c[2], d[2])


@kernel
def _spun(
    frame: Airframe, rotor: NDArray[np.float64], index: int, wanted: float, left: float
) -> tuple[float, float, float]:
    """Return the thrusts of one rotor as in `spun_up`; `left` is the gap after half a step."""
    goal = math.sqrt(wanted / frame.thrust_constant)
    gap = rotor[index] - goal
    middle, end = goal + left * gap, goal + left * left * gap
    first, rotor[index] = rotor[index], end
    factor = frame.thrust_constant
    return factor * first * first, factor * middle * middle, factor * end * end
