"""Motion of what flies between cameras and streets: birds in flocks, and drones.

All of it is a function of a seed, a number and the time.
"""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from eyas.engine.behaviours.airspace import Space
from eyas.engine.behaviours.groups import SampleClock
from eyas.engine.core.config import Config
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.lanes import exact

Floats = NDArray[np.float64]

_FLOCK = 6  # Most birds in a flock
_TRIES = 24  # Ways that are drawn for a flock; the first that is free is taken
_LOWEST, _HIGHEST, _ROOM = 10.0, 60.0, 4.0
"""Heights above the ground, and room above what stands below [m]."""
_LAG, _AVERAGE = 1.5, 2.0
"""How long after a vehicle a drone is where that was, and half the time over which its way is
averaged [s]."""


class AirborneConfig(Config):
    """What flies through the world and is never a target: distractors in the air."""

    birds: Annotated[int, Field(ge=0, le=200)] = 0
    """Birds, in flocks of up to six (docs/weather.md); they are never targets."""
    drones: Annotated[int, Field(ge=0, le=20)] = 0
    """Drones, each of which follows a vehicle of its own; they are never targets."""


class _Way(NamedTuple):
    """A closed way: two harmonics along each axis, and a height."""

    centre: Floats  # East and north [m], shape (2,)
    size: Floats  # Amplitudes of each harmonic eastwards and northwards [m], shape (2, 2)
    phase: Floats  # [rad], shape (2, 2)
    rate: float  # Of the first harmonic [rad/s]
    height: float  # [m]


def _place(way: _Way, time: Floats) -> tuple[Floats, Floats]:
    """Return places and velocities along a way, shape (..., 3)."""
    place, velocity = np.zeros((*time.shape, 3)), np.zeros((*time.shape, 3))
    for order in range(2):
        rate = (order + 1) * way.rate
        for axis in range(2):
            angle, size = rate * time + way.phase[order, axis], way.size[order, axis]
            place[..., axis] += size * exact.cos(angle)
            velocity[..., axis] -= rate * size * exact.sin(angle)
    place[..., :2] += way.centre
    angle, deep = 3.0 * way.rate * time + way.phase[0, 0], 0.12 * way.height
    place[..., 2] = way.height + deep * exact.sin(angle)
    velocity[..., 2] = 3.0 * way.rate * deep * exact.cos(angle)
    return place, velocity


def _free_way(space: Space, rng: np.random.Generator, speed: float) -> _Way:
    """Return a way above all that stands on it; the lowest of those tried if none is low."""
    best: _Way | None = None
    for _ in range(_TRIES):
        radius = rng.uniform(25.0, 60.0)
        size = np.array([[radius, radius], [0.0, 0.0]]) * rng.uniform(0.75, 1.25, (2, 2))
        size[1] = radius * rng.uniform(0.05, 0.2, 2)
        turn = rng.uniform(0.0, 2.0 * np.pi)
        phase = np.array([[turn, turn - 0.5 * np.pi], rng.uniform(0.0, 2.0 * np.pi, 2)])
        centre = rng.uniform(-0.32, 0.32, 2) * space.extent
        wanted = rng.uniform(_LOWEST, 0.6 * _HIGHEST)
        way = _Way(centre, size, phase, speed / radius, wanted)
        points, _ = _place(way, np.linspace(0.0, 2.0 * np.pi / way.rate, 96))
        least = (float(space.heights(points[:, :2]).max()) + _ROOM) / 0.86
        way = way._replace(height=max(wanted, least))
        if best is None or way.height < best.height:
            best = way
        if way.height == wanted:
            return way
    assert best is not None
    return best


def flocks(
    count: int,  # Number of them
    kind: int,
    space: Space,  # The map
    clock: SampleClock,  # The instants
    rng: np.random.Generator,  # Random numbers
    speed: float,  # [m/s]
) -> SampledMotion:
    """Return the motion of birds, or of drones that follow nobody, on closed ways."""
    time = np.arange(clock.samples) / clock.rate
    table = np.zeros((clock.samples, count), SAMPLE)
    way = _free_way(space, rng, speed)
    size = 0
    for k in range(count):
        if size == _FLOCK or (k > 0 and rng.random() < 0.2):
            way, size = _free_way(space, rng, speed), 0
        size += 1
        place, velocity = _place(way, time - rng.uniform(0.0, 1.8))
        # Each sways about its place in the flock.
        for axis, reach in enumerate((2.5, 2.5, 0.8)):
            own, angle = rng.uniform(0.25, 0.6), rng.uniform(0.0, 2.0 * np.pi)
            place[:, axis] += reach * exact.sin(own * time + angle)
            velocity[:, axis] += reach * own * exact.cos(own * time + angle)
        _write(table[:, k], place, velocity, None, clock.rate)
    return SampledMotion(table, np.full(count, kind, np.int32), clock.rate, 0.0)


def chases(
    count: int,  # Number of them; no more than vehicles
    kind: int,
    vehicles: SampledMotion,
    rng: np.random.Generator,  # Random numbers
) -> SampledMotion:
    """Return the motion of drones that follow vehicles, each another one, from above."""
    table = np.zeros((len(vehicles.table), count), SAMPLE)
    chosen = rng.permutation(len(vehicles.kind))[:count]
    lag, half = round(_LAG * vehicles.rate), round(_AVERAGE * vehicles.rate)
    for k, vehicle in enumerate(chosen.tolist()):
        way = vehicles.table[:, vehicle]
        place = np.stack([way[axis].astype(np.float64) for axis in ("x", "y", "z")], axis=1)
        seen = np.concatenate([place, way["yaw"].astype(np.float64)[:, None]], axis=1)
        mean = _averaged(seen, lag, half)
        mean[:, 2] += rng.uniform(11.0, 26.0)
        velocity = np.gradient(mean[:, :3], 1.0 / vehicles.rate, axis=0)
        column = table[:, k]
        _write(column, mean[:, :3], velocity, mean[:, 3], vehicles.rate)
        there = _averaged((way["present"] > 0.5).astype(np.float64)[:, None], lag, half)[:, 0]
        column["present"] = there > 1.0 - 1e-6
    return SampledMotion(table, np.full(count, kind, np.int32), vehicles.rate, vehicles.first_time)


def _averaged(values: Floats, lag: int, half: int) -> Floats:
    """Return means over samples `half` before and after, `lag` samples late, shape (S, K)."""
    before = np.repeat(values[:1], half + lag, axis=0)
    padded = np.concatenate([before, values, np.repeat(values[-1:], half, axis=0)])
    total = np.cumsum(np.concatenate([np.zeros((1, values.shape[1])), padded]), axis=0)
    width = 2 * half + 1
    mean: Floats = (total[width:] - total[:-width])[: len(values)] / width
    return mean


def _write(
    column: NDArray[np.void], place: Floats, velocity: Floats, yaw: Floats | None, rate: float
) -> None:
    """Write the samples of one that flies; it looks where it flies unless a heading is given."""
    level = np.sqrt(np.square(velocity[:, :2]).sum(axis=1))
    if yaw is None:
        yaw = np.unwrap(exact.atan2(velocity[:, 1], velocity[:, 0]))
        climb = exact.atan2(velocity[:, 2], np.maximum(level, 0.1))
        column["slope"] = np.clip(climb, -0.6, 0.6)
    for axis, name in enumerate("xyz"):
        column[name], column[f"velocity_{name}"] = place[:, axis], velocity[:, axis]
    column["yaw"], column["yaw_rate"] = yaw, np.gradient(yaw, 1.0 / rate)
    column["travelled"] = np.cumsum(level) / rate
    column["present"] = 1.0
