"""COCO, for pictures and for videos: one `annotations/<split>.json`, masks as run-length codes.

Beyond https://cocodataset.org/#format-data: `videos`, `video_id`, `frame_id` and `track_id`, as the
data sets of video instances have them (TAO, YouTube-VIS), and `visibility`, `words`, `is_target`.

`bbox` is the extent of the visible pixels, what a detector can see and the extent of the mask;
`amodal_bbox` that of the whole object inside the picture, hidden parts included. An object that is
to be ignored has `iscrowd`: detections on it count neither way.
"""

import json
from collections.abc import Sequence
from typing import Any

from eyas.datasets.rle import encoded_masks
from eyas.engine.core.files import atomic_path
from eyas.engine.recordings.format import (
    CLASS_NAMES,
    Exported,
    Format,
    by_split,
    left_top_width_height,
    numbered,
    objects_of,
    picture_ending,
    split_of,
)
from eyas.engine.recordings.recording import RecordedEpisode, RecordedFrame

Row = dict[str, Any]


class Coco(Format):
    """`<split>/<episode>/NNNNNN.jpg`, `annotations/<split>.json`."""

    needs = frozenset({"jpeg", "labels", "masks"})

    def add(self, episode: RecordedEpisode) -> None:
        """Place its pictures, and keep its annotations."""
        frames = []
        ending, folder = picture_ending(episode), f"{split_of(episode)}/{episode.name}"
        for frame in episode:
            inside = f"{folder}/{numbered(frame, 0, 6, ending)}"
            self.job.place(episode.picture_file(frame.number), inside)
            frames.append((self._image(frame, inside), self._annotations(frame)))
        self.job.keep(episode, {"fps": episode.fps, "frames": frames})

    def _image(self, frame: RecordedFrame, inside: str) -> Row:
        label = frame.label
        size = {"width": label["width"], "height": label["height"]}
        return {"file_name": inside, **size, "frame_id": frame.number}

    def _annotations(self, frame: RecordedFrame) -> list[Row]:
        masks = frame.masks()
        codes, height, width = encoded_masks(masks), *masks.shape
        rows = []
        for seen in objects_of(frame.label):
            label = seen.label
            counts, area = codes[label["id"]]
            row = {
                "category_id": list(CLASS_NAMES.values()).index(seen.name) + 1,
                "bbox": left_top_width_height(label["visible_box"]),
                "area": area,
                "iscrowd": int(self.job.ignores(seen)),
                "segmentation": {"size": [height, width], "counts": counts},
                "amodal_bbox": left_top_width_height(label["box"]),
                "track_id": label["id"],
                "visibility": label["visible_fraction"],
                "words": label["words"],
                "is_target": seen.is_target,
            }
            rows.append(row)
        return rows

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Write the annotations of each split."""
        for split, group in by_split(episodes).items():
            self._write(split, group)

    def _write(self, split: str, episodes: Sequence[Exported]) -> None:
        """Write one file, with the rows of one episode in memory at a time."""
        path = self.job.folder / "annotations" / f"{split}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        videos, tracks = [], 0
        with atomic_path(path) as part, part.open("w") as file:
            file.write('{"info": ' + json.dumps({"description": self.job.name}))
            file.write(', "licenses": [], "categories": ' + json.dumps(_categories()))
            file.write(', "annotations": [')
            images: list[Row] = []
            written = 0
            for video, episode in enumerate(episodes, 1):
                kept = self.job.kept(episode.name)
                videos.append({"id": video, "name": episode.name, "fps": kept["fps"]})
                own: dict[int, int] = {}  # an id of an episode is unique in the file as well
                for image, rows in kept["frames"]:
                    images.append({"id": len(images) + 1, **image, "video_id": video})
                    for row in rows:
                        track = own.setdefault(row["track_id"], tracks + len(own) + 1)
                        ids = {"id": written + 1, "image_id": len(images), "video_id": video}
                        whole = {**row, **ids, "track_id": track, "instance_id": track}
                        file.write((",\n" if written else "\n") + json.dumps(whole))
                        written += 1
                tracks += len(own)
            file.write('], "images": ' + json.dumps(images))
            file.write(', "videos": ' + json.dumps(videos) + "}\n")


def _categories() -> list[Row]:
    return [{"id": number, "name": name} for number, name in enumerate(CLASS_NAMES.values(), 1)]
