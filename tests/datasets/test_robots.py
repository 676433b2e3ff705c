"""Formats of robot learning and of viewers, read by their owners' own readers."""

import json
import subprocess
import sys
import tarfile
import warnings

import numpy as np
import pytest

from eyas.datasets.motion import motion_of
from eyas.engine.camera.config import CameraConfig
from eyas.engine.recordings.export import ExportOptions, export
from eyas.engine.recordings.recording import load
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.video import run as video


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A recording of two drones with actions, one second each."""
    folder = tmp_path_factory.mktemp("robots") / "first flight"
    config = EyasConfig(
        camera=CameraConfig(width=64, height=48),
        video=VideoConfig(
            channels=2, fps=10.0, total_time=1.0, flight="random",
            writers=("png", "labels", "mp4"),
        ),
    )  # fmt: skip
    video.run(config, folder, quiet=True)
    return load(folder)


@pytest.fixture
def exported(recorded, tmp_path):
    def run(name):
        folder = tmp_path / name
        export(recorded, name, folder, ExportOptions())
        return folder

    return run


def test_minari_reads_exact_pictures_and_the_actions_between_them(exported, recorded, monkeypatch):
    minari = pytest.importorskip("minari")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(exported("minari")))
    data = minari.load_dataset("eyas/first-flight-v0")
    assert data.total_steps == sum(len(episode) - 1 for episode in recorded)
    for read, episode in zip(data.iterate_episodes(), recorded, strict=True):
        pictures = np.stack([frame.picture() for frame in episode])
        assert (read.observations["image"] == pictures).all()
        commands = [label["command"] for label in episode.labels[1:]]
        assert np.allclose(read.actions, commands)
        assert np.allclose(read.rewards, episode.array("reward")[1:], equal_nan=True)
        assert not read.truncations[:-1].any()
        assert read.truncations[-1] or read.terminations[-1]


def test_webdataset_yields_every_frame_of_every_episode(exported, recorded):
    webdataset = pytest.importorskip("webdataset")
    shards = sorted(map(str, exported("webdataset").glob("train-*.tar")))
    assert len(shards) == len(recorded)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        read = webdataset.WebDataset(shards, shardshuffle=False).decode("rgb8")
        samples = list(read)
    frames = [frame for episode in recorded for frame in episode]
    assert len(samples) == len(frames)
    for sample, frame in zip(samples, frames, strict=True):
        assert (sample["png"] == frame.picture()).all()
        assert sample["json"] == frame.label


def test_tar_files_tell_no_date_and_no_owner(exported):
    with tarfile.open(next(exported("webdataset").glob("*.tar"))) as tar:
        assert {(one.mtime, one.uid, one.uname) for one in tar} == {(0, 0, "")}


def test_rerun_verifies_its_files(exported, recorded):
    folder = exported("rerun")
    pytest.importorskip("rerun")
    files = list(folder.glob("train/*.rrd"))
    assert len(files) == len(recorded)
    command = [sys.executable, "-m", "rerun", "rrd", "verify", *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    assert f"{len(files)} files verified" in done.stdout + done.stderr


def test_mcap_reads_a_message_of_each_topic_for_each_frame(exported, recorded):
    pytest.importorskip("mcap")
    from mcap.reader import make_reader

    folder = exported("mcap")
    for episode in recorded:
        with (folder / "train" / f"{episode.name}.mcap").open("rb") as file:
            messages = list(make_reader(file, validate_crcs=True).iter_messages())
        topics = [channel.topic for _, channel, _ in messages]
        assert {topics.count(topic) for topic in topics} == {len(episode)}
        labels = [json.loads(one.data) for _, channel, one in messages if channel.topic == "/label"]
        assert labels == episode.labels


def test_an_action_is_what_was_commanded_or_else_what_was_flown(tmp_path):
    config = EyasConfig(
        camera=CameraConfig(width=32, height=24),
        video=VideoConfig(channels=1, fps=50.0, total_time=0.5, flight="exact",
                          writers=("png", "labels")),
    )  # fmt: skip
    video.run(config, tmp_path / "exact", quiet=True)
    (episode,) = load(tmp_path / "exact")
    motion = motion_of(episode)
    assert episode.labels[1]["command"] is None
    # It moves with its target, whose speed along its own heading the drone's axes turn only.
    speeds = np.linalg.norm(episode.array("target_velocity")[1:, :2], axis=1)
    flown = np.linalg.norm(motion.actions[:-1, :2], axis=1)
    assert np.allclose(flown, speeds, atol=0.5)


def test_lerobot_tables_hold_each_frame_once_and_videos_are_the_recorded_ones(exported, recorded):
    parquet = pytest.importorskip("pyarrow.parquet")
    folder = exported("lerobot")
    info = json.loads((folder / "meta/info.json").read_text())
    assert info["total_frames"] == recorded.frame_count
    assert info["splits"] == {"train": f"0:{len(recorded)}"}
    first = 0
    for number, episode in enumerate(recorded):
        inside = f"chunk-000/file-{number:03d}"
        table = parquet.read_table(folder / "data" / f"{inside}.parquet").to_pydict()
        assert table["index"] == list(range(first, first + len(episode)))
        first += len(episode)
        assert np.allclose(table["action"], motion_of(episode).actions)
        film = folder / "videos/observation.images.camera" / f"{inside}.mp4"
        assert film.read_bytes() == (episode.folder / "episode.mp4").read_bytes()
    rows = parquet.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pydict()
    assert rows["dataset_to_index"][-1] == recorded.frame_count
    assert all(text.startswith("Follow ") for (text,) in rows["tasks"])


@pytest.mark.parametrize("name", ["lerobot", "webdataset", "minari", "mcap"])
def test_two_exports_are_the_same_to_the_byte(recorded, tmp_path, name):
    contents = []
    for number in range(2):
        folder = tmp_path / str(number)
        export(recorded, name, folder, ExportOptions())
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        contents.append({path.relative_to(folder): path.read_bytes() for path in files})
    assert contents[0] == contents[1]


@pytest.mark.parametrize(
    ("name", "module"),
    [("lerobot", "pyarrow"), ("minari", "h5py"), ("rerun", "rerun"), ("mcap", "mcap")],
)
def test_a_missing_library_is_told_in_one_line(recorded, tmp_path, monkeypatch, name, module):
    from eyas.engine.core.errors import MissingExtraError

    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match="needs the extra 'exports'"):
        export(recorded, name, tmp_path / "out", ExportOptions())
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["minari", "rerun", "webdataset"])
def test_on_a_full_disk_an_export_ends_in_a_line_and_goes_on(recorded, tmp_path, name):
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=60k", "tmpfs", str(disk)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("disks of a given size are only for root")
    command = [sys.executable, "-m", "eyas", "export", str(recorded.folder), "--quiet"]
    command += ["--format", name, "--out", str(disk)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
        told = [line for line in done.stderr.splitlines() if line.startswith("eyas: ")]
        assert done.returncode == 2, done.stderr
        assert len(told) == 1
        assert "cannot write" in told[0]
        assert "Traceback" not in done.stderr
        subprocess.run(["mount", "-o", "remount,size=100m", str(disk)], check=True)
        again = subprocess.run([*command, "--resume"], timeout=100, check=False)
        assert again.returncode == 0
    finally:
        subprocess.run(["umount", "-l", str(disk)], check=True)
