"""MOTChallenge and KITTI, read and scored by TrackEval, where it is installed.

It brings another OpenCV than ours; `tools/check_peers.py` runs it in an environment of its own.
"""

from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
import trackeval

# It divides 0 by 0 where a sequence has no objects.
pytestmark = pytest.mark.filterwarnings("ignore:invalid value encountered:RuntimeWarning")


def mot_score(folder: Path, tracks: Path) -> float:
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
def test_truth_of_mot_against_itself_scores_one_and_shifted_less(
    exported, tmp_path, shift, low, high
):
    folder = exported("mot")
    write_tracks(folder, tmp_path / "tracks", shift)
    assert low <= round(mot_score(folder, tmp_path / "tracks"), 9) <= high


def kitti_score(folder: Path, tracks: Path, split: str, name: str) -> float | None:
    """Return the HOTA of a class; None if nothing of it is evaluated."""
    with redirect_stdout(StringIO()):
        data = trackeval.datasets.Kitti2DBox({
            "GT_FOLDER": str(folder / split), "TRACKERS_FOLDER": str(tracks),
            "CLASSES_TO_EVAL": [name], "SPLIT_TO_EVAL": split, "PRINT_CONFIG": False,
        })  # fmt: skip
        hota, results = trackeval.metrics.HOTA(), {}
        for sequence in data.seq_list:
            raw = data.get_raw_seq_data("truth", sequence)
            found = data.get_preprocessed_seq_data(raw, name)
            if found["num_gt_dets"]:
                results[sequence] = hota.eval_sequence(found)
        return float(np.mean(hota.combine_sequences(results)["HOTA"])) if results else None


@pytest.mark.parametrize(("shift", "low", "high"), [(0.0, 1.0, 1.0), (8.0, 0.0, 0.8)])
def test_truth_of_kitti_against_itself_scores_one_and_shifted_less(
    exported, tmp_path, shift, low, high
):
    folder = exported("kitti")
    scores = []
    for split in ("training", "validation"):
        tracks = tmp_path / split
        (tracks / "truth/data").mkdir(parents=True)
        for path in (folder / split / "label_02").iterdir():
            rows = [row.split() for row in path.read_text().splitlines()]
            for row in rows:
                row[6], row[8] = (str(float(row[column]) + shift) for column in (6, 8))
            text = "".join(" ".join([*row, "1"]) + "\n" for row in rows)
            (tracks / "truth/data" / path.name).write_text(text)
        scores += [kitti_score(folder, tracks, split, name) for name in ("car", "pedestrian")]
    told = [score for score in scores if score is not None]
    assert len(told) >= 3
    assert all(low <= round(score, 9) <= high for score in told)
