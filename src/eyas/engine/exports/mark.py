"""`mark.json` and `dir_info.json`, as the original writes them."""

import json
import math
from collections.abc import Sequence
from pathlib import Path

from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import write_atomic
from eyas.engine.exports.frame import Frame
from eyas.engine.exports.writer import EndedEpisode, Episode, Files, Gather, Run, Summary, Writer

__all__ = ["MarkWriter"]

MARK, DIR_INFO = "mark.json", "dir_info.json"

Mark = int | list[float | None]


class MarkWriter(Writer):
    """Writes a mark for each frame, and the number of frames of each episode of each tracker.

    A mark is `[reward, action]`, or the target's direction (0 stop, 1 straight, 2 left, 3 right).

    Args:
        run: The recording.
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
