"""TrackEval gives the truth of MOTChallenge and KITTI a HOTA of 1, boxes that are moved less."""

import sys
import tempfile
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import numpy as np
import trackeval

SHIFTS = (0.0, 0.3)
"""Shares of their width by which boxes are moved."""


def mot_score(folder: Path, tracks: Path, shift: float) -> float:
    """Return the HOTA of the boxes of MOTChallenge, moved by a share of their width."""
    (tracks / "EYAS-train/truth/data").mkdir(parents=True)
    for path in folder.glob("EYAS-train/*/gt/gt.txt"):
        rows = np.loadtxt(path, delimiter=",", ndmin=2)
        if rows.size:
            rows[:, 2] += shift * rows[:, 4]
            rows[:, 6:] = [1, -1, -1]
        name = path.parent.parent.name
        np.savetxt(tracks / f"EYAS-train/truth/data/{name}.txt", rows, delimiter=",", fmt="%g")
    settings = {"GT_FOLDER": str(folder), "TRACKERS_FOLDER": str(tracks), "BENCHMARK": "EYAS"}
    told = {"SPLIT_TO_EVAL": "train", "PRINT_CONFIG": False}
    return scored(trackeval.datasets.MotChallenge2DBox({**settings, **told}), "pedestrian")


def kitti_score(folder: Path, tracks: Path, shift: float) -> float:
    """Return the HOTA of the cars of KITTI, moved by a share of their width."""
    (tracks / "truth/data").mkdir(parents=True)
    for path in (folder / "training/label_02").iterdir():
        rows = [row.split() for row in path.read_text().splitlines()]
        for row in rows:
            left, right = float(row[6]), float(row[8])
            row[6], row[8] = (str(side + shift * (right - left)) for side in (left, right))
        text = "".join(" ".join([*row, "1"]) + "\n" for row in rows)
        (tracks / "truth/data" / path.name).write_text(text)
    settings = {"GT_FOLDER": str(folder / "training"), "TRACKERS_FOLDER": str(tracks)}
    told = {"CLASSES_TO_EVAL": ["car"], "SPLIT_TO_EVAL": "training", "PRINT_CONFIG": False}
    return scored(trackeval.datasets.Kitti2DBox({**settings, **told}), "car")


def scored(data: "trackeval.datasets._base_dataset._BaseDataset", name: str) -> float:
    """Return the HOTA of a class, the mean over all thresholds."""
    hota, results = trackeval.metrics.HOTA(), {}
    for sequence in data.seq_list:
        found = data.get_preprocessed_seq_data(data.get_raw_seq_data("truth", sequence), name)
        if found["num_gt_dets"]:
            results[sequence] = hota.eval_sequence(found)
    assert results, f"nothing of class {name} was read"
    return float(np.mean(hota.combine_sequences(results)["HOTA"]))


exports = Path(sys.argv[1], "exports")
for form, score in (("mot", mot_score), ("kitti", kitti_score)):
    with tempfile.TemporaryDirectory() as scratch, redirect_stdout(StringIO()):
        whole, moved = (score(exports / form, Path(scratch, str(s)), s) for s in SHIFTS)
    print(f"trackeval: {form}: HOTA {whole:.6f} of the truth, {moved:.3f} of moved boxes")
    assert round(whole, 9) == 1.0
    assert 0.05 < moved < 0.8
