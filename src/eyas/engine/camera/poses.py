"""Where cameras are during an exposure, and how far what they see moves in the picture."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.vibration import Shake, shaken_axes
from eyas.engine.state.snapshot import CameraState
from eyas.lanes import compiled, kernel
from eyas.lanes.elementary import sin_cos, tan

Floats = NDArray[np.float64]
Vector = tuple[float, float, float]
Lens = tuple[float, float]  # Focal length, and half the width of the picture [pixels]


class Exposure(NamedTuple):
    """V cameras at the instants of their pictures, without their vibration."""

    cameras: CameraState  # With velocities
    shake: Shake  # Their vibration
    instant: Floats  # Time of each for its vibration [s], shape (V,)


class Moments(NamedTuple):
    """K moments of V cameras."""

    of: NDArray[np.int64]  # Whose, shape (K,)
    later: Floats  # Time after the instant of its picture [s], shape (K,)
    position: Floats  # Written: optical centre [m], shape (K, 3)
    rotation: Floats  # Written: camera to world, shape (K, 3, 3)


@kernel(inline=True)
def turned(axes: Floats, x: float, y: float, z: float) -> None:
    """Turn axes, the columns of a matrix, by a rotation vector in the world [rad], in place.

    Rodrigues' formula, with series for the small angles of an exposure.
    """
    square = x * x + y * y + z * z
    if square < 1e-6:
        first = 1.0 - square / 6.0
        second = 0.5 - square / 24.0
    else:
        angle = math.sqrt(square)
        sine, cosine = sin_cos(angle)
        first = sine / angle
        second = (1.0 - cosine) / square
    for column in range(3):
        a, b, c = axes[0, column], axes[1, column], axes[2, column]
        u, v, w = y * c - z * b, z * a - x * c, x * b - y * a
        axes[0, column] = a + first * u + second * (y * w - z * v)
        axes[1, column] = b + first * v + second * (z * u - x * w)
        axes[2, column] = c + first * w + second * (x * v - y * u)


@kernel(inline=True)
def _pose(exposure: Exposure, v: int, later: float, place: Floats, axes: Floats) -> None:
    """Write the pose of camera `v` some time after its instant."""
    cameras = exposure.cameras
    velocity, turning = cameras.velocity[v], cameras.angular_velocity[v]
    for row in range(3):
        place[row] = cameras.position[v, row] + later * velocity[row]
        for column in range(3):
            axes[row, column] = cameras.rotation[v, row, column]
    turned(axes, later * turning[0], later * turning[1], later * turning[2])
    shaken_axes(exposure.shake, v, exposure.instant[v] + later, axes)


@compiled
def poses_at(exposure: Exposure, moments: Moments) -> None:
    """Write the poses of cameras at moments of their exposures."""
    for k in range(moments.of.shape[0]):
        place, axes = moments.position[k], moments.rotation[k]
        _pose(exposure, moments.of[k], moments.later[k], place, axes)


class Moving(NamedTuple):
    """E things that V views may show, with their motion."""

    first: NDArray[np.int64]  # Where the things of each view begin, shape (V,)
    end: NDArray[np.int64]  # Where they end, shape (V,)
    position: Floats  # Reference points, world frame [m], shape (E, 3)
    velocity: Floats  # [m/s], shape (E, 3)
    reach: Floats
    """How far they reach from there, a few metres at most [m], shape (E,). Those that reach into a
    view must be the same whatever other views there are."""


class Seen(NamedTuple):
    """What V cameras see, as far as its motion in the picture is asked."""

    window: Floats  # Length of the time around the instant [s], shape (V,)
    floor: Floats  # Height of the ground ahead [m], shape (V,)
    frame: Floats
    """Width of the picture [pixels]; height over width of what it shows; its rows over those that
    it had if its pixels were square; shape (3,)."""
    things: Moving
    place: Floats  # Working memory, shape (INSTANTS, 3)
    axes: Floats  # The same, shape (INSTANTS, 3, 3)
    motion: Floats  # Written: the longest way of anything in the picture [pixels], shape (V,)


INSTANTS = 5  # Instants of the time that are compared: vibration goes to and fro within it

_FARTHEST = 1000.0
_NEAREST = 1.0
_WIDE = 1.0  # Roundings must not move the ground at the edge of the picture out of it [m]


@kernel(inline=True)
def _way(seen: Seen, v: int, lens: Lens, reach: float, point: Vector, velocity: Vector) -> float:
    """Return the way of a thing through the picture of view `v` [pixels]; 0 if it is not in it."""
    focal, half = lens
    x, y, z = point
    east, north, up = velocity
    way, column, row, window = 0.0, 0.0, 0.0, seen.window[v]
    for k in range(INSTANTS):
        later = window * (k / (INSTANTS - 1.0) - 0.5)
        place, axes = seen.place[k], seen.axes[k]
        a = x + later * east - place[0]
        b = y + later * north - place[1]
        c = z + later * up - place[2]
        ahead = axes[0, 0] * a + axes[1, 0] * b + axes[2, 0] * c
        if ahead < _NEAREST:
            return 0.0
        right = -focal * (axes[0, 1] * a + axes[1, 1] * b + axes[2, 1] * c) / ahead
        down = -focal * (axes[0, 2] * a + axes[1, 2] * b + axes[2, 2] * c) / ahead
        if k == INSTANTS // 2:
            edge = focal * reach / ahead
            if abs(right) > half + edge or abs(down) > half * seen.frame[1] + edge:
                return 0.0
        if k > 0:
            way += math.sqrt((right - column) ** 2 + (seen.frame[2] * (down - row)) ** 2)
        column, row = right, down
    return way


@kernel(inline=True)
def _way_of_ground(
    exposure: Exposure, seen: Seen, v: int, lens: Lens, across: int, down: int
) -> float:
    """Return the way of what a place of the picture shows of the plane of the ground."""
    focal, half = lens
    place, axes = exposure.cameras.position[v], exposure.cameras.rotation[v]
    left, up = -across * half / focal, -down * half * seen.frame[1] / focal
    x = axes[0, 0] + left * axes[0, 1] + up * axes[0, 2]
    y = axes[1, 0] + left * axes[1, 1] + up * axes[1, 2]
    z = axes[2, 0] + left * axes[2, 1] + up * axes[2, 2]
    away, height = _FARTHEST, max(place[2] - seen.floor[v], _NEAREST)
    if -z * _FARTHEST > height:
        away = max(-height / z, _NEAREST)
    x, y, z = place[0] + away * x, place[1] + away * y, place[2] + away * z
    return _way(seen, v, lens, _WIDE, (x, y, z), (0.0, 0.0, 0.0))


@compiled
def motion_in_pixels(exposure: Exposure, seen: Seen) -> None:
    """Write how far what each camera sees moves through its picture within a time: the ground, at
    nine places of the picture, and things.
    """
    half = 0.5 * seen.frame[0]
    for v in range(seen.motion.shape[0]):
        lens = half / tan(0.5 * exposure.cameras.field_of_view[v]), half
        for k in range(INSTANTS):
            later = seen.window[v] * (k / (INSTANTS - 1.0) - 0.5)
            _pose(exposure, v, later, seen.place[k], seen.axes[k])
        longest = 0.0
        for across in range(-1, 2):
            for down in range(-1, 2):
                way = _way_of_ground(exposure, seen, v, lens, across, down)
                longest = max(longest, way)
        things = seen.things
        for e in range(things.first[v], things.end[v]):
            point, speed = things.position[e], things.velocity[e]
            velocity = speed[0], speed[1], speed[2]
            place = point[0], point[1], point[2]
            way = _way(seen, v, lens, things.reach[e], place, velocity)
            longest = max(longest, way)
        seen.motion[v] = longest
