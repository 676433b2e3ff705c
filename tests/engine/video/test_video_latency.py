"""Recordings of what agents see late: each label is true of its picture."""

import itertools

import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.exports.label import read_labels
from eyas.engine.sensors.config import CameraErrors, LidarConfig, SensorsConfig
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.sim.config import ControlConfig
from eyas.engine.task.config import DoneConfig, StartConfig
from eyas.engine.video import run as video

PRESENT = {"frame", "reward", "action", "command", "done"}
"""What a label tells of the present: the number of the frame, and what is judged and commanded."""


def recorded(folder, **changes):
    """Labels, pictures and distances of two trackers' first episodes, a frame every 4 ms."""
    config = EyasConfig(
        seed=3,
        camera=CameraConfig(width=160, height=120, field_of_view=2.0),  # sees others, too
        lidar=LidarConfig(enabled=True),
        start=StartConfig(height=45.0, pitch=1.0),
        done=DoneConfig(total_steps=100, grace_steps=20, max_height=100.0),
        video=VideoConfig(
            channels=2,
            fps=250.0,
            start_time=0.7,
            total_time=0.2,
            warm_up_steps=10,
            flight="random",
            writers=("jpeg", "labels", "lidar"),
        ),
        **changes,
    )
    video.run(config, folder, quiet=True)
    episodes = [folder / f"DRONE{n}" / "episode0" for n in range(2)]
    labels = [read_labels(e / "labels.jsonl") for e in episodes]
    pictures = [[path.read_bytes() for path in sorted(e.glob("*.jpeg"))] for e in episodes]
    rows = [(e / "lidar.csv").read_text().splitlines()[1:] for e in episodes]
    return labels, pictures, [[row.split(",")[1:] for row in table] for table in rows]


@pytest.fixture(scope="module")
def now(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("now"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "all_late"),
    [
        ({"control": ControlConfig(observation_latency_steps=4.0)}, True),
        ({"sensors": SensorsConfig(camera=CameraErrors(delay_steps=4))}, False),
    ],
)
def test_a_late_frame_is_that_of_so_many_frames_ago(now, tmp_path, changes, all_late):
    late = recorded(tmp_path / "late", **changes)
    others = [[label["others"] for label in labels] for labels in now[0]]
    assert any(a != b for own in others for a, b in itertools.pairwise(own))
    for tracker in range(2):
        seen, present = late[0][tracker], now[0][tracker]
        assert len(seen) == len(present) > 20
        for k in range(2, len(seen)):
            for name, value in seen[k].items():
                source = present[k] if name in PRESENT else present[k - 2]
                assert value == source[name], name
            assert late[1][tracker][k] == now[1][tracker][k - 2]
            assert late[2][tracker][k][1:] == now[2][tracker][k - 2 * all_late][1:]
        assert seen[20]["tracker_position"] != present[20]["tracker_position"]
