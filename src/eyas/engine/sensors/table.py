"""The table of sensors whose readings are numbers, and the selection that trackers have."""

from collections.abc import Sequence
from dataclasses import dataclass

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.registry import Registry
from eyas.engine.sensors.config import FurtherSensorConfig, ReadingConfig, SensorsConfig
from eyas.engine.sensors.original import ORIGINAL
from eyas.engine.sensors.sensor import Sensor

SENSORS: Registry[Sensor] = Registry(
    "sensors.further",
    Sensor,
    {
        **{each.name: f"eyas.engine.sensors.original:{each.name.upper()}" for each in ORIGINAL},
        "compass": "eyas.engine.sensors.compass:COMPASS",
        "barometer": "eyas.engine.sensors.barometer:BAROMETER",
    },
    group="eyas.sensors",
)
"""All sensors; a user's own is found by its path, or in an entry point of an installed package."""


@dataclass(frozen=True, slots=True)
class Fitted:
    """A sensor that trackers have."""

    sensor: Sensor
    errors: ReadingConfig
    settings: tuple[float, ...]  # Values of its own settings, in the order of `Sensor.settings`.
    first: int  # Column of its first number in rows of all readings
    random: tuple[str, int, int]
    """Name of the seed of its random numbers, empty: that of the episode's readings; and with that
    seed the channels of its first number's noise and of its drop-out."""

    @property
    def columns(self) -> slice:
        """Its columns in rows of all readings."""
        return slice(self.first, self.first + self.sensor.width)


def fitted_sensors(config: SensorsConfig) -> tuple[Fitted, ...]:
    """Return the sensors of trackers: the original's, then the further ones.

    Raises:
        ConfigError: There is no such sensor or setting of it, or two have the same name.
    """
    found: list[Fitted] = []
    first = 0
    for number, sensor in enumerate(ORIGINAL):
        # Recordings depend on it: the original's sensors share a seed, and have channels by column.
        found.append(Fitted(sensor, getattr(config, sensor.name), (), first, ("", first, number)))
        first += sensor.width
    for number, given in enumerate(config.further):
        sensor = SENSORS.get(given.sensor)
        path = f"sensors.further.{number}"
        _check_names(path, sensor, [each.sensor for each in found])
        values = _settings(path, sensor, given)
        found.append(Fitted(sensor, given, values, first, (sensor.name, 0, 0)))
        first += sensor.width
    return tuple(found)


def further_sensors(config: SensorsConfig) -> tuple[Fitted, ...]:
    """Return those of them that are not the original's.

    Raises:
        ConfigError: As `fitted_sensors`.
    """
    return fitted_sensors(config)[len(ORIGINAL) :]


def _check_names(path: str, sensor: Sensor, others: Sequence[Sensor]) -> None:
    """Refuse a sensor whose name, or that of a number or part of its readings, is taken."""
    for other in others:
        if sensor.name == other.name:
            raise ConfigError(f"{path}: trackers have a sensor {sensor.name!r} already")
        for name in (*sensor.parts, *sensor.columns):
            if name in (*other.parts, *other.columns):
                raise ConfigError(
                    f"{path}: {name!r} of the sensor {sensor.name!r} is the name of a reading of "
                    f"{other.name!r}; choose another"
                )


def _settings(path: str, sensor: Sensor, given: FurtherSensorConfig) -> tuple[float, ...]:
    for name in given.settings:
        if name not in sensor.settings:
            raise UnknownNameError(f"{path}.settings", name, tuple(sensor.settings))
    return tuple(given.settings.get(name, value) for name, value in sensor.settings.items())
