"""Formats of single-object tracking, read by the toolkit of GOT-10k where it can."""

import configparser
import json
import shutil
from contextlib import redirect_stdout
from hashlib import sha256
from io import StringIO

import numpy as np
import pytest

from eyas.datasets.formats.sot import cover_levels
from eyas.engine.exports.checksums import CHECKSUMS, checksum_lines, read_checksums
from eyas.engine.exports.label import LABELS
from eyas.engine.recordings.export import ExportOptions, export
from eyas.engine.recordings.recording import Recording, from_first_sight, load

# It reads files with np.loadtxt, which warns of sequences of one frame; its report divides by 0.
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


@pytest.fixture
def shown(data) -> Recording:
    """The data set, from where its targets are first visible."""
    return Recording(data.folder, [from_first_sight(episode) for episode in data])


def quiet(make, *arguments, **options):
    with redirect_stdout(StringIO()):
        return make(*arguments, **options)


def clipped(label) -> list[int]:
    left, top, right, bottom = label["target_box"]
    return [left, top, right - left, bottom - top]


@pytest.fixture
def got10k():
    """The toolkit of GOT-10k, of the extra `checkers`."""
    pytest.importorskip("got10k.trackers")
    pytest.importorskip("got10k.datasets")
    pytest.importorskip("got10k.experiments")
    return pytest.importorskip("got10k")


@pytest.mark.parametrize("subset", ["train", "val"])
def test_got10k_loads(got10k, exported, shown, subset):
    loaded = quiet(got10k.datasets.GOT10k, exported("got10k"), subset=subset, return_meta=True)
    episodes = {episode.name: episode for episode in shown.split(subset)}
    assert loaded.seq_names == list(episodes)
    for name, (pictures, boxes, facts) in zip(loaded.seq_names, loaded, strict=True):
        labels = episodes[name].labels
        assert len(pictures) == len(labels)
        assert boxes.tolist() == [clipped(label) for label in labels]
        visible = np.array([label["visible_fraction"] for label in labels])
        cut = [label["visible_fraction"] > 0 and label["target_truncated"] > 0 for label in labels]
        assert np.array_equal(facts["absence"], visible == 0.0)
        assert np.array_equal(facts["cut_by_image"], cut)
        assert np.array_equal(facts["cover"], cover_levels(visible))
        assert facts["anno_fps"] == "10Hz"
        assert facts["resolution"] == "(160, 120)"


@pytest.mark.parametrize(
    ("share", "level"),
    [(0.0, 0), (0.001, 1), (0.15, 1), (0.151, 2), (0.3, 2), (0.45, 3), (0.5, 4), (0.6, 4),
     (0.75, 5), (0.9, 6), (0.901, 7), (0.999, 7), (1.0, 8)],
)  # fmt: skip
def test_levels_of_cover_are_those_of_got10k(share, level):
    assert cover_levels(np.array([share])).tolist() == [level]


@pytest.mark.filterwarnings("ignore:.*(Mean of empty slice|invalid value|figure):RuntimeWarning")
def test_got10k_runs_a_tracker_and_writes_its_report(got10k, exported, tmp_path):
    class Still(got10k.trackers.Tracker):
        """A tracker that never moves."""

        def __init__(self):
            super().__init__("Still", is_deterministic=True)

        def init(self, image, box):
            self.box = box

        def update(self, image):
            return self.box

    experiment = quiet(
        got10k.experiments.ExperimentGOT10k, exported("got10k"), subset="val",
        result_dir=str(tmp_path / "results"), report_dir=str(tmp_path / "reports"),
    )  # fmt: skip
    quiet(experiment.run, Still())
    performance = quiet(experiment.report, ["Still"])
    assert 0.0 < performance["Still"]["overall"]["ao"] < 1.0
    assert (tmp_path / "reports/GOT-10k/Still/performance.json").is_file()


def test_dtb70_loads(got10k, exported, shown):
    loaded = quiet(got10k.datasets.DTB70, exported("dtb70") / "train")
    for name, (pictures, boxes) in zip(loaded.seq_names, loaded, strict=True):
        (episode,) = (each for each in shown if each.name == name)
        assert len(pictures) == len(episode)
        assert boxes.tolist() == [clipped(label) for label in episode.labels]


@pytest.mark.parametrize("split", ["train", "val"])
def test_vot_is_read_as_its_toolkit_does(exported, shown, split):
    folder = exported("vot") / split
    names = (folder / "list.txt").read_text().split()
    assert names == [episode.name for episode in shown.split(split)]
    for name in names:
        (episode,) = (each for each in shown if each.name == name)
        boxes = np.loadtxt(folder / name / "groundtruth.txt", delimiter=",", ndmin=2)
        pictures = list((folder / name / "color").glob("????????.jpg"))
        visible = episode.array("visible_fraction") > 0
        assert len(pictures) == len(episode)
        assert np.array_equal(~np.isnan(boxes).any(axis=1), visible)
        expected = np.array([clipped(label) for label in episode.labels])[visible]
        assert np.array_equal(boxes[visible], expected)
        own = configparser.ConfigParser(interpolation=None)
        own.read_string("[_]\n" + (folder / name / "sequence").read_text())
        assert own["_"]["name"] == name
        assert own["_"].getint("length") == len(episode)
        assert (folder / name / (own["_"]["channels.color"] % 1)).is_file()
        hidden = np.loadtxt(folder / name / "occlusion.tag")
        in_view = episode.array("in_view")
        assert np.array_equal(hidden, in_view & (episode.array("visible_fraction") < 1))
        shares = np.loadtxt(folder / name / "visibility.value")
        assert np.array_equal(shares, episode.array("visible_fraction"))


