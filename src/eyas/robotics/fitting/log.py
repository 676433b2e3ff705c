"""Logs of flights: recordings of Eyas, and tables with the same columns."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.exports.episode_files import ROTOR_COLUMNS, SensorWriter

Floats = NDArray[np.float64]

_LARGEST = 1 << 30  # Largest size of a file [bytes]

_LARGEST_NUMBER = 1e10  # Largest number in a table: the seconds since 1970 are less

_LONGEST = 86_400.0  # Longest flight [s]

_LEAST_ROWS = 200  # Fewer say nothing about a lag

_UNIT = 1e-2  # Largest deviation of a quaternion's length from 1


class FlightLog(NamedTuple):
    """What is known of a drone at K times. World frame: east, north, up; body frame: forward, left,
    up.
    """

    time: Floats  # [s], shape (K,); rising
    velocity: Floats  # World frame [m/s], shape (K, 3)
    attitude: Floats  # Body to world, quaternion w, x, y, z, shape (K, 4)
    rotors: Floats  # Rates that are asked of the rotors until that time, in any unit, shape (K, 4)
    felt: Floats | None
    """What an accelerometer in the middle reads, body frame [m/s^2], shape (K, 3); None: there is
    none."""
    wind: Floats  # Velocity of the air, world frame [m/s], shape (K, 3)


def read_log(path: Path) -> FlightLog:
    """Return a log.

    Args:
        path: A table, or the folder of an episode that `eyas video` has recorded with the writer
            `sensors`.

    Raises:
        DataFileError: The file is missing or is no such table.
    """
    file = path / SensorWriter.table if path.is_dir() else path
    columns = _columns(file)
    if "time" not in columns and "step" in columns:
        columns["time"] = PHYSICS_STEP * columns["step"]
    missing = [name for name in ("time", *_VELOCITY, *_ATTITUDE) if name not in columns]
    if missing:
        raise DataFileError(f"{file}: without the column '{missing[0]}'")
    if any(name not in columns for name in ROTOR_COLUMNS):
        raise DataFileError(
            f"{file}: without the columns {', '.join(ROTOR_COLUMNS)}; of Eyas' own flights, record "
            "with tracker.tells_rotors=true"
        )
    time = columns["time"]
    if len(time) < _LEAST_ROWS:
        raise DataFileError(f"{file}: {len(time)} rows; at least {_LEAST_ROWS} are needed")
    if not (np.diff(time) > 0.0).all():
        raise DataFileError(f"{file}: its times do not rise")
    if time[-1] - time[0] > _LONGEST:
        raise DataFileError(f"{file}: it lasts {time[-1] - time[0]:.6g} s; up to {_LONGEST:g} s")
    attitude = _joined(columns, _ATTITUDE)
    sizes = np.sqrt((attitude * attitude).sum(axis=1))
    if (np.abs(sizes - 1.0) > _UNIT).any():
        raise DataFileError(f"{file}: {', '.join(_ATTITUDE)} are no unit quaternions")
    wind = np.stack([columns.get(name, np.zeros(len(time))) for name in _WIND], axis=1)
    felt = _joined(columns, _FELT) if all(name in columns for name in _FELT) else None
    rotors, velocity = _joined(columns, ROTOR_COLUMNS), _joined(columns, _VELOCITY)
    return FlightLog(time, velocity, attitude / sizes[:, None], rotors, felt, wind)


_VELOCITY = ("velocity_x", "velocity_y", "velocity_z")
_ATTITUDE = ("orientation_w", "orientation_x", "orientation_y", "orientation_z")
_FELT = ("felt_acceleration_x", "felt_acceleration_y", "felt_acceleration_z")
_WIND = ("wind_x", "wind_y", "wind_z")
_READ = {"time", "step", *_VELOCITY, *_ATTITUDE, *_FELT, *_WIND, *ROTOR_COLUMNS}


def _joined(columns: dict[str, Floats], names: tuple[str, ...]) -> Floats:
    return np.stack([columns[name] for name in names], axis=1)


def _rows(path: Path, text: str) -> Iterator[list[str]]:
    try:
        yield from csv.reader(io.StringIO(text))
    except csv.Error as error:
        raise DataFileError(f"{path}: not a table: {error}") from error


def _columns(path: Path) -> dict[str, Floats]:
    """Return the columns of a table that are read; others may hold anything."""
    try:
        text = read_limited(path, _LARGEST).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise DataFileError(f"{path}: not a text file in UTF-8") from error
    rows = _rows(path, text)
    names = [name.strip() for name in next(rows, [])]
    wanted = [(place, name) for place, name in enumerate(names) if name in _READ]
    for place, name in wanted:
        if name in names[:place]:
            raise DataFileError(f"{path}: the column '{name}' is there twice")
    values: dict[str, list[float]] = {name: [] for _, name in wanted}
    for number, row in enumerate(rows, start=2):
        if not row:
            continue
        for place, name in wanted:
            try:
                value = float(row[place])
            except (IndexError, ValueError):
                value = float("nan")
            if not abs(value) <= _LARGEST_NUMBER:  # also not a number: it is not
                told = f"'{name}' is no number" if np.isnan(value) else f"'{name}' is {value:g}"
                raise DataFileError(
                    f"{path}: line {number}: {told}; allowed: up to {_LARGEST_NUMBER:g}"
                )
            values[name].append(value)
    return {name: np.array(column) for name, column in values.items()}
