"""The sensors of the original's trackers, whose readings are its basic packet."""

from collections.abc import Mapping

from eyas.engine.core.frames import wrap_angle
from eyas.engine.sensors.inertial import accelerometer, gyroscope
from eyas.engine.sensors.sensor import Floats, Sensor
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.lanes import kernel
from eyas.lanes.elementary import sin_cos

_EULER = 4  # column of the IMU's Euler angles, behind the quaternion


@kernel(inline=True)
def _position(
    snapshot: Snapshot, terrain: Terrain, n: int, settings: Floats, reading: Floats
) -> None:
    position = snapshot.trackers.position
    reading[0], reading[1], reading[2] = position[n, 0], position[n, 1], position[n, 2]


@kernel(inline=True)
def _velocity(
    snapshot: Snapshot, terrain: Terrain, n: int, settings: Floats, reading: Floats
) -> None:
    velocity = snapshot.trackers.velocity
    reading[0], reading[1], reading[2] = velocity[n, 0], velocity[n, 1], velocity[n, 2]


@kernel(inline=True)
def _felt(snapshot: Snapshot, terrain: Terrain, n: int, settings: Floats, reading: Floats) -> None:
    reading[0], reading[1], reading[2] = accelerometer(snapshot.trackers, n)


@kernel(inline=True)
def _turn(snapshot: Snapshot, terrain: Terrain, n: int, settings: Floats, reading: Floats) -> None:
    reading[0], reading[1], reading[2] = gyroscope(snapshot.trackers, n)


@kernel(inline=True)
def _attitude(
    snapshot: Snapshot, terrain: Terrain, n: int, settings: Floats, reading: Floats
) -> None:
    for part in range(_EULER):
        reading[part] = snapshot.trackers.orientation[n, part]
    for axis in range(3):
        reading[_EULER + axis] = snapshot.trackers.euler[n, axis]


@kernel(inline=True)
def _quaternion(
    snapshot: Snapshot, terrain: Terrain, n: int, settings: Floats, reading: Floats
) -> None:
    """Write the quaternion of a reading's Euler angles: yaw, then pitch, then roll."""
    reading[_EULER + 2] = wrap_angle(reading[_EULER + 2])
    roll, pitch, yaw = 0.5 * reading[_EULER], 0.5 * reading[_EULER + 1], 0.5 * reading[_EULER + 2]
    (sr, cr), (sp, cp), (sy, cy) = sin_cos(roll), sin_cos(pitch), sin_cos(yaw)
    reading[0] = cr * cp * cy + sr * sp * sy
    reading[1] = sr * cp * cy - cr * sp * sy
    reading[2] = cr * sp * cy + sr * cp * sy
    reading[3] = cr * cp * sy - sr * sp * cy


def _vector(name: str) -> Mapping[str, tuple[str, ...]]:
    return {name: tuple(f"{name}_{axis}" for axis in "xyz")}


# The noises are those of small drones' parts: the preset `noisy` says whose, and the inertial ones
# suffice for PX4, which takes a sensor for broken whose readings stay the same.
GPS_POSITION = Sensor(
    name="gps_position", unit="m", parts=_vector("position"), read=_position, noise=0.3
)
GPS_VELOCITY = Sensor(
    name="gps_velocity", unit="m/s", parts=_vector("velocity"), read=_velocity, noise=0.05
)
ACCELEROMETER = Sensor(
    name="accelerometer", unit="m/s²", parts=_vector("felt_acceleration"), read=_felt, noise=0.012
)
GYROSCOPE = Sensor(
    name="gyroscope", unit="rad/s", parts=_vector("angular_velocity"), read=_turn, noise=0.0006
)
IMU = Sensor(
    name="imu",
    unit="rad",
    parts={
        "orientation": tuple(f"orientation_{part}" for part in "wxyz"),
        "euler": ("roll", "pitch", "yaw"),
    },
    read=_attitude,
    noise=0.01,
    settle=_quaternion,
)

ORIGINAL = (GPS_POSITION, GPS_VELOCITY, ACCELEROMETER, GYROSCOPE, IMU)
"""Every tracker has these, in the order of the columns of the basic packet."""
