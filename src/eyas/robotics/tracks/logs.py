"""Logs of flight controllers and ground stations: PX4's `.ulg`, ArduPilot's `.bin`, `.tlog`.

ULog: docs.px4.io, "ULog File Format"; a header of 16 bytes, then messages of a length, a kind and a
content. DataFlash: ardupilot.org, "Log message format"; packets that begin with A3 95 and their
kind, whose lengths and columns other packets describe. Telemetry: mavlink.io, "Serialization";
each packet after its time, as eight bytes. Only the few messages are read that say
where the vehicle was, and not by pyulog and pymavlink, which never end on some damaged files. A log
that is cut is read up to there.
"""

import re
import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.custom.trajectory import Track
from eyas.lanes import exact

_LARGEST = 1 << 30  # Largest file [bytes]

Floats = NDArray[np.float64]
Table = NDArray[np.void]  # A column each field, shape (N,)

_ULOG = b"ULog\x01\x12\x35"
_ULOG_TYPES = {
    **{"int8_t": "i1", "uint8_t": "u1", "int16_t": "<i2", "uint16_t": "<u2", "int32_t": "<i4"},
    **{"uint32_t": "<u4", "int64_t": "<i8", "uint64_t": "<u8", "float": "<f4", "double": "<f8"},
    **{"bool": "?", "char": "S1"},
}
_PACKET = b"\xa3\x95"
_FORMAT = 128  # Kind of the packets that describe others
_FORMAT_LENGTH = 89
_CODES = {
    **{"a": "S64", "b": "i1", "B": "u1", "h": "<i2", "H": "<u2", "i": "<i4", "I": "<u4"},
    **{"f": "<f4", "d": "<f8", "n": "S4", "N": "S16", "Z": "S64", "c": "<i2", "C": "<u2"},
    **{"e": "<i4", "E": "<u4", "L": "<i4", "M": "u1", "q": "<i8", "Q": "<u8", "g": "<f2"},
}
_SCALES = {"c": 1e-2, "C": 1e-2, "e": 1e-2, "E": 1e-2, "L": 1e-7}


def read_ulg(path: Path) -> list[Track]:
    """Return the flight of a log of PX4: by the estimator's place on earth, else its local one."""
    content = read_limited(path, _LARGEST)
    if not content.startswith(_ULOG):
        raise DataFileError(f"{path}: not a log of PX4: its first bytes are others")
    tables = _ulog_tables(
        content, {"vehicle_global_position", "vehicle_local_position", "vehicle_attitude"}
    )
    yaw = None
    attitude = tables.get("vehicle_attitude")
    if attitude is not None and _has(attitude, "q") and attitude["q"].shape[1:] == (4,):
        # A damaged one may have anything: what is no rotation becomes one.
        w, x, y, z = np.clip(np.nan_to_num(attitude["q"].astype(np.float64)), -1.0, 1.0).T
        # Body to north, east, down: clockwise from north.
        north = exact.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        yaw = 1e-6 * attitude["timestamp"], 0.5 * np.pi - north
    for name, columns, on_earth in (
        ("vehicle_global_position", ("lon", "lat", "alt"), True),
        ("vehicle_local_position", ("y", "x", "z"), False),
    ):
        table = tables.get(name)
        if table is not None and len(table) > 1 and _has(table, *columns):
            place = np.stack([table[column].astype(np.float64) for column in columns], axis=1)
            place[:, 2] *= 1.0 if on_earth else -1.0  # the local one counts downwards
            return [_flight(path, 1e-6 * table["timestamp"], place, yaw, on_earth=on_earth)]
    raise DataFileError(f"{path}: has no vehicle_global_position and no vehicle_local_position")


def _ulog_tables(content: bytes, wanted: set[str]) -> dict[str, Table]:
    """Return the wanted messages of a log, of the first instance of each."""
    forms: dict[str, str] = {}
    names: dict[int, str] = {}
    rows: dict[str, list[bytes]] = {name: [] for name in wanted}
    at = 16
    while at + 3 <= len(content):
        length, kind = struct.unpack_from("<HB", content, at)
        inside = content[at + 3 : at + 3 + length]
        at += 3 + length
        if kind == ord("F"):
            name, _, form = inside.decode("latin-1").partition(":")
            forms[name] = form
        elif kind == ord("A") and length > 3 and inside[0] == 0:
            names[int.from_bytes(inside[1:3], "little")] = inside[3:].decode("latin-1")
        elif kind == ord("D") and length >= 2:
            name = names.get(int.from_bytes(inside[:2], "little"), "")
            if name in wanted:
                rows[name].append(inside[2:])
    return {
        name: table
        for name, several in rows.items()
        if (table := _table(several, _ulog_fields(forms.get(name, "")), "timestamp")) is not None
    }


