"""What a policy learns from a recording: states and actions of the tracker, as arrays."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.exports.label import Label
from eyas.engine.recordings.recording import RecordedEpisode
from eyas.lanes import exact

STATE_NAMES = tuple(
    "x y z velocity_x velocity_y velocity_z orientation_w orientation_x orientation_y "
    "orientation_z".split()
)
"""The tracker's position [m], velocity [m/s] and orientation, in the world's frame."""

TRUTH_NAMES = tuple(
    "target_forward target_left target_up target_visible box_left box_top box_right "
    "box_bottom".split()
)
"""What only a teacher knows: the target's place in the tracker's body [m], its visible share, and
its box [pixels]."""

ACTION_NAMES = ("forward", "left", "up", "yaw_rate")
"""Velocity in the tracker's body [m/s], counter-clockwise [rad/s]: the set point of PX4 and
ArduPilot (there with other signs: forward, right, down)."""


GIMBAL_NAMES = ("gimbal_pitch_rate", "gimbal_yaw_rate")
"""Behind `ACTION_NAMES` where a policy turns the camera: down and to the left [rad/s]."""


def action_names(widths: Iterable[int]) -> tuple[str, ...]:
    """Return the names of the numbers of an action of a data set.

    Raises:
        ConfigError: Not all have as many.
    """
    found = {*widths}
    if len(found) > 1:
        raise ConfigError(
            "episodes with four and with six numbers in an action (a policy turns the camera) are "
            "not allowed in one data set: export them apart"
        )
    return (*ACTION_NAMES, *GIMBAL_NAMES)[: found.pop()]


class EpisodeMotion(NamedTuple):
    """States and actions of one episode of T frames."""

    states: NDArray[np.float32]  # `STATE_NAMES` of each frame, shape (T, 10)
    truth: NDArray[np.float32]  # `TRUTH_NAMES` of each frame, shape (T, 8)
    actions: NDArray[np.float32]
    """`ACTION_NAMES` from each frame to the next: as commanded, or as flown where nothing was
    commanded; in the last frame those before; shape (T, 4), or with `GIMBAL_NAMES` (T, 6)."""
    rewards: NDArray[np.float32]  # Reward at each frame, NaN where it is not defined, shape (T,)


def motion_of(episode: RecordedEpisode) -> EpisodeMotion:
    """Return the states and actions of an episode."""
    labels = episode.labels
    return EpisodeMotion(
        states=np.array(
            [
                (*each["tracker_position"], *each["tracker_velocity"], *each["tracker_orientation"])
                for each in labels
            ],
            np.float32,
        ),
        truth=np.array(
            [
                (*each["relative_position"], each["visible_fraction"], *each["target_box"])
                for each in labels
            ],
            np.float32,
        ),
        actions=_actions(labels, 1.0 / episode.fps),
        rewards=np.array([each["reward"] for each in labels], np.float64).astype(np.float32),
    )


def task_of(episode: RecordedEpisode) -> str:
    """Return what the tracker has to do, in words."""
    return f"Follow {episode.labels[0]['target_words']}."


def _actions(labels: list[Label], period: float) -> NDArray[np.float32]:
    """Return the actions; that of a frame is told by the next one, which it has led to."""
    turns = any("gimbal_command" in label for label in labels)
    actions = np.zeros((len(labels), 6 if turns else 4), np.float32)
    for number, label in enumerate(labels[1:]):
        command = label["command"]
        actions[number, :4] = _flown(labels[number], label, period) if command is None else command
        if turns:
            actions[number, 4:] = label.get("gimbal_command", (0.0, 0.0))
    if len(labels) > 1:
        actions[-1] = actions[-2]
    return actions


def _flown(before: Label, after: Label, period: float) -> tuple[float, float, float, float]:
    """Return the mean velocity between two frames, in the axes of the first one's heading."""
    yaw, next_yaw = (_yaw(label["tracker_orientation"]) for label in (before, after))
    pairs = zip(after["tracker_position"], before["tracker_position"], strict=True)
    x, y, z = ((now - then) / period for now, then in pairs)
    cosine, sine = exact.cos(yaw), exact.sin(yaw)
    turn = (next_yaw - yaw + np.pi) % (2.0 * np.pi) - np.pi
    return cosine * x + sine * y, cosine * y - sine * x, z, turn / period


def _yaw(orientation: list[float]) -> float:
    w, x, y, z = orientation
    return float(exact.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
