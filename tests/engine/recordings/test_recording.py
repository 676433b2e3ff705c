"""`eyas.load`: what was recorded comes back, and what is not whole is refused in a line."""

import json
import shutil

import numpy as np
import pytest

import eyas
from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.errors import DataFileError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.state.scene import ObjectClass
from eyas.engine.video import run as video

ARRAYS = ("png", "labels", "masks", "classes", "depth", "arrays", "flow", "normals")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two drones, half a second, everything that can be recorded of pixels."""
    folder = tmp_path_factory.mktemp("loaded") / "run"
    config = EyasConfig(
        camera=CameraConfig(width=64, height=48),
        video=VideoConfig(channels=2, fps=10.0, total_time=0.5, flight="orbit", writers=ARRAYS),
    )
    video.run(config, folder, quiet=True)
    return folder


def test_episodes_and_frames_are_those_of_the_labels(folder):
    recording = eyas.load(folder)
    assert [episode.name for episode in recording] == ["DRONE0-episode0", "DRONE1-episode0"]
    episode = recording[1]
    assert len(episode) == len(episode.labels)
    assert [frame.number for frame in episode] == list(range(len(episode)))
    assert [frame.label for frame in episode[1:3]] == episode.labels[1:3]
    assert episode[-1].label == episode.labels[-1]
    with pytest.raises(IndexError):
        episode[len(episode)]
    assert recording.frame_count == sum(map(len, recording)) == len(list(recording.frames()))
    assert len(recording.split("train")) == 0  # there are no splits outside of a data set


def test_arrays_of_labels_have_a_row_for_each_frame(folder):
    episode = eyas.load(folder)[0]
    assert episode.array("target_box").shape == (len(episode), 4)
    assert episode.array("camera_rotation").shape == (len(episode), 3, 3)
    assert episode.array("command").shape == (len(episode), 4)
    with pytest.raises(DataFileError, match="not all labels have 'target_boxes'"):
        episode.array("target_boxes")


def test_arrays_of_pixels_agree_with_the_lossless_ones(folder):
    for frame in eyas.load(folder).frames():
        exact = frame.arrays()
        seen = np.isfinite(exact["depth"]) & (exact["depth"] < 650)
        assert np.abs(frame.depth()[seen] - exact["depth"][seen]).max() <= 0.006
        assert (frame.classes() == exact["class_id"]).all()
        masks = frame.masks()
        moving = exact["class_id"] >= ObjectClass.CAR
        moving &= exact["class_id"] != ObjectClass.SKY
        assert (masks[moving] == exact["object_id"][moving]).all()
        assert (masks[~moving] == 0).all()
        assert (frame.picture()[0, 0] <= 255).all()
        normals = frame.normals()[seen]
        assert np.allclose(np.linalg.norm(normals, axis=-1), 1.0, atol=0.03)


def test_flow_is_of_pixels_and_the_last_frame_has_none(folder):
    episode = eyas.load(folder)[0]
    flow, known = episode[0].flow()
    assert flow.shape == (48, 64, 2)
    assert known.mean() > 0.5
    assert 0.0 < np.abs(flow[known]).max() < 64
    assert not episode[-1].flow()[1].any()


def test_pytorch_gets_batches_of_pictures_and_masks(folder):
    data = pytest.importorskip("torch.utils.data")
    frames = eyas.load(folder).as_torch("masks")
    assert len(frames) == eyas.load(folder).frame_count
    last = eyas.load(folder)[1][-1]
    assert (frames[len(frames) - 1]["picture"] == last.picture()).all()
    assert (frames[-1]["masks"] == last.masks()).all()

    def collated(items):
        return data.default_collate([(item["picture"], item["masks"]) for item in items])

    pictures, masks = next(iter(data.DataLoader(frames, batch_size=4, collate_fn=collated)))
    assert tuple(pictures.shape) == (4, 48, 64, 3)
    assert tuple(masks.shape) == (4, 48, 64)


def test_what_was_not_recorded_is_told(folder, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(folder, copy)
    shutil.rmtree(copy / "DRONE0/episode0/masks")
    with pytest.raises(DataFileError, match=r"masks/000000\.png: missing"):
        eyas.load(copy)


def break_off(copy):
    (copy / "checksums.sha256").rename(copy / ".checksums")


def lose_settings(copy):
    (copy / "config.json").unlink()


def name_code(copy):
    settings = json.loads((copy / "config.json").read_text())
    settings["world"]["map"] = "no_such.module:Map"
    (copy / "config.json").write_text(json.dumps(settings))


@pytest.mark.parametrize(
    ("breaks", "told"), [(break_off, "in progress"), (lose_settings, "not a recording")]
)
def test_a_recording_that_is_not_whole_is_refused(folder, tmp_path, breaks, told):
    copy = tmp_path / "copy"
    shutil.copytree(folder, copy)
    breaks(copy)
    with pytest.raises(DataFileError, match=told) as error:
        eyas.load(copy)
    assert "\n" not in str(error.value)


def test_settings_that_name_code_are_read_and_nothing_is_run(folder, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(folder, copy)
    name_code(copy)
    assert eyas.load(copy).frame_count == eyas.load(folder).frame_count


def test_a_folder_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(DataFileError, match="not a recording"):
        eyas.load(tmp_path / "nothing")
