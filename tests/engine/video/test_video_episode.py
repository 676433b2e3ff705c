import shutil
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.camera.esim import EVENT
from eyas.engine.camera.events import EventsConfig
from eyas.engine.core.errors import OutputError
from eyas.engine.exports.capture import FrameMoment, frame_of
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.exports.registry import WRITERS, chosen_writers
from eyas.engine.exports.writer import Episode, EpisodeWriter, Files, Run, Scores, Summary, Writer
from eyas.engine.sensors.config import LidarConfig
from eyas.engine.sim.config import SimConfig
from eyas.engine.state.draw import MovingParts, Picture
from eyas.engine.state.motion import ActorState, ActorView
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.video import run
from eyas.engine.video.episode import EpisodeFiles, read_complete

SENSORS = SimConfig(
    lidar=LidarConfig(enabled=True), camera=CameraConfig(events=EventsConfig(enabled=True))
)
RUN = Run(
    Path("unused"), ("DRONE0",), SENSORS, target_direction=False, jpeg_quality=95,
    depth_unit=0.01,
)  # fmt: skip


def writers_of(*names: str) -> list[Writer]:
    return [writer(RUN) for writer in chosen_writers(names or WRITERS.built_in)]


def write(folder: Path, frames: int, writers: list[Writer] | None = None) -> EpisodeFiles:
    episode = Episode(folder, "DRONE0", 0, 64, 48, np.eye(3), 25.0)
    files = EpisodeFiles(writers or writers_of(), episode)
    snapshot, picture = (
        Snapshot.create(1),
        Picture.create(
            1, 48, 64, subject=True, depth=True, object_id=True, class_id=True, normal=True
        ),
    )
    snapshot.targets.actor[:] = 0
    car, looks = ActorState.create(1, 1), (np.zeros(1, np.int32), np.zeros((1, 3), np.float32))
    car.present[:] = True
    traffic = ActorView(car, car, *looks)
    snapshot.episodes.reward[:] = 0.5
    picture.subject_pixels[:] = 4, 5
    for number in range(frames):
        picture.rgb[:] = 40 * number
        action, now = RecordedAction(-1, None), snapshot.episodes
        told = {"lidar": np.ones(400), "sensors": np.ones(19), "events": np.zeros(0, EVENT)}
        told |= {"parts": PARTS, "clean": picture.rgb[0].copy(), "traffic": traffic}
        moment = FrameMoment(snapshot, now, further=told)
        files.add(frame_of(moment, 0, picture, 0, number, action))
    return files


PARTS = MovingParts(
    np.full((48, 64), -1, np.int32), np.ones((48, 64), np.float32), np.zeros(0, np.int32),
    np.zeros((0, 3, 4), np.float32),
)  # fmt: skip
BAGS = ["rosbag/.rosbag_0.db3.part", "rosbag-mcap/.rosbag-mcap_0.mcap.part"]
PICTURES = sorted(
    f"{place}{number:06d}.{kind}"
    for place, kind in (
        *(("", "jpeg"), ("", "png"), ("masks/", "png"), ("classes/", "png"), ("depth/", "png")),
        *(("normals/", "png"), ("clean/", "png")),
        *(("arrays/", "npz"),),
    )
    for number in range(2)
)
FLOW = ["flow/000000.png"]  # that of the last frame is written at the end


def names_in(folder: Path) -> list[str]:
    return sorted(
        path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()
    )


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """Finished episodes of two and of three frames."""
    folder = tmp_path_factory.mktemp("kept")
    for frames in (2, 3):
        write(folder / str(frames), frames).finish()
    return folder


@pytest.fixture
def finished(kept, tmp_path):
    """A function that lays a finished episode of so many frames in `tmp_path`."""
    return lambda name, frames: shutil.copytree(kept / str(frames), tmp_path / name)


def test_a_finished_episode_is_complete(finished):
    found = read_complete(writers_of(), finished("episode0", 3))
    assert found == Summary(3, Scores(3, 1.5, 3))


