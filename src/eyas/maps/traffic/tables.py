"""Tables of recorded vehicles, as drones above a road make them: highD, inD, INTERACTION, ..."""

import csv
import io
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from eyas.engine.core.config import Config, shown, validated
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.targets.config import vehicle_class
from eyas.engine.traffic.config import VehicleType
from eyas.engine.world.projection import Projection
from eyas.lanes import exact

Floats = NDArray[np.float64]
Column = Annotated[str, Field(min_length=1)] | Annotated[int, Field(ge=0, le=1000)]

_LARGEST = 256 << 20  # Largest size of a table [bytes]
_META = 16 << 20  # Largest size of a table of metadata [bytes]
_LIMIT = 1e7  # Largest length in a table [m]
_USUAL_RATE = 25.0  # Frames a second where nothing says it, as in highD and inD [Hz]
_STANDING = 0.5  # Distance between two headings along the way, at least [m]
_LENGTHS = (0.5, 30.0)  # Of a vehicle [m]


class Columns(Config):
    """What the columns of a table are, by their names, or by their numbers from 0 in a table
    without a line of names.
    """

    id: Column
    """Which vehicle a row is of."""
    frame: Column | None = None
    """Number of the picture; either this or `time`."""
    rate: Annotated[float, Field(gt=0, le=1000)] | None = None
    """Pictures a second [Hz]; None: that of `..._recordingMeta.csv` beside the table, or 25."""
    time: Column | None = None
    time_unit: Annotated[float, Field(gt=0, le=1e6)] = 1.0
    """Unit of `time` [s]."""
    x: Column
    y: Column
    unit: Annotated[float, Field(gt=0, le=1e4)] = 1.0
    """Unit of all lengths [m]."""
    corner: bool = False
    """Whether x and y are the least corner of an upright box, `length` wide and `width` high, not
    the vehicle's middle."""
    front: bool = False
    """Whether x and y are the middle of the vehicle's front, not its middle."""
    down: bool = False
    """Whether y points down, as in pictures."""
    heading: Column | None = None
    """Counter-clockwise from x, clockwise if `down`; None: along the way."""
    heading_unit: Literal["radians", "degrees"] = "radians"
    length: Column | None = None
    width: Column | None = None
    class_: Annotated[Column | None, Field(alias="class")] = None
    """Class of the vehicle; None: that of `..._tracksMeta.csv` beside the table, or a car."""
    classes: dict[str, str | None] = {}  # noqa: RUF012  # pydantic copies it
    """What each class is shown as: car, bus, truck, trailer, motorcycle; null: left out. Others are
    cars."""
    pixels: bool = False
    """Whether lengths are pixels, so that `unit` must be given."""
    needs: tuple[Column, ...] = ()
    """Further columns by which a form is known."""

    def kind_of(self, name: str) -> VehicleType | None:
        """Return what a class of the table is shown as; None: it is left out.

        Raises:
            UnknownNameError: It is to be shown as something that is no vehicle.
        """
        shown_as = self.classes.get(name, VehicleType.PASSENGER)
        return None if shown_as is None else vehicle_class(shown_as, f"classes.{name}")

    @model_validator(mode="after")
    def _whole(self) -> "Columns":
        for name in self.classes:
            self.kind_of(name)
        if (self.frame is None) == (self.time is None):
            raise ValueError("one of frame and time must be given")
        if self.corner and (self.length is None or self.width is None):
            raise ValueError("corner needs length and width")
        if self.front and self.length is None:
            raise ValueError("front needs length")
        if len({isinstance(each, int) for each in self.all}) > 1:
            raise ValueError("columns must be all names or all numbers")
        return self

    @property
    def all(self) -> tuple[Column, ...]:
        """All columns that are read."""
        own = (self.id, self.frame, self.time, self.x, self.y, self.heading, self.length)
        return tuple(c for c in (*own, self.width, self.class_, *self.needs) if c is not None)


class Vehicle(NamedTuple):
    """The way of one vehicle."""

    kind: VehicleType
    length: float  # [m]; 0: not known
    time: Floats  # Increasing [s], shape (N,)
    place: Floats  # Its middle, in metres of the table, y up, shape (N, 2)
    yaw: Floats  # Counter-clockwise from x, without jumps [rad], shape (N,)


