"""Recordings with all that pictures may hold: continued, replaced, and the same to the byte."""

import cv2
import numpy as np
import pytest

from eyas.engine.core.errors import OutputError
from eyas.engine.exports.label import read_labels
from eyas.engine.settings.config import EyasConfig
from eyas.engine.video import run as video

WRITERS = ("png", "labels", "masks", "classes", "depth", "normals", "arrays", "flow", "sensors")
CONFIG = EyasConfig(
    seed=2,
    camera={"width": 84, "height": 60},
    done={"total_steps": 200},
    video={"channels": 2, "total_time": 0.8, "fps": 25.0, "writers": WRITERS, "depth_unit": 0.02},
)


def contents(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recorded") / "run"
    video.run(CONFIG, folder, quiet=True)
    return folder


def picture(episode, kind, number=0):
    return cv2.imread(str(episode / f"{kind}{number:06d}.png"), cv2.IMREAD_UNCHANGED)


def test_files_of_a_frame_agree(recorded):
    episode = recorded / "DRONE1" / "episode0"
    labels = read_labels(episode / "labels.jsonl")
    assert len(list(recorded.glob("*/episode*"))) > 2
    for number, label in enumerate(labels):
        masks, depth = picture(episode, "masks/", number), picture(episode, "depth/", number)
        with np.load(episode / f"arrays/{number:06d}.npz") as file:
            assert np.array_equal(np.maximum(file["object_id"] - 65535, 0), masks)
            assert np.array_equal(file["class_id"], picture(episode, "classes/", number))
            far = file["depth"]
        known = depth > 0
        assert np.abs(far[known] - 0.02 * depth[known]).max() <= 0.0101
        told = {each["id"] for each in label["others"]} | {label["target_id"]}
        assert set((masks[masks > 0].astype(int) + 65535).tolist()) <= told
        assert picture(episode, "flow/", number)[..., 0].any() == (number + 1 < len(labels))
    rows = (episode / "sensors.csv").read_text().splitlines()
    assert len(rows) == len(labels) + 1


def test_a_continued_recording_is_the_same(recorded):
    before = contents(recorded)
    (recorded / "DRONE0/episode1/masks/000002.png").unlink()
    (recorded / "DRONE1/episode1/flow/000001.png").write_bytes(b"damaged")
    video.run(CONFIG, recorded, resume=True, quiet=True)
    assert contents(recorded) == before


def test_it_can_be_replaced_unless_something_else_lies_in_it(recorded):
    before = contents(recorded)
    (recorded / "DRONE0/episode0/masks/mine.png").write_bytes(b"")
    with pytest.raises(OutputError, match=r"'DRONE0/episode0/masks/mine\.png' is not part"):
        video.run(CONFIG, recorded, overwrite=True, quiet=True)
    (recorded / "DRONE0/episode0/masks/mine.png").unlink()
    video.run(CONFIG, recorded, overwrite=True, quiet=True)
    assert contents(recorded) == before
