"""The drone flown by its controller: four rotors move a rigid body, which tilts to accelerate."""

import math
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.core.variation import bounds
from eyas.engine.state.snapshot import CameraState, TrackerState
from eyas.engine.state.terrain import Terrain, ground_at
from eyas.engine.trackers.airframe import FIRM_GROUND, ORIGINAL, Airframe
from eyas.engine.trackers.commands import CommandFilters, follow_command
from eyas.engine.trackers.config import Flight, TrackerConfig
from eyas.engine.trackers.drone import move_level, place
from eyas.engine.trackers.flight_controller import attitude_torque, desired_force, mixed
from eyas.engine.trackers.gimbal import advance_gimbal, camera_pose, reset_gimbal
from eyas.engine.trackers.gimbal_servo import ServoMemory, advance_servo, settle_servo
from eyas.engine.trackers.level_gimbal import level_pose
from eyas.engine.trackers.rigid_body import RigidBody, Thrusts, moved, spun_up
from eyas.engine.trackers.steady import launch
from eyas.engine.trackers.tracker import Tracker
from eyas.engine.trackers.wind import WindMemory, begin_wind, blow
from eyas.lanes import kernel
from eyas.lanes.elementary import asin, atan2

Vector = tuple[float, float, float]


class FlightMemory(NamedTuple):
    """What N flown drones remember, and their constants."""

    filters: CommandFilters
    servo: ServoMemory
    last_command: NDArray[np.float64]
    """Commanded velocity of the last step, towards east and north [m/s], shape (N, 2)."""
    measured: NDArray[np.float64]
    """Difference of the last two positions over 2 ms, as the controller knows the velocity [m/s],
    shape (N, 3)."""
    rotor: NDArray[np.float64]  # Rates of the rotors [rad/s], shape (N, 4)
    wind: WindMemory
    turbulence: float  # See `eyas.engine.trackers.wind.blow`.
    frame: Airframe
    terrain: Terrain

    @classmethod
    def create(
        cls, frame: Airframe, turbulence: float, count: int, terrain: Terrain
    ) -> "FlightMemory":
        """Return the memory of drones at rest."""
        return cls(
            filters=CommandFilters.create(count),
            servo=ServoMemory.create(count),
            last_command=np.zeros((count, 2)),
            measured=np.zeros((count, 3)),
            rotor=np.zeros((count, 4)),
            wind=WindMemory.create(count),
            turbulence=turbulence,
            frame=frame,
            terrain=terrain,
        )


@kernel(inline=True)
def start(
    trackers: TrackerState,
    memory: FlightMemory,
    n: int,
    x: float,
    y: float,
    z: float,
    yaw: float,
    pitch: float,
) -> None:
    """Place drone `n` at rest, level, its rotors carrying it, see `Tracker.start`."""
    place(trackers, memory.filters, n, x, y, z, yaw)
    reset_gimbal(trackers, memory.filters.gimbal, n, pitch, 0.0)
    _settle(trackers, memory, n)


@kernel(inline=True)
def carry(
    trackers: TrackerState, memory: FlightMemory, n: int, x: float, y: float, z: float, yaw: float
) -> None:
    """Move a level drone to a pose within one physics step, as in the supervised mode."""
    move_level(trackers, n, x, y, z, yaw)
    advance_gimbal(trackers, memory.filters.gimbal, n)
    _settle(trackers, memory, n)


@kernel(inline=True)
def _settle(trackers: TrackerState, memory: FlightMemory, n: int) -> None:
    """Forget the past: what was commanded is what is."""
    memory.last_command[n, 0], memory.last_command[n, 1] = 0.0, 0.0
    for axis in range(3):
        memory.measured[n, axis] = trackers.velocity[n, axis]
    frame = memory.frame
    hover = math.sqrt(0.25 * frame.mass * frame.gravity / frame.thrust_constant)
    for rotor in range(4):
        memory.rotor[n, rotor] = hover
    settle_servo(trackers, memory.filters.gimbal, memory.servo, n)


@kernel(inline=True)
def advance(
    trackers: TrackerState, memory: FlightMemory, n: int, command: NDArray[np.float64]
) -> None:
    """Fly drone `n` for one physics step of 2 ms, see `Tracker.advance`.

    The controller acts at the beginning of the step. As in the original, the commanded velocity
    has no part upwards: a command to climb moves only the commanded position.
    """
    east, north, _ = follow_command(trackers, memory.filters, n, command)
    wanted = wanted_thrusts(trackers, memory, n, east, north)
    frame, before = memory.frame, body_of(trackers, n)
    air = air_around(memory, n, before)
    pushed = spun_up(frame, memory.rotor[n], wanted)
    after = moved(frame, before, pushed, air, memory.terrain, PHYSICS_STEP)
    arrive(trackers, memory, n, before, after)