class TrackTable(NamedTuple):
    """What a table holds."""

    form: str  # Name of the form
    vehicles: tuple[Vehicle, ...]
    left_out: Mapping[str, int]  # How many tracks of other classes, or of one row, are left out
    origin: tuple[float, float] | None  # Longitude and latitude of 0, 0 [degrees], if it is known


def forms() -> dict[str, Columns]:
    """Return the forms that are known, by name."""
    content = json.loads((files("eyas.maps.traffic") / "table_forms.json").read_text())
    return {name: validated(Columns, columns) for name, columns in content.items()}


def read_columns(path: Path) -> Columns:
    """Return the columns that a JSON file describes.

    Raises:
        DataFileError: The file cannot be read.
        ConfigError: A key or a value is wrong.
    """
    content = read_json(path, 1 << 20)
    if not isinstance(content, dict):
        raise DataFileError(f"{path}: not a JSON object")
    try:
        return validated(Columns, content)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from None


def form_of(path: Path) -> str | None:
    """Return the name of the form of a table, by its first line; None: it is of none.

    Raises:
        DataFileError: The file cannot be read.
    """
    with _opened(path) as lines:
        first = next(lines, [])
    return _form(first)


def read_tracks(
    path: Path, columns: Columns | None = None, unit: float | None = None
) -> TrackTable:
    """Return the vehicles of a table.

    Args:
        path: The file; `XX_tracksMeta.csv` and `XX_recordingMeta.csv` beside `XX_tracks.csv` are
            read, too.
        columns: What its columns are; None: by its first line.
        unit: Unit of its lengths [m], such as the size of a pixel on the ground; None: that of
            the form.

    Raises:
        DataFileError: The file is damaged, of no known form, or lacks a column: one line.
    """
    with _opened(path) as lines:
        first = next(lines, [])
        name = "of a file"
        if columns is None:
            found = _form(first)
            if found is None:
                raise DataFileError(
                    f"{path}: line 1: {shown(','.join(first))} is of no known table; allowed: "
                    f"{'; '.join(forms())}; or --columns FILE.json"
                )
            name, columns = found, forms()[found]
        if unit is None and columns.pixels:
            raise DataFileError(
                f"{path}: its lengths are pixels: --unit says how many metres one is"
            )
        if unit is not None:
            columns = columns.model_copy(update={"unit": unit})
        rows = _rows(path, first, lines, columns)
    meta = _recording_meta(path)
    vehicles, left_out = _vehicles(path, rows, columns, _rate(columns, meta), _classes(path))
    if not vehicles:
        raise DataFileError(f"{path}: no vehicle with two rows or more")
    return TrackTable(name, vehicles, left_out, _origin(meta))


class _Rows(NamedTuple):
    """The rows of a table. N rows."""

    who: list[str]
    when: Floats  # In the table's own unit
    numbers: dict[str, Floats]  # x, y, heading, length, width, as far as there, in its own units
    kind: list[str] | None


@contextmanager
def _opened(path: Path, largest: int | None = None) -> Iterator[Iterator[list[str]]]:
    """Provide the lines of a table, with commas, semicolons or tabs, cell by cell."""
    text = read_limited(path, largest or _LARGEST).decode("utf-8-sig", errors="replace")
    first = text.partition("\n")[0]
    delimiter = max(",;\t", key=first.count)
    try:
        yield csv.reader(io.StringIO(text, newline=None), delimiter=delimiter)
    except csv.Error as error:
        raise DataFileError(f"{path}: not a CSV file: {error}") from None


def _form(first: list[str]) -> str | None:
    names = {name.strip() for name in first}
    for form, columns in forms().items():
        asked = columns.all
        if all(isinstance(each, str) for each in asked):
            if names.issuperset(asked):
                return form
        elif 9 <= len(first) <= 10 and all(map(_is_number, first)):
            return form
    return None


def _is_number(cell: str) -> bool:
    try:
        return bool(np.isfinite(float(cell)))
    except ValueError:
        return False


