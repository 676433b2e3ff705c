import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.config import DoneConfig, RewardConfig
from eyas.engine.task.rules import make_rules


@pytest.fixture(scope="session")
def rules_with():
    """Build rules from settings of the reward and of the end, for the original's camera."""

    def build(done=None, **reward):
        return make_rules(RewardConfig(**reward), DoneConfig(**(done or {})), CameraConfig())

    return build


@pytest.fixture(scope="session")
def look():
    """Rotation of a camera by heading and pitch, positive down."""

    def rotation(yaw, pitch, roll=0.0):
        cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
        cr, sr = np.cos(roll), np.sin(roll)
        turn = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1.0]])
        nod = np.array([[cp, 0, sp], [0, 1.0, 0], [-sp, 0, cp]])
        lean = np.array([[1.0, 0, 0], [0, cr, -sr], [0, sr, cr]])
        return np.ascontiguousarray(turn @ nod @ lean)

    return rotation


@pytest.fixture
def snapshot():
    """Three trackers; tests use number 1."""
    return Snapshot.create(3)
