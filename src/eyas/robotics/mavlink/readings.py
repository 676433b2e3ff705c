"""What a vehicle knows of itself at one instant, in MAVLink's frames, by sensors it must have."""

import math
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.frames import rotate_back
from eyas.engine.sensors.config import FurtherSensorConfig, SensorsConfig
from eyas.engine.sensors.inertial import accelerometer
from eyas.engine.sensors.original import ACCELEROMETER, GYROSCOPE
from eyas.engine.sensors.table import SENSORS, further_sensors
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.terrain import reliefs
from eyas.engine.task.packets import BASIC_COLUMNS
from eyas.lanes import interpreted
from eyas.robotics.mavlink.config import MavlinkConfig
from eyas.robotics.mavlink.frames import (
    Geodesy,
    Quaternion,
    Vector,
    compass,
    of_body,
    swapped,
    to_frd,
    wrapped,
)
from eyas.robotics.mavlink.pilot import Body

Settings = TypeVar("Settings", bound=SimConfig)


class Quantity(NamedTuple):
    """What a message has room for."""

    unit: str
    width: int  # How many numbers it is
    usual: str  # Name of the sensor that measures it if there is no other


FIELD = Quantity("gauss", 3, "compass")  # The magnetic field, forward-left-up
PRESSURE = Quantity("hPa", 1, "barometer")


def part_of(config: SensorsConfig, quantity: Quantity) -> str | None:
    """Return the name of the reading that is the first of a quantity; None: nothing reads it."""
    for fitted in further_sensors(config):
        for name, numbers in fitted.sensor.parts.items():
            if fitted.sensor.unit == quantity.unit and len(numbers) == quantity.width:
                return name
    return None


def equipped(config: Settings, mavlink: MavlinkConfig, *, noisy: bool = False) -> Settings:
    """Return settings with a compass and a barometer, unless there are others of their kind.

    Args:
        mavlink: Says how high the origin of the world is.
        noisy: Whether no sensor may be exact: those without noise get that of small ones, since PX4
            takes a sensor for broken whose readings stay the same.
    """
    sensors = config.sensors
    missing = (each.usual for each in (FIELD, PRESSURE) if part_of(sensors, each) is None)
    added = (*sensors.further, *(FurtherSensorConfig(sensor=name) for name in missing))
    changes: dict[str, object] = {}
    if noisy:
        for sensor in (ACCELEROMETER, GYROSCOPE):
            errors = getattr(sensors, sensor.name)
            noise = errors.noise or sensor.noise
            changes[sensor.name] = errors.model_copy(update={"noise": noise})
    further = []
    for each in added:
        settings = {"altitude": mavlink.altitude} if each.sensor == PRESSURE.usual else {}
        noise = each.noise or (SENSORS.get(each.sensor).noise if noisy else 0.0)
        update = {"settings": settings | each.settings, "noise": noise}
        further.append(each.model_copy(update=update))
    sensors = sensors.model_copy(update={**changes, "further": tuple(further)})
    return config.model_copy(update={"sensors": sensors})


_accelerometer = interpreted(accelerometer)
_rotate_back = interpreted(rotate_back)


class VehicleReadings:
    """Reads a simulation for its vehicles."""

    def __init__(
        self,
        simulation: Simulation,  # The trackers are the vehicles, `equipped`
        geodesy: Geodesy,  # Where the origin of the world is
    ) -> None:
        self.simulation, self.geodesy = simulation, geodesy
        self._sensed: NDArray[np.float64] | None = None
        self._further: dict[str, NDArray[np.float64]] | None = None
        sensors = simulation.config.sensors
        self._parts = {each: part_of(sensors, each) for each in (FIELD, PRESSURE)}

    def renew(self) -> None:
        """Forget what was sensed before the last step."""
        self._sensed = self._further = None

    def sensed(self, vehicle: int) -> NDArray[np.float64]:
        """Return what the sensors of a vehicle read: its basic packet, shape (22,)."""
        if self._sensed is None:
            self._sensed = self.simulation.packets()[0]
        row: NDArray[np.float64] = self._sensed[vehicle]
        return row

    def measured(self, vehicle: int, quantity: Quantity) -> NDArray[np.float64]:
        """Return what a vehicle's sensor of a quantity reads, shape (width,)."""
        if self._further is None:
            self._further = self.simulation.readings()
        part = self._parts[quantity]
        assert part is not None  # they are equipped
        row: NDArray[np.float64] = self._further[part][vehicle]
        return row

    def ground(self, east: float, north: float) -> float:
        """Return z of the ground at a place [m]."""
        terrain = self.simulation.scene.terrain
        return terrain.floor + float(reliefs(terrain, np.array([east, north])))

    def body(self, vehicle: int) -> Body:
        """Return what the pilot of a vehicle knows."""
        state = self.simulation.snapshot.trackers
        x, y, z = state.position[vehicle].tolist()
        east, north, up = state.commanded_position[vehicle].tolist()
        return Body(
            (x, y, z),
            (east, north, up),
            float(state.euler[vehicle, 2]),
            float(state.commanded_yaw[vehicle]),
            self.ground(x, y),
        )


