"""Episodes from the first frame in which their target is visible, with which trackers begin."""

from functools import cached_property
from pathlib import Path

from eyas.engine.exports.label import Label
from eyas.engine.recordings.recording import RecordedEpisode

__all__ = ["from_first_sight"]


def from_first_sight(episode: RecordedEpisode) -> RecordedEpisode | None:
    """Return the rest of an episode, whose frames count from 0 again; None if its target is never
    visible.
    """
    for label in episode.labels:
        if label["visible_fraction"] > 0.0:
            return _Later(episode, label["frame"]) if label["frame"] else episode
    return None


class _Later(RecordedEpisode):
    """An episode without its first frames."""

    def __init__(self, whole: RecordedEpisode, skipped: int) -> None:
        super().__init__(whole.name, whole.folder, whole.split, whole.config)
        self._whole, self._skipped = whole, skipped

    @cached_property
    def labels(self) -> list[Label]:
        left = self._whole.labels[self._skipped :]
        return [{**label, "frame": number} for number, label in enumerate(left)]

    @cached_property
    def frame_count(self) -> int:
        return self._whole.frame_count - self._skipped

    def file(self, output: str, number: int) -> Path:
        return self._whole.file(output, number + self._skipped)