def _rows(path: Path, first: list[str], lines: Iterator[list[str]], columns: Columns) -> _Rows:
    names = [name.strip() for name in first]
    headless = isinstance(columns.id, int)

    def at(column: Column) -> int:
        if isinstance(column, int):
            return column
        if column not in names:
            raise DataFileError(f"{path}: line 1: no column {column!r} in {shown(','.join(names))}")
        return names.index(column)

    clock = columns.frame if columns.frame is not None else columns.time
    assert clock is not None  # one is there
    numbered = {"when": clock, "x": columns.x, "y": columns.y}
    further = {"heading": columns.heading, "length": columns.length, "width": columns.width}
    numbered |= {name: column for name, column in further.items() if column is not None}
    places = [at(column) for column in numbered.values()]
    who, kind = at(columns.id), None if columns.class_ is None else at(columns.class_)
    needed = max(places + [who] + ([] if kind is None else [kind]))
    ids: list[str] = []
    kinds: list[str] = []
    values: list[list[float]] = []
    for number, line in enumerate([first, *lines] if headless else lines, 1 if headless else 2):
        if not any(map(str.strip, line)):
            continue
        try:
            if len(line) <= needed:
                raise ValueError
            values.append([float(line[place]) for place in places])
        except ValueError:
            raise DataFileError(
                f"{path}: line {number}: {shown(','.join(line))} is not allowed: numbers in "
                f"{', '.join(map(str, numbered.values()))}"
            ) from None
        ids.append(line[who].strip())
        if kind is not None:
            kinds.append(line[kind].strip())
    table = np.array(values, np.float64).reshape(-1, len(places))
    limits = {"when": 1e19, "heading": 1e6}
    most = np.array([limits.get(name, _LIMIT / columns.unit) for name in numbered])
    bad = ~(np.abs(table) <= most)  # also what is no number
    if bad.any():
        row, place = (int(each[0]) for each in np.nonzero(bad))
        value, column = table[row, place], list(numbered.values())[place]
        raise DataFileError(
            f"{path}: data row {row + 1}: {column} is {value:g}; allowed: finite, up to "
            f"{most[place]:g}"
        )
    own = dict(zip(numbered, table.T, strict=True))
    when = own.pop("when")
    return _Rows(ids, when, own, kinds if kind is not None else None)


def _vehicles(
    path: Path,
    rows: _Rows,
    columns: Columns,
    rate: float,  # Frames a second, if the table counts them [Hz]
    classes: Mapping[str, str],  # Class of each id, of the metadata
) -> tuple[tuple[Vehicle, ...], dict[str, int]]:
    """Return the vehicles in the order in which they come, and what is left out."""
    time = rows.when / rate if columns.frame is not None else rows.when * columns.time_unit
    time = time - (time.min() if len(time) else 0.0)
    unit = columns.unit
    place = np.stack([rows.numbers["x"], rows.numbers["y"]], axis=1) * unit
    size = {n: rows.numbers[n] * unit for n in ("length", "width") if n in rows.numbers}
    if columns.corner:
        place += 0.5 * np.stack([size["length"], size["width"]], axis=1)
    if columns.down:
        place[:, 1] *= -1.0
    heading = rows.numbers.get("heading")
    if heading is not None:
        heading = heading * (np.pi / 180.0 if columns.heading_unit == "degrees" else 1.0)
        heading = -heading if columns.down else heading
    own: dict[str, list[int]] = {}
    for row, name in enumerate(rows.who):
        own.setdefault(name, []).append(row)
    found, left_out = [], dict[str, int]()
    for name, several in own.items():
        said = rows.kind[several[0]] if rows.kind is not None else classes.get(name, "")
        kind = columns.kind_of(said)
        at = np.array(several)
        at = at[np.argsort(time[at], kind="stable")]
        at = at[np.concatenate([[True], np.diff(time[at]) > 0.0])]
        what = f"tracks of the class {said!r}" if kind is None else "tracks of one row"
        if kind is None or len(at) < 2:
            left_out[what] = left_out.get(what, 0) + 1
            continue
        where = place[at]
        yaw = np.unwrap(heading[at]) if heading is not None else _along(where)
        length = 0.0
        if "length" in size:
            length = float(np.median(size["length"][at]))
            if columns.corner:  # of an upright box: the longer side, of a vehicle along either
                length = max(length, float(np.median(size["width"][at])))
        if columns.front:
            where = where - 0.5 * length * np.stack([exact.cos(yaw), exact.sin(yaw)], axis=1)
        if length:
            length = min(max(length, _LENGTHS[0]), _LENGTHS[1])
        found.append(Vehicle(kind, length, time[at], where, yaw))
    found.sort(key=lambda vehicle: float(vehicle.time[0]))
    return tuple(found), left_out


