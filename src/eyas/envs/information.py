"""What environments tell besides observation and reward: arrays over N trackers, by name."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.sim.simulation import Simulation
from eyas.state.scene import ObjectClass
from eyas.state.snapshot import Snapshot
from eyas.targets.catalogue import MODELS
from eyas.task.config import Crash
from eyas.task.done import DoneReason
from eyas.task.packet_rows import SENSOR_COLUMNS

__all__ = ["Info", "by_term", "information", "masked", "of_one", "privileged_state", "sensor_state"]

Floats = NDArray[np.float64]
Info = dict[str, Any]
Mask = NDArray[np.bool_]

_SENSORS = {
    "position": slice(1, 4),
    "velocity": slice(4, 7),
    "felt_acceleration": slice(7, 10),
    "angular_velocity": slice(10, 13),
    "orientation": slice(13, 17),
    "euler": slice(17, 20),
}
"""Columns of the basic packet by the names of `BasicPacket`."""

_REWARD: dict[str, int | slice] = {
    "field_of_view": 2,
    "focal_length": 3,
    "camera_pitch": 4,
    "commanded_height": 5,
    "start_direction": 6,
    "camera_pose": slice(7, 23),
    "target_pose": slice(23, 39),
    "view_centre": slice(39, 42),
    "target_centre": slice(42, 45),
    "camera_position": slice(45, 48),
    "relative_yaw": 48,
    "relative_position": slice(49, 52),
    "relative_velocity": slice(52, 55),
    "relative_acceleration": slice(55, 58),
}
"""Columns of the reward packet by the names of `RewardPacket`."""
_WHOLE = {"camera_width": 0, "camera_height": 1, "target_direction": 59}
_CRASH = 58

_WORDS = {
    "done_reason": [reason.name.lower() for reason in DoneReason],
    "done_state": [reason.original for reason in DoneReason],
    "contact_class": [*(kind.name.lower() for kind in ObjectClass), "drone", "nothing"],
}
"""What numbers mean."""


def information(simulation: Simulation) -> Info:
    """Return the state of N trackers by name, in arrays that later steps do not change.

    - the sensors of the basic packet: `position` and `velocity` (GPS), `orientation` and `euler`
      (IMU), `angular_velocity` (gyroscope), `felt_acceleration` (accelerometer);
    - the reward packet (both: `eyas.task.packets`), with the type of the target as an index into
      `eyas.targets.catalogue.MODELS`;
    - as numbers of `eyas.task.done.DoneReason`, the reason of the end (`done_reason`) and the limit
      that the body violates (`done_state`); the physics steps since the reset (`step`);
    - the values drawn from the `light` settings (factor on the sky, factor on the sun, one over the
      visibility range [1/m]);
    - where `done.crash` means contacts, the place of the last one since the reset (`contact`, world
      frame [m]), the object that was touched (`contact_object`, as in `Picture.object_id`; -1:
      none) and its `ObjectClass` (`contact_class`; `DRONE_CLASS`: another drone; -1: none);
    - the distances that the lidar has measured, if there is one (`lidar` [m], infinity where
      nothing was within range).
    """
    basic, reward = simulation.packets()
    _, _, targets, episodes, light = simulation.snapshot
    info: Info = {name: basic[:, columns] for name, columns in _SENSORS.items()}
    info.update({name: reward[:, columns] for name, columns in _REWARD.items()})
    info.update({name: reward[:, column].astype(np.int64) for name, column in _WHOLE.items()})
    info["crash"] = reward[:, _CRASH] != 0.0
    info["target_type"] = targets.model.copy()
    info["step"] = episodes.step_count.copy()
    info["done_reason"] = episodes.reason.copy()
    info["done_state"] = episodes.breach.copy()
    info["light"] = np.stack(light, axis=1)
    if simulation.config.done.crash is not Crash.ORIGINAL:
        info["contact"] = episodes.contact.copy()
        info["contact_object"] = episodes.contact_object.copy()
        info["contact_class"] = simulation.classes_of(episodes.contact_object)
    if (lidar := simulation.view.lidar) is not None:
        info["lidar"] = lidar.ranges()
    return info


def by_term(terms: dict[str, Floats]) -> Info:
    """Return terms of the reward under the names `reward/<term>`.

    They are no dictionary of their own, because TorchRL takes only arrays.
    """
    return {f"reward/{name}": values for name, values in terms.items()}


def of_one(info: Info, index: int) -> Info:
    """Return the information of one tracker, with words for its numbers that mean words:
    `done_reason`, `done_state` (the original's), `target_type` (the same) and `contact_class`.
    """
    one = {name: value[index] for name, value in info.items()}
    words = {**_WORDS, "target_type": [model.typename for model in MODELS]}  # users add models
    return one | {name: said[one[name]] for name, said in words.items() if name in one}


def masked(info: Info, mask: Mask) -> Info:
    """Return information with Gymnasium's `_name` for each name: which environments have it."""
    told: Info = {}
    for name, value in info.items():
        told[name] = masked(value, mask) if isinstance(value, dict) else value
        told[f"_{name}"] = mask
    return told


def sensor_state(simulation: Simulation, out: NDArray[np.float32]) -> None:
    """Write position, velocity, felt acceleration, angular velocity, orientation and Euler angles,
    as the agents see them.

    Args:
        simulation: N trackers.
        out: Shape (N, 19).
    """
    out[:] = simulation.view.packets()[0][:, SENSOR_COLUMNS]


def privileged_state(snapshot: Snapshot, out: NDArray[np.float32]) -> None:
    """Write the true motion of the targets, seen from the trackers, which no sensor tells.

    The numbers: the target's centre in the body frame [m], its first [m/s] and second [m/s^2]
    change, 3 numbers each; sine and cosine of its heading relative to the body's; its speed [m/s];
    its length, width and height [m]; the pitch of the camera, positive down [rad].

    Args:
        snapshot: N trackers.
        out: Shape (N, 16).
    """
    trackers, _, targets, episodes, _ = snapshot
    out[:, 0:3] = episodes.relative_position
    out[:, 3:6] = episodes.relative_velocity
    out[:, 6:9] = episodes.relative_acceleration
    turn = targets.yaw - trackers.euler[:, 2]
    out[:, 9], out[:, 10] = exact.sin(turn), exact.cos(turn)
    out[:, 11] = targets.speed
    out[:, 12:15] = targets.size
    out[:, 15] = trackers.gimbal[:, 1]
