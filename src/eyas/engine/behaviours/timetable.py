"""When something is where on its path: speeds that curves and brakes allow."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.chain import Chain, Poses, poses_on
from eyas.engine.targets.habit import Habit

Floats = NDArray[np.float64]

_PHASES = 4  # Phases of a piece: turn on the spot, accelerate, keep the speed, brake


class TimedMotion(NamedTuple):
    """Motion at K instants, shape (K,) each."""

    poses: Poses
    speed: Floats  # [m/s]
    yaw_rate: Floats  # [rad/s]
    travelled: Floats  # Walkway since the beginning [m]


def ride(chain: Chain, habit: Habit, time: Floats) -> TimedMotion:
    """Return the motion along a path, at the end of which it stands still.

    Speed changes evenly; where a curve would need too fast a turn, or a spin follows, it is lower.

    Args:
        chain: The path.
        habit: Speed, acceleration and largest yaw rate.
        time: Times since the beginning [s], shape (K,), at least 0.
    """
    begin, ends = _speeds(chain, habit)
    duration, v, rate = _phases(chain, habit, begin, ends)
    start = np.cumsum(duration) - duration
    phase = np.searchsorted(start, time, side="right") - 1
    # Phases that last no time are passed over, as the last of those that begin at once is found.
    passed = np.minimum(time - start[phase], duration[phase])
    piece, spinning = phase // _PHASES, phase % _PHASES == 0
    way = v * duration + 0.5 * rate * np.square(duration)
    done = np.cumsum(way) - way
    first = done[::_PHASES]
    travelled = done[phase] + v[phase] * passed + 0.5 * rate[phase] * np.square(passed)
    along = np.clip(travelled - first[piece], 0.0, chain.length[piece])
    poses = poses_on(chain, piece, along)
    left = np.where(duration[phase] > 0.0, 1.0 - passed / np.maximum(duration[phase], 1e-12), 0.0)
    # Before a spin is done, the rest of it is missing from the heading.
    missing = np.where(spinning, chain.spin[piece] * left, 0.0)
    speed = v[phase] + rate[phase] * passed
    moving = time < start[phase] + duration[phase]
    turning = np.where(spinning, np.sign(chain.spin[piece]) * habit.yaw_rate, 0.0)
    yaw_rate = np.where(moving, turning + chain.curvature[piece] * speed, 0.0)
    return TimedMotion(
        Poses(poses.x, poses.y, poses.yaw - missing),
        np.where(moving, np.maximum(speed, 0.0), 0.0),
        yaw_rate,
        travelled,
    )


def time_of(chain: Chain, habit: Habit) -> float:
    """Return how long a path takes [s]."""
    return float(_phases(chain, habit, *_speeds(chain, habit))[0].sum())


def _speeds(chain: Chain, habit: Habit) -> tuple[Floats, Floats]:
    """Return the speeds at the beginning and the end of each piece [m/s]."""
    cap = _caps(chain, habit)
    joint = np.minimum(np.append(cap, 0.0), np.append(cap[:1], cap))
    joint[:-1][chain.spin != 0.0] = 0.0
    # Numbers of Python's own: each depends on the one before, and those of numpy take longer.
    gain: list[float] = (2.0 * habit.acceleration * chain.length).tolist()
    at: list[float] = joint.tolist()
    for i, more in enumerate(gain):
        at[i + 1] = min(at[i + 1], math.sqrt(at[i] * at[i] + more))
    for i in range(len(gain) - 1, -1, -1):
        at[i] = min(at[i], math.sqrt(at[i + 1] * at[i + 1] + gain[i]))
    return np.array(at[:-1]), np.array(at[1:])


def _caps(chain: Chain, habit: Habit) -> Floats:
    """Return the largest speed on each piece [m/s]."""
    bend = np.maximum(np.abs(chain.curvature), 1e-9)
    return np.minimum(habit.speed, habit.yaw_rate / bend)


def _phases(
    chain: Chain, habit: Habit, begin: Floats, end: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return duration [s], first speed [m/s] and acceleration [m/s^2] of all phases, (4 M,)."""
    gain = habit.acceleration
    top = np.sqrt(gain * chain.length + 0.5 * (np.square(begin) + np.square(end)))
    top = np.maximum(np.minimum(_caps(chain, habit), top), np.maximum(begin, end))
    up, down = (top - begin) / gain, (top - end) / gain
    ramps = (np.square(top) - np.square(begin) + np.square(top) - np.square(end)) / (2.0 * gain)
    flat = np.maximum(chain.length - ramps, 0.0) / np.maximum(top, 1e-9)
    zero = np.zeros_like(top)
    duration = np.column_stack([np.abs(chain.spin) / habit.yaw_rate, up, flat, down]).ravel()
    speed = np.column_stack([zero, begin, top, top]).ravel()
    rate = np.column_stack([zero, zero + gain, zero, zero - gain]).ravel()
    return duration, speed, rate
