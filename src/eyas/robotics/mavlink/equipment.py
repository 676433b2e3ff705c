"""The sensors that a vehicle of MAVLink must have: what its messages tell and trackers have not."""

from typing import NamedTuple, TypeVar

from eyas.engine.sensors.config import FurtherSensorConfig, SensorsConfig
from eyas.engine.sensors.original import ACCELEROMETER, GYROSCOPE
from eyas.engine.sensors.table import SENSORS, further_sensors
from eyas.engine.sim.config import SimConfig
from eyas.robotics.mavlink.config import MavlinkConfig

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
