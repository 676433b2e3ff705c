"""MOTChallenge: `EYAS-<split>/<episode>/{img1, gt, det, seqinfo.ini}`, `seqmaps/EYAS-<split>.txt`.

Frames, columns and rows of pixels are counted from 1. In `gt/gt.txt` everything has class 1,
pedestrian, the only one that the challenge's own evaluation counts: with class 3, car, truth
against itself has a HOTA of 0. The true classes are in `gt/gt_class.txt`, numbered as the lines of
`gt/labels.txt`.

A box is the extent inside the picture, hidden parts included; its visibility is the share that is
neither hidden nor outside the picture. `det/det.txt` has the visible extents, as from a perfect
detector, for trackers that want detections.
"""

from collections.abc import Iterable, Sequence

from eyas.engine.recordings.format import (
    CLASS_NAMES,
    Exported,
    Format,
    by_split,
    left_top_width_height,
    lines,
    objects_of,
    picture_ending,
    split_of,
)
from eyas.engine.recordings.recording import RecordedEpisode

BENCHMARK = "EYAS"
COUNTED = 1  # The class of everything in the main file: pedestrian


class Mot(Format):
    """MOTChallenge, as TrackEval reads it."""

    needs = frozenset({"jpeg", "labels"})

    def add(self, episode: RecordedEpisode) -> None:
        """Write its sequence."""
        folder = f"{BENCHMARK}-{split_of(episode)}/{episode.name}"
        self.job.place_all(episode, f"{folder}/img1", 1, 6)
        names = list(CLASS_NAMES.values())
        truth, classes, detections = [], [], []
        for frame in episode:
            for seen in objects_of(frame.label):
                label = seen.label
                visibility = label["visible_fraction"] * (1.0 - label["truncated"])
                left, top, *size = left_top_width_height(label["box"])
                box = (frame.number + 1, label["id"], left + 1, top + 1, *size)
                counts = int(not self.job.ignores(seen))
                truth.append((*box, counts, COUNTED, f"{visibility:.6g}"))
                classes.append((*box, counts, names.index(seen.name) + 1, f"{visibility:.6g}"))
                left, top, *size = left_top_width_height(label["visible_box"])
                detections.append((frame.number + 1, -1, left + 1, top + 1, *size, 1, -1, -1, -1))
        self.job.write(f"{folder}/gt/gt.txt", lines(truth))
        self.job.write(f"{folder}/gt/gt_class.txt", lines(classes))
        self.job.write(f"{folder}/gt/labels.txt", lines(names))
        self.job.write(f"{folder}/det/det.txt", lines(detections))
        self.job.write(f"{folder}/seqinfo.ini", lines(_sequence(episode)))

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Write the list of each split's sequences."""
        for split, group in by_split(episodes).items():
            names = [episode.name for episode in group]
            self.job.write(f"seqmaps/{BENCHMARK}-{split}.txt", lines(["name", *names]))


def _sequence(episode: RecordedEpisode) -> Iterable[str]:
    width, height = episode.size
    facts = {
        "name": episode.name,
        "imDir": "img1",
        "frameRate": f"{episode.fps:g}",
        "seqLength": len(episode),
        "imWidth": width,
        "imHeight": height,
        "imExt": f".{picture_ending(episode)}",
    }
    return ["[Sequence]", *(f"{key}={value}" for key, value in facts.items())]
