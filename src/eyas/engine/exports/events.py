"""Events as Prophesee's raw files of format EVT 2.0."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.exports.frame import Frame
from eyas.engine.exports.writer import Episode, Files, Gather, Run, Summary, Writer

__all__ = ["EventWriter", "evt2"]

NAME = "events.raw"
_FRAMES = b"% eyas_frames "
_MOST = 2048  # Columns and rows have eleven bits

_TIME_HIGH = 8 << 28


class EventWriter(Writer):
    """`events.raw`: all events of an episode; the times count from its reset.

    Args:
        run: The recording.

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


def evt2(events: NDArray[np.void], size: tuple[int, int], frames: int) -> bytes:
    """Return a raw file of format EVT 2.0 (Prophesee, Metavision SDK documentation, "EVT 2.0").

    Words of 32 bits, the lowest byte first. Those of events have the polarity in bits 28 to 31, the
    lowest six bits of the time [us] in 22 to 27, the column in 11 to 21 and the row in 0 to 10;
    before them, each time that they change, come the upper 28 bits of the time.

    Args:
        events: In the order of time, see `eyas.engine.camera.esim.EVENT`.
        size: Width and height [pixels].
        frames: Number of frames of the episode; ours, as a comment.
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
