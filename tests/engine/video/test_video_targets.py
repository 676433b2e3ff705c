"""What is followed, from the settings to the labels: `eyas video` for each sort of target."""

import importlib
import json
import re
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from eyas.cli.app import run
from eyas.engine.exports.label import Label, read_labels
from eyas.engine.state.scene import ObjectClass

ROOT = Path(__file__).parents[3]

WRITER = '''
import numpy as np

from eyas.engine.exports.writer import Files
from eyas.engine.exports.writer import Gather
from eyas.engine.exports.writer import Summary
from eyas.engine.exports.writer import Writer


class Pixels(Writer):
    """The pictures of an episode, of what they show, and of its classes."""

    wants = frozenset({"rgb", "object_id", "class_id"})
    files = Files(episode=("pixels.bin",))

    def begin(self, episode):
        self.shape = (episode.height, episode.width, 5)
        return Gather(episode.folder / "pixels.bin", layers, b"".join)

    def read(self, folder):
        return None


def layers(frame):
    rgb, what, kind = frame.rgb, frame.object_id, frame.class_id
    return np.dstack([rgb, what, kind]).astype("<i4").tobytes()
'''

WIDTH, HEIGHT = 96, 72


class Recorded(NamedTuple):
    """One episode of a second and a half."""

    labels: list[Label]
    pixels: np.ndarray
    """Red, green, blue, object and class, shape (frames, HEIGHT, WIDTH, 5)."""

    def shown(self, label: Label) -> np.ndarray:
        """Return the colour and class of the target's pixels, shape (K, 4)."""
        picture = self.pixels[label["frame"]]
        own = picture[..., 3] == label["target_id"]
        return picture[own][:, [0, 1, 2, 4]]

    def moved(self) -> float:
        """Return how far the target is from where it was at first [m]."""
        first, last = (self.labels[k]["target_position"] for k in (0, -1))
        return float(np.hypot(*np.subtract(last, first)[:2]))

    def seconds(self) -> float:
        """Return the time from the first frame to the last [s]."""
        return self.labels[-1]["time"] - self.labels[0]["time"]


