"""MOTChallenge, read and scored by TrackEval."""

from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
import trackeval

from eyas.datasets.format import CLASS_NAMES, objects_of

NAMES = list(CLASS_NAMES.values())

# Its evaluator calls np.float and the like only where it prints; it divides 0 by 0 without objects.
pytestmark = pytest.mark.filterwarnings("ignore:invalid value encountered:RuntimeWarning")


def scored(folder: Path, tracks: Path) -> float:
    """Return the HOTA of tracks, the mean over all thresholds."""
    with redirect_stdout(StringIO()):
        data = trackeval.datasets.MotChallenge2DBox({
            "GT_FOLDER": str(folder), "TRACKERS_FOLDER": str(tracks), "BENCHMARK": "EYAS",
            "SPLIT_TO_EVAL": "train", "PRINT_CONFIG": False,
        })  # fmt: skip
        hota = trackeval.metrics.HOTA()
        results = {}
        for name in data.seq_list:
            raw = data.get_raw_seq_data("truth", name)
            results[name] = hota.eval_sequence(data.get_preprocessed_seq_data(raw, "pedestrian"))
        return float(np.mean(hota.combine_sequences(results)["HOTA"]))


def write_tracks(folder: Path, tracks: Path, shift: float) -> None:
    """Write the truth as the tracks of a tracker, its boxes moved by a share of their width."""
    (tracks / "EYAS-train/truth/data").mkdir(parents=True)
    for path in folder.glob("EYAS-train/*/gt/gt.txt"):
        rows = np.loadtxt(path, delimiter=",", ndmin=2)
        if rows.size:
            rows[:, 2] += shift * rows[:, 4]
            rows[:, 6:] = [1, -1, -1]
        name = path.parent.parent.name
        np.savetxt(tracks / f"EYAS-train/truth/data/{name}.txt", rows, delimiter=",", fmt="%g")


@pytest.mark.parametrize(("shift", "low", "high"), [(0.0, 1.0, 1.0), (0.3, 0.1, 0.7)])
def test_truth_against_itself_scores_one_and_shifted_less(exported, tmp_path, shift, low, high):
    folder = exported("mot")
    write_tracks(folder, tmp_path / "tracks", shift)
    assert low <= round(scored(folder, tmp_path / "tracks"), 9) <= high


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
