"""Replay of a recording at any time: cubic Hermite curves between its samples.

The scalar functions take the packed table, so that the simulation's inner loop can call them from
its own kernel.
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import ConfigError
from eyas.core.jit import kernel
from eyas.state.tracker import ActorState
from eyas.traffic.recording import Recording
from eyas.traffic.smoothing import Tracks, runs, smooth

__all__ = ["COLUMNS", "Replay", "interpolate_actor", "packed"]

COLUMNS: Final = 8
"""Numbers for each sample and actor: x, y, velocity x and y, yaw, yaw rate, travelled, present."""

ROUNDING: Final = 1e-9
"""A time that is a multiple of 2 ms may be off by this [s]."""


class Replay:
    """Traffic that was recorded before. Time 0 is the beginning of the recording.

    Args:
        recording: What SUMO drove.
    """

    def __init__(self, recording: Recording) -> None:
        tracks = smooth(recording)
        self.recording: Final = recording
        self.table: Final = packed(tracks)
        self.rate: Final = recording.rate
        self.duration: Final = recording.duration
        self.actors: Final = recording.actors
        stays = [
            (actor, *stay)
            for actor in range(self.actors)
            for stay in runs(tracks.present[:, actor])
        ]
        self._who, enters, leaves = np.array(stays, np.int64).reshape(-1, 3).T
        # Times of the first and the last sample of each stay in the world [s].
        self._enters, self._leaves = enters / self.rate, (leaves - 1) / self.rate

    def at(self, time: NDArray[np.float64], out: ActorState) -> None:
        """Write all actors of W worlds at the worlds' own times [s], shape (W,)."""
        motion = out.position, out.yaw, out.speed, out.yaw_rate, out.travelled, out.present
        _write_worlds(self.table, self.rate, time, *motion)

    def available(self, start: float, end: float) -> NDArray[np.bool_]:
        """Return which actors stay in the world from `start` to `end` [s], shape (A,).

        Raises:
            ConfigError: The recording does not last that long.
        """
        self.check_time(start)
        self.check_time(end)
        available = np.zeros(self.actors, np.bool_)
        available[self._who[self._staying(start) & (self._leaves >= end - ROUNDING)]] = True
        return available

    def present_until(self, time: float, actor: int) -> float:
        """Return when an actor that is there at `time` leaves [s]; `time` if it is not there."""
        until = self._leaves[self._staying(time) & (self._who == actor)]
        return float(until[0]) if len(until) else time

    def check_time(self, time: float) -> None:
        """Refuse a time that the recording does not reach.

        Raises:
            ConfigError: One line with the time and the duration.
        """
        if not 0.0 <= time <= self.duration + ROUNDING:
            raise ConfigError(
                f"traffic: the recording lasts {self.duration:g} s, but {time:g} s was asked for; "
                "shorten the episode or record more (eyas traffic record --duration)"
            )

    def _staying(self, time: float) -> NDArray[np.bool_]:
        """Return which of the stays go on at a time [s]."""
        return (self._enters - ROUNDING <= time) & (time <= self._leaves + ROUNDING)


def packed(tracks: Tracks) -> NDArray[np.float32]:
    """Return the table that the kernels read, shape (S, A, 8).

    32 bits keep positions to 0.03 mm and halve the memory that each world's step touches.
    """
    columns = (
        *np.moveaxis(tracks.position, -1, 0),
        *np.moveaxis(tracks.velocity, -1, 0),
        tracks.yaw,
        tracks.yaw_rate,
        tracks.travelled,
        tracks.present.astype(np.float64),
    )
    return np.ascontiguousarray(np.stack(columns, axis=-1), dtype=np.float32)


@kernel
def interpolate_actor(
    table: NDArray[np.float32], rate: float, actor: int, time: float
) -> tuple[float, float, float, float, float, float, bool]:
    """Return one actor at one time; times outside the recording are held at its ends.

    Args:
        table: Shape (S, A, 8), from `Replay.table`.
        rate: Rows in a second [Hz].
        actor: Which actor.
        time: [s]

    Returns:
        x, y [m], yaw [rad], speed [m/s], yaw rate [rad/s], travelled [m], present.
    """
    last = table.shape[0] - 1
    place = min(max(time * rate, 0.0), float(last))
    row = min(int(place), last - 1)
    f = place - row
    a = table[row, actor]
    b = table[row + 1, actor]
    step = 1.0 / rate
    x, speed_x = _hermite(a[0], b[0], a[2], b[2], step, f)
    y, speed_y = _hermite(a[1], b[1], a[3], b[3], step, f)
    yaw, yaw_rate = _hermite(a[4], b[4], a[5], b[5], step, f)
    speed_a = math.hypot(a[2], a[3])
    speed_b = math.hypot(b[2], b[3])
    travelled, _ = _hermite(a[6], b[6], speed_a, speed_b, step, f)
    present = (a[7] > 0.0 or f == 1.0) and (b[7] > 0.0 or f == 0.0)
    return x, y, yaw, math.hypot(speed_x, speed_y), yaw_rate, travelled, present


@kernel
def _hermite(
    a: float, b: float, slope_a: float, slope_b: float, step: float, f: float
) -> tuple[float, float]:
    """Return value and slope at share `f` of a step [s] of the cubic with given ends and slopes."""
    start = float(a)
    rise = float(b) - start
    lift_a = float(slope_a) * step
    lift_b = float(slope_b) * step
    square = lift_a + lift_b - 2.0 * rise
    bend = 3.0 * rise - 2.0 * lift_a - lift_b
    value = start + f * (lift_a + f * (bend + f * square))
    slope = (lift_a + f * (2.0 * bend + f * 3.0 * square)) / step
    return value, slope


@kernel
def _write_worlds(
    table: NDArray[np.float32],
    rate: float,
    time: NDArray[np.float64],
    position: NDArray[np.float64],
    yaw: NDArray[np.float64],
    speed: NDArray[np.float64],
    yaw_rate: NDArray[np.float64],
    travelled: NDArray[np.float64],
    present: NDArray[np.bool_],
) -> None:
    # One thread: waking a second one costs more than 64 worlds of 40 actors.
    for world in range(len(time)):
        for actor in range(table.shape[1]):
            pose = interpolate_actor(table, rate, actor, time[world])
            position[world, actor, 0] = pose[0]
            position[world, actor, 1] = pose[1]
            yaw[world, actor] = pose[2]
            speed[world, actor] = pose[3]
            yaw_rate[world, actor] = pose[4]
            travelled[world, actor] = pose[5]
            present[world, actor] = pose[6]
