"""The whole video mode: what it writes, and that it stops and continues without a trace."""

import json
import os
import re
import resource
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image

from eyas.cli.main import main
from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.errors import ConfigError, OutputError, SpawnError
from eyas.engine.core.folder_lock import folder_lock
from eyas.engine.exports.frame import Frame
from eyas.engine.exports.label import Label, read_labels
from eyas.engine.exports.registry import WRITERS
from eyas.engine.exports.writer import Episode, Files, Gather, Summary, Writer
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.task.config import DoneConfig
from eyas.engine.task.direction import TargetDirection
from eyas.engine.video import run as video
from eyas.engine.world.config import WorldConfig

# Two trackers, three and a half episodes of 0.2 s each, a frame every 8 ms.
CONFIG = EyasConfig(
    seed=3,
    extras=[],  # else labels are larger than pictures
    traffic={"signals": "amber"},  # who stands goes in no direction
    camera=CameraConfig(width=96, height=72),
    done=DoneConfig(total_steps=100, grace_steps=20),
    video=VideoConfig(
        channels=2,
        fps=125.0,
        start_time=0.7,
        total_time=0.7,
        warm_up_steps=10,
        flight="exact",
        jpeg_quality=100,  # so that pictures are larger than the settings: they meet a full disk
    ),
)
RUN = """
import sys
from pathlib import Path
from eyas.engine.video import run as video
from eyas.engine.settings.config import EyasConfig
video.run(EyasConfig.model_validate_json(sys.argv[1]), Path(sys.argv[2]), quiet=True)
"""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("video") / "out"
    video.run(CONFIG, path, quiet=True)
    return path


def episodes_of(path: Path) -> list[Path]:
    return sorted(path.glob("DRONE*/episode*"))


def contents(path: Path) -> dict[str, bytes]:
    return {
        inside.relative_to(path).as_posix(): inside.read_bytes()
        for inside in path.rglob("*")
        if inside.is_file()
    }


def movie_length(path: Path) -> int:
    with av.open(str(path)) as container:
        return sum(1 for _ in container.decode(video=0))


def test_every_description_counts_the_same_frames(recorded):
    info = json.loads((recorded / "dir_info.json").read_text())
    assert sorted(info) == ["DRONE0", "DRONE1"]
    assert len(episodes_of(recorded)) == sum(len(episodes) for episodes in info.values()) == 8
    for episode in episodes_of(recorded):
        frames = info[episode.parent.name][episode.name]
        names = [f"{frame:06d}" for frame in range(frames)]
        assert frames > 10
        assert sorted(path.stem for path in episode.glob("*.jpeg")) == names
        assert list(json.loads((episode / "mark.json").read_text())) == names
        assert [label["frame"] for label in read_labels(episode / "labels.jsonl")] == [
            *range(frames)
        ]
        assert movie_length(episode / "episode.mp4") == frames


def test_pictures_have_the_cameras_size_and_show_something(recorded):
    for episode in episodes_of(recorded):
        with Image.open(episode / "000000.jpeg") as image:
            assert image.size == (96, 72)
            assert np.asarray(image).std() > 3


def test_labels_agree_with_the_marks_and_the_geometry(recorded):
    for episode in episodes_of(recorded):
        marks = json.loads((episode / "mark.json").read_text())
        for label in read_labels(episode / "labels.jsonl"):
            reward, action = marks[f"{label['frame']:06d}"]
            assert (round(reward, 6), action) == (label["reward"], -1.0)
            left, top, right, bottom = label["target_box"]
            assert label["in_view"]
            assert 0 <= left < right <= 96
            assert 0 <= top < bottom <= 72
            assert 0.0 <= label["visible_fraction"] <= 1.0
            assert label["occluded"] == (label["visible_fraction"] < 1.0)
            offset = np.subtract(label["target_centre"], label["tracker_position"])
            assert np.linalg.norm(offset) == pytest.approx(
                np.linalg.norm(label["relative_position"])
            )