def _along(place: Floats) -> Floats:
    """Return the heading along a way, shape (N,): that to the next point which is far enough."""
    kept = [0]
    for row in range(1, len(place)):
        step = place[row] - place[kept[-1]]
        if float(step @ step) >= _STANDING * _STANDING:
            kept.append(row)
    if len(kept) < 2:
        return np.zeros(len(place))
    steps = np.diff(place[kept], axis=0)
    yaw = np.unwrap(exact.atan2(steps[:, 1], steps[:, 0]))
    middle = 0.5 * (np.array(kept[1:]) + np.array(kept[:-1]))
    return np.interp(np.arange(len(place)), middle, yaw)


def _beside(path: Path, what: str) -> Path | None:
    """Return the file of metadata beside `XX_tracks.csv`."""
    if not path.stem.endswith("tracks"):
        return None
    beside = path.with_name(f"{path.stem.removesuffix('tracks')}{what}{path.suffix}")
    return beside if beside.is_file() else None


def _classes(path: Path) -> dict[str, str]:
    """Return the class of each id in the metadata of the tracks."""
    meta = _beside(path, "tracksMeta")
    if meta is None:
        return {}
    with _opened(meta, _META) as lines:
        names = [name.strip() for name in next(lines, [])]
        who = next((names.index(name) for name in ("trackId", "id") if name in names), None)
        if who is None or "class" not in names:
            raise DataFileError(f"{meta}: line 1: no columns 'class' and 'id' or 'trackId'")
        kind = names.index("class")
        rows = (line for line in lines if len(line) > max(who, kind))
        return {line[who].strip(): line[kind].strip() for line in rows}


def _recording_meta(path: Path) -> dict[str, str]:
    """Return the metadata of the recording by their names."""
    meta = _beside(path, "recordingMeta")
    if meta is None:
        return {}
    with _opened(meta, _META) as lines:
        names, values = next(lines, []), next(lines, [])
    return {name.strip(): value.strip() for name, value in zip(names, values, strict=False)}


def _rate(columns: Columns, meta: Mapping[str, str]) -> float:
    said = meta.get("frameRate", "")
    rate = float(said) if columns.rate is None and _is_number(said) else columns.rate
    return rate if rate is not None and 0.1 <= rate <= 1000.0 else _USUAL_RATE


def _origin(meta: Mapping[str, str]) -> tuple[float, float] | None:
    """Return longitude and latitude of the table's 0, 0, which its metadata give in UTM."""
    names = ("xUtmOrigin", "yUtmOrigin", "lonLocation", "latLocation")
    if not all(_is_number(meta.get(name, "")) for name in names):
        return None
    east, north, longitude, latitude = (float(meta[name]) for name in names)
    if not (abs(longitude) <= 180.0 and abs(latitude) <= 84.0 and abs(north) <= 1e7):
        return None
    zone = 6.0 * np.floor(longitude / 6.0) + 3.0  # central meridian
    near = Projection(float(zone), latitude)
    # UTM counts from the equator, and in the south from 10,000 km below it; its scale is 0.9996.
    middle = Projection(float(zone), 0.0).metres((zone, latitude))[0, 1]
    up = (north - (1e7 if latitude < 0.0 else 0.0)) / 0.9996 - middle
    place = near.degrees(((east - 5e5) / 0.9996, up))[0]
    if max(abs(place[0] - longitude), abs(place[1] - latitude)) > 0.1:
        return None
    return float(place[0]), float(place[1])
