"""When something is where on its path: speeds that curves and brakes allow."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.chain import Chain, Poses, joints
from eyas.engine.targets.habit import Habit
from eyas.lanes import compiled
from eyas.lanes.elementary import cos, sin

Floats = NDArray[np.float64]

_PHASES: Final = 4  # Phases of a piece: turn on the spot, accelerate, keep the speed, brake

# Rows of the table of phases.
_START, _DURATION, _SPEED, _RATE, _DONE = range(5)


class TimedMotion(NamedTuple):
    """Motion at K instants, shape (K,) each."""

    poses: Poses
    speed: Floats  # [m/s]
    yaw_rate: Floats  # [rad/s]
    travelled: Floats  # Walkway since the beginning [m]


def ride(
    chain: Chain,  # The path
    habit: Habit,  # Speed, acceleration and largest yaw rate
    time: Floats,  # Times since the beginning [s], shape (K,), at least 0
) -> TimedMotion:
    """Return the motion along a path, at the end of which it stands still.

    Speed changes evenly; where a curve would need too fast a turn, or a spin follows, it is lower.
    """
    phases, at, made = _phases(chain, habit), joints(chain), np.empty((6, len(time)))
    # Phases that last no time are passed over, as the last of those that begin at once is found.
    phase = np.searchsorted(phases[_START], time, side="right") - 1
    pieces = np.stack([at.x[:-1], at.y[:-1], at.yaw[:-1], *chain[1:]])
    _ride(phases, pieces, float(habit.yaw_rate), phase, np.ascontiguousarray(time), made)
    return TimedMotion(Poses(*made[:3]), *made[3:])


@compiled
def _ride(
    phases: Floats,
    pieces: Floats,  # x, y and heading at their beginnings, spin, length, curvature
    turn: float,  # Yaw rate on the spot [rad/s]
    phase: NDArray[np.int64],  # Phase at each time
    time: Floats,
    made: Floats,  # Filled: the numbers of `TimedMotion`, shape (6, K)
) -> None:
    for k in range(len(time)):
        p = phase[k]
        piece, spinning = p // _PHASES, p % _PHASES == 0
        duration, speed, rate = phases[_DURATION, p], phases[_SPEED, p], phases[_RATE, p]
        x, y, yaw = pieces[0, piece], pieces[1, piece], pieces[2, piece]
        spin, length, bend = pieces[3, piece], pieces[4, piece], pieces[5, piece]
        passed = min(time[k] - phases[_START, p], duration)
        travelled = phases[_DONE, p] + speed * passed + 0.5 * rate * (passed * passed)
        along = min(max(travelled - phases[_DONE, p - p % _PHASES], 0.0), length)
        half = 0.5 * bend * along
        chord = along * (1.0 if half == 0.0 else sin(half) / half)
        moving = time[k] < phases[_START, p] + duration
        # Before a spin is done, the rest of it is missing from the heading.
        missing, turning = 0.0, 0.0
        if spinning:
            missing = spin * (1.0 - passed / max(duration, 1e-12) if duration > 0.0 else 0.0)
            turning = turn if spin > 0.0 else -turn if spin < 0.0 else 0.0
        made[0, k] = x + chord * cos(yaw + half)
        made[1, k] = y + chord * sin(yaw + half)
        made[2, k] = yaw + bend * along - missing
        made[3, k] = max(speed + rate * passed, 0.0) if moving else 0.0
        made[4, k] = turning + bend * (speed + rate * passed) if moving else 0.0
        made[5, k] = travelled


def time_of(chain: Chain, habit: Habit) -> float:
    """Return how long a path takes [s]."""
    return float(_phases(chain, habit)[_DURATION].sum())


def _phases(chain: Chain, habit: Habit) -> Floats:
    """Return start [s], duration [s], first speed [m/s], acceleration [m/s^2] of all phases of M
    pieces, and the way until each [m], shape (5, 4 M).
    """
    phases = np.empty((5, _PHASES * len(chain.length)))
    limits = float(habit.speed), float(habit.acceleration), float(habit.yaw_rate)
    _plan(np.stack(chain[1:]), *limits, phases)
    return phases


@compiled
def _plan(pieces: Floats, fastest: float, gain: float, turn: float, phases: Floats) -> None:
    spin, length, curvature = pieces[0], pieces[1], pieces[2]
    count, joint = len(length), phases[_DONE]  # speeds at the joints, one more than pieces
    top = phases[_START]  # the largest speed on each piece
    for i in range(count):
        top[i] = min(fastest, turn / max(abs(curvature[i]), 1e-9))
    for i in range(count + 1):
        joint[i] = 0.0 if i == count or spin[i] != 0.0 else min(top[i], top[max(i - 1, 0)])
    for i in range(count):
        joint[i + 1] = min(joint[i + 1], np.sqrt(joint[i] * joint[i] + 2.0 * gain * length[i]))
    for i in range(count - 1, -1, -1):
        joint[i] = min(joint[i], np.sqrt(joint[i + 1] * joint[i + 1] + 2.0 * gain * length[i]))
    for i in range(count - 1, -1, -1):
        a, b, p = joint[i], joint[i + 1], _PHASES * i
        most = np.sqrt(gain * length[i] + 0.5 * (a * a + b * b))
        most = max(min(top[i], most), max(a, b))
        ramps = (most * most - a * a + most * most - b * b) / (2.0 * gain)
        phases[_DURATION, p], phases[_SPEED, p], phases[_RATE, p] = abs(spin[i]) / turn, 0.0, 0.0
        phases[_DURATION, p + 1], phases[_DURATION, p + 3] = (most - a) / gain, (most - b) / gain
        phases[_DURATION, p + 2] = max(length[i] - ramps, 0.0) / max(most, 1e-9)
        phases[_SPEED, p + 1], phases[_SPEED, p + 2], phases[_SPEED, p + 3] = a, most, most
        phases[_RATE, p + 1], phases[_RATE, p + 2], phases[_RATE, p + 3] = gain, 0.0, -gain
    passed, way = 0.0, 0.0
    for p in range(_PHASES * count):
        duration = phases[_DURATION, p]
        gone = phases[_SPEED, p] * duration + 0.5 * phases[_RATE, p] * (duration * duration)
        passed, way = passed + duration, way + gone
        phases[_START, p], phases[_DONE, p] = passed - duration, way - gone
