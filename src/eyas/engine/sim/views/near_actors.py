"""Which actors matter for some views, and what is listed of them: the records and kernels that the
loops of this processor and of devices share.
"""

import math
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.scalars import f4
from eyas.engine.sim.views.spray import SPRAY_REACH
from eyas.engine.state.motion import ActorState, Motion
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.rig import Rigs
from eyas.engine.traffic.interpolation import ActorPose, write_actor
from eyas.engine.traffic.lamps import shining
from eyas.lanes import kernel
from eyas.lanes.elementary import tan
from eyas.lanes.vector import bits_of, load, magnitude

SLACK = 0.05  # Distance outside a view at which actors are still posed: more than roundings [m]

CAMERA: Final = np.dtype(
    [
        (name, np.float32)
        for name in (
            *("eye_x", "eye_y", "eye_z", "ahead_x", "ahead_y", "ahead_z"),
            *("left_x", "left_y", "left_z", "up_x", "up_y", "up_z"),
            *("wide", "high", "wide_edge", "high_edge"),
        )
    ],
    align=True,
)
"""A camera: optical centre [m], axes in the world, half the width and height of what it shows at a
depth of 1 m, and the lengths of the rays to its left and upper edge at that depth [m]."""


class KindTable(NamedTuple):
    """K kinds of actors, whose columns in the bounds follow each other."""

    end: NDArray[np.int64]  # Where the actors of each kind end, shape (K,)
    slots: NDArray[np.int64]  # Slots that an actor of each kind needs, shape (K,)
    reach: NDArray[np.float64]
    """Distance up to which an actor of each kind may matter [m], shape (K,)."""


class ViewQuery(NamedTuple):
    """W worlds at their times, with V views."""

    worlds: NDArray[np.int64]  # W, shape (1,)
    aspect: NDArray[np.float64]  # Height of what the cameras show over its width, shape (1,)
    world: NDArray[np.int64]  # Which worlds, shape (W,)
    time: NDArray[np.float64]  # [s], shape (W,)
    end: NDArray[np.int64]  # Where the views of each world end, shape (W,)
    eye: NDArray[np.float64]  # Optical centres of the views, world by world [m], shape (V, 3)
    rotation: NDArray[np.float64]  # Camera to world; columns forward, left, up, shape (V, 3, 3)
    field_of_view: NDArray[np.float64]  # Horizontal [rad], shape (V,)
    camera: NDArray[np.void]
    """Working memory: the same as the test needs it, of `CAMERA`, shape (V,)."""


class Listed(NamedTuple):
    """The actors that matter, E in all worlds; where there are more, the rest is not written."""

    needed: NDArray[np.int64]
    """Number of these actors, and the most slots that a world needs, shape (2,)."""
    end: NDArray[np.int64]  # Where the actors of each kind end, shape (K,)
    used: NDArray[np.int64]  # Slots used in each world, shape (W,)
    slot: NDArray[np.int64]
    """First slot of each actor, counted through the lists of all worlds, shape (E,)."""
    state: ActorState  # As of one world, shape (1, E)
    looks: Looks  # The same
    part: NDArray[np.int32]  # See `DrawList`; emptied, shape (W, I)
    object_id: NDArray[np.int32]  # See `DrawList`, shape (W, I)
    lamps: NDArray[np.uint8]  # See `DrawList`


@kernel(inline=True)
def set_camera(query: ViewQuery, v: int) -> None:
    """Fill `ViewQuery.camera` of view `v`."""
    camera, eye, axes = query.camera[v], query.eye[v], query.rotation[v]
    camera.eye_x, camera.eye_y, camera.eye_z = eye[0], eye[1], eye[2]
    camera.ahead_x, camera.ahead_y, camera.ahead_z = axes[0, 0], axes[1, 0], axes[2, 0]
    camera.left_x, camera.left_y, camera.left_z = axes[0, 1], axes[1, 1], axes[2, 1]
    camera.up_x, camera.up_y, camera.up_z = axes[0, 2], axes[1, 2], axes[2, 2]
    wide = tan(0.5 * query.field_of_view[v])
    high = wide * query.aspect[0]
    camera.wide, camera.high = wide, high
    camera.wide_edge = math.sqrt(1.0 + wide * wide)
    camera.high_edge = math.sqrt(1.0 + high * high)