@kernel(inline=True)
def air_around(memory: FlightMemory, n: int, body: RigidBody) -> Vector:
    """Return the wind at drone `n` in this step, world frame [m/s]; its gusts are advanced."""
    air = (0.0, 0.0, 0.0)
    if memory.frame.drag_area > 0.0:
        height = body.position[2]
        if memory.turbulence > 0.0:
            height -= ground_at(memory.terrain, body.position[0], body.position[1])
        air = blow(memory.wind, n, memory.turbulence, height, body.velocity)
    return air


@kernel(inline=True)
def arrive(
    trackers: TrackerState, memory: FlightMemory, n: int, before: RigidBody, after: RigidBody
) -> None:
    """Write the state of drone `n` after a step of 2 ms, and move its gimbal."""
    _write(trackers, memory, n, before, after)
    a, b = before.rate, after.rate
    change = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    advance_servo(trackers, memory.filters.gimbal, memory.servo, memory.frame, n, change)


@kernel(inline=True)
def aim(trackers: TrackerState, memory: FlightMemory, cameras: CameraState, n: int) -> None:
    """Write the pose of the camera on the gimbal."""
    body, attitude, gimbal = trackers.position[n], trackers.orientation[n], trackers.gimbal[n]
    if memory.frame.as_original:
        camera_pose(body, attitude, gimbal, cameras.position[n], cameras.rotation[n])
    else:
        level_pose(body, attitude, gimbal, cameras.position[n], cameras.rotation[n])


@kernel(inline=True)
def wanted_thrusts(
    trackers: TrackerState, memory: FlightMemory, n: int, east: float, north: float
) -> Thrusts:
    """Return the thrusts that the controller asks of the rotors [N]."""
    goal, position = trackers.commanded_position[n], trackers.position[n]
    measured, last = memory.measured[n], memory.last_command[n]
    behind = (goal[0] - position[0], goal[1] - position[1], goal[2] - position[2])
    slower = (east - measured[0], north - measured[1], -measured[2])
    change_east, change_north = (east - last[0]) / PHYSICS_STEP, (north - last[1]) / PHYSICS_STEP
    last[0], last[1] = east, north
    frame, attitude = memory.frame, trackers.orientation[n]
    force = desired_force(frame, behind, slower, change_east, change_north)
    rate = trackers.angular_velocity[n]
    torque = attitude_torque(frame, force, trackers.commanded_yaw[n], attitude, rate)
    return mixed(frame, force, torque, attitude)


@kernel
def body_of(trackers: TrackerState, n: int) -> RigidBody:
    """Return the state of drone `n`."""
    p, v = trackers.position[n], trackers.velocity[n]
    q, w = trackers.orientation[n], trackers.angular_velocity[n]
    return RigidBody(
        (p[0], p[1], p[2]), (v[0], v[1], v[2]), (q[0], q[1], q[2], q[3]), (w[0], w[1], w[2])
    )


@kernel(inline=True)
def _write(
    trackers: TrackerState, memory: FlightMemory, n: int, before: RigidBody, after: RigidBody
) -> None:
    """Write the state of a body after a step of 2 ms."""
    for axis in range(3):
        memory.measured[n, axis] = (after.position[axis] - before.position[axis]) / PHYSICS_STEP
        change = after.velocity[axis] - before.velocity[axis]
        trackers.acceleration[n, axis] = change / PHYSICS_STEP
        trackers.position[n, axis] = after.position[axis]
        trackers.velocity[n, axis] = after.velocity[axis]
        trackers.angular_velocity[n, axis] = after.rate[axis]
    w, x, y, z = after.attitude
    attitude, euler = trackers.orientation[n], trackers.euler[n]
    attitude[0], attitude[1], attitude[2], attitude[3] = w, x, y, z
    euler[0] = atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    euler[1] = asin(min(max(2.0 * (w * y - z * x), -1.0), 1.0))
    euler[2] = atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def with_options(config: TrackerConfig, frame: Airframe) -> Airframe:
    """Return an airframe with the options of some settings; what they leave at 0 is its own."""
    return frame._replace(
        motor_time_constant=float(config.motor_time_constant) or frame.motor_time_constant,
        drag_area=float(config.drag_area) or frame.drag_area,
        as_original=int(config.flight is Flight.ORIGINAL),
        contact_stiffness=FIRM_GROUND if config.ground_contact else 0.0,
    )


def flown_drone(config: TrackerConfig, frame: Airframe = ORIGINAL) -> Tracker:
    """Return the drone that its flight controller flies.

    Args:
        config: The options: motors, drag, contact, wind.
        frame: The constants; options other than 0 replace its own.
    """
    wind, frame = config.wind, with_options(config, frame)
    blows = wind.turbulence > 0.0 or bounds(wind.speed) != (0.0, 0.0)

    def sample(memory: FlightMemory, n: int, key: EpisodeKey) -> None:
        begin_wind(memory.wind, n, wind.speed, wind.direction, key)

    return Tracker(
        "flown drone",
        partial(FlightMemory.create, frame, float(wind.turbulence)),
        start,
        advance,
        carry,
        aim,
        launch,
        sample if blows else None,
        sampled="wind",
        jumps=False,
    )
