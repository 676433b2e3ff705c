from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig, FurtherCameraConfig
from eyas.engine.camera.esim import EVENT
from eyas.engine.camera.events import EventsConfig
from eyas.engine.core.optics.pinhole import intrinsics
from eyas.engine.exports.frame import (
    CameraPicture,
    CameraPose,
    Frame,
    RecordedAction,
    RecordedBody,
    Subject,
)
from eyas.engine.exports.movement import Movement
from eyas.engine.exports.writer import Episode, Run
from eyas.engine.sensors.config import LidarConfig
from eyas.engine.sim.config import SimConfig
from eyas.engine.state.draw import MovingParts
from eyas.engine.state.motion import ActorState, ActorView
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import model_index
from eyas.engine.task.direction import TargetDirection
from eyas.engine.task.done import DoneReason

TARGET = Subject(
    object_id=65536 + 3,
    type="BmwX5Simple",
    object_class=ObjectClass.CAR,
    size=np.array([4.6, 1.9, 1.7]),
    position=np.array([14.0, 2.0, 0.37]),
    centre=np.array([13.0, 2.0, 0.37]),
    velocity=np.array([13.0, 0.0, 0.0]),
    yaw=0.0,
    motion=Movement(np.array([0.5, 0.0, 0.0]), 0.0, 0.0, 120.0, TargetDirection.STRAIGHT, 0.37),
    box=np.array([10, 11, 20, 17], np.int32),
    visible_box=np.array([10, 11, 18, 17], np.int32),
    whole_box=np.array([10.25, 10.5, 20.0, 17.0]),
    seen_pixels=45,
    covered_pixels=60,
)


POSE = CameraPose(np.array([1.1, 2.0, 21.9]), np.eye(3), 0.8, 64, 48)


def traffic_at(number: int) -> ActorView:
    """A car that drives east, a bus that comes after the first frame and is gone after the third,
    a person, and seven who are not there.
    """
    state = ActorState.create(1, 10)
    state.position[0, :3] = [[14.0 + 0.5 * number, 2.0, 0.0], [30.0, 5.0, 0.0], [3.0, -4.0, 0.0]]
    state.yaw[0, :3] = [0.0, 0.25, -1.5]
    state.slope[0, :3] = [0.125, 0.0, 0.0]
    state.present[0, :3] = [True, number in (1, 2), True]
    models = np.full(10, model_index("BmwX5Simple"), np.int32)
    models[1:3] = model_index("BusSimple"), model_index("Pedestrian")
    colours = np.tile(np.float32([0.75, 0.5, 0.25]), (10, 1))
    return ActorView(state, state, models, colours)


def made(number: int, **changes: object) -> Frame:
    values: dict[str, object] = {
        "number": number,
        "time": 1.0 + 0.04 * number,
        "step": 20 * number + 31,
        "tracker": RecordedBody(
            position=np.array([1.0, 2.0, 22.0]),
            velocity=np.array([13.0, 0.0, 0.0]),
            acceleration=np.zeros(3),
            orientation=np.array([1.0, 0.0, 0.0, 0.0]),
            angular_velocity=np.zeros(3),
            gimbal=np.zeros(3),
        ),
        "camera": POSE,
        "target": TARGET,
        "others": (),
        "action": RecordedAction(-1, None),
        "reward": 0.5,
        "direction": TargetDirection.STRAIGHT,
        "reason": DoneReason.NONE,
        "rgb": np.full((48, 64, 3), 40 * number % 256, np.uint8),
        "depth": np.full((48, 64), 12.5, np.float32),
        "object_id": np.full((48, 64), 7, np.int32),
        "class_id": np.full((48, 64), 3, np.uint8),
        "normal": np.full((48, 64, 3), 200, np.uint8),
        "parts": MovingParts(
            row=np.full((48, 64), -1, np.int32),
            depth=np.full((48, 64), 12.5, np.float32),
            part=np.zeros(2, np.int32),
            pose=np.zeros((2, 3, 4), np.float32),
        ),
        "lidar": np.array([0.5, np.inf]),
        "sensors": np.arange(19.0),
        "clean": np.full((48, 64, 3), 41, np.uint8),
        "cameras": (CameraPicture("right", POSE, np.full((48, 64, 3), 42, np.uint8)),),
        "events": np.array([(3, 4, 1, 1000 * number + 5)], EVENT),
        "traffic": traffic_at(number),
    }
    return Frame(**{**values, **changes})  # type: ignore[arg-type]


@pytest.fixture
def frame() -> Callable[..., Frame]:
    """Makes a frame by its number; keywords change single fields."""
    return made


@pytest.fixture
def episode(tmp_path: Path) -> Episode:
    """An episode of pictures of 64 x 48 in an empty folder."""
    return Episode(tmp_path, "DRONE0", 0, 64, 48, intrinsics(64, 48, 0.8), 25.0)


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """A recording of two trackers with a lidar, in an empty folder."""
    config = SimConfig(
        lidar=LidarConfig(enabled=True),
        camera=CameraConfig(events=EventsConfig(enabled=True)),
        cameras=(FurtherCameraConfig(name="right"),),
    )
    return Run(
        tmp_path, ("DRONE0", "DRONE1"), config, target_direction=False, jpeg_quality=95,
        depth_unit=0.01,
    )  # fmt: skip