class Instant:
    """One vehicle at one instant: what several messages tell is computed once.

    Attributes:
        seconds: Time since the start [s].
        origin: Origin of the vehicle's local frame, world frame [m].

    Args:
        origin: As above.
        seconds: As above.
    """

    def __init__(
        self, readings: VehicleReadings, vehicle: int, origin: Vector, seconds: float
    ) -> None:
        self._readings, self._vehicle = readings, vehicle
        self._trackers = readings.simulation.snapshot.trackers
        self.origin, self.seconds = origin, seconds

    @property
    def milliseconds(self) -> int:
        """Time since the start [ms]."""
        return round(self.seconds * 1e3)

    @property
    def microseconds(self) -> int:
        """Time since the start [us]."""
        return round(self.seconds * 1e6)

    @cached_property
    def body(self) -> Body:
        """Where it is, world frame."""
        return self._readings.body(self._vehicle)

    @cached_property
    def local(self) -> Vector:
        """Place, north-east-down from the origin [m]."""
        x, y, z = self.body.position
        return swapped((x - self.origin[0], y - self.origin[1], z - self.origin[2]))

    @cached_property
    def velocity(self) -> Vector:
        """North, east, down [m/s]."""
        return swapped(self._trackers.velocity[self._vehicle])

    @cached_property
    def angles(self) -> Vector:
        """Roll, pitch, yaw of forward-right-down against north-east-down [rad]."""
        roll, pitch, yaw = self._trackers.euler[self._vehicle].tolist()
        return roll, -pitch, compass(yaw)

    @cached_property
    def attitude(self) -> Quaternion:
        """Attitude as a quaternion."""
        return of_body(self._trackers.orientation[self._vehicle])

    @cached_property
    def rates(self) -> Vector:
        """Angular velocity, forward-right-down [rad/s]."""
        return to_frd(self._trackers.angular_velocity[self._vehicle])

    def forward_velocity(self) -> Vector:
        """Return the velocity forward, right, down [m/s]."""
        vector = self._trackers.velocity[self._vehicle].tolist()
        return to_frd(_rotate_back(tuple(self._trackers.orientation[self._vehicle]), *vector))

    @cached_property
    def global_place(self) -> tuple[float, float, float]:
        """Latitude, longitude [degrees], altitude above mean sea level [m]."""
        return self.global_of(self.body.position)

    def global_of(self, place: Vector) -> tuple[float, float, float]:
        """Return latitude, longitude [degrees] and altitude [m] of a place of the world."""
        geodesy = self._readings.geodesy
        return *geodesy.degrees(place[0], place[1]), geodesy.altitude + place[2]

    def place_of(
        self,
        latitude: float,  # [degrees]
        longitude: float,  # [degrees]
        altitude: float,  # Above mean sea level, or above the origin if `relative` [m]
        *,
        relative: bool,  # As above
    ) -> Vector:
        """Return a place on the earth as one of the world [m]."""
        geodesy = self._readings.geodesy
        up = self.origin[2] if relative else -geodesy.altitude
        return *geodesy.place(latitude, longitude), altitude + up

    @property
    def heading(self) -> float:
        """Clockwise from north, 0 to 360 [degrees]."""
        return math.degrees(self.angles[2]) % 360.0

    @property
    def relative_height(self) -> float:
        """Over the origin [m]."""
        return -self.local[2]

    def gps(self) -> tuple[Vector, Vector]:
        """Return what the GPS tells: place in the world [m], and velocity north-east-down [m/s]."""
        row = self._readings.sensed(self._vehicle)
        x, y, z = row[BASIC_COLUMNS["position"]].tolist()
        return (x, y, z), swapped(row[BASIC_COLUMNS["velocity"]])

    def imu(self) -> tuple[Vector, Vector]:
        """Return what accelerometer [m/s^2] and gyroscope [rad/s] read, forward-right-down."""
        row = self._readings.sensed(self._vehicle)
        felt, turn = BASIC_COLUMNS["felt_acceleration"], BASIC_COLUMNS["angular_velocity"]
        return to_frd(row[felt]), to_frd(row[turn])

    def felt(self) -> Vector:
        """Return what an exact accelerometer would read, forward-right-down [m/s^2]."""
        return to_frd(_accelerometer(self._trackers, self._vehicle))

    def magnetic(self) -> Vector:
        """Return the field that the compass reads, forward-right-down [gauss]."""
        return to_frd(self._readings.measured(self._vehicle, FIELD))

    def pressure(self) -> float:
        """Return what the barometer reads [hPa]."""
        return float(self._readings.measured(self._vehicle, PRESSURE)[0])

    def camera(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return place [m], shape (3,), and rotation, shape (3, 3), of the camera, world frame."""
        cameras = self._readings.simulation.snapshot.cameras
        return cameras.position[self._vehicle], cameras.rotation[self._vehicle]

    def turned_from_heading(self, yaw: float) -> float:
        """Return a yaw clockwise from north as one from the vehicle's heading [rad]."""
        return wrapped(yaw - self.angles[2])
