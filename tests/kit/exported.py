"""A data set of two small recordings, which holds what formats find difficult."""

import json
from pathlib import Path

import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.recordings.export import ExportOptions, export
from eyas.engine.recordings.recording import Recording, load
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.task.config import DoneConfig, StartConfig
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.library import CANONICAL_MIX
from eyas.engine.video import run as video

PARTS = {"first": ("train", (30, 1.2, 0.6)), "second": ("val", (0, 0.7854, 0.7))}
"""Split, seed, field of view, pitch. In the first something hides targets, and a truck with a
trailer and people are followed; in the second they are cut and lost."""


def config(seed: int, field_of_view: float, pitch: float) -> EyasConfig:
    return EyasConfig(
        seed=seed,
        traffic=TrafficConfig(vehicle_type=CANONICAL_MIX),
        camera=CameraConfig(width=160, height=120, field_of_view=field_of_view),
        start=StartConfig(height=12.0, pitch=pitch),
        done=DoneConfig(total_steps=750, no_reward_steps=10**6, min_height=1.0),
        video=VideoConfig(
            channels=2, fps=10.0, total_time=3.0, flight="random",
            writers=("jpeg", "labels", "masks"),
        ),
    )  # fmt: skip


@pytest.fixture(scope="session")
def dataset(tmp_path_factory) -> Path:
    """A data set with the splits `train` and `val`."""
    root = tmp_path_factory.mktemp("recorded") / "dataset"
    for name, (split, settings) in PARTS.items():
        video.run(config(*settings), root / "parts" / split / name, quiet=True)
    rows = [{"split": split, "name": name} for name, (split, _) in PARTS.items()]
    (root / "dataset.json").write_text(json.dumps({"parts": rows}))
    return root


@pytest.fixture(scope="session")
def data(dataset) -> Recording:
    return load(dataset)


@pytest.fixture
def exported(data, tmp_path):
    """Return a function that exports the data set, and returns the folder."""

    def run(name: str, **options) -> Path:
        folder = tmp_path / "exported" / name.rpartition(":")[2]
        export(data, name, folder, ExportOptions(**options))
        return folder

    return run