@kernel(inline=True)
def may_show(
    camera: Any,  # noqa: ANN401  # a record of `CAMERA`
    x: float,
    y: float,
    z: float,
    reach: float,
) -> bool:
    """Return which spheres, of float32, a camera may show; how far it sees is not known."""
    x, y, z = x - camera.eye_x, y - camera.eye_y, z - camera.eye_z
    ahead = camera.ahead_x * x + camera.ahead_y * y + camera.ahead_z * z
    left = magnitude(camera.left_x * x + camera.left_y * y + camera.left_z * z)
    up = magnitude(camera.up_x * x + camera.up_y * y + camera.up_z * z)
    seen: bool = ahead > -reach
    seen &= left - camera.wide * ahead < camera.wide_edge * reach
    seen &= up - camera.high * ahead < camera.high_edge * reach
    return seen


@kernel(inline=True)
def eight_may_matter(
    query: ViewQuery, w: int, sphere: NDArray[np.float32], first: int, reach: float
) -> int:
    """Return which of eight columns of rows x, y, z and radius a view of world `w` may show, a bit
    each.
    """
    width = sphere.shape[1]
    x, y, z = load(sphere, first), load(sphere, width + first), load(sphere, 2 * width + first)
    around = load(sphere, 3 * width + first) + f4(reach)
    seen = 0
    for v in range(query.end[w - 1] if w > 0 else 0, query.end[w]):
        seen |= bits_of(may_show(query.camera[v], x, y, z, around))
    return seen


@kernel(inline=True)
def one_may_matter(query: ViewQuery, w: int, pose: ActorPose, reach: float) -> bool:
    """Return whether a view of world `w` may show something of an actor."""
    x, y, z = f4(pose.x), f4(pose.y), f4(pose.z)
    for v in range(query.end[w - 1] if w > 0 else 0, query.end[w]):
        if may_show(query.camera[v], x, y, z, f4(reach)):
            return True
    return False


class Entry(NamedTuple):
    """An actor that is listed."""

    actor: int
    world: int  # Whose looks it has
    row: int  # Of the list of that world
    slots: int  # How many it needs
    place: int  # Its place in `Listed.slot`.
    state_row: int  # Its place in `Listed.state` and `Listed.looks`.
    state_column: int
    first: int
    """What is added to the number of its first slot in the list, to be told in `Listed.slot`."""


@kernel(inline=True)
def write_entry(
    motion: Motion, looks: Looks, listed: Listed, entry: Entry, pose: ActorPose, time: float
) -> None:
    """Write an actor into its list, except for the parts of its slots and their poses."""
    begun, end = listed.used[entry.row], listed.used[entry.row] + entry.slots
    row, column = entry.state_row, entry.state_column
    listed.slot[entry.place] = entry.first + begun
    listed.looks.model[row, column] = looks.model[entry.world, entry.actor]
    for channel in range(3):
        colour = looks.colour[entry.world, entry.actor, channel]
        listed.looks.colour[row, column, channel] = colour
    for slot in range(begun, end):
        listed.object_id[entry.row, slot] = ACTOR_OBJECT + entry.actor
    if listed.lamps.shape[1] > 0:
        lit = shining(motion, entry.actor, time)
        for slot in range(begun, end):
            listed.lamps[entry.row, slot] = lit
    write_actor(pose, listed.state, row, column)


def kind_table(rigs: Rigs, reach: NDArray[np.float64], *, spray: bool = False) -> KindTable:
    """Return the kinds of actors.

    Args:
        rigs: Their rigs.
        reach: Distance up to which an actor of each kind may matter [m], shape (K,).
        spray: Whether vehicles throw up water, which matters, too.
    """
    return KindTable(
        end=np.cumsum([len(cast.group.actor) for cast in rigs.casts], dtype=np.int64),
        slots=np.array([cast.rig.slots for cast in rigs.casts], np.int64),
        reach=np.asarray(reach, np.float64) * 1.001 + SLACK + SPRAY_REACH * spray,
    )


def column_actors(rigs: Rigs) -> NDArray[np.int64]:
    """Return the actors kind by kind, as bounds have their columns."""
    return np.concatenate([np.zeros(0, np.int64), *(cast.group.actor for cast in rigs.casts)])
