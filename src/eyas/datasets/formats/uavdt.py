"""UAVDT's detection and multi-object tracking: `UAV-benchmark-M/<episode>/imgNNNNNN.jpg`,
`UAV-benchmark-MOTD_v1.0/GT/<episode>_gt{,_whole,_ignore}.txt`, `M_attr/<split>/<episode>_attr.txt`.

https://sites.google.com/view/daweidu/projects/uavdt. Frames are counted from 1, boxes are left,
top, width, height [pixels] of the whole object inside the picture. Its classes are car, truck and
bus; motorcycles, what is more than half outside the picture, and what is to be ignored are in
`_gt_ignore.txt`, people and robots nowhere. The splits `train` and `val` are UAVDT's `train`.
"""

import math
from collections.abc import Sequence

from eyas.engine.core.frames import wrap_angle
from eyas.engine.exports.label import Label
from eyas.engine.recordings.format import (
    Format,
    SeenObject,
    left_top_width_height,
    lines,
    objects_of,
)
from eyas.engine.recordings.recording import RecordedEpisode
from eyas.engine.state.scene import ObjectClass
from eyas.lanes import exact, interpreted

CATEGORIES = {ObjectClass.CAR: 1, ObjectClass.TRUCK: 2, ObjectClass.BUS: 3}
IGNORED = (1, -1, -1)  # The last columns of an ignored box
LOW, HIGH = 30.0, 70.0  # Altitudes up to which a sequence is low, and from which it is high [m]
LONG_TERM = 1500  # Number of frames from which a sequence is long
STEEP = math.radians(60.0)  # Pitch of the camera from which it looks as a bird does

_wrapped = interpreted(wrap_angle)


class Uavdt(Format):
    """UAVDT-M."""

    needs = frozenset({"jpeg", "labels"})

    def add(self, episode: RecordedEpisode) -> None:
        """Write its sequence."""
        name = episode.name
        self.job.place_all(episode, f"UAV-benchmark-M/{name}", 1, 6, "img")
        counted, whole, ignored = [], [], []
        for frame in episode:
            for seen in objects_of(frame.label):
                label = seen.label
                box = left_top_width_height(label["box"])
                row = (frame.number + 1, label["id"], *box)
                category = CATEGORIES.get(ObjectClass(label["class_id"]))
                if category is None and label["class_id"] != ObjectClass.MOTORCYCLE:
                    continue
                if category is None or label["truncated"] > 0.5 or self.job.ignores(seen):
                    ignored.append((*row, *IGNORED))
                else:
                    counted.append((*row, 1, category, -1))
                    whole.append((*row, *_levels(seen), category))
        truth = f"UAV-benchmark-MOTD_v1.0/GT/{name}_gt"
        self.job.write(f"{truth}.txt", lines(counted))
        self.job.write(f"{truth}_whole.txt", lines(whole))
        self.job.write(f"{truth}_ignore.txt", lines(ignored))
        folder = "test" if episode.split == "test" else "train"
        self.job.write(f"M_attr/{folder}/{name}_attr.txt", lines([_attributes(episode)]))


def _levels(seen: SeenObject) -> tuple[int, int]:
    """Return UAVDT's levels of what is out of view (1 none, 2 medium, 3 small: up to 30 %), and of
    what is hidden (1 none, 2 large: over 70 %, 3 medium, 4 small: up to 30 %).
    """
    outside, hidden = seen.label["truncated"], 1.0 - seen.label["visible_fraction"]
    out_of_view = 1 if outside <= 0.0 else 3 if outside <= 0.3 else 2
    occlusion = 1 if hidden <= 0.0 else 4 if hidden <= 0.3 else 3 if hidden <= 0.7 else 2
    return out_of_view, occlusion


def _attributes(episode: RecordedEpisode) -> list[int]:
    """Return which attributes hold: daylight, night, fog; low, medium, high; views; long."""
    weather, labels = episode.config.world.weather, episode.labels
    night, fog = "night" in weather, "fog" in weather
    altitude = sorted(_altitude(label) for label in labels)[len(labels) // 2]
    view = _view(labels)
    facts = [
        not night and not fog,
        night,
        fog,
        altitude <= LOW,
        LOW < altitude < HIGH,
        altitude >= HIGH,
        *(view == name for name in ("front", "side", "bird")),
        len(labels) >= LONG_TERM,
    ]
    return [int(fact) for fact in facts]


def _altitude(label: Label) -> float:
    return float(label["camera_position"][2] - label["target_position"][2])


def _view(labels: Sequence[Label]) -> str:
    """Return how the target is seen in the middle of the sequence."""
    label = labels[len(labels) // 2]
    forward = [row[0] for row in label["camera_rotation"]]
    if -forward[2] >= exact.sin(STEEP):
        return "bird"
    turn = _wrapped(label["target_yaw"] - float(exact.atan2(forward[1], forward[0])))
    return "side" if math.pi / 4 < abs(turn) < 3 * math.pi / 4 else "front"
