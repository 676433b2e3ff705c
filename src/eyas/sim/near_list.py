"""Which actors may matter in some views: the kernel that lists them.

Most actors of a large world are behind the cameras or far aside. They are left out, eight at
once, by their spheres in a chart; only the others are interpolated.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import compiled, kernel
from eyas.lanes.elementary import tan
from eyas.lanes.vector import WIDTH, bits_of, first_bit, load, magnitude
from eyas.render.kernels.scalars import f4
from eyas.sim.chart import Chart, charted
from eyas.state.motion import ActorState, Motion
from eyas.state.scene import ACTOR_OBJECT
from eyas.targets.kind import Looks
from eyas.traffic.interpolation import (
    ActorPose,
    interpolate_actor,
    sample_before,
    write_actor,
)

__all__ = ["Near", "Plan", "Query", "list_near"]


class Plan(NamedTuple):
    """K kinds of actors, whose columns in the chart follow each other."""

    end: NDArray[np.int64]
    """Where the actors of each kind end, shape (K,)."""
    slots: NDArray[np.int64]
    """Slots that an actor of each kind needs, shape (K,)."""
    reach: NDArray[np.float64]
    """Distance up to which an actor of each kind may matter [m], shape (K,)."""


class Query(NamedTuple):
    """W worlds at their times, with V views."""

    worlds: NDArray[np.int64]
    """W, shape (1,)."""
    aspect: NDArray[np.float64]
    """Height of what the cameras show over its width, shape (1,)."""
    world: NDArray[np.int64]
    """Which worlds, shape (W,)."""
    time: NDArray[np.float64]
    """[s], shape (W,)"""
    end: NDArray[np.int64]
    """Where the views of each world end, shape (W,)."""
    eye: NDArray[np.float64]
    """Optical centres of the views, world by world [m], shape (V, 3)."""
    rotation: NDArray[np.float64]
    """Camera to world; columns forward, left, up, shape (V, 3, 3)."""
    field_of_view: NDArray[np.float64]
    """Horizontal [rad], shape (V,)."""
    camera: NDArray[np.float32]
    """Working memory: the same in numbers that the test needs, shape (V, 16)."""


class Near(NamedTuple):
    """The actors that matter, E in all worlds; where there are more, the rest is not written."""

    needed: NDArray[np.int64]
    """Number of these actors, and the most slots that a world needs, shape (2,)."""
    end: NDArray[np.int64]
    """Where the actors of each kind end, shape (K,)."""
    used: NDArray[np.int64]
    """Slots used in each world, shape (W,)."""
    slot: NDArray[np.int64]
    """First slot of each actor, counted through the lists of all worlds, shape (E,)."""
    state: ActorState
    """As of one world, shape (1, E)."""
    looks: Looks
    """The same."""
    part: NDArray[np.int32]
    """See `DrawList`; emptied, shape (W, I)."""
    object_id: NDArray[np.int32]
    """See `DrawList`, shape (W, I)."""


class _Camera(NamedTuple):
    """A row of `Query.camera`."""

    eye: tuple[float, float, float]
    """Optical centre [m]."""
    ahead: tuple[float, float, float]
    left: tuple[float, float, float]
    up: tuple[float, float, float]
    wide: float
    """Half the width of what it shows at a depth of 1 m."""
    high: float
    """Half the height."""
    wide_edge: float
    """Length of the ray to the left edge at a depth of 1 m."""
    high_edge: float
    """Length of the ray to the upper edge."""


@kernel(inline=True)
def _set_cameras(query: Query) -> None:
    """Fill `Query.camera`."""
    for v in range(query.end[query.worlds[0] - 1]):
        camera, wide = query.camera[v], tan(0.5 * query.field_of_view[v])
        high = wide * query.aspect[0]
        for axis in range(3):
            camera[axis] = query.eye[v, axis]
            for column in range(3):
                camera[3 + 3 * column + axis] = query.rotation[v, axis, column]
        camera[12], camera[13] = wide, high
        camera[14], camera[15] = math.sqrt(1.0 + wide * wide), math.sqrt(1.0 + high * high)


@kernel(inline=True)
def _camera_of(query: Query, v: int) -> _Camera:
    c = query.camera[v]
    return _Camera(
        (c[0], c[1], c[2]),
        (c[3], c[4], c[5]),
        (c[6], c[7], c[8]),
        (c[9], c[10], c[11]),
        c[12],
        c[13],
        c[14],
        c[15],
    )


@kernel(inline=True)
def _along(axis: tuple[float, float, float], x: float, y: float, z: float) -> float:
    return axis[0] * x + axis[1] * y + axis[2] * z


@kernel(inline=True)
def _may_show(camera: _Camera, x: float, y: float, z: float, reach: float) -> bool:
    """Return which spheres, of float32, a camera may show; it is not told how far it sees."""
    eye = camera.eye
    x, y, z = x - eye[0], y - eye[1], z - eye[2]
    ahead = _along(camera.ahead, x, y, z)
    left = magnitude(_along(camera.left, x, y, z))
    up = magnitude(_along(camera.up, x, y, z))
    seen: bool = ahead > -reach
    seen &= left - camera.wide * ahead < camera.wide_edge * reach
    seen &= up - camera.high * ahead < camera.high_edge * reach
    return seen


@kernel(inline=True)
def _eight_may_matter(
    query: Query, w: int, sphere: NDArray[np.float32], first: int, reach: float
) -> int:
    """Return which of eight columns of a chart's row a view of world `w` may show, a bit each."""
    width = sphere.shape[1]
    x, y, z = load(sphere, first), load(sphere, width + first), load(sphere, 2 * width + first)
    around = load(sphere, 3 * width + first) + f4(reach)
    seen = 0
    for v in range(query.end[w - 1] if w > 0 else 0, query.end[w]):
        seen |= bits_of(_may_show(_camera_of(query, v), x, y, z, around))
    return seen


