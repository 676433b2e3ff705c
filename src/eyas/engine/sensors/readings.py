"""Readings of the sensors of the table with errors: each has its own rate, noise, bias, delay and
drop-out.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple, cast
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.counter_rng import SEEDS, mixed, normal, uniform
from eyas.engine.sensors.config import ReadingConfig
from eyas.engine.sensors.sensor import Floats, Sensor, keep
from eyas.engine.sensors.table import Fitted
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.lanes import CompiledCall, compiled, interpreted, kernel, specialised

Integers = NDArray[np.int64]

_DROP_OUT, _BIAS = 64, 128  # channels of random numbers beside those of the noise
_NO_ERRORS = {name: getattr(ReadingConfig(), name) for name in ReadingConfig.model_fields}

_mixed = interpreted(mixed)


def must_read(fitted: Sequence[Fitted]) -> bool:
    """Return whether trackers have readings that their packets do not hold: a sensor has errors, or
    is a further one.
    """
    return any(each.random[0] or _has_errors(each.errors) for each in fitted)


def _has_errors(errors: ReadingConfig) -> bool:
    return any(getattr(errors, name) != value for name, value in _NO_ERRORS.items())


class Readings:
    """What the sensors of N trackers read.

    Attributes:
        told: What they tell now, the original's in the columns 1 to 19 of the basic packet, shape
            (N, C); written in place.

    Args:
        fitted: The sensors, with their errors.
        snapshot: State of the trackers.
        terrain: The ground.
        active: Whether each tracker moves in a step, shape (N,); read at each.
    """

    def __init__(
        self,
        fitted: Sequence[Fitted],
        snapshot: Snapshot,
        terrain: Terrain,
        active: NDArray[np.bool_],
    ) -> None:
        errors, count = [each.errors for each in fitted], len(active)
        widths = [each.sensor.width for each in fitted]
        columns = sum(widths)
        channels = [each.random[1] + at for each in fitted for at in range(each.sensor.width)]
        delays = np.array([each.delay_steps for each in errors], np.int64)
        settings = np.zeros((len(fitted), max(1, *(len(each.settings) for each in fitted))))
        for row, each in zip(settings, fitted, strict=True):
            row[: len(each.settings)] = each.settings
        names = [each.random[0] for each in fitted]
        self._salts = [crc32(name.encode()) if name else None for name in names]
        self._seed = np.zeros((count, len(fitted)), np.int64)
        self.told = np.zeros((count, columns))
        self._history = np.zeros((count, int(delays.max()) + 2, columns))
        work = _Work(
            snapshot,
            terrain,
            active,
            self._seed,
            np.array([each.first for each in fitted] + [columns], np.int64),
            settings,
            np.array([max(round(PHYSICS_RATE / each.rate), 1) for each in errors], np.int64),
            np.repeat([each.noise for each in errors], widths).astype(np.float64),
            np.repeat([each.bias for each in errors], widths).astype(np.float64),
            np.array(channels, np.int64),
            delays,
            np.array([each.drop_out for each in errors], np.float64),
            np.array([_DROP_OUT + each.random[2] for each in fitted], np.int64),
            self._history,
            self.told,
        )
        self._readings = _reading_of(tuple(each.sensor for each in fitted)).bind(work)

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode: the next `advance` makes its first reading."""
        seed = int(rng.integers(SEEDS))
        for number, salt in enumerate(self._salts):
            self._seed[tracker, number] = seed if salt is None else _mixed(seed ^ salt)

    def advance(self) -> None:
        """Read, after each physics step and after a reset."""
        self._readings()


class _Work(NamedTuple):
    """Inputs and outputs of the kernel, for S sensors and C columns."""

    snapshot: Snapshot
    terrain: Terrain
    active: NDArray[np.bool_]
    seed: Integers  # of the random numbers of each sensor, shape (N, S)
    first: Integers  # where the columns of each sensor begin, shape (S + 1,)
    settings: Floats  # values of its own settings, in the first of P columns, shape (S, P)
    period: Integers  # physics steps between readings, shape (S,)
    noise: Floats  # shape (C,)
    bias: Floats  # shape (C,)
    channel: Integers  # channel of the random numbers of the noise, shape (C,)
    delay: Integers  # [physics steps], shape (S,)
    drop_out: Floats  # shape (S,)
    drop_out_channel: Integers  # shape (S,)
    history: Floats  # readings by step modulo D > the longest delay, shape (N, D, C)
    told: Floats  # shape (N, C)


