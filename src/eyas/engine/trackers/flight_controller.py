"""The flight controller: from a commanded motion to the thrusts of four rotors.

A cascade as in the original: position and velocity give a force, the force an attitude (Lee, Leok
and McClamroch, "Geometric tracking control of a quadrotor UAV on SE(3)", CDC 2010), the error of
attitude a torque, and force and torque the thrusts. Rotors are numbered front right, front left,
rear left, rear right.
"""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.frames import rotate, rotate_back
from eyas.engine.trackers.airframe import Airframe
from eyas.lanes import kernel
from eyas.lanes.elementary import sin_cos, tan

Vector = tuple[float, float, float]
Thrusts = tuple[float, float, float, float]
Row = NDArray[np.float64]


@kernel
def desired_force(
    frame: Airframe,  # Its gains, assumed mass and gravity, and tilt limit are used
    position_error: Vector,  # Commanded minus true position, world frame [m]
    velocity_error: Vector,  # Commanded minus measured velocity, world frame [m/s]
    acceleration_east: float,  # Change of the commanded velocity [m/s^2]
    acceleration_north: float,  # The same towards north
) -> Vector:
    """Return the force that the rotors should exert, world frame [N], within the tilt limit."""
    mass, gain = frame.assumed_mass, frame.velocity_gain
    x = frame.position_gain[0] * position_error[0] + gain * velocity_error[0]
    y = frame.position_gain[1] * position_error[1] + gain * velocity_error[1]
    z = frame.position_gain[2] * position_error[2] + gain * velocity_error[2]
    x += mass * acceleration_east
    y += mass * acceleration_north
    return within_tilt((x, y, z), mass * frame.assumed_gravity, frame.tilt_limit)


@kernel
def within_tilt(force: Vector, weight: float, limit: float) -> Vector:
    """Return a force added to the weight, scaled down so that their sum tilts within a limit.

    The original solves a quadratic equation for the scale; this is its solution.

    Args:
        force: Force besides the one against the weight [N].
        weight: [N]
        limit: Largest angle between the sum and the vertical [rad].
    """
    x, y, z = force
    aside, tangent = math.sqrt(x * x + y * y), tan(limit)
    scale = 1.0
    if aside > tangent * (z + weight):
        # A sum that points down, with nothing aside, has no such scale but 0.
        scale = weight * tangent / (aside - tangent * z)
    return scale * x, scale * y, scale * z + weight


@kernel
def attitude_torque(
    frame: Airframe,  # Its gains and inertia are used
    force: Vector,  # Force that the rotors should exert, world frame [N]
    yaw: float,  # Commanded heading [rad]
    attitude: Row,  # Body to world, shape (4,)
    rate: Row,  # Angular velocity, body frame [rad/s], shape (3,)
) -> Vector:
    """Return the torque that turns the body towards a force and a heading, body frame [N m]."""
    ahead, left, (x, y, z) = body_axes(force, yaw)
    _, x1, x2 = rotate_back(attitude, ahead[0], ahead[1], ahead[2])
    y0, _, y2 = rotate_back(attitude, left[0], left[1], left[2])
    z0, z1, _ = rotate_back(attitude, x, y, z)
    p, q, r = rate[0], rate[1], rate[2]
    jx, jy, jz = frame.inertia
    gain, damping = frame.attitude_gain, frame.rate_gain
    return (
        0.5 * gain[0] * (y2 - z1) - damping * p + (jz - jy) * q * r,
        0.5 * gain[1] * (z0 - x2) - damping * q + (jx - jz) * r * p,
        0.5 * gain[2] * (x1 - y0) - damping * r + (jy - jx) * p * q,
    )


@kernel
def body_axes(
    force: Vector,  # Force that the rotors should exert, world frame [N]
    yaw: float,  # Commanded heading [rad]
) -> tuple[Vector, Vector, Vector]:
    """Return the axes that the body should have, forward, left and up, world frame."""
    x, y, z = _unit(force)
    sine, cosine = sin_cos(yaw)
    left = _unit((-z * sine, z * cosine, x * sine - y * cosine))
    ahead = (left[1] * z - left[2] * y, left[2] * x - left[0] * z, left[0] * y - left[1] * x)
    return ahead, left, (x, y, z)


@kernel
def mixed(frame: Airframe, force: Vector, torque: Vector, attitude: Row) -> Thrusts:
    """Return the thrusts of the rotors, each from 0 to that of the largest rate [N].

    A rotor cannot pull down: what it lacks is added to all four, one after the other, which keeps
    the torque and raises the total. As in the original's code, if so told, what it lacks is added
    only to those before it: its loop takes the thrust of rotor i from each in turn, and that is 0
    once its own turn has come. Then the torque is not kept.

    Args:
        frame: Its arm, its rotor constants and its way at the limits are used.
        force: Force that the rotors should exert, world frame [N].
        torque: Torque that they should exert, body frame [N m].
        attitude: Body to world, shape (4,).
    """
    x, y, z = rotate(attitude, 0.0, 0.0, 1.0)
    total = max(0.0, force[0] * x + force[1] * y + force[2] * z)
    roll, pitch = torque[0] / frame.arm, torque[1] / frame.arm
    yaw = torque[2] * frame.thrust_constant / frame.torque_constant
    front_right = 0.25 * (total - roll - pitch - yaw)
    front_left = 0.25 * (total + roll - pitch + yaw)
    rear_left = 0.25 * (total + roll + pitch - yaw)
    rear_right = 0.25 * (total - roll + pitch + yaw)
    most = frame.thrust_constant * frame.rotor_limit * frame.rotor_limit
    if frame.as_original:
        second = max(0.0, -front_left)
        third, fourth = max(0.0, -rear_left), max(0.0, -rear_right)
        return (
            min(max(front_right, 0.0) + second + third + fourth, most),
            min(front_left + second + third + fourth, most),
            min(rear_left + third + fourth, most),
            min(rear_right + fourth, most),
        )
    raised = max(0.0, -front_right)
    raised += max(0.0, -(front_left + raised))
    raised += max(0.0, -(rear_left + raised))
    raised += max(0.0, -(rear_right + raised))
    return (
        _within(front_right + raised, most),
        _within(front_left + raised, most),
        _within(rear_left + raised, most),
        _within(rear_right + raised, most),
    )


@kernel
def _within(thrust: float, most: float) -> float:
    """Return a thrust that a rotor can have [N]; rounding may leave less than none."""
    return min(max(thrust, 0.0), most)


@kernel
def _unit(vector: Vector) -> Vector:
    """Return a vector of length 1; up for one that is almost 0."""
    x, y, z = vector
    length = math.sqrt(x * x + y * y + z * z)
    if length < 1e-7:
        return 0.0, 0.0, 1.0
    return x / length, y / length, z / length
