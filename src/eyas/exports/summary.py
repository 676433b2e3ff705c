"""Summary of frames: their number, their rewards, how often the target is visible."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from eyas.exports.frame import Frame

__all__ = ["Scores", "Summary", "total"]


@dataclass(frozen=True, slots=True)
class Scores:
    """Sums over frames."""

    rewarded: int = 0
    """Frames whose reward is a finite number."""
    reward: float = 0.0
    """Sum of those rewards."""
    sightings: int = 0
    """Frames in which a pixel of the target is visible."""

    def plus(self, reward: float, *, seen: bool) -> "Scores":
        """Return the sums including one more frame."""
        finite = math.isfinite(reward)
        return Scores(
            self.rewarded + finite,
            self.reward + (reward if finite else 0.0),
            self.sightings + seen,
        )


@dataclass(frozen=True, slots=True)
class Summary:
    """Summary of some frames."""

    frames: int
    """Number of frames."""
    scores: Scores | None = None
    """None if the files do not contain them."""

    def plus(self, frame: Frame) -> "Summary":
        """Return the summary including one more frame."""
        seen = frame.target.seen_pixels > 0
        scores = self.scores and self.scores.plus(frame.reward, seen=seen)
        return Summary(self.frames + 1, scores)


def total(summaries: Iterable[Summary]) -> Summary:
    """Return the summary of some episodes; its scores are None if those of any episode are."""
    listed = list(summaries)
    scores = [summary.scores for summary in listed if summary.scores is not None]
    whole = Scores(
        sum(each.rewarded for each in scores),
        sum(each.reward for each in scores),
        sum(each.sightings for each in scores),
    )
    frames = sum(summary.frames for summary in listed)
    return Summary(frames, whole if len(scores) == len(listed) else None)
