"""Tables as nuScenes has them: complete, chained, and their boxes projected again.

`tools/check_peers.py nuscenes` has its own devkit read them.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from eyas.engine.exports.boxes import quaternion_of
from eyas.engine.recordings.format import objects_of

TABLES = {
    "attribute", "calibrated_sensor", "category", "ego_pose", "instance", "log", "map", "sample",
    "sample_annotation", "sample_data", "scene", "sensor", "visibility",
}  # fmt: skip


@pytest.fixture
def folder(exported) -> Path:
    return exported("nuscenes")


def tables_of(folder: Path, split: str) -> dict[str, dict[str, dict]]:
    """Return the rows of each table by their tokens."""
    found = {}
    for path in (folder / f"v1.0-{split}").iterdir():
        rows = json.loads(path.read_text())
        found[path.stem] = {row["token"]: row for row in rows}
        assert len(found[path.stem]) == len(rows), path
    return found


def rotation(quaternion) -> np.ndarray:
    return Rotation.from_quat(quaternion, scalar_first=True).as_matrix()


@pytest.mark.parametrize("split", ["train", "val"])
def test_every_token_leads_to_a_row(folder, split):
    tables = tables_of(folder, split)
    assert tables.keys() == TABLES
    for rows in tables.values():
        for row in rows.values():
            for key, value in row.items():
                if key.endswith("_token") and key != "visibility_token":
                    name = key.removesuffix("_token")
                    name = {"first_sample": "sample", "last_sample": "sample",
                            "first_annotation": "sample_annotation",
                            "last_annotation": "sample_annotation"}.get(name, name)  # fmt: skip
                    assert value in tables[name], key
                elif key == "attribute_tokens":
                    assert all(token in tables["attribute"] for token in value)
                elif key == "visibility_token":
                    assert value in tables["visibility"]
                elif key == "filename":
                    assert (folder / value).is_file()


def test_samples_and_instances_are_chains(folder, data):
    tables = tables_of(folder, "train")
    for scene in tables["scene"].values():
        names, token = [], scene["first_sample_token"]
        while token:
            names.append(token)
            token = tables["sample"][token]["next"]
        assert len(names) == scene["nbr_samples"]
        assert names[-1] == scene["last_sample_token"]
    gaps = 0
    for instance in tables["instance"].values():
        token, times = instance["first_annotation_token"], []
        while token:
            row = tables["sample_annotation"][token]
            assert row["instance_token"] == instance["token"]
            times.append(tables["sample"][row["sample_token"]]["timestamp"])
            last, token = token, row["next"]
            assert not token or tables["sample_annotation"][token]["prev"] == last
        assert last == instance["last_annotation_token"]
        assert len(times) == instance["nbr_annotations"]
        assert times == sorted(set(times))
        gaps += any(np.diff(times) > 150_000)
    assert gaps, "no object is absent for a while"


def test_boxes_projected_again_are_those_of_the_labels(folder, data):
    checked = 0
    for split in ("train", "val"):
        tables = tables_of(folder, split)
        pictures = {row["sample_token"]: row for row in tables["sample_data"].values()}
        by_file = {Path(row["filename"]).stem: token for token, row in pictures.items()}
        rows = {}
        for row in tables["sample_annotation"].values():
            rows.setdefault(row["sample_token"], []).append(row)
        for episode in data.split(split):
            for frame in episode:
                token = by_file[f"{episode.name}__{frame.number:06d}"]
                picture = pictures[token]
                ego = tables["ego_pose"][picture["ego_pose_token"]]
                camera = tables["calibrated_sensor"][picture["calibrated_sensor_token"]]
                placed = rotation(ego["rotation"]) @ camera["translation"] + ego["translation"]
                assert placed == pytest.approx(frame.label["camera_position"], abs=1e-5)
                seen = list(objects_of(frame.label))
                for row, each in zip(rows.get(token, []), seen, strict=True):
                    corners = corners_of(row)
                    expected = np.array(each.label["corners"])
                    assert corners == pytest.approx(expected, abs=0.3)
                    body = (corners - ego["translation"]) @ rotation(ego["rotation"])
                    inside = (body - camera["translation"]) @ rotation(camera["rotation"])
                    pixels = inside @ np.array(camera["camera_intrinsic"]).T
                    pixels = pixels[:, :2] / pixels[:, 2:]
                    checked += check(pixels, each.label)
    assert checked > 20


def corners_of(row: dict) -> np.ndarray:
    """Return the corners of an annotation in the order of the labels."""
    width, length, height = row["size"]
    along = np.array([-1, 1, 1, -1] * 2) * length / 2
    aside = np.array([-1, -1, 1, 1] * 2) * width / 2
    up = np.repeat([-1, 1], 4) * height / 2
    return np.stack([along, aside, up], axis=1) @ rotation(row["rotation"]).T + row["translation"]


def check(pixels: np.ndarray, label: dict) -> bool:
    """Compare projected corners with the whole box of what is inside the picture and rigid."""
    if label["truncated"] > 0.0 or "posed_corners" in label:
        return False
    low, high = np.split(np.array(label["whole_box"]), 2)
    # The box stands around the body, whose corners are round.
    assert (pixels.min(axis=0) <= low + 1.0).all()
    assert (pixels.max(axis=0) >= high - 1.0).all()
    assert (np.ptp(pixels, axis=0) <= 1.8 * (high - low) + 2.0).all()
    return True


def test_categories_visibility_and_words(folder, data):
    tables = tables_of(folder, "train")
    names = {row["name"] for row in tables["category"].values()}
    assert {"vehicle.car", "human.pedestrian.adult"} <= names
    used = {row["visibility_token"] for row in tables["sample_annotation"].values()}
    assert "4" in used
    assert len(used) >= 2
    moving = {
        tables["attribute"][token]["name"]
        for row in tables["sample_annotation"].values()
        for token in row["attribute_tokens"]
    }
    assert {"vehicle.moving", "pedestrian.moving"} <= moving
    (first,) = (s for s in tables["scene"].values() if s["name"] == data[0].name)
    assert first["description"] == f"citystreet, day: {data[0].labels[0]['target_words']}"


def test_quaternions_are_those_of_scipy():
    for turn in Rotation.random(200, rng=np.random.default_rng(3)):
        expected = turn.as_quat(canonical=True, scalar_first=True)
        assert quaternion_of(turn.as_matrix()) == pytest.approx(expected, abs=1e-12)
    for axis in np.eye(3):
        half = np.array(quaternion_of(Rotation.from_rotvec(np.pi * axis).as_matrix()))
        assert np.abs(half[1:]) == pytest.approx(axis, abs=1e-12)
