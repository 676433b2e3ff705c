"""KITTI tracking: its columns, and its 3D boxes, projected again."""

from pathlib import Path

import numpy as np
import pytest

from eyas.engine.recordings.format import objects_of


def read_rows(path: Path) -> np.ndarray:
    return np.loadtxt(path, ndmin=2)


def corners_of(row: list[str], camera: np.ndarray) -> np.ndarray:
    """Return the corners of a KITTI box in the camera's frame, as its readers do, but upright in
    the world: with the tilt that the pose tells.
    """
    height, width, length = (float(value) for value in row[10:13])
    turn = float(row[16])
    along = np.array([-1, 1, 1, -1] * 2) * length / 2
    across = np.array([-1, -1, 1, 1] * 2) * width / 2  # KITTI's z, left of the heading
    up = np.array([0.0] * 4 + [-height] * 4)
    level = np.stack([
        np.cos(turn) * along + np.sin(turn) * across, up,
        -np.sin(turn) * along + np.cos(turn) * across,
    ])  # fmt: skip
    ahead = np.cross(camera[:, 0], [0.0, 0.0, 1.0])  # of a level camera with the same right
    ahead = -ahead / np.linalg.norm(ahead)
    levelled = np.stack([np.cross(ahead, [0, 0, 1]), [0, 0, -1], ahead], axis=1)
    return (camera.T @ levelled @ level).T + [float(value) for value in row[13:16]]


def test_boxes_projected_again_are_those_of_the_labels(exported, data):
    folder = exported("kitti")
    checked = 0
    for episode in data:
        own = folder / {"train": "training", "val": "validation"}[episode.split]
        poses = read_rows(own / f"poses/{episode.name}.txt").reshape(-1, 3, 4)
        matrices = read_rows(own / f"intrinsics/{episode.name}.txt").reshape(-1, 3, 3)
        calibration = (own / f"calib/{episode.name}.txt").read_text().splitlines()
        assert calibration[2].split()[0] == "P2:"
        p2 = np.array(calibration[2].split()[1:], float).reshape(3, 4)
        assert np.array_equal(p2[:, :3], matrices[0])
        rows = [
            row.split() for row in (own / f"label_02/{episode.name}.txt").read_text().splitlines()
        ]
        seen = [(f.number, s) for f in episode for s in objects_of(f.label)]
        for row, (number, each) in zip(rows, seen, strict=True):
            assert [int(row[0]), int(row[1])] == [number, each.label["id"]]
            pose = poses[number]
            inside = corners_of(row, pose[:, :3])
            world = inside @ pose[:, :3].T + pose[:, 3]
            assert world == pytest.approx(np.array(each.label["corners"]), abs=0.25)
            centre = inside.mean(axis=0)
            assert np.linalg.norm(centre) == pytest.approx(each.label["distance"], abs=1.5)
            pixels = inside @ matrices[number].T
            pixels = pixels[:, :2] / pixels[:, 2:]
            low, high = np.split(np.array(each.label["whole_box"]), 2)
            if each.label["truncated"] == 0.0 and "posed_corners" not in each.label:
                # The box stands around the body, whose corners are round.
                assert (pixels.min(axis=0) <= low + 1.0).all()
                assert (pixels.max(axis=0) >= high - 1.0).all()
                assert (np.ptp(pixels, axis=0) <= 1.8 * (high - low) + 2.0).all()
                checked += 1
    assert checked > 20


def test_levels_and_angles(exported, data):
    folder = exported("kitti")
    levels = set()
    for episode in data.split("train"):
        rows = (folder / f"training/label_02/{episode.name}.txt").read_text().splitlines()
        seen = [(f.label, s.label) for f in episode for s in objects_of(f.label)]
        for row, (frame, label) in zip((row.split() for row in rows), seen, strict=True):
            share, visible = label["truncated"], label["visible_fraction"]
            assert int(row[3]) == (0 if share == 0 else 1 if share <= 0.5 else 2)
            assert int(row[4]) == (0 if visible == 1 else 1 if visible >= 0.5 else 2)
            levels.add(row[4])
            # Seen from exactly behind, whatever the pitch, alpha is -90 degrees.
            alpha, turn = float(row[5]), float(row[16])
            away = np.subtract(label["centre"], frame["camera_position"])
            bearing = label["yaw"] - np.arctan2(away[1], away[0])
            assert np.exp(1j * alpha) == pytest.approx(-1j * np.exp(-1j * bearing), abs=0.06)
            assert -np.pi <= alpha <= np.pi
            assert -np.pi <= turn <= np.pi
    assert levels == {"0", "1", "2"}


def test_what_is_ignored_is_dont_care(exported):
    folder = exported("kitti", least_side=10)
    texts = [path.read_text() for path in folder.glob("*/label_02/*.txt")]
    rows = [row.split() for text in texts for row in text.splitlines()]
    assert all(len(row) == 17 for row in rows)
    small = [min(float(r[8]) - float(r[6]), float(r[9]) - float(r[7])) < 10 for r in rows]
    assert small == [row[2] == "DontCare" for row in rows]
    assert len(set(small)) == 2
