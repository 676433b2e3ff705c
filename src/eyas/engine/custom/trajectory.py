"""Trajectories in CSV files, and their motion at the samples of the traffic."""

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.config import shown
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.lanes import exact

COLUMNS = ("t", "x", "y", "z", "yaw")  # Names in the first line; z and yaw may be left out
JUMP = 100.0  # Speed from which on two points are a jump [m/s]
_LARGEST = 64 << 20  # Largest size of a file [bytes]
_LIMITS = {
    **{"t": 1e19, "x": 1e9, "y": 1e9, "z": 1e9, "yaw": 1e6},
    **{"latitude": 90.0, "longitude": 180.0},
}
"""Largest numbers of the columns; times may count from 1970 in any unit."""

_MOST = 200  # Largest number of bodies in a table: each is sampled for the whole time
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


class Track(NamedTuple):
    """Places of one body as a file has them, before they are on a map."""

    time: Floats | None  # On the file's own clock [s], shape (N,); None: it has none
    place: Floats
    """East, north, up [m]; or longitude, latitude [degrees], altitude [m]; shape (N, 3). NaN: the
    height is not known."""
    on_earth: bool  # Which of the two
    yaw: Floats | None = None  # Counter-clockwise from east [rad], shape (N,); None: along the way
    name: str = ""  # Of several in one file


def read_table(path: Path) -> list[Track]:
    """Return the tracks of a CSV file, whose columns may have the names that others give them: one
    for each value of a column `id`, in the order of the file, or one, which may have no times.

    Raises:
        DataFileError: The file is missing, or has not the columns, or something else than numbers,
            or too many bodies.
    """
    text = read_limited(path, _LARGEST).decode("utf-8-sig", errors="replace")
    text, above = _below_comments(text)
    delimiter = _delimiter(text)
    try:
        # Also lines that end with a carriage return, as some spreadsheets write them.
        lines = list(csv.reader(io.StringIO(text, newline=None), delimiter=delimiter))
    except csv.Error as error:  # a quotation mark that is never closed
        raise DataFileError(f"{path}: not a CSV file: {error}") from None
    named = [_column(name) for name in lines[0]] if lines else []
    names = [name for name, _ in named]
    on_earth = "latitude" in names or "longitude" in names
    needed: tuple[str, ...] = ("t", "latitude", "longitude") if on_earth else COLUMNS[:3]
    if not on_earth and "id" not in names:  # a list of towns is no track
        needed = needed[1:]  # without times it goes at one speed
    missing = [name for name in needed if name not in names]
    if missing:
        there = shown(",".join(lines[0] if lines else []))
        raise DataFileError(
            f"{path}: line {above + 1}: no column '{missing[0]}' in {there}; allowed: t,x,y and "
            "perhaps z,yaw; or t,latitude,longitude"
        )
    for name in COLUMNS:
        if names.count(name) > 1:
            raise DataFileError(f"{path}: line {above + 1}: two columns are '{name}'")
    wanted = [(k, name) for k, name in enumerate(names) if name in _LIMITS]
    filled = [(k, line) for k, line in enumerate(lines[1:], above + 2) if any(map(str.strip, line))]
    rows = [
        _numbers(path, k, line, len(names), wanted, decimal_comma=delimiter == ";")
        for k, line in filled
    ]
    values = np.array(rows, np.float64).reshape(-1, len(wanted))
    column = {name: values[:, k] for k, (_, name) in enumerate(wanted)}
    time = None
    if "t" in column:
        time = column["t"] * dict(named)["t"]
        time = time * _epoch_unit(time)
    level = np.full(len(values), np.nan)
    if on_earth:
        places = (column["longitude"], column["latitude"], column.get("z", level))
    else:
        places = (column["x"], column["y"], column.get("z", level))
    yaw = None
    if "yaw" in column and not on_earth and time is not None:
        yaw = column["yaw"]
    whole = Track(time, np.column_stack(places), on_earth, yaw)
    if "id" not in names:
        return [_of_body(whole, slice(None), "")]
    who = np.array([line[names.index("id")].strip() for _, line in filled], np.str_)
    bodies = [(name, np.flatnonzero(who == name)) for name in dict.fromkeys(who.tolist())]
    # A body of one point is seen for one picture only, as at the edge of a recording.
    bodies = [(name, own) for name, own in bodies if len(own) > 1]
    if len(bodies) > _MOST:
        raise DataFileError(
            f"{path}: {len(bodies)} bodies; allowed: up to {_MOST}: leave out the rows of others"
        )
    return [_of_body(whole, own, name) for name, own in bodies]


def _of_body(whole: Track, own: slice | NDArray[np.int64], name: str) -> Track:
    yaw = None if whole.yaw is None else np.unwrap(whole.yaw[own])
    time = None if whole.time is None else whole.time[own]
    return Track(time, whole.place[own], whole.on_earth, yaw, name)


def read_trajectory(path: Path) -> Trajectory:
    """Return the trajectory of a CSV file in metres of the map; its first time becomes 0.

    Raises:
        DataFileError: The file is missing, or does not hold a trajectory: time runs backwards, a
            number is missing, not finite or absurd, or it lasts longer than a day.
    """
    track, *others = read_table(path)
    if others:
        raise DataFileError(f"{path}: {1 + len(others)} bodies; allowed here: one")
    if track.time is None:
        raise DataFileError(f"{path}: no column 't'; allowed here: t,x,y and perhaps z,yaw")
    return trajectory_of(path, track.time, track.place, track.yaw)