Kernel = Callable[..., Any]


@kernel(inline=True)
def _others(
    snapshot: Snapshot, terrain: Terrain, n: int, sensor: int, settings: Floats, reading: Floats
) -> None:
    """Do nothing: there is no such sensor."""


@kernel(inline=True)
def _first_or_others(
    snapshot: Snapshot, terrain: Terrain, n: int, sensor: int, settings: Floats, reading: Floats
) -> None:
    """Call the kernel of sensor 0 of several, or let the others do it."""
    if sensor == 0:
        keep(snapshot, terrain, n, settings, reading)
    else:
        _others(snapshot, terrain, n, sensor - 1, settings, reading)


_read = _settle = _others  # what a selection's kernels take the place of


@lru_cache(maxsize=16)
def _reading_of(sensors: tuple[Sensor, ...]) -> CompiledCall:
    """Return the loop over some sensors, in which each kernel has its branch."""
    reads, settles = _others, _others
    for sensor in reversed(sensors):
        reads = _branch(sensor.read, reads)
        settles = _branch(sensor.settle, settles)
    one = kernel(inline=True)(specialised(_read_one, _read=reads, _settle=settles))
    due = kernel(inline=True)(specialised(_read_due, _read_one=one))
    return compiled(specialised(_read_all, _read_due=due))


def _branch(first: Kernel, others: Kernel) -> Kernel:
    made = specialised(_first_or_others, keep=first, _others=others)
    return cast("Kernel", kernel(inline=True)(made))


@kernel(inline=True)
def _read_one(work: _Work, n: int, step: int, sensor: int, row: Floats) -> None:
    """Write a new reading of a sensor."""
    first, end, seed = work.first[sensor], work.first[sensor + 1], work.seed[n, sensor]
    reading, settings = row[first:end], work.settings[sensor]
    _read(work.snapshot, work.terrain, n, sensor, settings, reading)
    changed = False
    for column in range(first, end):
        channel = work.channel[column]
        if work.noise[column] > 0.0:
            row[column] += work.noise[column] * normal(seed, step, channel)
            changed = True
        if work.bias[column] > 0.0:
            row[column] += work.bias[column] * normal(seed, 0, _BIAS + channel)
            changed = True
    if changed:
        _settle(work.snapshot, work.terrain, n, sensor, settings, reading)


@kernel(inline=True)
def _read_due(work: _Work, n: int, step: int) -> None:
    """Read the sensors of tracker `n` that are due; the others keep their last readings."""
    slots = work.history.shape[1]
    row, last = work.history[n, step % slots], work.history[n, (step - 1) % slots]
    for sensor in range(work.period.shape[0]):
        due = step % work.period[sensor] == 0
        if due and step > 0 and work.drop_out[sensor] > 0.0:
            sampled = uniform(work.seed[n, sensor], step, work.drop_out_channel[sensor])
            due = sampled >= work.drop_out[sensor]
        if due:
            _read_one(work, n, step, sensor, row)
        else:
            for column in range(work.first[sensor], work.first[sensor + 1]):
                row[column] = last[column]


def _read_all(work: _Work) -> None:
    """Read all sensors of all active trackers."""
    for n in range(work.active.shape[0]):
        step = work.snapshot.episodes.step_count[n]
        if step == 0:
            _read_due(work, n, 0)
            for slot in range(1, work.history.shape[1]):
                for column in range(work.told.shape[1]):
                    work.history[n, slot, column] = work.history[n, 0, column]
        elif work.active[n]:
            _read_due(work, n, step)
        _tell(work, n, step)


@kernel(inline=True)
def _tell(work: _Work, n: int, step: int) -> None:
    """Tell the readings of the time before each sensor's delay, or the first."""
    slots = work.history.shape[1]
    for sensor in range(work.period.shape[0]):
        slot = max(step - work.delay[sensor], 0) % slots
        for column in range(work.first[sensor], work.first[sensor + 1]):
            work.told[n, column] = work.history[n, slot, column]
