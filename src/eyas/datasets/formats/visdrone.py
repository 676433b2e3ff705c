"""VisDrone's tasks: detection, single-object and multi-object tracking.

http://aiskyeye.com: boxes are left, top, width, height [pixels], here of the whole object inside
the picture, hidden parts included. Score is 1, and 0 for what is ignored: what is more than half
outside the picture, as in the challenge, and the class `others`. Truncation is 1 where a part is
outside the picture; occlusion is 0 for nothing, 1 for up to half, 2 for more.
"""

from collections.abc import Iterator

from eyas.datasets.formats.kitti import occlusion_level
from eyas.datasets.formats.sot import target_boxes
from eyas.engine.recordings.format import (
    ExportJob,
    Format,
    SeenObject,
    left_top_width_height,
    lines,
    numbered,
    objects_of,
    picture_ending,
    split_of,
)
from eyas.engine.recordings.recording import RecordedEpisode
from eyas.engine.state.scene import ObjectClass

OTHERS = 11
CATEGORIES = {
    ObjectClass.CAR: 4,
    ObjectClass.TRUCK: 6,
    ObjectClass.BUS: 9,
    ObjectClass.MOTORCYCLE: 10,
    ObjectClass.PERSON: 1,
    ObjectClass.ROBOT: OTHERS,
    ObjectClass.BICYCLE: 3,
    ObjectClass.BOAT: OTHERS,
    ObjectClass.TRAIN: OTHERS,
}
"""VisDrone's own numbers: 1 pedestrian, 3 bicycle, 4 car, 6 truck, 9 bus, 10 motor, 11 others."""

Row = tuple[int, ...]


def _row(seen: SeenObject, job: ExportJob) -> Row:
    """Return box, score, category, truncation and occlusion."""
    label = seen.label
    category = CATEGORIES[ObjectClass(label["class_id"])]
    ignored = category == OTHERS or label["truncated"] > 0.5 or job.ignores(seen)
    return (
        *left_top_width_height(label["box"]),
        int(not ignored),
        category,
        int(label["truncated"] > 0.0),
        occlusion_level(label["visible_fraction"]),
    )


def _root(task: str, episode: RecordedEpisode) -> str:
    """Return the folder of a split, with the name that readers of VisDrone expect."""
    return f"VisDrone2019-{task}-{split_of(episode)}"


class VisDroneDet(Format):
    """VisDrone-DET: `VisDrone2019-DET-<split>/{images, annotations}`, a text for each picture."""

    needs = frozenset({"jpeg", "labels"})

    def add(self, episode: RecordedEpisode) -> None:
        """Place its pictures, and write their annotations."""
        root, ending = _root("DET", episode), picture_ending(episode)
        for frame in episode:
            name = f"{episode.name}_{numbered(frame, 0, 6, ending)}"
            self.job.place(episode.picture_file(frame.number), f"{root}/images/{name}")
            rows = lines(_row(seen, self.job) for seen in objects_of(frame.label))
            self.job.write(f"{root}/annotations/{name.removesuffix(ending)}txt", rows)


class VisDroneMot(Format):
    """VisDrone-MOT: `VisDrone2019-MOT-<split>/{sequences, annotations}`, a text for each sequence,
    with frame, from 1, and track before the columns of detection.
    """

    needs = frozenset({"jpeg", "labels"})

    def add(self, episode: RecordedEpisode) -> None:
        """Write its sequence."""
        root = _root("MOT", episode)
        self.job.place_all(episode, f"{root}/sequences/{episode.name}", 1, 7)
        self.job.write(f"{root}/annotations/{episode.name}.txt", lines(self._rows(episode)))

    def _rows(self, episode: RecordedEpisode) -> Iterator[Row]:
        for frame in episode:
            for seen in objects_of(frame.label):
                yield frame.number + 1, seen.label["id"], *_row(seen, self.job)


class VisDroneSot(Format):
    """VisDrone-SOT: `VisDrone2019-SOT-<split>/{sequences, annotations}`, pictures
    `imgNNNNNNN.jpg`, and a box of the target for each.
    """

    needs = frozenset({"jpeg", "labels"})
    first_sight = True

    def add(self, episode: RecordedEpisode) -> None:
        """Write its sequence."""
        root, name = _root("SOT", episode), episode.name
        self.job.place_all(episode, f"{root}/sequences/{name}", 1, 7, "img")
        boxes = target_boxes(episode.labels).tolist()
        self.job.write(f"{root}/annotations/{name}.txt", lines(boxes))
