"""Writers of one file an episode: tables of the sensors with a row for each frame, the lidar's
points, events as Prophesee's raw files, and the marks of the original (`mark.json`,
`dir_info.json`).
"""

import json
import math
from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.files import read_limited, write_atomic
from eyas.engine.exports.frame import Floats, Frame
from eyas.engine.exports.writer import EndedEpisode, Episode, Files, Gather, Run, Summary, Writer
from eyas.engine.sensors.table import fitted_sensors

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
        texts = (f"{value:.10g}" if np.isfinite(value) else "" for value in values)
        return ",".join([str(frame.number), str(frame.step), *texts])

    def _encoded(self, rows: Sequence[str]) -> bytes:
        count = rows[0].count(",") - 1 if rows else 0
        return "\n".join([",".join(["frame", "step", *self.names(count)]), *rows, ""]).encode()


class LidarWriter(TableWriter):
    """`lidar.csv`: the distance of each point [m], empty where nothing was within range. Point 0
    looks back; the others follow clockwise.

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


NAME = "events.raw"
_FRAMES = b"% eyas_frames "
"""Comment with the number of frames, by which an episode is known to be whole."""
_MOST = 2048  # Columns and rows have eleven bits
_TIME_HIGH = 8 << 28  # Kind of the words with the upper bits of the time


class EventWriter(Writer):
    """`events.raw`: all events of an episode; the times count from its reset.

    Raises:
        ConfigError: The trackers have no event camera, or it is too large for the format.
    """

    wants = frozenset({"events"})
    files = Files(episode=(NAME,))

    def __init__(self, run: Run) -> None:
        camera = run.config.camera
        if not camera.events.enabled:
            raise ConfigError("video.writers: 'events' needs camera.events.enabled: true")
        self._size = camera.events.width or camera.width, camera.events.height or camera.height
        if max(self._size) > _MOST:
            raise ConfigError(
                f"video.writers: 'events' has at most {_MOST} columns and rows, not "
                f"{self._size[0]}x{self._size[1]}"
            )

    def begin(self, episode: Episode) -> Gather[NDArray[np.void]]:
        """Return the writer of an episode's events."""
        return Gather(episode.folder / NAME, _events, self._encoded)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of frames."""
        try:
            with (folder / NAME).open("rb") as file:
                lines = [file.readline() for _ in range(8)]
            counts = [line[len(_FRAMES) :] for line in lines if line.startswith(_FRAMES)]
            return Summary(int(counts[0]))
        except (OSError, ValueError, IndexError):
            return None

    def _encoded(self, frames: Sequence[NDArray[np.void]]) -> bytes:
        return evt2(np.concatenate(frames), self._size, len(frames))


def _events(frame: Frame) -> NDArray[np.void]:
    assert frame.events is not None
    return frame.events


def evt2(
    events: NDArray[np.void],  # In the order of time, see `eyas.engine.camera.esim.EVENT`
    size: tuple[int, int],  # Width and height [pixels]
    frames: int,  # Number of frames of the episode; ours, as a comment
) -> bytes:
    """Return a raw file of format EVT 2.0 (Prophesee, Metavision SDK documentation, "EVT 2.0").

    Words of 32 bits, the lowest byte first. Those of events have the polarity in bits 28 to 31, the
    lowest six bits of the time [us] in 22 to 27, the column in 11 to 21 and the row in 0 to 10;
    before them, each time that they change, come the upper 28 bits of the time.
    """
    width, height = size
    head = (
        f"% evt 2.0\n% format EVT2;width={width};height={height}\n% geometry {width}x{height}\n"
        f"{_FRAMES.decode()}{frames}\n% end\n"
    )
    time = events["t"].astype(np.int64)
    words = (
        (events["p"].astype(np.uint32) << np.uint32(28))
        | ((time & 63).astype(np.uint32) << np.uint32(22))
        | (events["x"].astype(np.uint32) << np.uint32(11))
        | events["y"].astype(np.uint32)
    )
    high = time >> 6
    changes = np.flatnonzero(np.diff(high, prepend=-1))
    marks = (_TIME_HIGH | (high[changes] & 0xFFFFFFF)).astype(np.uint32)
    return head.encode() + np.insert(words, changes, marks).astype("<u4").tobytes()


MARK, DIR_INFO = "mark.json", "dir_info.json"

Mark = int | list[float | None]


class MarkWriter(Writer):
    """Writes a mark for each frame, and the number of frames of each episode of each tracker.

    A mark is `[reward, action]`, or the target's direction (0 stop, 1 straight, 2 left, 3 right).
    """

    files = Files(episode=(MARK,), run=(DIR_INFO,))

    def __init__(self, run: Run) -> None:
        self._run = run

    def begin(self, episode: Episode) -> Gather[tuple[str, Mark]]:
        """Return the writer of `mark.json`: `{"000000": [reward, action], ...}`."""
        return Gather(episode.folder / MARK, self._marked, _encoded)

    def _marked(self, frame: Frame) -> tuple[str, Mark]:
        # The original writes both as C++ doubles: an action as 3.0, exact following as -1.0.
        reward = frame.reward if math.isfinite(frame.reward) else None
        pair = [reward, float(frame.action.number)]
        return f"{frame.number:06d}", int(frame.direction) if self._run.target_direction else pair

    def read(self, folder: Path) -> Summary | None:
        """Return the number of marks."""
        try:
            marks = read_json(folder / MARK, 1 << 30)
        except DataFileError:
            return None
        return Summary(len(marks)) if isinstance(marks, dict) else None

    def finish(self, episodes: Sequence[EndedEpisode]) -> None:
        """Write `dir_info.json`.

        The original counts the files in an episode's folder without `mark.json`, which gives the
        same numbers.
        """
        info: dict[str, dict[str, int]] = {tracker: {} for tracker in self._run.trackers}
        for episode, summary in episodes:
            info[episode.tracker][f"episode{episode.number}"] = summary.frames
        write_atomic(self._run.folder / DIR_INFO, json.dumps(info, indent=4).encode())


def _encoded(marks: Sequence[tuple[str, Mark]]) -> bytes:
    return json.dumps(dict(marks), indent=4).encode()
