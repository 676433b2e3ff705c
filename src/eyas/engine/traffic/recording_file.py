"""The file of a recording: an npz with the header, and the rest as bytes of the format xz.

The rest is an npz again, of the poses as `pose_steps` has them, with a checksum; files before 1.0
(format 2) have all in one npz. A file has about 0.4 MB for 20 minutes of 40 cars. Time is the last
axis. Equal recordings give equal bytes.
"""

import hashlib
import io
import json
import lzma
from contextlib import suppress
from dataclasses import asdict
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.config import shown, validated
from eyas.engine.core.decoding import decoded_json, npz_arrays
from eyas.engine.core.errors import DataFileError, EyasError
from eyas.engine.core.files import read_limited, write_atomic
from eyas.engine.traffic.config import Mix, Signals, TrafficConfig, VehicleType
from eyas.engine.traffic.pose_steps import Arrays, packed, unpacked, unpacked_differences
from eyas.engine.traffic.recording import (
    ANGLE_UNIT,
    POSITION_UNIT,
    Provenance,
    TrafficRecording,
    problem_of,
    quantised,
    restored,
)

FORMAT = "eyas traffic recording 3"
"""Format in the header of a file; another layout gets another number."""

_BEFORE = "eyas traffic recording 2"  # Format before it, which is read as well

_LARGEST = 256 << 20  # Largest size of a file, and of its arrays: a day of 50 vehicles [bytes]

_FILTERS = [
    {
        "id": lzma.FILTER_LZMA2,
        "preset": 9 | lzma.PRESET_EXTREME,
        "dict_size": 8 << 20,
        "lc": 4,
        "pb": 0,
    }
]
"""Settings of LZMA for single bytes: their place says nothing, what stood before them much. With
the preset's own dictionary it would need 0.7 GB."""


class Outline(NamedTuple):
    """What the header of a file says."""

    provenance: Provenance
    samples: int
    rate: float  # Samples per second [Hz]
    vehicle_types: tuple[VehicleType, ...]  # Class of each actor


class RecordingFile(NamedTuple):
    """The content of a file, not unpacked yet: that takes a tenth of a second."""

    data: bytes
    source: str  # Name of the file for messages

    @classmethod
    def read(cls, path: Path | Traversable) -> "RecordingFile":
        """Read a file.

        Raises:
            DataFileError: It is missing, unreadable or too large.
        """
        data = read_limited(path, _LARGEST) if isinstance(path, Path) else path.read_bytes()
        return cls(data, str(path))

    def outline(self) -> Outline:
        """Return what the header says, without checking that the rest is whole.

        Raises:
            DataFileError: The content is truncated, damaged or not a recording.
        """
        try:
            header = npz_arrays(self.data, _LARGEST, ("header",))["header"]
            return _outline(decoded_json(header.tobytes()), self.source)
        except EyasError:
            raise
        except Exception as error:  # damaged bytes raise many kinds in zipfile, zlib, numpy, json
            raise DataFileError(f"{self.source}: not a complete traffic recording") from error

    def load(self) -> TrafficRecording:
        """Return the recording.

        Raises:
            DataFileError: The content is truncated, damaged or not a recording.
        """
        return from_bytes(self.data, self.source)


def save(recording: TrafficRecording, path: Path) -> None:
    """Write the file of a recording, completely or not at all.

    Raises:
        OutputError: The file cannot be written.
    """
    write_atomic(path, to_bytes(recording))


def load(path: Path | Traversable) -> TrafficRecording:
    """Read a recording.

    Raises:
        DataFileError: The file is missing, unreadable, truncated or not a recording.
    """
    return RecordingFile.read(path).load()


def to_bytes(recording: TrafficRecording) -> bytes:
    """Return the content of a recording's file."""
    header = {
        "format": FORMAT,
        "rate": recording.rate,
        **_fleet_header(recording),
        "shape": recording.present.shape,
        "provenance": {
            **asdict(recording.provenance),
            "config": _told(recording.provenance.config),
        },
    }
    position = quantised(recording.position, POSITION_UNIT).transpose(1, 2, 0)
    yaw = quantised(recording.yaw, ANGLE_UNIT).T
    arrays: Arrays = {
        "header": np.frombuffer(json.dumps(header, sort_keys=True).encode(), np.uint8),
        **packed(position, yaw),
        "present": np.packbits(recording.present.T, axis=-1),
    }
    arrays["checksum"] = _checksum(arrays)
    buffer = io.BytesIO()
    rest = _condensed({name: array for name, array in arrays.items() if name != "header"})
    np.savez_compressed(buffer, allow_pickle=False, header=arrays["header"], rest=rest)
    return buffer.getvalue()


def _told(config: TrafficConfig) -> dict[str, Any]:
    """Return settings for the header; those that came later only where they are not as usual."""
    usual = {"lamps", *(("signals",) if config.signals is Signals.AMBER else ())}
    return config.model_dump(mode="json", exclude=usual)


