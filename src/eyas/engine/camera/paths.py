"""The way of a camera between two pictures, from its poses and velocities at both."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.poses import Moments, turned
from eyas.engine.camera.vibration import Shake, shaken_axes
from eyas.engine.state.snapshot import CameraState
from eyas.lanes import compiled, kernel
from eyas.lanes.elementary import atan2, hypot

Floats = NDArray[np.float64]
Vector = tuple[float, float, float]


class Ways(NamedTuple):
    """The ways of V cameras, without their vibration."""

    first: CameraState  # Where they were, with velocities
    last: CameraState  # Where they are
    shake: Shake  # Their vibration
    begin: Floats  # Time of the first pose [s], shape (V,)
    end: Floats  # Time of the last one [s], shape (V,)


@kernel(inline=True)
def _turn(first: Floats, last: Floats) -> Vector:
    """Return the rotation vector in the world [rad] that turns axes, columns, into others."""
    x, y, z, trace = 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        a, b, c = first[0, k], first[1, k], first[2, k]
        u, v, w = last[0, k], last[1, k], last[2, k]
        x += 0.5 * (b * w - c * v)
        y += 0.5 * (c * u - a * w)
        z += 0.5 * (a * v - b * u)
        trace += a * u + b * v + c * w
    sine = hypot(hypot(x, y), z)
    scale = 1.0
    if sine > 1e-9:
        scale = atan2(sine, 0.5 * (trace - 1.0)) / sine
    return scale * x, scale * y, scale * z


@compiled
def poses_between(ways: Ways, moments: Moments) -> None:
    """Write where cameras are at moments of their ways, `Moments.later` after the end, so mostly
    negative: cubic curves with the velocities at both ends, of the place and of the rotation
    vector from the first pose.
    """
    for k in range(moments.of.shape[0]):
        v = moments.of[k]
        place, axes, length = moments.position[k], moments.rotation[k], ways.end[v] - ways.begin[v]
        share = 1.0
        if length > 0.0:
            share += moments.later[k] / length
        rest = 1.0 - share
        leave, arrive = share * rest * rest * length, -share * share * rest * length
        arrived = share * share * (3.0 - 2.0 * share)
        first, last = ways.first, ways.last
        turn = _turn(first.rotation[v], last.rotation[v])
        x = arrived * turn[0]
        y = arrived * turn[1]
        z = arrived * turn[2]
        x += leave * first.angular_velocity[v, 0] + arrive * last.angular_velocity[v, 0]
        y += leave * first.angular_velocity[v, 1] + arrive * last.angular_velocity[v, 1]
        z += leave * first.angular_velocity[v, 2] + arrive * last.angular_velocity[v, 2]
        for row in range(3):
            way = last.position[v, row] - first.position[v, row]
            place[row] = first.position[v, row] + arrived * way
            place[row] += leave * first.velocity[v, row] + arrive * last.velocity[v, row]
            for column in range(3):
                axes[row, column] = first.rotation[v, row, column]
        turned(axes, x, y, z)
        shaken_axes(ways.shake, v, ways.end[v] + moments.later[k], axes)


@compiled
def speeds_between(
    ways: Ways,  # V ways
    velocity: Floats,  # Written: world frame [m/s], shape (V, 3)
    turning: Floats,  # Written: world frame [rad/s], shape (V, 3)
) -> None:
    """Write the mean velocities of cameras on their ways, 0 where no time passes."""
    for v in range(velocity.shape[0]):
        length = ways.end[v] - ways.begin[v]
        turn = _turn(ways.first.rotation[v], ways.last.rotation[v])
        per = 1.0 / length if length > 0.0 else 0.0
        for axis in range(3):
            way = ways.last.position[v, axis] - ways.first.position[v, axis]
            velocity[v, axis] = per * way
            turning[v, axis] = per * turn[axis]