def _ulog_fields(form: str) -> list[tuple[str, str, int]] | None:
    """Return name, type and length of the fields of a format; None: it holds other messages."""
    fields = []
    for part in filter(None, form.split(";")):
        match = re.fullmatch(r"(\w+)(?:\[(\d{1,4})\])? (\w+)", part)
        if match is None or match[1] not in _ULOG_TYPES:
            return None
        fields.append((match[3], _ULOG_TYPES[match[1]], int(match[2] or 1)))
    if fields and fields[-1][0].startswith("_padding"):  # which is not written
        fields.pop()
    return fields


def read_bin(path: Path) -> list[Track]:
    """Return the flight of a log of ArduPilot: by `POS`, else by `GPS`."""
    content = read_limited(path, _LARGEST)
    if not content.startswith(_PACKET):
        raise DataFileError(f"{path}: not a log of ArduPilot: its first bytes are others")
    tables = _dataflash_tables(content, {"POS", "GPS", "ATT"})
    yaw = None
    if (attitude := tables.get("ATT")) is not None and _has(attitude, "Yaw"):
        yaw = attitude["time"], np.radians(90.0 - attitude["Yaw"])
    for name in ("POS", "GPS"):
        table = tables.get(name)
        if table is not None and _has(table, "Lng", "Lat", "Alt"):
            if _has(table, "Status"):
                table = table[table["Status"] >= 3]  # a fix in three dimensions
            if len(table) > 1:
                place = np.stack([table[column] for column in ("Lng", "Lat", "Alt")], axis=1)
                return [_flight(path, table["time"], place, yaw, on_earth=True)]
    raise DataFileError(f"{path}: has no POS and no GPS with a fix")


_POSITION = 33  # Number of GLOBAL_POSITION_INT, and what is in it by mavlink.io, "common"
_FIELDS = np.dtype([
    ("boot", "<u4"), ("lat", "<i4"), ("lon", "<i4"), ("alt", "<i4"), ("above", "<i4"),
    ("v", "<i2", (3,)), ("heading", "<u2"),
])  # fmt: skip
_UNKNOWN = 65535  # Heading that is not known


def read_tlog(path: Path) -> list[Track]:
    """Return the flights of telemetry that a ground station has kept, one for each vehicle."""
    content = read_limited(path, _LARGEST)
    times: dict[int, list[int]] = {}
    rows: dict[int, list[bytes]] = {}
    at = 0
    while at + 20 <= len(content):
        length, system, kind, payload = _packet(content, at + 8)
        if length == 0:
            at += 1
            continue
        if kind == _POSITION:
            times.setdefault(system, []).append(int.from_bytes(content[at : at + 8], "big"))
            # Version 2 leaves zeros at the end out.
            rows.setdefault(system, []).append(payload.ljust(_FIELDS.itemsize, b"\0"))
        at += 8 + length
    found = []
    for system, several in rows.items():
        table = np.frombuffer(b"".join(row[: _FIELDS.itemsize] for row in several), _FIELDS)
        place = np.stack([1e-7 * table["lon"], 1e-7 * table["lat"], 1e-3 * table["alt"]], axis=1)
        time = 1e-6 * np.array(times[system], np.float64)
        fixed = (table["lon"] != 0) | (table["lat"] != 0)
        if fixed.sum() > 1:
            known = fixed & (table["heading"] != _UNKNOWN)
            yaw = time[known], np.radians(90.0 - 0.01 * table["heading"][known])
            found.append(_flight(path, time[fixed], place[fixed], yaw, on_earth=True))
    if not found:
        raise DataFileError(f"{path}: has no GLOBAL_POSITION_INT with a place")
    return found