def from_bytes(
    data: bytes,  # Content of the file, from `to_bytes`
    source: str,  # Name of the file for messages
) -> TrafficRecording:
    """Return the recording from the content of its file.

    Raises:
        DataFileError: The content is truncated, damaged or not a recording.
    """
    arrays = _read_arrays(data, source)
    try:
        recording = _recording(arrays, source)
        problem = problem_of(recording)
    except EyasError as error:
        raise DataFileError(str(error)) from error
    except Exception as error:  # a right checksum says nothing about what its maker has written
        raise DataFileError(f"{source}: not a traffic recording: its parts do not fit") from error
    if problem:
        raise DataFileError(f"{source}: not a traffic recording: {problem}")
    return recording


def _recording(arrays: Arrays, source: str) -> TrafficRecording:
    """Return the recording of arrays that have any shapes and types."""
    header = decoded_json(arrays["header"].tobytes())
    position, yaw = _poses(arrays, header["format"])
    samples = position.shape[-1]
    flags = arrays["present"].astype(np.uint8, casting="safe")
    if samples != header["shape"][0] or flags.shape[-1] != -(-samples // 8):
        raise ValueError(f"{samples} samples, but the header says {header['shape']}")
    present = np.unpackbits(flags, axis=-1, count=samples)
    outline = _outline(header, source)
    # One length is that of all actors.
    length = np.asarray(header["vehicle_length"], np.float64)
    return TrafficRecording(
        rate=outline.rate,
        position=np.ascontiguousarray(restored(position, POSITION_UNIT).transpose(2, 0, 1)),
        yaw=np.ascontiguousarray(restored(yaw, ANGLE_UNIT).T),
        present=np.ascontiguousarray(present.T.astype(np.bool_)),
        vehicle_types=outline.vehicle_types,
        vehicle_length=length if length.ndim else np.full(len(present), float(length)),
        provenance=outline.provenance,
    )


def _poses(arrays: Arrays, kind: str) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return positions (A, 2, S) and headings (A, S) in whole units."""
    if kind == _BEFORE:
        return unpacked_differences("position", arrays), unpacked_differences("yaw", arrays)
    return unpacked(arrays)


def _fleet_header(recording: TrafficRecording) -> dict[str, Any]:
    """Return what the header says of the actors: one length, or class and length of each."""
    length = recording.vehicle_length.tolist()
    if not isinstance(recording.provenance.config.vehicle_type, Mix):
        return {"vehicle_length": length[0]}
    return {"vehicle_length": length, "vehicle_types": list(recording.vehicle_types)}


def _outline(header: dict[str, Any], source: str) -> Outline:
    origin = _provenance(header, source)
    # One class is that of all actors.
    classes = header.get("vehicle_types", [origin.config.vehicle_type] * header["shape"][1])
    samples, rate = int(header["shape"][0]), float(header["rate"])
    return Outline(origin, samples, rate, tuple(map(VehicleType, classes)))


def _provenance(header: dict[str, Any], source: str) -> Provenance:
    origin = dict(header["provenance"])
    known = {"signals": Signals.AMBER, **origin["config"]}
    origin["config"] = validated(TrafficConfig, known, f"{source}: config")
    origin["options"] = tuple(origin["options"])
    return Provenance(**origin)


def _read_arrays(data: bytes, source: str) -> Arrays:
    try:
        arrays = _unpacked_npz(data)
    except Exception as error:  # damaged bytes raise many kinds in zipfile, zlib, numpy
        raise DataFileError(f"{source}: not a complete traffic recording") from error
    if {"header", "checksum"} - set(arrays):
        raise DataFileError(f"{source}: not a traffic recording (allowed: '{FORMAT}')")
    if not np.array_equal(arrays.pop("checksum"), _checksum(arrays)):
        raise DataFileError(f"{source}: damaged: its checksum does not match its content")
    with suppress(ValueError, TypeError, LookupError):
        kind = decoded_json(arrays["header"].tobytes())["format"]
        if kind in (FORMAT, _BEFORE):
            return arrays
        raise DataFileError(f"{source}: format {shown(kind)} (allowed: '{FORMAT}')")
    raise DataFileError(f"{source}: not a traffic recording: its header cannot be read")


def _checksum(arrays: Arrays) -> NDArray[np.uint8]:
    digest = hashlib.sha256()
    for name in sorted(arrays.keys() - {"checksum"}):
        array = arrays[name]
        digest.update(f"{name} {array.dtype.str} {array.shape}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return np.frombuffer(digest.digest(), np.uint8)


def _unpacked_npz(data: bytes) -> Arrays:
    """Return the arrays of a file, those in the rest among them."""
    arrays = npz_arrays(data, _LARGEST)
    return arrays | _expanded(arrays.pop("rest"), _LARGEST) if "rest" in arrays else arrays


def _condensed(arrays: Arrays) -> NDArray[np.uint8]:
    """Return arrays as an npz file that is compressed with LZMA as a whole."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    return np.frombuffer(lzma.compress(buffer.getvalue(), filters=_FILTERS), np.uint8)


def _expanded(content: NDArray[np.generic], largest: int) -> Arrays:
    """Return the arrays of `_condensed`, if they have less than so many bytes.

    Raises:
        Exception: The content is damaged, too large or something else.
    """
    machine = lzma.LZMADecompressor(lzma.FORMAT_XZ, memlimit=largest)
    data = machine.decompress(content.tobytes(), largest)
    if not machine.eof:
        raise ValueError(f"cut off, or larger than {largest} bytes")
    return npz_arrays(data, largest)
