"""VisDrone and UAVDT, read back by what their owners say of the columns."""

import re

import numpy as np
import pytest
from globox import Annotation, BoxFormat

from eyas.datasets.formats import uavdt
from eyas.engine.recordings.format import objects_of

VISDRONE = {"person": 1, "car": 4, "truck": 6, "bus": 9, "motorcycle": 10, "robot": 11,
            "bicycle": 3, "boat": 11, "train": 11}  # fmt: skip
UAVDT = {"car": 1, "truck": 2, "bus": 3}


def rows_of(path) -> list[list[int]]:
    return [[int(value) for value in row.split(",")] for row in path.read_text().splitlines()]


def expected(label, name) -> list[int]:
    left, top, right, bottom = label["box"]
    share, visible = label["truncated"], label["visible_fraction"]
    hidden = 0 if visible == 1.0 else 1 if visible >= 0.5 else 2
    counts = int(name != "robot" and share <= 0.5)
    box = [left, top, right - left, bottom - top]
    return [*box, counts, VISDRONE[name], int(share > 0), hidden]


def test_visdrone_det_has_the_columns_of_the_challenge(exported, data):
    folder = exported("visdrone-det")
    levels = set()
    for episode in data:
        root = folder / f"VisDrone2019-DET-{episode.split}"
        for frame in episode:
            name = f"{episode.name}_{frame.number:06d}"
            assert (root / f"images/{name}.jpg").is_file()
            seen = [expected(each.label, each.name) for each in objects_of(frame.label)]
            assert rows_of(root / f"annotations/{name}.txt") == seen
            levels.update((row[4], row[6], row[7]) for row in seen)
    for column in range(3):
        assert {0, 1} <= {level[column] for level in levels}


def test_globox_reads_the_boxes_of_visdrone(exported, data, tmp_path):
    root = exported("visdrone-det") / "VisDrone2019-DET-train"
    for frame in data.split("train")[0]:
        path = root / f"annotations/{data[0].name}_{frame.number:06d}.txt"
        # It takes a class first, so that column is brought there.
        rows = [[r[5], *r[:4]] for r in rows_of(path)]
        turned = tmp_path / path.name
        turned.write_text("".join(",".join(map(str, row)) + "\n" for row in rows))
        found = Annotation.from_txt(turned, box_format=BoxFormat.LTWH, separator=",")
        for box, each in zip(found.boxes, objects_of(frame.label), strict=True):
            assert list(box.ltrb) == each.label["box"]
            assert box.label == str(VISDRONE[each.name])


def test_visdrone_mot_has_frames_from_one_and_tracks(exported, data):
    folder = exported("visdrone-mot")
    for episode in data:
        root = folder / f"VisDrone2019-MOT-{episode.split}"
        seen = [
            [frame.number + 1, each.label["id"], *expected(each.label, each.name)]
            for frame in episode
            for each in objects_of(frame.label)
        ]
        assert rows_of(root / f"annotations/{episode.name}.txt") == seen
        pictures = sorted(path.name for path in (root / f"sequences/{episode.name}").iterdir())
        assert pictures == [f"{number:07d}.jpg" for number in range(1, len(episode) + 1)]


def test_visdrone_sot_is_read_as_pytracking_does(exported, data):
    folder = exported("visdrone-sot")
    for episode in data:
        root = folder / f"VisDrone2019-SOT-{episode.split}"
        boxes = np.loadtxt(root / f"annotations/{episode.name}.txt", delimiter=",", ndmin=2)
        names = [path.name for path in (root / f"sequences/{episode.name}").iterdir()]
        assert sorted(int(name[3:-4]) for name in names) == list(range(1, len(episode) + 1))
        for box, label in zip(boxes.tolist(), episode.labels, strict=True):
            left, top, right, bottom = label["target_box"]
            assert box == [left, top, right - left, bottom - top]


def test_uavdt_has_the_columns_of_its_owners(exported, data):
    folder = exported("uavdt")
    truth = folder / "UAV-benchmark-MOTD_v1.0/GT"
    codes = set()
    for episode in data:
        counted, ignored = [], []
        for frame in episode:
            for each in objects_of(frame.label):
                left, top, right, bottom = each.label["box"]
                box = [left, top, right - left, bottom - top]
                row = [frame.number + 1, each.label["id"], *box]
                share, hidden = each.label["truncated"], 1 - each.label["visible_fraction"]
                if each.name in UAVDT and share <= 0.5:
                    out = 1 if share == 0 else 3 if share <= 0.3 else 2
                    behind = 1 if hidden == 0 else 4 if hidden <= 0.3 else 3 if hidden <= 0.7 else 2
                    counted.append([*row, out, behind, UAVDT[each.name]])
                    codes.add((out, behind))
                elif each.name in {*UAVDT, "motorcycle"}:
                    ignored.append([*row, 1, -1, -1])
        assert rows_of(truth / f"{episode.name}_gt_whole.txt") == counted
        assert rows_of(truth / f"{episode.name}_gt_ignore.txt") == ignored
        short = [[*row[:6], 1, row[8], -1] for row in counted]
        assert rows_of(truth / f"{episode.name}_gt.txt") == short
        pictures = sorted((folder / f"UAV-benchmark-M/{episode.name}").iterdir())
        assert [path.name for path in pictures] == [
            f"img{number:06d}.jpg" for number in range(1, len(episode) + 1)
        ]
    assert len(codes) >= 4


def test_attributes_of_uavdt(exported, data):
    folder = exported("uavdt")
    paths = sorted((folder / "M_attr/train").iterdir())
    assert len(paths) == len(data)
    for path in paths:
        text = path.read_text()
        assert re.fullmatch(r"([01],){9}[01]\n", text)
        facts = [int(value) for value in text.split(",")]
        assert facts[:3] == [1, 0, 0]  # by day
        assert facts[3:6] == [1, 0, 0]  # below 30 m
        assert sum(facts[6:9]) == 1
        assert facts[9] == 0


@pytest.mark.parametrize("name", ["visdrone-det", "visdrone-mot", "uavdt"])
def test_what_is_to_be_ignored_is_marked(exported, name):
    folder = exported(name, least_side=12)
    rows = [
        row
        for path in sorted(folder.rglob("*.txt"))
        if "attr" not in path.name and "_gt.txt" not in path.name
        for row in rows_of(path)
    ]
    marks = set()
    for row in rows:
        if name == "uavdt":
            box, ignored = row[2:6], row[7] == -1
        else:
            box, ignored = (row[2:6], row[6] == 0) if len(row) == 10 else (row[:4], row[4] == 0)
        marks.add((min(box[2:]) < 12, ignored))
    assert (True, True) in marks
    assert (False, False) in marks
    assert (True, False) not in marks


@pytest.mark.parametrize(("low", "high", "levels"), [(5.0, 70.0, [0, 1, 0]), (5.0, 8.0, [0, 0, 1])])
def test_levels_of_altitude(exported, monkeypatch, low, high, levels):
    monkeypatch.setattr(uavdt, "LOW", low)
    monkeypatch.setattr(uavdt, "HIGH", high)
    for path in (exported("uavdt") / "M_attr/train").iterdir():
        assert [int(value) for value in path.read_text().split(",")[3:6]] == levels
