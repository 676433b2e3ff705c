"""What all formats have in common."""

import hashlib
import json
import os
import random
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from eyas.engine.core.codecs.png import png_bytes
from eyas.engine.core.errors import ConfigError, DataFileError, OutputError, UnknownNameError
from eyas.engine.exports.checksums import CHECKSUMS
from eyas.engine.recordings.export import ExportOptions, export
from eyas.engine.recordings.format import FORMATS, objects_of
from eyas.engine.recordings.recording import from_first_sight, load
from eyas.engine.recordings.run import run
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass

OF_MOTION = {"lerobot", "webdataset", "minari", "rerun", "mcap"}
FORMATS_OF_PICTURES = tuple(name for name in FORMATS.built_in if name not in OF_MOTION)

KILLS = int(os.environ.get("EYAS_TEST_KILLS", "2"))


def contents(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def test_the_data_set_holds_what_formats_find_difficult(data):
    labels = [frame.label for frame in data.frames()]
    others = [other for label in labels for other in label["others"]]
    classes = {*(label["target_class_id"] for label in labels)}
    assert any(label["in_view"] and label["visible_fraction"] == 0.0 for label in labels)
    assert any(0.0 < label["visible_fraction"] < 1.0 for label in labels)
    assert any(0.0 < label["target_truncated"] < 1.0 for label in labels)
    assert any(not label["in_view"] for label in labels)
    assert any("target_sections" in label for label in labels)
    assert ObjectClass.CAR in classes
    assert any(other["class_id"] == ObjectClass.PERSON for other in others)


def test_an_id_is_the_same_after_an_absence(data):
    returned = 0
    for episode in data:
        seen = {}
        for frame in episode:
            for each in objects_of(frame.label):
                number = each.label["id"]
                returned += number in seen and seen[number][0] < frame.number - 1
                assert seen.get(number, (0, each.name))[1] == each.name
                seen[number] = frame.number, each.name
    assert returned


@pytest.mark.slow
@pytest.mark.parametrize("name", FORMATS_OF_PICTURES)
def test_the_same_recording_gives_the_same_bytes(exported, dataset, tmp_path, name):
    first = contents(exported(name))
    folder = tmp_path / "again"
    export(load(dataset), name, folder, ExportOptions())
    assert contents(folder) == first
    assert first


@pytest.mark.parametrize("name", FORMATS_OF_PICTURES)
def test_the_split_of_an_episode_decides_its_place(exported, data, name):
    folder = exported(name)
    where = {split: {episode.name for episode in data.split(split)} for split in ("train", "val")}
    pictures = [path.relative_to(folder).as_posix() for path in folder.rglob("*.jpg")]
    shown = list(map(from_first_sight, data)) if FORMATS.get(name).first_sight else data
    assert len(pictures) == sum(map(len, shown))
    if name in ("nuscenes", "uavdt"):  # their splits are in tables, or train and test
        return
    for picture in pictures:
        (split,) = (s for s, names in where.items() if any(each in picture for each in names))
        other = {"train": "val", "val": "train"}[split]
        top = picture.removeprefix("images/").split("/")[0]
        assert split in top
        assert other not in top


def test_pictures_are_links_or_copies(exported, data):
    original = data[0].picture_file(0).stat().st_ino
    (linked,) = exported("otb").glob(f"train/{data[0].name}/img/0001.jpg")
    (copied,) = exported("dtb70", copies=True).glob(f"train/{data[0].name}/img/00001.jpg")
    assert linked.stat().st_ino == original
    assert copied.stat().st_ino != original
    assert copied.read_bytes() == linked.read_bytes()


@pytest.mark.slow
def test_killed_at_any_moment_it_continues_to_the_same_bytes(dataset, tmp_path):
    names = FORMATS_OF_PICTURES
    begun = time.perf_counter()
    run(dataset, names, tmp_path / "whole", ExportOptions())
    duration = time.perf_counter() - begun
    whole = contents(tmp_path / "whole")
    chance = random.Random(5)
    out = tmp_path / "killed"
    options = [part for name in names for part in ("--format", name)]
    command = [sys.executable, "-m", "eyas", "export", str(dataset), *options]
    for _ in range(KILLS):
        process = subprocess.Popen([*command, "--out", str(out), "--resume", "--quiet"])
        while process.poll() is None and not out.exists():
            time.sleep(0.01)
        time.sleep(chance.uniform(0.0, duration))
        process.kill()
        process.wait()
        for path, content in contents(out).items():
            if not path.endswith((".part", ".lock", "/.export.json", ".done")) and (
                "/.kept/" not in path
            ):
                assert content == whole[path], path
    run(dataset, names, out, ExportOptions(resume=True))
    assert contents(out) == whole


class Interrupted:
    """A format that is interrupted at its third episode, once."""

    needs = frozenset({"labels"})
    added: ClassVar[list[str]] = []

    def __init__(self, job):
        self.job = job

    def add(self, episode):
        self.added.append(episode.name)
        if len(self.added) == 3:
            raise KeyboardInterrupt
        self.job.keep(episode, len(episode))

    def finish(self, episodes):
        for each in episodes:
            assert self.job.kept(each.name) == each.frames


def test_what_is_written_completely_is_not_written_again(data, tmp_path):
    FORMATS.register("interrupted", Interrupted)
    with pytest.raises(KeyboardInterrupt):
        export(data, "interrupted", tmp_path / "out", ExportOptions())
    export(data, "interrupted", tmp_path / "out", ExportOptions(resume=True))
    names = [episode.name for episode in data]
    assert Interrupted.added == [*names[:3], *names[2:]]


def test_killed_while_it_tidies_up_it_is_finished(data, exported, tmp_path, monkeypatch):
    def kill(*arguments, **options):
        raise KeyboardInterrupt

    folder = tmp_path / "killed"
    with monkeypatch.context() as patch:
        patch.setattr(shutil, "rmtree", kill)
        with pytest.raises(KeyboardInterrupt):
            export(data, "coco", folder, ExportOptions())
    export(data, "coco", folder, ExportOptions(resume=True))
    assert contents(folder) == contents(exported("coco"))


def test_two_exports_at_once_disturb_each_other_in_no_way(dataset, tmp_path):
    threads = [
        threading.Thread(
            target=export, args=(load(dataset), "yolo-seg", tmp_path / name, ExportOptions())
        )
        for name in ("a", "b")
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


def test_a_folder_in_use_is_refused(data, tmp_path):
    export(data, "otb", tmp_path / "otb", ExportOptions())
    with pytest.raises(OutputError, match="not empty; continue its export with --resume"):
        export(data, "otb", tmp_path / "otb", ExportOptions())
    with pytest.raises(OutputError, match="its least_side was 1, is 5"):
        export(data, "otb", tmp_path / "otb", ExportOptions(least_side=5, resume=True))
    export(data, "otb", tmp_path / "otb", ExportOptions(least_side=5, overwrite=True))
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/thesis.tex").touch()
    with pytest.raises(OutputError, match="not deleted: it is not an export"):
        export(data, "otb", tmp_path / "mine", ExportOptions(overwrite=True))


@pytest.fixture
def copied(dataset, tmp_path):
    """One recording of the data set, to be spoilt."""
    return shutil.copytree(dataset / "parts/train/first", tmp_path / "copied")


def test_a_picture_that_is_not_what_was_recorded_is_refused(copied, tmp_path):
    picture = copied / "DRONE0/episode0/000003.jpeg"
    picture.write_bytes(picture.read_bytes()[:-1])
    with pytest.raises(DataFileError, match=r"000003.jpeg: not what was recorded"):
        export(load(copied), "otb", tmp_path / "out", ExportOptions())


def test_a_recording_in_progress_or_without_a_file_is_refused(copied):
    (copied / ".checksums").touch()
    with pytest.raises(DataFileError, match="in progress, or was interrupted: continue it"):
        load(copied)
    (copied / ".checksums").unlink()
    (copied / "DRONE0/episode0/000003.jpeg").unlink()
    with pytest.raises(DataFileError, match=r"000003.jpeg: missing, though"):
        load(copied)


def test_a_recording_without_what_a_format_needs_is_refused(copied, tmp_path):
    shutil.rmtree(copied / "DRONE0/episode0/masks")
    sums = copied / "checksums.sha256"
    kept = [row for row in sums.read_text().splitlines(True) if "DRONE0/episode0/masks" not in row]
    sums.write_text("".join(kept))
    with pytest.raises(DataFileError, match="the format 'coco' needs the writer 'masks'; record"):
        export(load(copied), "coco", tmp_path / "out", ExportOptions())
    export(load(copied), "yolo", tmp_path / "yolo", ExportOptions())


def test_a_name_that_is_no_format_is_refused(data, tmp_path):
    with pytest.raises(UnknownNameError, match="coco"):
        export(data, "cocoo", tmp_path / "out", ExportOptions())
    with pytest.raises(ConfigError, match="is not a format: it has no 'needs'"):
        export(data, "pathlib:Path", tmp_path / "out", ExportOptions())


def test_what_is_ignored_is_marked_or_left_out(exported):
    def boxes(name, pattern, **options):
        folder = exported(name, **options)
        texts = [path.read_text() for path in sorted(folder.glob(pattern))]
        shutil.rmtree(folder)
        return [row for text in texts for row in text.splitlines()]

    for name, pattern in (("yolo", "labels/*/*.txt"), ("yolo-obb", "labels/*/*.txt")):
        assert 0 < len(boxes(name, pattern, least_side=9)) < len(boxes(name, pattern))
    mot = boxes("mot", "*/*/gt/gt.txt", least_side=9)
    assert len(mot) == len(boxes("mot", "*/*/gt/gt.txt"))
    assert all((min(map(int, r[4:6])) < 9) == (r[6] == "0") for r in (x.split(",") for x in mot))


def test_what_is_parked_counts_or_is_ignored(exported, data):
    parked = [
        other for episode in data for frame in episode for other in frame.label["others"]
        if "parked" in other
    ]  # fmt: skip
    assert parked

    def rows(name, pattern, **options):
        folder = exported(name, **options)
        texts = [path.read_text() for path in sorted(folder.glob(pattern))]
        shutil.rmtree(folder)
        return [row for text in texts for row in text.splitlines()]

    for name, pattern, marked in (
        ("mot", "*/*/gt/gt.txt", lambda row: row.split(",")[6] == "0"),
        ("kitti", "*/label_02/*.txt", lambda row: "DontCare" in row),
        ("visdrone-det", "*/annotations/*.txt", lambda row: row.split(",")[4] == "0"),
        ("yolo", "labels/*/*.txt", None),
    ):
        counted, ignored = rows(name, pattern), rows(name, pattern, ignore_parked=True)
        if marked is None:
            assert len(ignored) == len(counted) - len(parked), name
        else:
            assert len(ignored) == len(counted), name
            assert sum(map(marked, ignored)) > sum(map(marked, counted)), name
    coco = json.loads((exported("coco", ignore_parked=True) / "annotations/train.json").read_text())
    assert {each["iscrowd"] for each in coco["annotations"]} == {0, 1}
    scenes = exported("nuscenes") / "v1.0-train"
    attributes = {each["name"]: each["token"]
                  for each in json.loads((scenes / "attribute.json").read_text())}  # fmt: skip
    annotations = json.loads((scenes / "sample_annotation.json").read_text())
    assert any(each["attribute_tokens"] == [attributes["vehicle.parked"]] for each in annotations)


def test_masks_show_what_is_parked_under_its_id(data):
    for episode in data:
        for frame in episode:
            masks = frame.masks()
            for other in frame.label["others"]:
                if "parked" in other:
                    assert other["id"] < ACTOR_OBJECT
                    rows, columns = np.nonzero(masks == other["id"])
                    ends = [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
                    assert ends == other["visible_box"]


def test_export_json_tells_what_it_is_of(exported, dataset):
    told = json.loads((exported("otb", least_side=4) / "export.json").read_text())
    assert told["format"] == "otb"
    assert told["recording"] == dataset.name
    assert told["least_side"] == 4


@pytest.fixture
def foreign(data, tmp_path):
    """A copy of a recording whose files may be changed, with checksums that fit."""
    root = tmp_path / "foreign"
    source = data.episodes[0].folder.parent.parent
    shutil.copytree(source, root, ignore=shutil.ignore_patterns("exports"))

    def changed(name: str, content: bytes) -> Path:
        path = next(root.glob(f"*/episode*/{name}"))
        path.unlink()
        path.write_bytes(content)
        sums = root / "checksums.sha256"
        digest, own = hashlib.sha256(content).hexdigest(), path.relative_to(root).as_posix()
        lines = [line for line in sums.read_text().splitlines() if not line.endswith(own)]
        sums.unlink()
        sums.write_text("\n".join([*lines, f"{digest}  {own}"]) + "\n")
        return root

    return changed


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"hello", "cannot read: not a picture"),
        (png_bytes(np.zeros((12, 16), np.uint16)), "has 16x12 pixels, not"),
        (None, "though its label does"),
    ],
)
def test_masks_of_someone_else_that_do_not_fit_are_refused(foreign, data, content, told):
    frame = next(frame for frame in data[0] if frame.label["visible_fraction"] > 0.0)
    width, height = data[0].size
    empty = png_bytes(np.zeros((height, width), np.uint16))
    root = foreign(f"masks/{frame.number:06d}.png", content or empty)
    with pytest.raises(DataFileError, match=told) as raised:
        run(root, ["coco"], None, ExportOptions())
    assert "\n" not in str(raised.value)