def test_tags_of_vot_tell_motion(exported, shown):
    folder = exported("vot")
    tags = {}
    for path in folder.glob("*/*/*.tag"):
        values = np.loadtxt(path, ndmin=1)
        tags.setdefault(path.stem, []).extend(values.tolist())
    kinds = {"occlusion", "out_of_view", "camera_motion", "motion_change", "size_change"}
    assert tags.keys() == kinds
    assert set(tags.pop("camera_motion")) <= {0.0, 1.0}
    assert all(set(values) == {0.0, 1.0} for values in tags.values())
    assert all(len(values) == shown.frame_count for values in tags.values())


def test_lasot_is_read_as_its_readers_do(exported, shown):
    folder = exported("lasot")
    for episode in shown:
        labels = episode.labels
        (own,) = (folder / episode.split).glob(f"*/*-{episode.name}")
        assert own.name.split("-")[0] == own.parent.name
        hidden, outside = (
            np.loadtxt(own / name, delimiter=",")
            for name in ("full_occlusion.txt", "out_of_view.txt")
        )
        visible = episode.array("visible_fraction") > 0
        assert np.array_equal((hidden == 0) & (outside == 0), visible)
        assert np.array_equal(outside == 1, ~episode.array("in_view"))
        boxes = np.loadtxt(own / "groundtruth.txt", delimiter=",")
        assert boxes.tolist() == [clipped(label) for label in labels]
        assert len(list((own / "img").glob("????????.jpg"))) == len(labels)
        assert (own / "nlp.txt").read_text().strip() == labels[0]["target_words"]


def test_uav123_is_nan_where_the_target_is_absent(exported, shown):
    folder = exported("uav123")
    absent = 0
    for episode in shown:
        root = folder / episode.split
        boxes = np.loadtxt(root / f"anno/UAV123/{episode.name}.txt", delimiter=",", ndmin=2)
        visible = episode.array("visible_fraction") > 0
        assert np.array_equal(np.isnan(boxes).all(axis=1), ~visible)
        expected = np.array([clipped(label) for label in episode.labels])[visible]
        assert np.array_equal(boxes[visible], expected)
        pictures = list((root / f"data_seq/UAV123/{episode.name}").glob("??????.jpg"))
        assert len(pictures) == len(episode)
        absent += (~visible).sum()
    assert absent


def test_otb_is_read_as_its_readers_do(exported, shown):
    folder = exported("otb")
    for episode in shown:
        own = folder / episode.split / episode.name
        boxes = np.loadtxt(own / "groundtruth_rect.txt", delimiter=",", ndmin=2)
        assert boxes.tolist() == [clipped(label) for label in episode.labels]
        names = sorted(path.name for path in (own / "img").iterdir())
        assert names == [f"{number:04d}.jpg" for number in range(1, len(episode) + 1)]


@pytest.fixture(scope="module")
def late(dataset, tmp_path_factory):
    """The data set, whose first episode has no visible target for 3 frames, and its second none at
    all.
    """
    root = shutil.copytree(dataset, tmp_path_factory.mktemp("late") / "dataset")
    data = load(root)
    for episode, hidden in zip(data.episodes, (3, len(data[1])), strict=False):
        labels = [json.loads(line) for line in (episode.folder / LABELS).open()]
        for label in labels[:hidden]:
            label["visible_fraction"] = 0.0
        labels[min(hidden, len(labels) - 1)]["visible_fraction"] = 0.0 if hidden > 3 else 1.0
        text = "".join(f"{json.dumps(label)}\n" for label in labels).encode()
        (episode.folder / LABELS).write_bytes(text)
        run = episode.folder.parent.parent
        sums = read_checksums(run / CHECKSUMS)
        sums[(episode.folder / LABELS).relative_to(run).as_posix()] = sha256(text).hexdigest()
        (run / CHECKSUMS).write_bytes(checksum_lines(sums))
    return load(root)


@pytest.mark.parametrize(
    ("name", "boxes", "pictures"),
    [
        ("got10k", "train/*/groundtruth.txt", "train/{}/*.jpg"),
        ("lasot", "train/*/*/groundtruth.txt", "train/*/*-{}/img/*.jpg"),
        ("otb", "train/*/groundtruth_rect.txt", "train/{}/img/*.jpg"),
        ("dtb70", "train/*/groundtruth_rect.txt", "train/{}/img/*.jpg"),
        ("vot", "train/*/groundtruth.txt", "train/{}/color/*.jpg"),
        ("uav123", "train/anno/UAV123/*.txt", "train/data_seq/UAV123/{}/*.jpg"),
        (
            "visdrone-sot",
            "VisDrone2019-SOT-train/annotations/*.txt",
            "VisDrone2019-SOT-train/sequences/{}/*.jpg",
        ),
    ],
)
def test_a_sequence_begins_where_its_target_is_first_visible(
    late, tmp_path, caplog, name, boxes, pictures
):
    export(late, name, tmp_path / name, ExportOptions())
    first, unseen = late[0], late[1]
    assert f"{unseen.name}: left out: its target is never visible" in caplog.text
    (rows,) = (
        path.read_text().splitlines()
        for path in (tmp_path / name).glob(boxes)
        if first.name in path.as_posix()
    )
    found = sorted((tmp_path / name).glob(pictures.format(first.name)))
    assert len(rows) == len(found) == len(first) - 3
    assert rows[0] == ",".join(map(str, clipped(first.labels[3])))
    assert found[0].read_bytes() == first.picture_file(3).read_bytes()
    assert not [path for path in (tmp_path / name).rglob("*") if unseen.name in path.name]
    lists = [path.read_text() for path in (tmp_path / name).rglob("list.txt")]
    assert all(unseen.name not in text.split() for text in lists)
