"""Start of an episode: drawn at random, and placed relative to a target."""

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.core.elementary_arrays import cos, sin, tan
from eyas.core.errors import SpawnError
from eyas.core.frames import wrap_angle
from eyas.core.jit import interpreted
from eyas.core.variation import sample
from eyas.task.config import StartConfig

__all__ = ["Start", "choose_target", "sample_start", "start_pose"]

_wrapped = interpreted(wrap_angle)


@dataclass(frozen=True, slots=True)
class Start:
    """A drawn start, relative to the target; the fields of `StartConfig`."""

    pitch: float
    """Drawn camera pitch, positive down [rad], before the gimbal limits it."""
    height: float
    """[m]"""
    direction: float
    """[rad]"""
    horizontal_bias: float
    """[m]"""
    vertical_bias: float
    """[m]"""


def sample_start(config: StartConfig, rng: np.random.Generator) -> Start:
    """Draw a start, in the original's order: pitch, the two biases, height, direction."""
    pitch = sample(config.pitch, rng)
    horizontal_bias = sample(config.horizontal_bias, rng)
    vertical_bias = sample(config.vertical_bias, rng)
    height = sample(config.height, rng)
    direction = sample(config.direction, rng)
    return Start(pitch, height, direction, horizontal_bias, vertical_bias)


def start_pose(
    start: Start, target_position: ArrayLike, target_yaw: float, ahead: float
) -> tuple[NDArray[np.float64], float]:
    """Return the start position of the tracker's body [m], shape (3,), and its yaw [rad].

    The tracker starts so far behind the target that, without biases, its optical axis meets the
    target's centre. As in the original, this neglects the place of the camera in the body and the
    height of the reference point, and applies `ahead` along the tracker's heading.

    Args:
        start: The drawn start.
        target_position: Reference point of the target [m], shape (3,).
        target_yaw: Heading of the target [rad].
        ahead: Distance of the target's middle ahead of its reference point, see
            `eyas.targets.kind.Kind` [m].
    """
    yaw = target_yaw + start.direction
    forward = ahead + start.vertical_bias
    forward -= tan(abs(0.5 * math.pi - start.pitch)) * start.height
    left = start.horizontal_bias
    east = cos(yaw) * forward - sin(yaw) * left
    north = sin(yaw) * forward + cos(yaw) * left
    offset = np.array([east, north, start.height])
    return np.asarray(target_position, np.float64) + offset, _wrapped(yaw)


def choose_target(
    available: NDArray[np.bool_], used: Collection[int], rng: np.random.Generator
) -> int:
    """Return an actor that is available and that no tracker follows, drawn uniformly.

    Args:
        available: Whether each actor may be followed, shape (A,).
        used: Actors that are already followed; -1 for a tracker without a target.
        rng: Random generator.

    Raises:
        SpawnError: There is no such actor.
    """
    free = [int(actor) for actor in np.flatnonzero(available) if int(actor) not in used]
    if not free:
        here, followed = int(np.sum(available)), sum(actor >= 0 for actor in used)
        enough = "at least as many targets as trackers, or same_target"
        # Those who come and go may not have come yet, or have all gone.
        sooner = "some at any time: see traffic.group_interval and route_count, or objects.interval"
        raise SpawnError(
            f"start: no target is free: {here} in the world, {followed} followed; "
            f"allowed: {enough if here else sooner}"
        )
    return free[int(rng.integers(len(free)))]
