"""`lidar.csv`: the distances that the lidar has measured, for each frame."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from eyas.core.errors import ConfigError
from eyas.exports.frame import Frame
from eyas.exports.writer import Episode, Files, Gather, Run, Summary, Writer

__all__ = ["LidarWriter"]

TABLE = "lidar.csv"


class LidarWriter(Writer):
    """Writes a row for each frame: its number, its step, and the distance of each point [m], empty
    where nothing was within range. Point 0 looks back; the others follow clockwise.

    Args:
        run: The recording.

    Raises:
        ConfigError: The trackers have no lidar.
    """

    files = Files(episode=(TABLE,))

    def __init__(self, run: Run) -> None:
        if not run.config.lidar.enabled:
            raise ConfigError("video.writers: 'lidar' needs lidar.enabled (Lidar_Enable): true")

    def begin(self, episode: Episode) -> Gather[str]:
        """Return the writer of `lidar.csv`."""
        return Gather(episode.folder / TABLE, _row, _encoded)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of rows."""
        try:
            lines = (folder / TABLE).read_text().splitlines()
        except (OSError, ValueError):
            return None
        return Summary(len(lines) - 1) if lines and lines[0].startswith("frame,step,") else None


def _row(frame: Frame) -> str:
    assert frame.lidar is not None
    told = (f"{metres:.10g}" if np.isfinite(metres) else "" for metres in frame.lidar.tolist())
    return ",".join([str(frame.number), str(frame.step), *told])


def _encoded(rows: Sequence[str]) -> bytes:
    points = rows[0].count(",") - 1 if rows else 0
    header = ",".join(["frame", "step", *(f"point_{point}" for point in range(points))])
    return "\n".join([header, *rows, ""]).encode()
