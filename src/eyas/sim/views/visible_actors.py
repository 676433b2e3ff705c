"""The actors that matter for some views: those that a camera may show, listed and posed.

An actor also matters if its shadow or the light of its lamps may be in the picture, so leaving
others out changes no byte. Most actors of a large world are behind the cameras or far aside: they
are left out, eight at once, by their bounds; only the others are interpolated.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import Held, compiled, kernel
from eyas.lanes.elementary import tan
from eyas.lanes.vector import WIDTH, bits_of, first_bit, load, magnitude
from eyas.render.kernels.scalars import f4
from eyas.sensors.camera.poses import Moving
from eyas.sim.views.actor_bounds import ActorBounds, bounds_of, made_row
from eyas.sim.views.spray import SPRAY_REACH, spray_of, throwing
from eyas.state.draw import DrawList
from eyas.state.motion import ActorState, Motion
from eyas.state.scene import ACTOR_OBJECT
from eyas.state.snapshot import CameraState
from eyas.targets.kind import Group, Looks
from eyas.targets.rig import Rigs
from eyas.traffic.interpolation import ActorPose, interpolate_actor, sample_before, write_actor
from eyas.traffic.lamps import shining

__all__ = ["VisibleActors"]

_SLACK = 0.05
"""Distance outside a view at which actors are still posed: more than roundings [m]."""

_LONGEST = 3.0
"""Reach of a thing beyond which it is not said to move in a picture: half a long car [m]."""

_CHOICES = 32
"""Groups of actors that are kept: those of one picture are mostly those of the next."""

_CAMERA = np.dtype(
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

    end: NDArray[np.int64]
    """Where the actors of each kind end, shape (K,)."""
    slots: NDArray[np.int64]
    """Slots that an actor of each kind needs, shape (K,)."""
    reach: NDArray[np.float64]
    """Distance up to which an actor of each kind may matter [m], shape (K,)."""


class ViewQuery(NamedTuple):
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
    camera: NDArray[np.void]
    """Working memory: the same as the test needs it, of `_CAMERA`, shape (V,)."""


class Listed(NamedTuple):
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
    lamps: NDArray[np.uint8]
    """See `DrawList`."""


@kernel(inline=True)
def _set_cameras(query: ViewQuery) -> None:
    """Fill `ViewQuery.camera`."""
    for v in range(query.end[query.worlds[0] - 1]):
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
def _may_show(
    camera: Any,  # noqa: ANN401  # a record of `_CAMERA`
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
def _eight_may_matter(
    query: ViewQuery, w: int, sphere: NDArray[np.float32], first: int, reach: float
) -> int:
    """Return which of eight columns of a row of bounds a view of world `w` may show, a bit each."""
    width = sphere.shape[1]
    x, y, z = load(sphere, first), load(sphere, width + first), load(sphere, 2 * width + first)
    around = load(sphere, 3 * width + first) + f4(reach)
    seen = 0
    for v in range(query.end[w - 1] if w > 0 else 0, query.end[w]):
        seen |= bits_of(_may_show(query.camera[v], x, y, z, around))
    return seen


@kernel(inline=True)
def _one_may_matter(query: ViewQuery, w: int, pose: ActorPose, reach: float) -> bool:
    """Return whether a view of world `w` may show something of an actor."""
    x, y, z = f4(pose.x), f4(pose.y), f4(pose.z)
    for v in range(query.end[w - 1] if w > 0 else 0, query.end[w]):
        if _may_show(query.camera[v], x, y, z, f4(reach)):
            return True
    return False


@kernel(inline=True)
def _write(
    listed: Listed, k: int, actor: int, w: int, slots: int, looks: Looks, world: int
) -> None:
    """Write entry `k` except its state: its looks, and the object ids of its slots in list `w`."""
    first = listed.used[w]
    listed.slot[k] = w * listed.part.shape[1] + first
    listed.looks.model[0, k] = looks.model[world, actor]
    for channel in range(3):
        listed.looks.colour[0, k, channel] = looks.colour[world, actor, channel]
    for slot in range(first, first + slots):
        listed.object_id[w, slot] = ACTOR_OBJECT + actor


@compiled
def _list_actors(  # the records that it reads
    motion: Motion,
    bounds: ActorBounds,
    kinds: KindTable,
    looks: Looks,
    query: ViewQuery,
    listed: Listed,
) -> None:
    """Find the actors that matter, and give each its slots; the lists get in their order."""
    _set_cameras(query)
    listed.needed[1] = 0
    for w in range(query.worlds[0]):
        listed.used[w] = 0
        listed.part[w, :] = -1
    entries, begin = 0, 0
    for k in range(kinds.end.shape[0]):
        reach, slots, end = kinds.reach[k], kinds.slots[k], kinds.end[k]
        for w in range(query.worlds[0]):
            time = query.time[w]
            sphere = bounds.sphere[made_row(bounds, motion, sample_before(motion, time))]
            for first in range(begin, end, WIDTH):
                seen = _eight_may_matter(query, w, sphere, first, reach)
                seen &= (1 << min(end - first, WIDTH)) - 1
                while seen != 0:
                    actor = bounds.actor[first + first_bit(seen)]
                    seen &= seen - 1
                    pose = interpolate_actor(motion, actor, time)
                    if not pose.present or not _one_may_matter(query, w, pose, reach):
                        continue
                    fits = listed.used[w] + slots <= listed.part.shape[1]
                    if fits and entries < listed.slot.shape[0]:
                        _write(listed, entries, actor, w, slots, looks, query.world[w])
                        if listed.lamps.shape[1] > 0:
                            begun = listed.used[w]
                            listed.lamps[w, begun : begun + slots] = shining(motion, actor, time)
                        write_actor(pose, listed.state, 0, entries)
                    entries += 1
                    listed.used[w] += slots
                    listed.needed[1] = max(listed.needed[1], listed.used[w])
        listed.end[k] = entries
        begin = end
    listed.needed[0] = entries


class _Size(NamedTuple):
    """Capacity of the buffers."""

    worlds: int
    views: int
    entries: int
    slots: int


class VisibleActors:
    """Poses the actors that matter for some views, in draw lists that hold no others.

    Args:
        motion: Motion of all actors.
        rigs: Their rigs.
        looks: Models and colours of the actors of all worlds; may change.
        reach: Distance up to which an actor of each of the rigs' kinds may matter [m], shape (K,).
        spray: Whether vehicles throw up water.
    """

    def __init__(
        self,
        motion: Motion,
        rigs: Rigs,
        looks: Looks,
        reach: NDArray[np.float64],
        *,
        spray: bool = False,
    ) -> None:
        self._throws = throwing(rigs.kinds) if spray else None
        groups = [cast.group for cast in rigs.casts]
        kinds = KindTable(
            end=np.cumsum([len(group.actor) for group in groups], dtype=np.int64),
            slots=np.array([cast.rig.slots for cast in rigs.casts], np.int64),
            reach=np.asarray(reach, np.float64) * 1.001 + _SLACK + SPRAY_REACH * spray,
        )
        actor = np.concatenate([np.zeros(0, np.int64), *(group.actor for group in groups)])
        self._rigs, self._signal = rigs, motion.lamps.size > 0
        self._reach = np.minimum(kinds.reach, _LONGEST)
        self._given = Held(motion), Held(bounds_of(motion, actor)), Held(kinds), Held(looks)
        self._size = _Size(0, 0, 0, 0)

    def of(
        self,
        worlds: NDArray[np.integer],
        time: NDArray[np.float64],
        row: NDArray[np.integer] | None,
        cameras: CameraState,
        aspect: float,
    ) -> DrawList:
        """Return a draw list of W worlds; the next call overwrites it.

        Args:
            worlds: The worlds, shape (W,).
            time: Time of each [s], shape (W,).
            row: Row of `worlds` that each view shows, shape (V,); None: views and worlds are pairs.
            cameras: The V cameras.
            aspect: Height of what they show over its width.
        """
        self._list_for(worlds, time, row, cameras, aspect)
        self._pose()
        count = len(worlds)
        if count not in self._first:
            self._first[count] = self._movers.first(count)
        if self._throws is not None:
            self._first[count].spray = self._spray(count)
        return self._first[count]

    def _spray(self, worlds: int) -> NDArray[np.float32]:
        """Return `DrawList.spray` of what was listed."""
        listed, entries = self._listed, int(self._listed.needed[0])
        throws = np.repeat(self._throws, np.diff(listed.end, prepend=0))
        slot = listed.slot[:entries]
        actor = listed.object_id.reshape(-1)[slot] - ACTOR_OBJECT
        world = slot // max(self._size.slots, 1)
        return spray_of(listed.state, listed.looks.model[0], throws, world, actor, worlds)

    def moving(
        self,
        worlds: NDArray[np.integer],
        time: NDArray[np.float64],
        row: NDArray[np.integer] | None,
        cameras: CameraState,
        aspect: float,
    ) -> Moving:
        """Return where these actors are, and how fast, without posing them; see `of`."""
        self._list_for(worlds, time, row, cameras, aspect)
        entries, (state, slots) = (
            int(self._listed.needed[0]),
            (self._listed.state, self._size.slots),
        )
        world = self._listed.slot[:entries] // max(slots, 1)
        order = np.argsort(world, kind="stable")
        rows = np.arange(len(worlds)) if row is None else row
        first, end = (np.searchsorted(world[order], rows, side) for side in ("left", "right"))
        per_kind = np.diff(self._listed.end, prepend=0)
        reach = np.repeat(self._reach, per_kind)[order]
        return Moving(first, end, state.position[0, order], state.velocity[0, order], reach)

    def _list_for(
        self,
        worlds: NDArray[np.integer],
        time: NDArray[np.float64],
        row: NDArray[np.integer] | None,
        cameras: CameraState,
        aspect: float,
    ) -> None:
        """Find the actors that matter, see `of`."""
        count, views = len(worlds), len(cameras.position)
        self._grow(_Size(count, views, 0, 0))
        query = self._query
        query.worlds[0], query.aspect[0] = count, aspect
        query.world[:count], query.time[:count] = worlds, time
        order: NDArray[np.integer] | slice = slice(None)
        if row is None:
            query.end[:count] = self._pairs[:count]
        else:
            order = np.argsort(row, kind="stable")
            query.end[:count] = np.searchsorted(row[order], np.arange(count), side="right")
        query.eye[:views] = cameras.position[order]
        query.rotation[:views] = cameras.rotation[order]
        query.field_of_view[:views] = cameras.field_of_view[order]
        self._list()
        entries, slots = self._listed.needed.tolist()
        if entries > self._size.entries or slots > self._size.slots:
            self._grow(_Size(0, 0, entries, slots))
            self._list_for(worlds, time, row, cameras, aspect)

    def _pose(self) -> None:
        """Let the rigs pose the actors, those of each kind at once."""
        listed, begin = self._listed, 0
        for k, end in enumerate(listed.end.tolist()):
            if begin < end:
                chosen = self._chosen.get((k, begin, end)) or self._choose(k, begin, end)
                self._rigs.casts[k].rig.pose(chosen, listed.state, listed.looks, self._flat)
            begin = end

    def _choose(self, k: int, begin: int, end: int) -> Group:
        """Return entries of the list as the actors of kind `k`."""
        if len(self._chosen) >= _CHOICES:
            self._chosen.clear()
        group = self._rigs.casts[k].group
        chosen = group._replace(actor=self._entries[begin:end], slot=self._listed.slot[begin:end])
        self._chosen[k, begin, end] = chosen
        return chosen

    def _grow(self, wanted: "_Size") -> None:
        """Make buffers that suffice, a quarter larger than needed; keep them if they do."""
        size = self._size
        if all(a <= b for a, b in zip(wanted, size, strict=True)):
            return
        self._size = size = _Size(
            *(b if a <= b else a + a // 4 for a, b in zip(wanted, size, strict=True))
        )
        self._query = ViewQuery(
            worlds=np.zeros(1, np.int64),
            aspect=np.ones(1),
            world=np.zeros(size.worlds, np.int64),
            time=np.zeros(size.worlds),
            end=np.zeros(size.worlds, np.int64),
            eye=np.zeros((size.views, 3)),
            rotation=np.zeros((size.views, 3, 3)),
            field_of_view=np.ones(size.views),
            camera=np.zeros(size.views, _CAMERA),
        )
        self._pairs = np.arange(1, size.worlds + 1)
        self._entries = np.arange(size.entries)
        self._first: dict[int, DrawList] = {}
        self._chosen: dict[tuple[int, int, int], Group] = {}
        self._movers = self._rigs.short_list(size.worlds, size.slots, lamps=self._signal)
        self._flat = self._movers.flat()
        self._listed = Listed(
            needed=np.zeros(2, np.int64),
            end=np.zeros(len(self._rigs.casts), np.int64),
            used=np.zeros(size.worlds, np.int64),
            slot=np.zeros(size.entries, np.int64),
            state=ActorState.create(1, size.entries)._replace(
                present=np.ones((1, size.entries), np.bool_)
            ),
            looks=Looks(
                np.zeros((1, size.entries), np.int32), np.ones((1, size.entries, 3), np.float32)
            ),
            part=self._movers.part,
            object_id=self._movers.object_id,
            lamps=self._movers.lamps,
        )
        self._list = _list_actors.bind(*self._given, self._query, self._listed)