def _packet(content: bytes, at: int) -> tuple[int, int, int, bytes]:
    """Return length, system, number and payload of the packet at a place; length 0: there is none.

    Checksums are not looked at: they need the definition of every message.
    """
    head = content[at : at + 10]
    if len(head) < 8 or head[0] not in (0xFD, 0xFE):
        return 0, 0, 0, b""
    if head[0] == 0xFE:
        begin, system, kind = 6, head[3], head[5]
    elif len(head) == 10 and not head[2] & ~1:
        begin, system, kind = 10, head[5], int.from_bytes(head[7:10], "little")
    else:
        return 0, 0, 0, b""
    signed = 13 if head[0] == 0xFD and head[2] & 1 else 0
    length = begin + head[1] + 2 + signed
    # The next packet, after its time, tells whether this is one.
    after = content[at + length + 8 : at + length + 9]
    if at + length > len(content) or (after and after[0] not in (0xFD, 0xFE)):
        return 0, 0, 0, b""
    return length, system, kind, content[at + begin : at + begin + head[1]]


def _dataflash_tables(content: bytes, wanted: set[str]) -> dict[str, Table]:
    """Return the wanted messages of a log as numbers in their units, with their `time` [s]."""
    kinds: dict[int, tuple[str, int, str, list[str]]] = {}
    rows: dict[int, list[bytes]] = {}
    at = 0
    while 0 <= at <= len(content) - 3:
        if content[at : at + 2] != _PACKET:
            at = content.find(_PACKET, at + 1)
            continue
        kind = content[at + 2]
        length = _FORMAT_LENGTH if kind == _FORMAT else kinds.get(kind, ("", 0, "", []))[1]
        inside = content[at + 3 : at + length]
        if length < 3 or len(inside) < length - 3:
            at = content.find(_PACKET, at + 1)
            continue
        at += length
        if kind == _FORMAT:
            of, size = inside[:2]
            name, form, listed = (
                part.rstrip(b"\0").decode("latin-1")
                for part in (inside[2:6], inside[6:22], inside[22:86])
            )
            kinds[of] = (name, size, form, listed.split(","))
        elif kinds[kind][0] in wanted:
            rows.setdefault(kind, []).append(inside)
    tables = {}
    for kind, several in rows.items():
        name, _, form, columns = kinds[kind]
        if len(form) == len(columns) and all(code in _CODES for code in form):
            fields = [(column, _CODES[code], 1) for column, code in zip(columns, form, strict=True)]
            time = next((each for each in ("TimeUS", "TimeMS") if each in columns), "")
            table = _table(several, fields, time)
            if table is not None:
                codes = zip(columns, form, strict=True)
                scales = {column: _SCALES.get(code, 1.0) for column, code in codes}
                scales["time"] = 1e-6 if time == "TimeUS" else 1e-3
                tables[name] = _in_units(table, scales, time)
    return tables


def _in_units(table: Table, scales: dict[str, float], time: str) -> Table:
    numbers = [name for name in table.dtype.names or () if table[name].dtype.kind in "iuf"]
    found = np.zeros(len(table), [(name, np.float64) for name in [*numbers, "time"]])
    for name in numbers:
        found[name] = table[name] * scales[name]
    found["time"] = table[time] * scales["time"]
    return found


def _table(
    rows: list[bytes], fields: list[tuple[str, str, int]] | None, needed: str
) -> Table | None:
    """Return rows of bytes as a table; None: they do not fit their description."""
    if not fields or needed not in {name for name, _, _ in fields}:
        return None
    try:
        kind = np.dtype([(name, code, (n,)) if n > 1 else (name, code) for name, code, n in fields])
    except (ValueError, TypeError):  # a name twice
        return None
    whole = [row[: kind.itemsize] for row in rows if len(row) >= kind.itemsize]
    return np.frombuffer(b"".join(whole), kind) if whole else None


def _has(table: Table, *names: str) -> bool:
    return all(name in (table.dtype.names or ()) for name in names)


def _flight(
    path: Path, time: Floats, place: Floats, yaw: tuple[Floats, Floats] | None, *, on_earth: bool
) -> Track:
    most = np.array([180.0, 90.0]) if on_earth else np.array([1e7, 1e7])
    good = np.isfinite(place).all(axis=1) & (np.abs(place[:, :2]) <= most).all(axis=1)
    if good.sum() < 2:
        raise DataFileError(f"{path}: has no two places")
    time, place = time[good], place[good]
    heading = None
    if yaw is not None and len(yaw[0]) > 1 and (np.abs(yaw[1]) < 1e4).all():
        heading = np.interp(time, yaw[0], np.unwrap(yaw[1]))
    return Track(time, place, on_earth, heading)
