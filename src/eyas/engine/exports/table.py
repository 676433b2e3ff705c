"""Tables of an episode with a row for each frame: what the lidar and the other sensors read."""

from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np

from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.exports.frame import Floats, Frame
from eyas.engine.exports.writer import Episode, Files, Gather, Run, Summary, Writer
from eyas.engine.sensors.table import fitted_sensors

__all__ = ["ROTOR_COLUMNS", "LidarWriter", "SensorWriter"]


ROTOR_COLUMNS = ("rotor_1", "rotor_2", "rotor_3", "rotor_4")  # Columns of `Frame.rotors`.


class TableWriter(Writer):
    """Writes a table: for each frame its number, its step, and some numbers, empty where one is not
    finite.
    """

    table: ClassVar[str]
    """Name of the file."""

    @abstractmethod
    def numbers(self, frame: Frame) -> Floats:
        """Return the numbers of a frame, shape (K,)."""

    @abstractmethod
    def names(self, count: int) -> Sequence[str]:
        """Return the names of their columns."""

    def begin(self, episode: Episode) -> Gather[str]:
        """Return the writer of an episode's table."""
        return Gather(episode.folder / self.table, self._row, self._encoded)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of rows."""
        try:
            lines = read_limited(folder / self.table, 1 << 30).decode().splitlines()
        except (DataFileError, ValueError):
            return None
        return Summary(len(lines) - 1) if lines and lines[0].startswith("frame,step,") else None

    def _row(self, frame: Frame) -> str:
        values = self.numbers(frame).tolist()
        told = (f"{value:.10g}" if np.isfinite(value) else "" for value in values)
        return ",".join([str(frame.number), str(frame.step), *told])

    def _encoded(self, rows: Sequence[str]) -> bytes:
        count = rows[0].count(",") - 1 if rows else 0
        return "\n".join([",".join(["frame", "step", *self.names(count)]), *rows, ""]).encode()


class LidarWriter(TableWriter):
    """`lidar.csv`: the distance of each point [m], empty where nothing was within range. Point 0
    looks back; the others follow clockwise.

    Args:
        run: The recording.

    Raises:
        ConfigError: The trackers have no lidar.
    """

    table = "lidar.csv"
    files = Files(episode=(table,))

    def __init__(self, run: Run) -> None:
        if not run.config.lidar.enabled:
            raise ConfigError("video.writers: 'lidar' needs lidar.enabled (Lidar_Enable): true")

    def numbers(self, frame: Frame) -> Floats:
        """Return the distances."""
        assert frame.lidar is not None
        return frame.lidar

    def names(self, count: int) -> Sequence[str]:
        """Return the points."""
        return [f"point_{point}" for point in range(count)]


class SensorWriter(TableWriter):
    """`sensors.csv`: what GPS, accelerometer, gyroscope and IMU tell, with their errors; then what
    further sensors tell (`sensors.further`), and what a tracker asks of its rotors, if it tells
    (`tracker.tells_rotors`).

    Args:
        run: The recording.
    """

    table = "sensors.csv"
    files = Files(episode=(table,))

    def __init__(self, run: Run) -> None:
        fitted = fitted_sensors(run.config.sensors)
        self._fields = [column for each in fitted for column in each.sensor.columns]

    def numbers(self, frame: Frame) -> Floats:
        """Return the readings."""
        assert frame.sensors is not None
        rotors = () if frame.rotors is None else frame.rotors
        return np.concatenate([frame.sensors, *frame.signals.values(), rotors])

    def names(self, count: int) -> Sequence[str]:
        """Return their names, as in packets."""
        return self._fields if count == len(self._fields) else (*self._fields, *ROTOR_COLUMNS)
