"""`labels.jsonl`: the data of each frame, one JSON object per line."""

import json
import math
from collections.abc import Sequence
from pathlib import Path

from eyas.core.errors import DataFileError
from eyas.exports.files import Files
from eyas.exports.gather import Gather
from eyas.exports.label import Label, checked, label_of
from eyas.exports.summary import Scores, Summary
from eyas.exports.writer import Episode, Writer

__all__ = ["LabelWriter", "read_labels"]

LABELS = "labels.jsonl"


class LabelWriter(Writer):
    """`labels.jsonl`."""

    wants = frozenset({"others"})
    files = Files(episode=(LABELS,))

    def begin(self, episode: Episode) -> Gather[Label]:
        """Return the writer of an episode's labels."""
        return Gather(episode.folder / LABELS, lambda frame: label_of(frame, episode), _encoded)

    def read(self, folder: Path) -> Summary | None:
        """Return the summary of the labels; None if they are missing or cut off."""
        scores = Scores()
        try:
            labels = read_labels(folder / LABELS)
            for label in labels:
                reward = math.nan if label["reward"] is None else label["reward"]
                scores = scores.plus(reward, seen=label["visible_fraction"] > 0.0)
        except (DataFileError, TypeError, OverflowError):  # a field may hold anything
            return None
        return Summary(len(labels), scores)


def _encoded(labels: Sequence[Label]) -> bytes:
    return "".join(json.dumps(label, allow_nan=False) + "\n" for label in labels).encode()


def read_labels(path: Path) -> list[Label]:
    """Return the labels of an episode, one for each frame, see docs/labels.md.

    Raises:
        DataFileError: The file is missing, cut off, or does not hold labels.
    """
    labels = []
    try:
        text = path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise DataFileError(f"{path}: cannot read: {error}") from error
    for number, line in enumerate(text.splitlines(), 1):
        try:
            record = json.loads(line)
        except (ValueError, RecursionError):
            raise DataFileError(f"{path}: line {number} is cut off or not JSON") from None
        try:
            labels.append(checked(record))
        except (TypeError, ValueError):
            raise DataFileError(f"{path}: line {number} is not the label of a frame") from None
    return labels