@kernel(inline=True)
def _one_may_matter(query: Query, w: int, pose: ActorPose, reach: float) -> bool:
    """Return whether a view of world `w` may show something of an actor."""
    x, y, z = f4(pose.x), f4(pose.y), f4(pose.z)
    for v in range(query.end[w - 1] if w > 0 else 0, query.end[w]):
        if _may_show(_camera_of(query, v), x, y, z, f4(reach)):
            return True
    return False


@kernel(inline=True)
def _write(near: Near, k: int, actor: int, w: int, slots: int, looks: Looks, world: int) -> None:
    """Write entry `k` except its state: its looks, and the object ids of its slots in list `w`."""
    first = near.used[w]
    near.slot[k] = w * near.part.shape[1] + first
    near.looks.model[0, k] = looks.model[world, actor]
    for channel in range(3):
        near.looks.colour[0, k, channel] = looks.colour[world, actor, channel]
    for slot in range(first, first + slots):
        near.object_id[w, slot] = ACTOR_OBJECT + actor


@compiled
def list_near(
    motion: Motion, chart: Chart, plan: Plan, looks: Looks, query: Query, near: Near
) -> None:
    """Find the actors that matter, and give each its slots; the lists get in their order."""
    _set_cameras(query)
    near.needed[1] = 0
    for w in range(query.worlds[0]):
        near.used[w] = 0
        near.part[w, :] = -1
    entries, begin = 0, 0
    for k in range(plan.end.shape[0]):
        reach, slots, end = plan.reach[k], plan.slots[k], plan.end[k]
        for w in range(query.worlds[0]):
            time = query.time[w]
            sphere = chart.sphere[charted(chart, motion, sample_before(motion, time))]
            for first in range(begin, end, WIDTH):
                seen = _eight_may_matter(query, w, sphere, first, reach)
                seen &= (1 << min(end - first, WIDTH)) - 1
                while seen != 0:
                    actor = chart.actor[first + first_bit(seen)]
                    seen &= seen - 1
                    pose = interpolate_actor(motion, actor, time)
                    if not pose.present or not _one_may_matter(query, w, pose, reach):
                        continue
                    fits = near.used[w] + slots <= near.part.shape[1]
                    if fits and entries < near.slot.shape[0]:
                        _write(near, entries, actor, w, slots, looks, query.world[w])
                        write_actor(pose, near.state, 0, entries)
                    entries += 1
                    near.used[w] += slots
                    near.needed[1] = max(near.needed[1], near.used[w])
        near.end[k] = entries
        begin = end
    near.needed[0] = entries
