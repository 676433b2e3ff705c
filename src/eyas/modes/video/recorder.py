"""Turns due trackers into drawn, labelled and written frames, and keeps what was recorded."""

import numpy as np
from numpy.typing import NDArray

from eyas.exports.labels import FrameLabel
from eyas.modes.video.episode import EpisodeWriter, read_complete
from eyas.modes.video.folder import VideoFolder
from eyas.modes.video.label import label_of
from eyas.modes.video.writers import WriterLanes
from eyas.settings.config import EyasConfig
from eyas.sim.simulation import Simulation
from eyas.state.draw import Picture

__all__ = ["Recorder"]


class Recorder:
    """Records the episodes of all trackers into a folder.

    An episode that lies there complete is taken as it is and not drawn again.

    Args:
        sim: What is recorded.
        config: Its settings.
        folder: Where to.
    """

    episodes: list[list[list[FrameLabel]]]
    """For each tracker the labels of its ended episodes, those that have frames."""
    drawn: int
    """Frames that were drawn."""

    def __init__(self, sim: Simulation, config: EyasConfig, folder: VideoFolder) -> None:
        count = config.video.channels
        self._sim = sim
        self._video = config.video
        self._folder = folder
        self._lanes = WriterLanes(count)
        self._picture = Picture.create(
            count, config.camera.height, config.camera.width, subject=True
        )
        self._labels: list[list[FrameLabel]] = [[] for _ in range(count)]
        self._writers: list[EpisodeWriter | None] = [None] * count
        self._complete = [False] * count
        self._begun: list[EpisodeWriter] = []
        self.episodes = [[] for _ in range(count)]
        self.drawn = 0

    def take(self, due: NDArray[np.int32], action: NDArray[np.int32]) -> None:
        """Record one frame of each of these trackers.

        Args:
            due: Trackers, shape (V,).
            action: Number of each tracker's action, shape (N,).

        Raises:
            OutputError: The file system refused this frame or an earlier one.
        """
        for tracker in due.tolist():
            if self._writers[tracker] is None and not self._complete[tracker]:
                self._begin(tracker)
        drawn = np.array([n for n in due.tolist() if not self._complete[n]], np.int32)
        if not drawn.size:
            return
        picture = self._views(drawn.size)
        self._sim.draw(drawn, picture, overlay=self._video.overlay)
        for view, tracker in enumerate(drawn.tolist()):
            self._write(tracker, picture, view, int(action[tracker]))
        self.drawn += drawn.size

    def _begin(self, tracker: int) -> None:
        path = self._folder.episode(tracker, len(self.episodes[tracker]))
        found = read_complete(path)
        if found is not None:
            self._labels[tracker] = found
            self._complete[tracker] = True
            return
        writer = EpisodeWriter(path, self._video.fps, target_direction=self._video.target_direction)
        self._writers[tracker] = writer
        self._begun = [begun for begun in self._begun if not begun.finished] + [writer]

    def _views(self, count: int) -> Picture:
        whole = self._picture
        assert whole.rgb is not None
        assert whole.subject_box is not None
        assert whole.subject_pixels is not None
        box, pixels = whole.subject_box[:count], whole.subject_pixels[:count]
        return Picture(whole.rgb[:count], None, None, box, pixels)

    def _write(self, tracker: int, picture: Picture, view: int, action: int) -> None:
        writer, labels = self._writers[tracker], self._labels[tracker]
        assert writer is not None
        assert picture.rgb is not None
        label = label_of(self._sim, tracker, picture, view, len(labels), action)
        labels.append(label)
        self._lanes.submit(tracker, writer.add, label, picture.rgb[view].copy())

    def end(self, trackers: NDArray[np.bool_]) -> None:
        """End the episodes of some trackers, shape (N,); those without frames leave nothing.

        Raises:
            OutputError: The file system refused.
        """
        for tracker in np.flatnonzero(trackers).tolist():
            writer = self._writers[tracker]
            if writer is not None:
                self._lanes.submit(tracker, writer.finish)
            if self._labels[tracker]:
                self.episodes[tracker].append(self._labels[tracker])
            self._writers[tracker] = None
            self._labels[tracker] = []
            self._complete[tracker] = False

    def finish(self) -> None:
        """End all episodes, and describe the whole folder.

        Raises:
            OutputError: The file system refused.
        """
        self.end(np.ones(len(self._writers), np.bool_))
        self._lanes.finish()
        self._folder.write_info(self.episodes)

    def stop(self) -> None:
        """Leave in the middle: every file that is there is whole, begun episodes have no marks."""
        self._lanes.stop()
        for writer in self._begun:
            writer.abandon()
