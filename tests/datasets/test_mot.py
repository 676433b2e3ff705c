"""MOTChallenge, read back; `test_hota.py` has TrackEval score it."""

import pytest

from eyas.engine.recordings.format import CLASS_NAMES, objects_of

NAMES = list(CLASS_NAMES.values())


def test_true_classes_visibility_and_detections_stand_beside(exported, data):
    folder = exported("mot")
    for episode in data:
        own = folder / f"EYAS-{episode.split}" / episode.name / "gt"
        names = (own / "labels.txt").read_text().split()
        assert names == NAMES
        rows = (own / "gt_class.txt").read_text().splitlines()
        seen = [(f.number, s) for f in episode for s in objects_of(f.label)]
        detections = (own.parent / "det/det.txt").read_text().splitlines()
        for row, found, (number, each) in zip(rows, detections, seen, strict=True):
            values = [float(value) for value in row.split(",")]
            left, top, right, bottom = each.label["box"]
            box = [left + 1, top + 1, right - left, bottom - top]
            assert values[:6] == [number + 1, each.label["id"], *box]
            assert names[int(values[7]) - 1] == each.name
            visible = each.label["visible_fraction"] * (1 - each.label["truncated"])
            assert values[8] == pytest.approx(visible, abs=1e-5)
            left, top, right, bottom = each.label["visible_box"]
            box = [left + 1, top + 1, right - left, bottom - top]
            assert [float(value) for value in found.split(",")][2:6] == box


def test_seqinfo_tells_rate_length_and_size(exported, data):
    folder = exported("mot")
    text = (folder / f"EYAS-train/{data[0].name}/seqinfo.ini").read_text()
    assert f"seqLength={len(data[0])}\nimWidth=160\nimHeight=120\nimExt=.jpg\n" in text
    assert "frameRate=10\n" in text
    listed = (folder / "seqmaps/EYAS-val.txt").read_text().splitlines()
    assert listed == ["name", *(episode.name for episode in data.split("val"))]
