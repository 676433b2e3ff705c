"""Trajectories in CSV files, and their motion at the samples of the traffic."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.config import shown
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.lanes import exact

COLUMNS = ("t", "x", "y", "z", "yaw")  # Names in the first line; z and yaw may be left out
JUMP = 100.0  # Speed from which on two points are a jump [m/s]
_LARGEST = 64 << 20  # Largest size of a file [bytes]
_LIMITS = {"t": 1e19, "x": 1e9, "y": 1e9, "z": 1e9, "yaw": 1e6}
"""Largest numbers of the columns; times may count from 1970 in any unit."""

_LONGEST = 86_400.0  # Longest trajectory: it is sampled as a whole [s]
_STANDING = 0.2  # Speed below which a heading that is not told is that before [m/s]
_SWING = 0.05
"""Share of the highest speed up to which a smoothed body may go back after a sudden stop: some
weights of the spline are negative, in all exp(-pi) = 0.043 of the others."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Places of a body at N times."""

    time: Floats  # Increasing, from 0 [s], shape (N,)
    position: Floats  # x, y, z [m], shape (N, 3); z is NaN where the ground tells it
    yaw: Floats | None
    """Heading, counter-clockwise from east, without jumps at ±180° [rad], shape (N,); None: along
    the way."""
    velocity: Floats | None = None
    """Velocity at the points, if smoothed [m/s], shape (N, 3); None: central differences."""

    @classmethod
    def of_track(cls, time: Floats, track: Floats) -> "Trajectory":
        """Return the trajectory of x, y and heading at times, shape (N, 3), on the ground."""
        on_ground = np.where([True, True, False], track, np.nan)
        return cls(time, on_ground, None)

    def jumps(self) -> NDArray[np.intp]:
        """Return the points that cannot be reached from those before, shape (K,)."""
        return np.flatnonzero(self.steps() > JUMP * np.diff(self.time)) + 1

    def steps(self) -> Floats:
        """Return the distance of each point from the one before [m], shape (N - 1,)."""
        x, y, z = np.diff(self.position, axis=0).T
        return exact.hypot(exact.hypot(x, y), np.where(np.isnan(z), 0.0, z))

    def at(self, time: Floats) -> tuple[Floats, Floats]:
        """Return position (S, 3) and heading (S,) at times (S,) within it.

        Positions follow cubic Hermite curves.
        """
        knots, points = self.time, self.position
        slope = self.velocity
        if slope is None:
            slope = np.gradient(points, knots, axis=0, edge_order=1)
        row = np.clip(np.searchsorted(knots, time, side="right") - 1, 0, len(knots) - 2)
        step = (knots[row + 1] - knots[row])[:, None]
        f = (time - knots[row])[:, None] / step
        a, b = points[row], points[row + 1]
        left, right = slope[row] * step, slope[row + 1] * step
        bend, square = 3.0 * (b - a) - 2.0 * left - right, left + right - 2.0 * (b - a)
        place = a + f * (left + f * (bend + f * square))
        if self.yaw is not None:
            return place, np.interp(time, knots, self.yaw)
        velocity = (left + f * (2.0 * bend + f * 3.0 * square)) / step
        swing = (
            0.0 if self.velocity is None else _SWING * np.linalg.norm(slope[:, :2], axis=1).max()
        )
        return place, _along(velocity, max(_STANDING, float(swing)))


def read_trajectory(path: Path) -> Trajectory:
    """Return the trajectory of a CSV file; its first time becomes 0.

    Raises:
        DataFileError: The file is missing, or does not hold a trajectory: time runs backwards, a
            number is missing, not finite or absurd, or it lasts longer than a day.
    """
    text = read_limited(path, _LARGEST).decode("utf-8-sig", errors="replace")
    try:
        # Also lines that end with a carriage return, as some spreadsheets write them.
        lines = list(csv.reader(io.StringIO(text, newline=None)))
    except csv.Error as error:  # a quotation mark that is never closed
        raise DataFileError(f"{path}: not a CSV file: {error}") from None
    names = [name.strip() for name in lines[0]] if lines else []
    missing = [name for name in COLUMNS[:3] if name not in names]
    if missing:
        raise DataFileError(
            f"{path}: line 1: no column '{missing[0]}' in {shown(','.join(names))}; allowed: "
            "t,x,y and perhaps z,yaw"
        )
    rows = [_numbers(path, k, line, names) for k, line in enumerate(lines[1:], 2) if line]
    values = np.array(rows, np.float64).reshape(-1, len(names))
    if len(values) < 2:
        raise DataFileError(f"{path}: {len(values)} points; a trajectory has two or more")
    column = {name: values[:, k] for k, name in enumerate(names)}
    time = column["t"]
    back = np.flatnonzero(np.diff(time) <= 0.0)
    if len(back):
        k = int(back[0])
        raise DataFileError(
            f"{path}: point {k + 2}: t is {time[k + 1]:g} after {time[k]:g}: time must increase"
        )
    if time[-1] - time[0] > _LONGEST:
        raise DataFileError(
            f"{path}: it lasts {time[-1] - time[0]:.6g} s; allowed: up to {_LONGEST:g} s: is t in "
            "milliseconds? it is in seconds"
        )
    z = column.get("z", np.full(len(time), np.nan))
    yaw = np.unwrap(column["yaw"]) if "yaw" in column else None
    return Trajectory(time - time[0], np.column_stack([column["x"], column["y"], z]), yaw)


def _numbers(path: Path, number: int, line: list[str], names: list[str]) -> list[float]:
    try:
        values = [float(text) for text in line]
    except ValueError:
        values = []
    if len(values) != len(names) or not np.isfinite(values).all():
        raise DataFileError(
            f"{path}: line {number}: {shown(','.join(line))} is not allowed: {len(names)} finite "
            "numbers"
        )
    for name, value in zip(names, values, strict=True):
        if abs(value) > _LIMITS.get(name, np.inf):
            raise DataFileError(
                f"{path}: line {number}: {name} = {value:g} is not allowed: up to {_LIMITS[name]:g}"
            )
    return values


def _along(velocity: Floats, standing: float) -> Floats:
    """Return the heading of velocities (S, 3); below the speed `standing` [m/s] the last one kept,
    at first the next.
    """
    moving = exact.hypot(velocity[:, 0], velocity[:, 1]) > standing
    if not moving.any():
        return np.zeros(len(velocity))
    last = np.maximum.accumulate(np.where(moving, np.arange(len(moving)), -1))
    source = np.where(last < 0, int(np.argmax(moving)), last)
    return np.unwrap(exact.atan2(velocity[source, 1], velocity[source, 0]))
