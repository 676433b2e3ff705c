"""Records the flight of the demo into a folder, as `eyas video` would."""

from contextlib import ExitStack
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.demo.flight import DemoFlight
from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.config import updated
from eyas.engine.core.folder_lock import folder_lock
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.video.folder import open_folder
from eyas.engine.video.formats import with_writers
from eyas.engine.video.recorder import Recorder


class DemoRecording:
    """A recording of one episode, from now on.

    Attributes:
        folder: Where it is.
        frames: Number of frames.

    Args:
        flight: What is recorded; the recording must end before its world does.
        folder: The folder; it must not exist, or be empty.
        size: Width and height of its pictures [pixels]; None: those of the settings.

    Raises:
        EyasError: It cannot be written.
    """

    def __init__(
        self, flight: DemoFlight, folder: Path, size: tuple[int, int] | None = None
    ) -> None:
        config = updated(flight.config, {"video": {"channels": 1}})
        if size is not None:
            config = updated(config, {"camera": {"width": size[0], "height": size[1]}})
        config = with_writers(config, quiet=True)
        self.folder, self.frames = folder, 0
        self.period = max(round(PHYSICS_RATE / config.video.fps), 1)
        self._steps = 0
        with ExitStack() as stack:
            stack.enter_context(folder_lock(folder, "recording into it"))
            opened = open_folder(folder, config, overwrite=False, resume=False)
            self._recorder = Recorder(flight.simulation, config, opened)
            self._lock = stack.pop_all()

    @property
    def steps_left(self) -> int:
        """Physics steps until the next frame."""
        return self.period - self._steps % self.period

    def count(self, command: NDArray[np.float64], steps: int) -> None:
        """Count steps of a command, shape (1, 4); write a frame if one is due.

        Raises:
            OutputError: A frame could not be written.
        """
        self._steps += steps
        if self._steps % self.period == 0:
            action = RecordedAction(-1, command[0])
            self._recorder.take(np.zeros(1, np.int32), lambda tracker: action)
            self.frames += 1

    def end(self) -> None:
        """End the recording; it is whole.

        Raises:
            OutputError: Writing failed.
        """
        with self._lock:
            try:
                self._recorder.finish()
            except BaseException:
                self._recorder.stop()
                raise

    def abandon(self) -> None:
        """Stop after a failure; every file that exists is whole."""
        with self._lock:
            self._recorder.stop()
