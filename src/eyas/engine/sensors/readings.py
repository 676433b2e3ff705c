"""Readings of GPS, accelerometer, gyroscope and IMU with errors: each sensor has its own rate,
noise, bias, delay and drop-out.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.frames import wrap_angle
from eyas.engine.sensors.chance import SEEDS, normal, uniform
from eyas.engine.sensors.config import ReadingConfig, SensorsConfig
from eyas.engine.sensors.inertial import accelerometer, gyroscope
from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.snapshot import Snapshot, TrackerState
from eyas.lanes import compiled, kernel
from eyas.lanes.elementary import sin_cos

__all__ = ["READ_COLUMNS", "Readings", "has_errors"]

_FIRST = (0, 3, 6, 9, 12, 19)
"""Where the columns of each sensor begin: position, velocity, felt acceleration, angular velocity,
and attitude as a quaternion and Euler angles."""

READ_COLUMNS = _FIRST[-1]
"""Numbers that the sensors read."""

_IMU, _QUATERNION, _EULER = 4, 12, 16
_DROP_OUT, _BIAS = 64, 128
"""Channels of the random numbers beside those of the noise, which are the columns."""


def has_errors(config: SensorsConfig) -> bool:
    """Return whether any sensor of this module reads something other than the truth."""
    return any(sensor != ReadingConfig() for sensor in config.readings)


class Readings:
    """What the sensors of N trackers read.

    Attributes:
        told: What they tell now, in the columns 1 to 19 of the basic packet, shape (N, 19); written
            in place.

    Args:
        config: Their errors.
        snapshot: State of the trackers.
        active: Whether each tracker moves in a step, shape (N,); read at each.
    """

    def __init__(
        self, config: SensorsConfig, snapshot: Snapshot, active: NDArray[np.bool_]
    ) -> None:
        sensors, count = config.readings, len(active)
        widths = np.diff(_FIRST)
        delays = np.array([sensor.delay_steps for sensor in sensors], np.int64)
        self._seed = np.zeros(count, np.int64)
        self.told = np.zeros((count, READ_COLUMNS))
        work = _Work(
            snapshot.trackers,
            snapshot.episodes,
            active,
            self._seed,
            np.array(_FIRST, np.int64),
            np.array([max(round(PHYSICS_RATE / s.rate), 1) for s in sensors], np.int64),
            np.repeat([s.noise for s in sensors], widths).astype(np.float64),
            np.repeat([s.bias for s in sensors], widths).astype(np.float64),
            delays,
            np.array([s.drop_out for s in sensors], np.float64),
            np.zeros((count, int(delays.max()) + 2, READ_COLUMNS)),
            self.told,
        )
        self._readings = _read_all.bind(work)

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode: the next `advance` makes its first reading."""
        self._seed[tracker] = rng.integers(SEEDS)

    def advance(self) -> None:
        """Read, after each physics step and after a reset."""
        self._readings()


class _Work(NamedTuple):
    """Inputs and outputs of the kernel. Of S sensors and C columns."""

    trackers: TrackerState
    episodes: EpisodeState
    active: NDArray[np.bool_]
    seed: NDArray[np.int64]
    first: NDArray[np.int64]
    """Where the columns of each sensor begin, shape (S + 1,)."""
    period: NDArray[np.int64]
    """Physics steps between readings, shape (S,)."""
    noise: NDArray[np.float64]
    """Shape (C,)."""
    bias: NDArray[np.float64]
    """Shape (C,)."""
    delay: NDArray[np.int64]
    """[physics steps], shape (S,)"""
    drop_out: NDArray[np.float64]
    """Shape (S,)."""
    history: NDArray[np.float64]
    """The reading of each step modulo D, which is more than the longest delay, shape (N, D, C)."""
    told: NDArray[np.float64]
    """Shape (N, C)."""


