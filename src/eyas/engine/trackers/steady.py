"""Steady flight: how a flown drone moves on at a velocity, and what its controller knows then."""

import math
from typing import Any

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.trackers.airframe import Airframe
from eyas.engine.trackers.commands import heading
from eyas.engine.trackers.flight_controller import body_axes, within_tilt
from eyas.engine.trackers.gimbal import reset_gimbal
from eyas.engine.trackers.gimbal_servo import settle_servo
from eyas.engine.trackers.level_gimbal import reset_level
from eyas.engine.trackers.lowpass import settle
from eyas.lanes import kernel
from eyas.lanes.elementary import asin, atan2, sin_cos

Vector = tuple[float, float, float]


@kernel(inline=True)
def launch(
    trackers: TrackerState,
    memory: Any,  # noqa: ANN401  # a `FlightMemory`
    n: int,
    east: float,
    north: float,
) -> None:
    """Let drone `n`, which has just been started, fly on at a velocity, see `Tracker.launch`.

    It leans so that its thrust balances weight and drag in the mean wind. Its commanded place is
    where the controller asks for just that: a step at the same command changes nothing.
    """
    frame, mean = memory.frame, memory.wind.mean[n]
    weight = frame.assumed_mass * frame.assumed_gravity
    drag_east, drag_north = _drag(frame, mean[0] - east, mean[1] - north)
    balance = (-drag_east, -drag_north, frame.mass * frame.gravity - weight)
    velocity, gain = (east, north, 0.0), frame.position_gain
    for axis in range(3):
        trackers.velocity[n, axis] = memory.measured[n, axis] = velocity[axis]
        ahead = balance[axis] / gain[axis] - velocity[axis] * PHYSICS_STEP
        trackers.commanded_position[n, axis] = trackers.position[n, axis] + ahead
    memory.last_command[n, 0], memory.last_command[n, 1] = east, north
    force = within_tilt(balance, weight, frame.tilt_limit)
    square = force[0] * force[0] + force[1] * force[1] + force[2] * force[2]
    _lean(trackers, n, force)
    for rotor in range(4):
        memory.rotor[n, rotor] = math.sqrt(0.25 * math.sqrt(square) / frame.thrust_constant)
    cosine, sine = heading(trackers.orientation[n])
    settle(memory.filters.forward[n], cosine * east + sine * north)
    settle(memory.filters.left[n], cosine * north - sine * east)
    if frame.as_original:
        pitch, yaw = trackers.commanded_gimbal[n, 0], trackers.commanded_gimbal[n, 1]
        reset_gimbal(trackers, memory.filters.gimbal, n, pitch, yaw)
    else:
        reset_level(trackers, memory.filters.gimbal, n)
    settle_servo(trackers, memory.filters.gimbal, memory.servo, n)


@kernel(inline=True)
def _drag(frame: Airframe, east: float, north: float) -> tuple[float, float]:
    """Return the force of air that passes the drone at a velocity, towards east and north [N]."""
    speed = math.sqrt(east * east + north * north)
    share = 0.5 * frame.air_density * frame.drag_area * speed
    return share * east, share * north


@kernel(inline=True)
def _lean(trackers: TrackerState, n: int, force: Vector) -> None:
    """Set the attitude in which the rotors of a body pull along a force, at its heading."""
    ahead, left, up = body_axes(force, trackers.commanded_yaw[n])
    euler, attitude = trackers.euler[n], trackers.orientation[n]
    euler[0] = atan2(left[2], up[2])
    euler[1] = asin(min(max(-ahead[2], -1.0), 1.0))
    euler[2] = atan2(ahead[1], ahead[0])
    (sr, cr), (sp, cp) = sin_cos(0.5 * euler[0]), sin_cos(0.5 * euler[1])
    sy, cy = sin_cos(0.5 * euler[2])
    attitude[0] = cr * cp * cy + sr * sp * sy
    attitude[1] = sr * cp * cy - cr * sp * sy
    attitude[2] = cr * sp * cy + sr * cp * sy
    attitude[3] = cr * cp * sy - sr * sp * cy
