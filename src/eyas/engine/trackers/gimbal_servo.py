"""The gimbal of the flown drone: motors turn its joints, and the body turns below it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.trackers.airframe import Airframe, GimbalServo
from eyas.engine.trackers.gimbal import desired_angles
from eyas.engine.trackers.level_gimbal import carried_along, level_angles
from eyas.engine.trackers.lowpass import low_pass, settle
from eyas.lanes import kernel
from eyas.lanes.elementary import sin_cos

Vector = tuple[float, float, float]


class ServoMemory(NamedTuple):
    """The joints' motors of N gimbals; each for roll, pitch, yaw."""

    rate: NDArray[np.float64]  # Rates of the joints [rad/s], shape (N, 3)
    integral: NDArray[np.float64]  # Integral parts of the torques [N m], shape (N, 3)

    @classmethod
    def create(cls, count: int) -> "ServoMemory":
        """Return the memory of joints at rest."""
        return cls(np.zeros((count, 3)), np.zeros((count, 3)))


@kernel(inline=True)
def advance_servo(
    # Source of the body's attitude and the commanded angles; its joint angles are set
    trackers: TrackerState,
    # Low-pass filters of the desired roll, pitch and yaw, shape (N, 3, 2); updated
    filters: NDArray[np.float64],
    memory: ServoMemory,  # Updated
    frame: Airframe,  # Its servo and its way at the limits are used
    n: int,  # Index of the tracker
    change: Vector,  # Change of the body's angular velocity in this step, body frame [rad/s]
) -> None:
    """Move gimbal `n` by one physics step of 2 ms.

    The joints are taken as independent. What a joint carries keeps its motion while the body turns
    faster or slower, unless the motor acts on it. The step is the semi-implicit one of Euler,
    which keeps such oscillators stable; the motors' forces on the body are neglected.
    """
    commanded, euler, gimbal = trackers.commanded_gimbal[n], trackers.euler[n], trackers.gimbal[n]
    servo = frame.servo
    if frame.as_original:
        desired = desired_angles(commanded[0], commanded[1], euler[0], euler[1])
        carried = _carried_along(gimbal, change)
    else:
        desired = level_angles(commanded[0], commanded[1], euler[0], euler[1])
        carried = carried_along(gimbal, change)
    for axis in range(3):
        error = low_pass(filters[n, axis], desired[axis]) - gimbal[axis]
        rate = memory.rate[n, axis]
        torque = _torque(servo, memory.integral[n], axis, error, rate)
        pull = (torque - servo.damping * rate) / servo.inertia[axis]
        rate += pull * PHYSICS_STEP - carried[axis]
        rate = min(max(rate, -servo.rate_limit), servo.rate_limit)
        memory.rate[n, axis] = rate
        gimbal[axis] += rate * PHYSICS_STEP


@kernel
def _carried_along(gimbal: NDArray[np.float64], change: Vector) -> Vector:
    """Return what the body's turn is about the axes of the original's joints: roll, pitch, yaw."""
    (sp, cp), (sy, cy) = sin_cos(gimbal[1]), sin_cos(gimbal[2])
    ahead = cy * change[0] + sy * change[1]
    return (cp * ahead - sp * change[2], cy * change[1] - sy * change[0], change[2])


@kernel
def _torque(
    servo: GimbalServo, integral: NDArray[np.float64], axis: int, error: float, rate: float
) -> float:
    """Return the torque of a motor [N m]; updates its integral part."""
    whole = integral[axis] + servo.integral[axis] * error * PHYSICS_STEP
    integral[axis] = min(max(whole, -servo.integral_limit), servo.integral_limit)
    torque = servo.proportional[axis] * error + integral[axis] - servo.derivative[axis] * rate
    return float(min(max(torque, -servo.torque_limit), servo.torque_limit))


@kernel(inline=True)
def settle_servo(
    trackers: TrackerState, filters: NDArray[np.float64], memory: ServoMemory, n: int
) -> None:
    """Let gimbal `n` rest at its present angles."""
    for axis in range(3):
        settle(filters[n, axis], trackers.gimbal[n, axis])
        memory.rate[n, axis] = 0.0
        memory.integral[n, axis] = 0.0