@pytest.mark.parametrize(
    "name",
    [
        "mark.json",
        "labels.jsonl",
        "episode.mp4",
        "episode.webp",
        "000001.jpeg",
        "masks/000001.png",
        "sensors.csv",
    ],
)
def test_an_episode_that_misses_a_file_is_not_complete(finished, name):
    episode = finished("episode0", 3)
    (episode / name).unlink()
    assert read_complete(writers_of(), episode) is None


@pytest.mark.parametrize(
    "name",
    [
        "mark.json",
        "labels.jsonl",
        "episode.mp4",
        "episode.webp",
        "000002.jpeg",
        "arrays/000002.npz",
        "flow/000002.png",
    ],
)
def test_an_episode_whose_files_hold_different_numbers_of_frames_is_not_complete(finished, name):
    episode, other = finished("episode0", 2), finished("other", 3)
    assert read_complete(writers_of(), episode) is not None
    (other / name).replace(episode / name)
    assert read_complete(writers_of(), episode) is None


@pytest.mark.parametrize("name", ["mark", "mp4", "webp"])
def test_without_labels_an_episode_is_complete_and_its_rewards_are_unknown(tmp_path, name):
    writers = writers_of(name, "jpeg")
    write(tmp_path / "episode0", 3, writers).finish()
    assert read_complete(writers, tmp_path / "episode0") == Summary(3, None)


def test_pictures_alone_do_not_tell_that_an_episode_has_ended(tmp_path):
    writers = writers_of("jpeg")
    write(tmp_path / "episode0", 3, writers).finish()
    assert read_complete(writers, tmp_path / "episode0") is None


def test_an_abandoned_episode_keeps_its_pictures_only(tmp_path):
    write(tmp_path / "episode0", 2).abandon()
    assert names_in(tmp_path / "episode0") == sorted([*FLOW, *PICTURES])
    assert read_complete(writers_of(), tmp_path / "episode0") is None


@pytest.mark.slow
def test_an_episode_that_is_drawn_anew_leaves_nothing_of_the_old(tmp_path):
    write(tmp_path / "episode0", 5).finish()
    (tmp_path / "episode0" / "notes.txt").write_text("mine")
    files = write(tmp_path / "episode0", 2)
    assert names_in(tmp_path / "episode0") == sorted(
        [".episode.mp4.part", ".episode.webp.part", *BAGS, *FLOW, *PICTURES, "notes.txt"]
    )
    files.finish()


def test_an_episode_without_frames_leaves_no_folder(tmp_path):
    write(tmp_path / "episode0", 0).abandon()
    assert list(tmp_path.iterdir()) == []


class Refusing(Writer):
    """Its part cannot be finished."""

    files = Files(episode=("never.txt",))

    def begin(self, episode: Episode) -> EpisodeWriter:
        return RefusingEpisode()

    def read(self, folder: Path) -> None: ...


class RefusingEpisode(EpisodeWriter):
    def add(self, frame) -> None: ...

    def finish(self) -> None:
        raise OutputError("full")

    def abandon(self) -> None:
        raise OutputError("still full")


def test_what_one_writer_cannot_close_the_others_still_do(tmp_path):
    files = write(tmp_path / "episode0", 2, [Refusing(RUN), *writers_of("mp4")])
    with pytest.raises(OutputError, match="full"):
        files.finish()
    assert not files.finished
    with pytest.raises(OutputError, match="still full"):
        files.abandon()
    assert list((tmp_path / "episode0").iterdir()) == []


@pytest.mark.parametrize(("name", "shows"), [("labels.jsonl", 0), ("0.png", 1), ("a.mp4", 1)])
def test_a_recording_with_something_to_see_says_how(tmp_path, name, shows):
    episode = tmp_path / "DRONE0" / "episode0"
    episode.mkdir(parents=True)
    (episode / name).touch()
    assert [*run._next(tmp_path)] == [("see it", ("eyas", "open", tmp_path))] * shows
