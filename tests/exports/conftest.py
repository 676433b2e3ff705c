from collections.abc import Callable

import pytest

from eyas.exports.labels import FrameLabel


def made(frame: int, **changes: object) -> FrameLabel:
    values: dict[str, object] = {
        "frame": frame,
        "time": 1.0 + 0.04 * frame,
        "step": 20 * frame + 31,
        "episode_time": 0.04 * frame + 0.062,
        "target_box": [10, 11, 20, 17],
        "visible_fraction": 0.75,
        "occluded": True,
        "in_view": True,
        "tracker_position": [1.0, 2.0, 22.0],
        "tracker_velocity": [13.0, 0.0, 0.0],
        "tracker_orientation": [1.0, 0.0, 0.0, 0.0],
        "camera_position": [1.1, 2.0, 21.9],
        "camera_rotation": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        "target_type": "BmwX5Simple",
        "target_size": [4.6, 1.9, 1.7],
        "target_position": [14.0, 2.0, 0.37],
        "target_centre": [13.0, 2.0, 0.37],
        "target_velocity": [13.0, 0.0, 0.0],
        "target_yaw": 0.0,
        "relative_position": [12.0, 0.0, -21.63],
        "reward": 0.5,
        "action": -1,
        "direction": 1,
        "done": False,
    }
    return FrameLabel(**{**values, **changes})  # type: ignore[arg-type]


@pytest.fixture
def frame_label() -> Callable[..., FrameLabel]:
    """Makes the label of a frame; keywords change single fields."""
    return made