@pytest.fixture
def record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return a function that records what settings ask for."""
    (tmp_path / "pixel_writer.py").write_text(WRITER)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.syspath_prepend(ROOT / "examples")
    importlib.invalidate_caches()

    def recorded(**settings: object) -> Recorded:
        always = {
            "camera": {"width": WIDTH, "height": HEIGHT},
            "start": {"pitch": 1.2, "height": 8.0},
            "video": {
                "channels": 1,
                "total_time": 1.5,
                "flight": "exact",
                "writers": ["labels", "pixel_writer:Pixels"],
            },
        }
        (tmp_path / "settings.json").write_text(json.dumps({**always, **settings}))
        out, given = tmp_path / "out", str(tmp_path / "settings.json")
        command = ["eyas", "video", "--quiet", "--overwrite", "--trust", "--config", given]
        monkeypatch.setattr(sys, "argv", [*command, "--out", str(out)])
        assert run() == 0
        episode = out / "DRONE0" / "episode0"
        pixels = np.frombuffer((episode / "pixels.bin").read_bytes(), "<i4")
        return Recorded(read_labels(episode / "labels.jsonl"), pixels.reshape(-1, HEIGHT, WIDTH, 5))

    return recorded


def assert_pixels_agree(recorded: Recorded, kind: ObjectClass) -> None:
    """The box of the label holds the pixels of the target, which are of its class."""
    assert len(recorded.labels) == len(recorded.pixels) > 20
    for label in recorded.labels:
        own = recorded.pixels[label["frame"]][..., 3] == label["target_id"]
        row, column = np.nonzero(own)
        assert len(row) > 20
        left, top, right, bottom = label["target_box"]
        assert left <= column.min() <= column.max() < right
        assert top <= row.min() <= row.max() < bottom
        if not label["occluded"]:
            found = [column.min(), row.min(), column.max() + 1, row.max() + 1]
            assert label["target_box"] == found
        assert set(recorded.shown(label)[:, 3]) == {kind}
        corners = np.array(label["target_corners"])
        assert np.ptp(corners[:, 2]) == pytest.approx(label["target_size"][2], abs=0.1)


@pytest.mark.slow
def test_a_pedestrian(record):
    recorded = record(target="Pedestrian", seed=3)
    assert_pixels_agree(recorded, ObjectClass.PERSON)
    label = recorded.labels[0]
    assert label["target_type"].startswith("Pedestrian")
    assert label["target_size"] == pytest.approx([0.4, 0.6, 1.8], rel=0.2)
    assert re.match(r"an? pedestrian in an? \w+", label["target_words"])
    ways = [label["target_travelled"] for label in recorded.labels]
    assert ways[-1] - ways[0] == pytest.approx(2.0 * recorded.seconds(), rel=0.05)
    assert 1.0 < recorded.moved() <= ways[-1] - ways[0] + 0.01


def crate(path: Path) -> None:
    """Write a box 1.2 m long whose texture is red on one half and blue on the other."""
    trimesh = pytest.importorskip("trimesh")
    from PIL import Image

    halves = np.zeros((32, 32, 3), np.uint8)
    halves[:16], halves[16:] = (
        (30, 40, 210),
        (210, 20, 20),
    )  # the upper half of a picture is v > 0.5
    box = trimesh.creation.box((0.8, 0.8, 1.2))  # y is up, z ahead
    uv = np.column_stack([box.vertices[:, 0] + 0.5, box.vertices[:, 2] / 1.2 + 0.5])
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.fromarray(halves))
    visual = trimesh.visual.TextureVisuals(uv=np.clip(uv, 0.01, 0.99), material=material)
    trimesh.Trimesh(box.vertices, box.faces, visual=visual, process=False).export(path)


@pytest.mark.slow
def test_a_mesh_file_in_the_settings_alone(record, tmp_path: Path):
    crate(tmp_path / "blue_red_crate.glb")
    mesh = {"mesh": str(tmp_path / "blue_red_crate.glb"), "behaviour": "straight", "speed": 1.5}
    recorded = record(custom=mesh)
    assert_pixels_agree(recorded, ObjectClass.ROBOT)
    for label in recorded.labels:
        assert label["target_type"] == "blue_red_crate"
        assert label["target_size"] == pytest.approx([1.2, 0.8, 0.8], abs=1e-6)
        assert label["target_words"] == "a blue red crate"
        red, blue = recorded.shown(label)[:, [0, 2]].T
        # Both colours of its texture are seen from above, and little else.
        assert (red > 1.5 * blue).mean() > 0.2
        assert (blue > 1.5 * red).mean() > 0.2
    assert recorded.moved() == pytest.approx(1.5 * recorded.seconds(), rel=0.05)
    told = record(custom={**mesh, "words": "a parcel"}, video={"flight": "exact", "total_time": 0.1,
                  "channels": 1, "writers": ["labels", "pixel_writer:Pixels"]})  # fmt: skip
    assert told.labels[0]["target_words"] == "a parcel"


@pytest.mark.slow
def test_a_class_of_a_users_package(record):
    recorded = record(custom={"path": "own_target:Sprinkler"}, world={"map": "farmland"})
    assert_pixels_agree(recorded, ObjectClass.ROBOT)
    label = recorded.labels[-1]
    assert (label["target_type"], label["target_words"]) == ("Sprinkler", "a sprinkler")
    assert label["target_size"] == [3.2, 3.2, 1.1]
    red, green, blue = recorded.shown(label)[:, :3].T
    assert ((green > red) & (green > blue)).any()  # its box
    assert ((red > 1.5 * blue) & (red > green)).any()  # its arm
    # On a circle of 8 m, 2 m/s.
    angle = 2.0 * recorded.seconds() / 8.0
    assert recorded.moved() == pytest.approx(16.0 * np.sin(angle / 2), rel=0.02)
    turned = (label["target_yaw"] - recorded.labels[0]["target_yaw"]) % (2 * np.pi)
    assert turned == pytest.approx(angle, rel=0.02)


@pytest.mark.slow
def test_a_trajectory_file(record, tmp_path: Path):
    lines = [f"{t},{-30.0 + 1.2 * t},{8.0 + 0.5 * t}" for t in range(40)]  # no tree above it
    (tmp_path / "walk.csv").write_text("\n".join(["t,x,y", *lines]))
    recorded = record(custom={"trajectory": str(tmp_path / "walk.csv"), "body": "BB-8"})
    assert_pixels_agree(recorded, ObjectClass.ROBOT)
    label = recorded.labels[-1]
    assert (label["target_type"], label["target_size"]) == ("BB-8", [0.5, 0.5, 0.68])
    assert label["target_words"] == "a white and orange robot that rolls on a ball"
    assert recorded.moved() == pytest.approx(1.3 * recorded.seconds(), rel=0.01)
    for one in recorded.labels:
        x, y = one["target_position"][:2]
        assert (x + 30.0) * 0.5 == pytest.approx((y - 8.0) * 1.2, abs=1e-3)  # on its line
        assert one["target_yaw"] == pytest.approx(np.arctan2(0.5, 1.2), abs=1e-3)
    speed = np.hypot(*recorded.labels[0]["target_velocity"][:2])
    assert speed == pytest.approx(1.3, rel=0.01)
