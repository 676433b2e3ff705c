"""Poses of odometry: files of the TUM benchmark and of KITTI.

TUM: `timestamp tx ty tz qx qy qz qw` a line, x to the right or forward, z up. KITTI: the twelve
numbers of a 3x4 matrix a line, camera frame (x right, y down, z forward), with the times in
`times.txt` beside it, else ten a second. Both begin anywhere: `custom.at` puts them on the map.
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.custom.trajectory import Track
from eyas.lanes import exact

_LARGEST = 64 << 20  # Largest file [bytes]
_KITTI_RATE = 10.0  # Of its cameras [Hz]

Floats = NDArray[np.float64]


def read_poses(path: Path) -> list[Track]:
    """Return the track of a file of poses; the columns say which form it has."""
    table = _table(path)
    columns = table.shape[1]
    if columns == 8:
        time, place = table[:, 0], table[:, 1:4]
        x, y, z, w = table[:, 4:].T
        yaw = exact.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        return [Track(time, _on_ground(place), on_earth=False, yaw=np.unwrap(yaw))]
    if columns == 12:
        x, z = table[:, 3], table[:, 11]
        place = np.column_stack([x, z, np.zeros(len(x))])
        return [Track(_times(path, len(table)), _on_ground(place), on_earth=False)]
    raise DataFileError(
        f"{path}: {columns} numbers a line; TUM's files have 8 (time, place, quaternion), KITTI's "
        "12"
    )


def _on_ground(place: Floats) -> Floats:
    return np.column_stack([place[:, :2], np.full(len(place), np.nan)])


def _times(path: Path, count: int) -> Floats:
    beside = path.with_name("times.txt")
    if beside.is_file():
        times = _table(beside)[:, 0]
        if len(times) >= count:
            return times[:count]
    return np.arange(count) / _KITTI_RATE


def _table(path: Path) -> Floats:
    text = read_limited(path, _LARGEST).decode("utf-8-sig", "replace")
    rows: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            row = [float(cell) for cell in re.split(r"[,;\s]+", line.strip())]
            if rows and len(row) != len(rows[0]):
                raise ValueError
        except ValueError:
            raise DataFileError(
                f"{path}: line {number}: {line.strip()!r:.60} is not a pose"
            ) from None
        rows.append(row)
    table = np.array(rows, np.float64).reshape(len(rows), -1 if rows else 0)
    if not len(table) or not (np.abs(table) <= 1e12).all():
        raise DataFileError(f"{path}: no poses, or one with an absurd number")
    return table
