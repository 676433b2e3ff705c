"""A policy that turns its camera: recorded, exported, evaluated."""

import json
import math
import sys

import numpy as np
import pytest

from eyas.benchmark.plan.entry import entry_of
from eyas.benchmark.policies.table import open_policy
from eyas.datasets.motion import action_names, motion_of
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError
from eyas.engine.exports.label import label_schema, read_labels
from eyas.engine.recordings.recording import load
from eyas.engine.settings.config import EyasConfig
from eyas.engine.video import run as video

OWN = """
class Watcher:
    '''Hovers, and turns its camera up and to the left.'''

    env_settings = {
        "actions": "velocity+gimbal",
        "action_repeat": 2,
        "observation": {"parts": ["privileged"]},
    }

    def act(self, state):
        return [0.0, 0.0, 0.0, 0.0, -0.25, 0.5]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("own")
    (place / "watching.py").write_text(OWN)
    sys.path.insert(0, str(place))
    settings = {
        "camera": {"width": 64, "height": 48},
        "video": {
            "policy": "watching:Watcher",
            "channels": 1,
            "writers": ["labels", "jpeg"],
            "episode_frames": 12,
        },
    }
    video.run(updated(EyasConfig(), settings), place / "run", quiet=True)
    yield place / "run"
    sys.path.remove(str(place))


def test_labels_tell_how_the_camera_is_told_to_turn(folder):
    (labels,) = [read_labels(path) for path in folder.glob("DRONE*/episode*/labels.jsonl")]
    assert all(label["gimbal_command"] == [-0.25, 0.5] for label in labels[1:])
    assert labels[1]["command"] == [0.0] * 4
    pitches = [label["camera_rotation"][2][0] for label in labels]  # how far it looks up
    assert pitches[-1] > pitches[0]
    jsonschema = pytest.importorskip("jsonschema")
    for label in labels:
        jsonschema.validate(json.loads(json.dumps(label)), label_schema())


def test_exports_have_actions_of_six_numbers(folder):
    (episode,) = load(folder)
    actions = motion_of(episode).actions
    assert actions.shape == (12, 6)
    assert np.allclose(actions[:, 4:], [-0.25, 0.5])
    assert action_names([6])[4:] == ("gimbal_pitch_rate", "gimbal_yaw_rate")
    with pytest.raises(ConfigError, match="export them apart"):
        action_names([4, 6])


def test_a_result_tells_how_the_camera_turns(folder):
    policy = open_policy("watching:Watcher", {"gimbal": {"yaw_rate": 0.25}}, sampled=False)
    entry = entry_of(policy, "0", apart=True, beside=False)
    assert entry.actions == "velocity+gimbal"
    assert entry.gimbal is not None
    assert math.isclose(entry.gimbal.yaw_rate, 0.25)
    assert entry_of(open_policy("hover", {}), "0", apart=False, beside=False).gimbal is None