def trajectory_of(path: Path, time: Floats, position: Floats, yaw: Floats | None) -> Trajectory:
    """Return places in metres of the map as a trajectory; its first time becomes 0.

    Raises:
        DataFileError: There are fewer than two, time runs backwards, or it lasts longer than a day.
    """
    if len(time) < 2:
        raise DataFileError(f"{path}: {len(time)} points; a trajectory has two or more")
    back = np.flatnonzero(np.diff(time) <= 0.0)
    if len(back):
        k = int(back[0])
        raise DataFileError(
            f"{path}: point {k + 2}: t is {time[k + 1]:.12g} after {time[k]:.12g}: time must "
            "increase"
        )
    if time[-1] - time[0] > _LONGEST:
        raise DataFileError(
            f"{path}: it lasts {time[-1] - time[0]:.6g} s; allowed: up to {_LONGEST:g} s"
            + (": is t in milliseconds? it is in seconds" if path.suffix == ".csv" else "")
        )
    return Trajectory(time - time[0], position, yaw)


_SYNONYMS = {
    "t": "t time timestamp stamp sec secs second seconds datetime date_time utc time_utc elapsed",
    "x": "x east e pos_x position_x px tx x_position xcenter x_center p_rs_r_x",
    "y": "y north n pos_y position_y py ty y_position ycenter y_center p_rs_r_y",
    "id": "id trackid track_id vehicle_id object_id agent_id",
    "z": "z up alt altitude height ele elevation pos_z position_z pz tz p_rs_r_z",
    "yaw": "yaw",
    "latitude": "latitude lat",
    "longitude": "longitude lon lng long",
}
"""Names of columns, in small letters, without units."""

_NAMED = {each: name for name, several in _SYNONYMS.items() for each in several.split()}
_FRAME = 0.04  # Time of a frame where a table counts these, as highD and inD do, 25 a second [s]
_UNITS = {"ns": 1e-9, "us": 1e-6, "µs": 1e-6, "ms": 1e-3, "s": 1.0}


def _column(name: str) -> tuple[str, float]:
    """Return our name of a column, and the factor of a time to seconds."""
    plain = name.strip().strip("\"'#").strip().lower()  # EuRoC's tables begin with #
    if plain == "frame":
        return "t", _FRAME
    unit = re.search(r"[\[(]\s*([a-zµ]+)\s*[\])]$|_([a-zµ]+)$", plain)
    stem = re.sub(r"\s*[\[(].*[\])]$", "", plain).strip().replace(" ", "_")
    factor = _UNITS.get((unit[1] or unit[2]) if unit else "", 0.0)
    if stem not in _NAMED and (factor or stem.endswith(("_m", "_deg"))) and "_" in stem:
        stem = stem.rpartition("_")[0]
    return _NAMED.get(stem, stem), factor or 1.0


def _below_comments(text: str) -> tuple[str, int]:
    """Return a table without the comments above it, and the number of their lines.

    Of lines that begin with #, the last names the columns if numbers follow it.
    """
    lines = text.splitlines(keepends=True)
    count = next((k for k, line in enumerate(lines) if not line.startswith("#")), len(lines))
    if count and count < len(lines) and re.match(r"\s*[-+.\d]", lines[count]):
        count -= 1
    return "".join(lines[count:]), count


def _delimiter(text: str) -> str:
    first = text.partition("\n")[0]
    return max(",;\t", key=first.count)  # a comma, if there is none


def _epoch_unit(time: Floats) -> float:
    """Return the factor to seconds of times that count from 1970 in smaller units."""
    start = float(time[0]) if len(time) else 0.0
    # In seconds these limits are in the year 5138 and later.
    return next((factor for least, factor in _EPOCHS if start > least), 1.0)


_EPOCHS = ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3))


def _number(cell: str, name: str, *, decimal_comma: bool) -> float:
    if decimal_comma:
        cell = cell.replace(",", ".")
    try:
        return float(cell)
    except ValueError:
        if name != "t":
            raise
    return datetime_seconds(cell)


def datetime_seconds(text: str) -> float:
    """Return the seconds since 1970 of a time in ISO 8601; without a zone it is taken as UTC.

    Raises:
        ValueError: It is no such time.
    """
    when = datetime.fromisoformat(text.strip().replace("/", "-"))
    return (when if when.tzinfo else when.replace(tzinfo=UTC)).timestamp()


def _numbers(
    path: Path,
    number: int,
    line: list[str],
    count: int,
    wanted: Sequence[tuple[int, str]],
    *,
    decimal_comma: bool,
) -> list[float]:
    """Return the wanted cells of a line; others may hold anything."""
    try:
        if len(line) != count:
            raise ValueError
        values = [_number(line[k], name, decimal_comma=decimal_comma) for k, name in wanted]
    except (ValueError, OverflowError):
        values = []
    if not values or not np.isfinite(values).all():
        raise DataFileError(
            f"{path}: line {number}: {shown(','.join(line))} is not allowed: {count} finite numbers"
        )
    for (_, name), value in zip(wanted, values, strict=True):
        if abs(value) > _LIMITS[name]:
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
