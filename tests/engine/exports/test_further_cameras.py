"""Recordings of cameras beside a tracker's own, and of clean pictures beside corrupted ones."""

import json

import numpy as np
from PIL import Image

import eyas


def _recorded(tmp_path, **settings) -> list:
    eyas.record(
        {
            "camera": {"width": 48, "height": 36, **settings.pop("camera", {})},
            "video": {
                "channels": 1, "fps": 10, "total_time": 0.3,
                "writers": ["png", "labels", *settings.pop("writers")],
            },
            **settings,
        },
        out=tmp_path / "run",
    )  # fmt: skip
    return sorted((tmp_path / "run").glob("*/episode0"))


def test_a_stereo_pair_is_recorded_with_its_baseline(tmp_path):
    right = {"name": "right", "width": 48, "height": 36, "mount": {"y": -0.12}}
    wide = {"name": "wide", "width": 40, "height": 20, "field_of_view": 1.6}
    (episode,) = _recorded(tmp_path, cameras=[right, wide], writers=["cameras"])
    frames = len(list(episode.glob("*.png")))
    assert frames >= 3
    assert {path.name for path in (episode / "cameras").iterdir()} == {
        f"{camera:02d}-{frame:06d}.png" for camera in (0, 1) for frame in range(frames)
    }
    told = json.loads((episode / "cameras.json").read_text())["cameras"]
    assert [camera["name"] for camera in told] == ["right", "wide"]
    assert len(told[0]["poses"]) == frames
    for pose in told[0]["poses"]:
        assert np.allclose(pose["from_own"]["position"], [0.0, -0.12, 0.0], atol=1e-9)
        assert np.allclose(pose["from_own"]["rotation"], np.eye(3), atol=1e-9)
    left = np.asarray(Image.open(episode / "000000.png"))
    other = np.asarray(Image.open(episode / "cameras" / "00-000000.png"))
    assert left.shape == other.shape
    assert not np.array_equal(left, other)
    assert np.abs(left.astype(int) - other).mean() < 20  # the same street
    assert np.asarray(Image.open(episode / "cameras" / "01-000000.png")).shape == (20, 40, 3)


def test_clean_pictures_lie_beside_corrupted_ones(tmp_path):
    (episode,) = _recorded(tmp_path, sensors={"camera": {"noise": 20.0}}, writers=["clean"])
    (plain,) = _recorded(tmp_path / "plain", writers=["clean"])
    for frame in range(3):
        noisy, clean, other = (
            np.asarray(Image.open(path))
            for path in (
                episode / f"{frame:06d}.png",
                episode / "clean" / f"{frame:06d}.png",
                plain / f"{frame:06d}.png",
            )
        )
        assert np.array_equal(clean, other)
        assert (noisy.astype(float) - clean).std() > 15.0