def test_a_box_lies_where_the_camera_projects_the_target(recorded):
    for episode in episodes_of(recorded):
        label = read_labels(episode / "labels.jsonl")[-1]
        offset = np.subtract(label["target_centre"], label["camera_position"])
        forward, left, up = np.array(label["camera_rotation"]).T @ offset
        focal = CONFIG.camera.width / 2 / np.tan(CONFIG.camera.field_of_view / 2)
        u = CONFIG.camera.width / 2 - focal * left / forward
        v = CONFIG.camera.height / 2 - focal * up / forward
        box = label["target_box"]
        assert box[0] - 2 <= u <= box[2] + 2
        assert box[1] - 2 <= v <= box[3] + 2


def test_frames_come_at_the_asked_rate_and_time(recorded):
    for episode in episodes_of(recorded):
        times = [label["time"] for label in read_labels(episode / "labels.jsonl")]
        assert np.diff(times) == pytest.approx(0.008)
        assert times[0] >= 0.7
        assert times[-1] <= 1.4


def test_exact_following_keeps_the_target_in_its_place(recorded):
    labels = read_labels(recorded / "DRONE0" / "episode0" / "labels.jsonl")
    places = np.array([label["relative_position"] for label in labels])
    assert np.ptp(places, axis=0).max() < 0.05


def test_the_settings_beside_a_recording_repeat_it_to_the_byte(recorded, tmp_path, monkeypatch):
    settings, again = recorded / "config.json", tmp_path / "again"
    command = ["eyas", "video", "--config", str(settings), "--out", str(again)]
    monkeypatch.setattr(sys, "argv", command)
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    assert contents(again) == contents(recorded)


def test_a_killed_recording_continues_to_the_same_bytes(recorded, tmp_path):
    path = tmp_path / "out"
    run = subprocess.Popen([sys.executable, "-c", RUN, CONFIG.model_dump_json(), str(path)])
    while not (path / "DRONE0" / "episode1" / "000010.jpeg").exists():
        assert run.poll() is None, "the recording ended before it could be killed"
        time.sleep(0.01)
    run.send_signal(signal.SIGKILL)
    run.wait()
    assert not (path / "dir_info.json").exists()
    for picture in path.rglob("*.jpeg"):
        Image.open(picture).load()
    kept = path / "DRONE0" / "episode0" / "000000.jpeg"
    drawn_at = kept.stat().st_mtime_ns
    video.run(CONFIG, path, resume=True, quiet=True)
    assert contents(path) == contents(recorded)
    assert kept.stat().st_mtime_ns == drawn_at


@pytest.mark.slow
def test_a_later_start_does_without_numba(tmp_path):
    """Which would take half a second to import, and compile for seconds what it keeps nowhere."""
    with_overlay = CONFIG.video.model_copy(  # with an episode that ends, and one that does not
        update={"overlay": True, "writers": tuple(WRITERS.built_in), "fps": 25.0, "total_time": 0.3}
    )
    lidar = CONFIG.lidar.model_copy(update={"enabled": True})  # for its writer
    few = {"enabled": True, "width": 24, "height": 18}  # for its writer, too
    events = CONFIG.camera.events.model_copy(update=few)
    camera = CONFIG.camera.model_copy(update={"events": events})
    # A small world, which the writer `scene` writes out, too.
    own = {"video": with_overlay, "lidar": lidar, "camera": camera}
    config = CONFIG.model_copy(update={**own, "world": WorldConfig(map="simpleway-grass")})
    program = RUN + 'print("numba" in sys.modules)'
    for out in ("first", "later"):
        command = [sys.executable, "-c", program, config.model_dump_json(), str(tmp_path / out)]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        if said == "False\n":
            break  # the first found all that earlier tests had compiled
    assert said == "False\n"


def test_control_c_leaves_whole_files_and_says_how_to_go_on(recorded, tmp_path):
    path = tmp_path / "out"

    def interrupt() -> None:
        while not (path / "DRONE0" / "episode1" / "000005.jpeg").exists():
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    user = threading.Thread(target=interrupt)
    user.start()
    with pytest.raises(KeyboardInterrupt) as caught:
        video.run(CONFIG, path)
    user.join()
    (note,) = caught.value.__notes__  # the command line prints it
    assert note == f"every file in {path} is whole; continue with --resume"
    whole = contents(recorded)
    found = contents(path)
    found.pop(".checksums", None)  # grows until all is recorded
    assert all(whole[name] == data for name, data in found.items())
    video.run(CONFIG, path, resume=True, quiet=True)
    assert contents(path) == whole