def test_checksums_that_do_not_name_a_file_do_not_vouch_for_it(foreign):
    root = foreign("labels.jsonl", b"")
    (root / "checksums.sha256").unlink()
    (root / "checksums.sha256").write_bytes(b"")
    with pytest.raises(DataFileError, match=r"labels.jsonl: has no frames|does not name it"):
        run(root, ["got10k"], None, ExportOptions())


def test_labels_of_another_size_are_refused(foreign, data):
    labels = [{**label, "width": label["width"] + 1} for label in data[0].labels]
    root = foreign("labels.jsonl", "".join(f"{json.dumps(each)}\n" for each in labels).encode())
    with pytest.raises(DataFileError, match=r"labels.jsonl: line 1: its picture is not \d+x\d+"):
        run(root, ["got10k"], None, ExportOptions())


@pytest.mark.parametrize("spoil", ["cut", "flip", "delete", "no sums", "cut sums"])
def test_a_finished_export_that_was_damaged_is_made_again(data, tmp_path, caplog, spoil):
    folder = tmp_path / "otb"
    export(data, "otb", folder, ExportOptions())
    made = contents(folder).items()
    pictures_and_boxes = {name: content for name, content in made if name.startswith("train")}
    path = sorted(folder.glob("train/*/groundtruth_rect.txt"))[0]
    if spoil == "cut":
        path.write_bytes(path.read_bytes()[:20])
    elif spoil == "flip":
        content = bytearray(path.read_bytes())
        content[3] ^= 1
        path.write_bytes(content)
    elif spoil == "cut sums":
        path = folder / CHECKSUMS
        path.write_bytes(path.read_bytes()[:70])
    else:
        path = folder / CHECKSUMS if spoil == "no sums" else path
        path.unlink()
    (folder / "my notes.txt").write_text("mine")
    export(data, "otb", folder, ExportOptions(resume=True))
    assert (folder / "my notes.txt").read_text() == "mine"
    assert {name: contents(folder).get(name) for name in pictures_and_boxes} == pictures_and_boxes
    assert f"{path}: not as it was exported" in caplog.text
    caplog.clear()
    export(data, "otb", folder, ExportOptions(resume=True))
    assert not caplog.text
