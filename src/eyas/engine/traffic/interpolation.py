"""Interpolation of actors: cubic Hermite curves between the samples of a motion."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.motion import BLOCK, ActorState, Motion
from eyas.lanes import compiled, kernel
from eyas.lanes.elementary import hypot

_BITS = BLOCK.bit_length() - 1


class ActorPose(NamedTuple):
    """One actor at one time; fields as in `eyas.engine.state.motion.ActorState`."""

    x: float
    y: float
    z: float
    yaw: float
    slope: float
    speed: float
    velocity_x: float
    velocity_y: float
    velocity_z: float
    yaw_rate: float
    hitch: float
    travelled: float
    present: bool


@kernel(inline=True)
def _place(motion: Motion, time: float) -> float:
    """Return a time in samples since the first, within the motion."""
    last = motion.samples - 1
    return min(max((time - motion.first_time) * motion.rate, 0.0), float(last))


@kernel(inline=True)
def sample_before(motion: Motion, time: float) -> int:
    """Return the sample at the beginning of the interval that a time [s] lies in."""
    return min(int(_place(motion, time)), motion.samples - 2)


@kernel(inline=True)
def place_of(motion: Motion, row: int, actor: int) -> int:
    """Return where sample `row` of an actor is in `Motion.track`."""
    start = int(motion.start[row >> _BITS, actor])
    still = start >> 63  # all bits of an inverted number, without a branch
    return (start ^ still) + (row & (BLOCK - 1) & ~still)


@kernel(inline=True)
def interpolate_actor(
    motion: Motion,  # Motion of all actors
    actor: int,  # Index of the actor
    time: float,  # Time [s]
) -> ActorPose:
    """Return one actor at one time; times outside the samples are clamped to their ends."""
    row = sample_before(motion, time)
    f = _place(motion, time) - row
    at = place_of(motion, row, actor)
    after = at + (motion.start[row >> _BITS, actor] >= 0)
    if (row & (BLOCK - 1)) == BLOCK - 1:
        after = place_of(motion, row + 1, actor)
    a, b = motion.track[at], motion.track[after]
    on_a, on_b = motion.footing[a.footing], motion.footing[b.footing]
    step = 1.0 / motion.rate
    x, speed_x = _hermite(a.x, b.x, a.velocity_x, b.velocity_x, step, f)
    y, speed_y = _hermite(a.y, b.y, a.velocity_y, b.velocity_y, step, f)
    z, climb = _hermite(on_a.z, on_b.z, on_a.velocity_z, on_b.velocity_z, step, f)
    yaw, yaw_rate = _hermite(a.yaw, b.yaw, a.yaw_rate, b.yaw_rate, step, f)
    speed_a = hypot(a.velocity_x, a.velocity_y)
    speed_b = hypot(b.velocity_x, b.velocity_y)
    travelled, _ = _hermite(a.travelled, b.travelled, speed_a, speed_b, step, f)
    slope = on_a.slope + f * (on_b.slope - on_a.slope)
    hitch = on_a.hitch + f * (on_b.hitch - on_a.hitch)
    speed = hypot(speed_x, speed_y)
    present = (on_a.present > 0.0 or f == 1.0) and (on_b.present > 0.0 or f == 0.0)
    velocity = (speed_x, speed_y, climb)
    return ActorPose(x, y, z, yaw, slope, speed, *velocity, yaw_rate, hitch, travelled, present)


@kernel(inline=True)
def _hermite(
    a: float, b: float, slope_a: float, slope_b: float, step: float, f: float
) -> tuple[float, float]:
    """Return value and slope of a cubic with given ends and slopes, at share `f` of a step [s]."""
    start = float(a)
    rise = float(b) - start
    lift_a = float(slope_a) * step
    lift_b = float(slope_b) * step
    square = lift_a + lift_b - 2.0 * rise
    bend = 3.0 * rise - 2.0 * lift_a - lift_b
    value = start + f * (lift_a + f * (bend + f * square))
    slope = (lift_a + f * (2.0 * bend + f * 3.0 * square)) / step
    return value, slope


@kernel(inline=True)
def write_actor(pose: ActorPose, out: ActorState, world: int, actor: int) -> None:
    """Write an actor as one of a world."""
    out.position[world, actor, 0] = pose.x
    out.position[world, actor, 1] = pose.y
    out.position[world, actor, 2] = pose.z
    out.yaw[world, actor] = pose.yaw
    out.slope[world, actor] = pose.slope
    out.speed[world, actor] = pose.speed
    out.velocity[world, actor, 0] = pose.velocity_x
    out.velocity[world, actor, 1] = pose.velocity_y
    out.velocity[world, actor, 2] = pose.velocity_z
    out.yaw_rate[world, actor] = pose.yaw_rate
    out.hitch[world, actor] = pose.hitch
    out.travelled[world, actor] = pose.travelled
    out.present[world, actor] = pose.present


def interpolate_actors(motion: Motion, time: NDArray[np.float64], out: ActorState) -> None:
    """Write all actors of W worlds at the worlds' own times [s], shape (W,)."""
    # In this thread: waking a second one takes longer than 64 worlds of 40 actors.
    _interpolate(motion, time, out)


@compiled
def _interpolate(motion: Motion, time: NDArray[np.float64], out: ActorState) -> None:
    for world in range(len(time)):
        for actor in range(motion.start.shape[1]):
            pose = interpolate_actor(motion, actor, time[world])
            write_actor(pose, out, world, actor)
