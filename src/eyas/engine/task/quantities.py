"""The named quantities that terms of the reward are made of.

A term asks for them by the names of its parameters. Each has a leading axis of N trackers. The body
and camera frames are forward, left, up.
"""

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.snapshot import Snapshot
from eyas.lanes import exact

Array = NDArray[np.float64] | NDArray[np.bool_] | NDArray[np.int64]


class Setting(NamedTuple):
    """What quantities depend on beside the snapshot."""

    aspect: float = 0.75  # Height of the camera's picture over its width
    early_steps: int = 0
    """Physics steps after a reset in which the original's algorithms overlook a crash."""


def _target_in_camera(snapshot: Snapshot) -> NDArray[np.float64]:
    away = snapshot.targets.centre - snapshot.cameras.position
    return np.asarray(exact.product(away[:, None], snapshot.cameras.rotation)[:, 0], np.float64)


def _vertical_field(snapshot: Snapshot, setting: Setting) -> NDArray[np.float64]:
    half = setting.aspect * exact.tan(0.5 * snapshot.cameras.field_of_view)
    return np.asarray(2.0 * exact.atan(half), np.float64)


def _visible(snapshot: Snapshot, setting: Setting) -> NDArray[np.bool_]:
    forward, left, up = _target_in_camera(snapshot).T
    wide = exact.tan(0.5 * snapshot.cameras.field_of_view) * forward
    inside = (np.abs(left) <= wide) & (np.abs(up) <= setting.aspect * wide)
    return np.asarray(inside & (forward > 0.0) & ~snapshot.targets.lost, np.bool_)


def _relative_yaw(snapshot: Snapshot) -> NDArray[np.float64]:
    turn = snapshot.targets.yaw - snapshot.trackers.euler[:, 2]
    return np.asarray((turn + math.pi) % (2.0 * math.pi) - math.pi, np.float64)


QUANTITIES: Mapping[str, Callable[[Snapshot, Setting], Array]] = {
    # The view reward is made of `proportion`, the distance reward of `offset`.
    "builtin": lambda snapshot, _: snapshot.episodes.reward,
    "proportion": lambda snapshot, _: snapshot.episodes.proportion,
    "offset": lambda snapshot, _: snapshot.episodes.offset,
    "visible": _visible,
    "lost": lambda snapshot, _: snapshot.targets.lost,
    "crash": lambda snapshot, _: snapshot.episodes.crash,
    "late_crash": lambda snapshot, setting: (
        snapshot.episodes.crash & (snapshot.episodes.step_count >= setting.early_steps)
    ),
    "step_count": lambda snapshot, _: snapshot.episodes.step_count,
    "target_position_body": lambda snapshot, _: snapshot.episodes.relative_position,
    "target_velocity_body": lambda snapshot, _: snapshot.episodes.relative_velocity,
    "target_acceleration_body": lambda snapshot, _: snapshot.episodes.relative_acceleration,
    "first_position_body": lambda snapshot, _: snapshot.episodes.first_position,
    "target_position_camera": lambda snapshot, _: _target_in_camera(snapshot),
    "relative_yaw": lambda snapshot, _: _relative_yaw(snapshot),
    "target_speed": lambda snapshot, _: snapshot.targets.speed,
    "target_size": lambda snapshot, _: snapshot.targets.size,
    "target_direction": lambda snapshot, _: snapshot.episodes.direction,
    "position": lambda snapshot, _: snapshot.trackers.position,
    "velocity": lambda snapshot, _: snapshot.trackers.velocity,
    "acceleration": lambda snapshot, _: snapshot.trackers.smoothed_acceleration,
    "angular_velocity": lambda snapshot, _: snapshot.trackers.angular_velocity,
    "euler": lambda snapshot, _: snapshot.trackers.euler,
    "camera_pitch": lambda snapshot, _: snapshot.trackers.gimbal[:, 1],
    "field_of_view": lambda snapshot, _: snapshot.cameras.field_of_view,
    "vertical_field_of_view": _vertical_field,
}
"""Quantities by name; docs/rewards.md says what each is, with its unit."""