@pytest.mark.slow
@pytest.mark.parametrize(("spare", "refused"), [(-1, r"\d{6}\.jpeg"), (1, r"(mp4|jsonl)")])
def test_a_full_disk_is_one_line_and_nothing_is_half_written(recorded, tmp_path, spare, refused):
    path = tmp_path / "out"
    whole = contents(recorded)
    largest = max(len(data) for name, data in whole.items() if name.endswith("jpeg"))
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (largest + spare, hard))
    try:
        with pytest.raises(OutputError, match=rf"{refused}: cannot write: File too") as caught:
            video.run(CONFIG, path, quiet=True)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert "continue with --resume" in str(caught.value)
    assert "\n" not in str(caught.value)
    found = contents(path)
    found.pop(".checksums", None)  # grows until all is recorded
    assert all(whole[name] == data for name, data in found.items())
    video.run(CONFIG, path, resume=True, quiet=True)
    assert contents(path) == whole


def test_two_recorders_do_not_share_a_folder(tmp_path):
    with (
        folder_lock(tmp_path, "recording into it"),
        pytest.raises(OutputError, match="is recording into it"),
    ):
        video.run(CONFIG, tmp_path, quiet=True)


def test_random_actions_are_seeded_held_and_marked(tmp_path):
    changed = CONFIG.video.model_copy(update={"flight": "random", "total_time": 0.4})
    config = CONFIG.model_copy(update={"video": changed})
    video.run(config, tmp_path / "a", quiet=True)
    video.run(config, tmp_path / "b", quiet=True)
    assert contents(tmp_path / "a") == contents(tmp_path / "b")
    labels = read_labels(tmp_path / "a" / "DRONE0" / "episode0" / "labels.jsonl")
    actions = {(label["step"] - 1) // 4: label["action"] for label in labels}
    assert all(actions[(label["step"] - 1) // 4] == label["action"] for label in labels)
    assert set(actions.values()) == {0, 1, 2, 3, 4, 5}


def test_direction_replaces_the_marks(recorded, tmp_path):
    changed = CONFIG.video.model_copy(update={"target_direction": True})
    video.run(CONFIG.model_copy(update={"video": changed}), tmp_path / "a", quiet=True)
    episodes, found = episodes_of(tmp_path / "a"), set()
    assert len(episodes) == len(episodes_of(recorded))
    for episode in episodes:
        same = recorded / episode.relative_to(tmp_path / "a") / "labels.jsonl"
        marked = np.array(list(json.loads((episode / "mark.json").read_text()).values()))
        expected, clear = directions(read_labels(same))
        assert len(marked) == len(expected) + 1
        assert clear.sum() > 0.5 * len(clear)
        np.testing.assert_array_equal(marked[1:][clear], expected[clear])
        found |= {*marked.tolist()}
    assert len(found) > 1  # some turn, some drive straight on


def directions(labels: list[Label]) -> tuple[np.ndarray, np.ndarray]:
    """Return which way the target goes in each frame but the first, and where that is beyond doubt.

    A frame is four steps; between the limits of turning, one step may differ from the others.
    """
    turn = np.diff([label["target_yaw"] for label in labels]) / 4.0
    speed = np.linalg.norm([label["target_velocity"] for label in labels], axis=1)[1:]
    along = np.where(speed > 0.5, TargetDirection.STRAIGHT, TargetDirection.STOP)
    aside = np.where(turn > 0.0, TargetDirection.LEFT, TargetDirection.RIGHT)
    clear = np.abs(np.abs(turn) - 1e-4) > 0.5e-4
    return np.where(np.abs(turn) < 1e-4, along, aside), clear


def test_the_report_names_trackers_and_folder(tmp_path, capsys):
    changed = CONFIG.video.model_copy(update={"total_time": 0.1})
    video.run(CONFIG.model_copy(update={"video": changed}), tmp_path / "a")
    said = capsys.readouterr()
    assert "DRONE1" in said.out
    assert str(tmp_path / "a") in said.out
    assert said.err == ""


def test_more_time_than_there_is_traffic_is_one_line_and_no_folder(tmp_path):
    changed = CONFIG.video.model_copy(update={"total_time": 1e6})
    with pytest.raises(ConfigError, match=r"video\.total_time: .*allowed: up to"):
        video.run(CONFIG.model_copy(update={"video": changed}), tmp_path / "a", quiet=True)
    assert not (tmp_path / "a").exists()


def test_fewer_targets_than_trackers_is_one_line_and_no_folder(tmp_path):
    changed = CONFIG.video.model_copy(update={"channels": 50})
    with pytest.raises(SpawnError, match="40 in the world, 40 followed"):
        video.run(CONFIG.model_copy(update={"video": changed}), tmp_path / "a", quiet=True)
    assert not (tmp_path / "a").exists()


def test_an_error_names_the_originals_key_if_the_setting_came_from_its_file(tmp_path):
    changed = CONFIG.video.model_copy(update={"total_time": 1e6})
    config = CONFIG.model_copy(update={"video": changed, "original": {}})
    with pytest.raises(ConfigError, match=r"^video\.total_time \(Out_Video\.total_time\): 1e\+06"):
        video.run(config, tmp_path / "a", quiet=True)


def test_verbose_logs_every_step_in_the_originals_words(recorded, tmp_path):
    short = CONFIG.video.model_copy(update={"total_time": 0.1})
    config = CONFIG.model_copy(update={"video": short, "verbose": True})
    path = tmp_path / "a"
    video.run(config, path, quiet=True)
    lines = (path / "DRONE1.log").read_text().splitlines()
    assert len(lines) == round((0.7 + 0.1) * 500) - CONFIG.start.warm_up_steps
    pattern = re.compile(
        r"id: DRONE1 done: [01] reward: [\d.e-]+ count: \d+ time: [\d.]+ carDir: [0-3]"
        r" pitchAngle: [\d.]+ doneState: none"
    )
    assert all(pattern.fullmatch(line) for line in lines)
    before = contents(path)
    next(path.glob("DRONE1/*/mark.json")).unlink()
    (path / "DRONE1.log").unlink()
    video.run(config, path, resume=True, quiet=True)
    assert contents(path) == before
    video.run(config, path, overwrite=True, quiet=True)
    assert contents(path) == before


def test_values_without_effect_do_not_keep_a_recording_from_being_continued(tmp_path):
    config = with_writers("mark", total_time=0.1)
    video.run(config, tmp_path / "a", quiet=True)
    kept = {"Drone_Random_Config.height_fixed": 17}
    video.run(config.model_copy(update={"original": kept}), tmp_path / "a", resume=True, quiet=True)
    written = json.loads((tmp_path / "a" / "env_config.json").read_text())
    assert written["Drone_Random_Config"]["height_fixed"] == 17


def test_a_recording_that_ends_before_it_begins_is_refused_and_leaves_no_folder(tmp_path):
    start = CONFIG.start.model_copy(update={"warm_up_steps": 5000})
    with pytest.raises(ConfigError, match=r"video\.total_time: .*warm up; .* later than 10\.02 s"):
        video.run(CONFIG.model_copy(update={"start": start}), tmp_path / "none", quiet=True)
    assert not (tmp_path / "none").exists()


@pytest.mark.slow
def test_an_overlay_changes_pictures_and_films_but_no_label_and_no_mark(recorded, tmp_path):
    config = CONFIG.model_copy(update={"video": CONFIG.video.model_copy(update={"overlay": True})})
    video.run(config, tmp_path / "out", quiet=True)
    clean, overlaid = contents(recorded), contents(tmp_path / "out")
    assert clean.keys() == overlaid.keys()
    for name in clean:
        drawn = name.endswith((".jpeg", ".mp4"))
        settings = name in ("config.json", "checksums.sha256")
        assert (clean[name] != overlaid[name]) == (drawn or settings), name


class Probe(Writer):
    """Compares the ids of all pixels with what is said about the target and other vehicles."""

    wants = frozenset({"object_id", "depth", "others"})
    files = Files(episode=("pixels.json",))

    def begin(self, episode: Episode) -> Gather[tuple[int, int, float, float]]:
        return Gather(
            episode.folder / "pixels.json", self._compared, lambda rows: json.dumps(rows).encode()
        )

    @staticmethod
    def _compared(frame: Frame) -> tuple[int, int, float, float]:
        assert frame.rgb is None
        assert frame.class_id is None
        shown = frame.object_id == frame.target.object_id
        for other in frame.others:
            assert (frame.object_id == other.object_id).sum() == other.seen_pixels
        moving = set(np.unique(frame.object_id[frame.object_id >= ACTOR_OBJECT]).tolist())
        others = {other.object_id for other in frame.others if not other.parked}
        assert moving == {frame.target.object_id} | others
        near = np.linalg.norm(frame.target.centre - frame.camera.position)
        return (
            int(shown.sum()),
            frame.target.seen_pixels,
            float(np.median(frame.depth[shown])),
            near,
        )

    def read(self, folder: Path) -> Summary | None:
        path = folder / "pixels.json"
        return Summary(len(json.loads(path.read_text()))) if path.exists() else None


def with_writers(*names: str, **changes: object) -> EyasConfig:
    video = CONFIG.video.model_copy(update={"writers": names, **changes})
    return CONFIG.model_copy(update={"video": video})


def test_writers_are_chosen_and_none_changes_what_another_writes(recorded, tmp_path):
    video.run(with_writers("labels", overlay=True), tmp_path / "out", quiet=True)
    found, whole = contents(tmp_path / "out"), contents(recorded)
    labels = {name for name in whole if name.endswith("labels.jsonl")}
    run = {"config.json", "env_config.json", "version.json", "checksums.sha256"}
    assert found.keys() == labels | run
    assert all(found[name] == whole[name] for name in labels)


def test_a_writer_gets_the_pictures_that_it_wants_and_no_others(tmp_path):
    video.run(with_writers(f"{__name__}:Probe", total_time=0.1), tmp_path / "out", quiet=True)
    files = sorted(tmp_path.rglob("pixels.json"))
    assert len(files) == 2
    for file in files:
        for shown, seen, depth, near in json.loads(file.read_text()):
            assert shown == seen > 0
            assert depth == pytest.approx(near, rel=0.1)


def test_an_unknown_writer_is_one_line_and_no_folder(tmp_path):
    with pytest.raises(ConfigError, match=r"video\.writers: 'jpg' .*did you mean 'jpeg'"):
        video.run(with_writers("jpg"), tmp_path / "out", quiet=True)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("labels", [(), ("labels",)], ids=["without labels", "with labels"])
def test_a_resumed_recording_reports_of_episodes_on_disk_what_they_tell(tmp_path, capsys, labels):
    config = with_writers("mark", *labels, total_time=0.1)
    video.run(config, tmp_path / "out")
    unbroken = rows_of(capsys.readouterr().out)
    (tmp_path / "out" / "DRONE0" / "episode0" / "mark.json").unlink()
    video.run(config, tmp_path / "out", resume=True)
    resumed = rows_of(capsys.readouterr().out)
    assert resumed["DRONE0"] == unbroken["DRONE0"]
    assert "-" not in unbroken["DRONE1"]
    told = unbroken["DRONE1"][:4] if labels else [*unbroken["DRONE1"][:2], "-", "-"]
    assert resumed["DRONE1"] == [*told, "-"]  # of what was not drawn now


def rows_of(report: str) -> dict[str, list[str]]:
    """Return the cells of each tracker's row of a report."""
    lines = [[cell.strip() for cell in line.split("│")[1:-1]] for line in report.splitlines()]
    return {name: cells for name, *cells in (line for line in lines if len(line) == 6)}