@compiled
def _read_all(work: _Work) -> None:
    """Read all sensors of all active trackers."""
    for n in range(work.active.shape[0]):
        step = work.episodes.step_count[n]
        if step == 0:
            _read(work, n, 0)
            for slot in range(1, work.history.shape[1]):
                for column in range(READ_COLUMNS):
                    work.history[n, slot, column] = work.history[n, 0, column]
        elif work.active[n]:
            _read(work, n, step)
        _tell(work, n, step)


@kernel(inline=True)
def _read(work: _Work, n: int, step: int) -> None:
    """Read the sensors of tracker `n` that are due; the others keep their last readings."""
    slots, seed = work.history.shape[1], work.seed[n]
    row, last = work.history[n, step % slots], work.history[n, (step - 1) % slots]
    for sensor in range(work.period.shape[0]):
        due = step % work.period[sensor] == 0
        if due and step > 0 and work.drop_out[sensor] > 0.0:
            due = uniform(seed, step, _DROP_OUT + sensor) >= work.drop_out[sensor]
        if due:
            _read_one(work, n, step, sensor, row)
        else:
            for column in range(work.first[sensor], work.first[sensor + 1]):
                row[column] = last[column]


@kernel(inline=True)
def _read_one(work: _Work, n: int, step: int, sensor: int, row: NDArray[np.float64]) -> None:
    """Write a new reading of a sensor."""
    _write_truth(work.trackers, n, sensor, row)
    seed = work.seed[n]
    begin = _EULER if sensor == _IMU else work.first[sensor]
    changed = False
    for column in range(begin, work.first[sensor + 1]):
        if work.noise[column] > 0.0:
            row[column] += work.noise[column] * normal(seed, step, column)
            changed = True
        if work.bias[column] > 0.0:
            row[column] += work.bias[column] * normal(seed, 0, _BIAS + column)
            changed = True
    if sensor == _IMU and changed:
        row[_EULER + 2] = wrap_angle(row[_EULER + 2])
        _write_quaternion(row)


@kernel(inline=True)
def _write_truth(trackers: TrackerState, n: int, sensor: int, row: NDArray[np.float64]) -> None:
    """Write what a sensor without errors reads."""
    if sensor == 0:
        row[0], row[1] = trackers.position[n, 0], trackers.position[n, 1]
        row[2] = trackers.position[n, 2]
    elif sensor == 1:
        row[3], row[4] = trackers.velocity[n, 0], trackers.velocity[n, 1]
        row[5] = trackers.velocity[n, 2]
    elif sensor == 2:
        row[6], row[7], row[8] = accelerometer(trackers, n)
    elif sensor == 3:
        row[9], row[10], row[11] = gyroscope(trackers, n)
    else:
        for axis in range(3):
            row[_EULER + axis] = trackers.euler[n, axis]
        for part in range(4):
            row[_QUATERNION + part] = trackers.orientation[n, part]


@kernel(inline=True)
def _write_quaternion(row: NDArray[np.float64]) -> None:
    """Write the quaternion of a row's Euler angles: yaw, then pitch, then roll."""
    roll, pitch, yaw = 0.5 * row[_EULER], 0.5 * row[_EULER + 1], 0.5 * row[_EULER + 2]
    (sr, cr), (sp, cp), (sy, cy) = sin_cos(roll), sin_cos(pitch), sin_cos(yaw)
    row[_QUATERNION] = cr * cp * cy + sr * sp * sy
    row[_QUATERNION + 1] = sr * cp * cy - cr * sp * sy
    row[_QUATERNION + 2] = cr * sp * cy + sr * cp * sy
    row[_QUATERNION + 3] = cr * cp * sy - sr * sp * cy


@kernel(inline=True)
def _tell(work: _Work, n: int, step: int) -> None:
    """Tell the readings of the time before each sensor's delay, or the first."""
    slots = work.history.shape[1]
    for sensor in range(work.period.shape[0]):
        slot = max(step - work.delay[sensor], 0) % slots
        for column in range(work.first[sensor], work.first[sensor + 1]):
            work.told[n, column] = work.history[n, slot, column]
