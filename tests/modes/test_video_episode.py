from pathlib import Path

import numpy as np
import pytest

from eyas.exports.labels import FrameLabel
from eyas.modes.video.episode import EpisodeWriter, read_complete


def label(frame: int) -> FrameLabel:
    return FrameLabel(
        frame=frame,
        time=1.0,
        step=31,
        episode_time=0.062,
        target_box=[10, 11, 20, 17],
        visible_fraction=1.0,
        occluded=False,
        in_view=True,
        tracker_position=[0.0, 0.0, 22.0],
        tracker_velocity=[0.0, 0.0, 0.0],
        tracker_orientation=[1.0, 0.0, 0.0, 0.0],
        camera_position=[0.1, 0.0, 22.0],
        camera_rotation=[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        target_type="BmwX5Simple",
        target_size=[4.6, 1.9, 1.7],
        target_position=[14.0, 2.0, 0.37],
        target_centre=[13.0, 2.0, 0.37],
        target_velocity=[13.0, 0.0, 0.0],
        target_yaw=0.0,
        relative_position=[13.0, 2.0, -21.63],
        reward=0.5,
        action=-1,
        direction=1,
        done=False,
    )


def write(folder: Path, frames: int) -> EpisodeWriter:
    writer = EpisodeWriter(folder, 25.0, target_direction=False)
    for frame in range(frames):
        writer.add(label(frame), np.full((48, 64, 3), 40 * frame, np.uint8))
    return writer


def test_a_finished_episode_is_complete(tmp_path):
    write(tmp_path / "episode0", 3).finish()
    assert read_complete(tmp_path / "episode0") == [label(frame) for frame in range(3)]


@pytest.mark.parametrize("name", ["mark.json", "labels.jsonl", "episode.mp4", "000001.jpeg"])
def test_an_episode_that_misses_a_file_is_not_complete(tmp_path, name):
    write(tmp_path / "episode0", 3).finish()
    (tmp_path / "episode0" / name).unlink()
    assert read_complete(tmp_path / "episode0") is None


def test_an_abandoned_episode_keeps_its_pictures_only(tmp_path):
    write(tmp_path / "episode0", 2).abandon()
    names = sorted(path.name for path in (tmp_path / "episode0").iterdir())
    assert names == ["000000.jpeg", "000001.jpeg"]
    assert read_complete(tmp_path / "episode0") is None


def test_an_episode_that_is_drawn_anew_leaves_nothing_of_the_old(tmp_path):
    write(tmp_path / "episode0", 5).finish()
    write(tmp_path / "episode0", 2).finish()
    assert len(list((tmp_path / "episode0").glob("*.jpeg"))) == 2


def test_an_episode_without_frames_leaves_no_folder(tmp_path):
    write(tmp_path / "episode0", 0).abandon()
    assert list(tmp_path.iterdir()) == []
