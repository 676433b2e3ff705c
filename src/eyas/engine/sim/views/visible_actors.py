"""The actors that matter for some views: those that a camera may show, listed and posed.

An actor also matters if its shadow or the light of its lamps may be in the picture, so leaving
others out changes no byte. Most actors of a large world are behind the cameras or far aside: they
are left out, eight at once, by their bounds; only the others are interpolated.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.poses import Moving
from eyas.engine.sim.views.actor_bounds import ActorBounds, bounds_of, made_row, unbounded_after
from eyas.engine.sim.views.near_actors import (
    CAMERA,
    Entry,
    KindTable,
    Listed,
    ViewQuery,
    column_actors,
    eight_may_matter,
    kind_table,
    one_may_matter,
    set_camera,
    write_entry,
)
from eyas.engine.sim.views.near_lights import NearLights
from eyas.engine.sim.views.spray import spray_of, throwing
from eyas.engine.state.draw import DrawList
from eyas.engine.state.motion import ActorState, Motion
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.snapshot import CameraState
from eyas.engine.targets.kind import HIDDEN, Group, Looks
from eyas.engine.targets.rig import Rigs
from eyas.engine.traffic.interpolation import interpolate_actor, sample_before
from eyas.engine.traffic.lamps import shining_as
from eyas.lanes import PackedBundle, compiled
from eyas.lanes.vector import WIDTH, first_bit

_LONGEST = 3.0
"""Reach of a thing beyond which it is not said to move in a picture: half a long car [m]."""

_CHOICES = 32  # Groups of actors that are kept: those of one picture are mostly those of the next


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
    for v in range(query.end[query.worlds[0] - 1]):
        set_camera(query, v)
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
                seen = eight_may_matter(query, w, sphere, first, reach)
                seen &= (1 << min(end - first, WIDTH)) - 1
                while seen != 0:
                    actor = bounds.actor[first + first_bit(seen)]
                    seen &= seen - 1
                    pose = interpolate_actor(motion, actor, time)
                    if not pose.present or not one_may_matter(query, w, pose, reach):
                        continue
                    fits = listed.used[w] + slots <= listed.part.shape[1]
                    if fits and entries < listed.slot.shape[0]:
                        flat = w * listed.part.shape[1]
                        entry = Entry(actor, query.world[w], w, slots, entries, 0, entries, flat)
                        write_entry(motion, looks, listed, entry, pose, time)
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


class StandIns(NamedTuple):
    """Actors that take the places of recorded ones, see `eyas.engine.sim.evader_traffic`."""

    motion: Motion
    model: NDArray[np.int32]  # Model of each actor in each world, or `HIDDEN`, shape (W, A)
    like: NDArray[np.int64]  # Recorded actor as whom each is drawn, shape (A,)
    known: int  # Number of recorded actors; the others follow
    slots: int  # Slots that each of the others needs


class VisibleActors:
    """Poses the actors that matter for some views, in draw lists that hold no others."""

    def __init__(
        self,
        motion: Motion,  # Motion of all actors
        rigs: Rigs,
        looks: Looks,  # Models and colours of the actors of all worlds; may change
        # Distance up to which an actor of each of the rigs' kinds may matter [m], shape (K,)
        reach: NDArray[np.float64],
        *,
        spray: bool = False,  # Whether vehicles throw up water
        # The lights of signals, which are listed behind the actors; None: there are none
        lights: NearLights | None = None,
        # Recorded actor as whom each actor is drawn, shape (A,); it may change. Those from `known`
        # on move as they go, and worlds may hide any; None: all are recorded, and none is hidden
        stand_in: NDArray[np.int64] | None = None,
        known: int = 0,
    ) -> None:
        self._lights = lights
        self._stand_ins: StandIns | None = None
        self._throws = throwing(rigs.kinds) if spray else None
        kinds, actor = kind_table(rigs, reach, spray=spray), column_actors(rigs)
        self._rigs, self._signal = rigs, motion.lamps.size > 0
        self._reach = np.minimum(kinds.reach, _LONGEST)
        bounds = bounds_of(motion, actor)
        if stand_in is not None:
            unbounded_after(known, bounds, motion)
            moved = next(cast for cast in rigs.casts if cast.group.actor[-1] >= known)
            slots = moved.rig.slots
            self._stand_ins = StandIns(motion, looks.model, stand_in, known, slots)
            self._moved, self._moved_like = np.zeros((0, slots), np.int64), np.zeros(0, np.int64)
        self._given = (
            PackedBundle(motion),
            PackedBundle(bounds),
            PackedBundle(kinds),
            PackedBundle(looks),
        )
        self._size = _Size(0, 0, 0, 0)

    def of(
        self,
        worlds: NDArray[np.integer],  # The worlds, shape (W,)
        time: NDArray[np.float64],  # Time of each [s], shape (W,)
        # Row of `worlds` that each view shows, shape (V,); None: views and worlds are pairs
        row: NDArray[np.integer] | None,
        cameras: CameraState,  # The V cameras
        aspect: float,  # Height of what they show over its width
    ) -> DrawList:
        """Return a draw list of W worlds; the next call overwrites it."""
        self._list_for(worlds, time, row, cameras, aspect)
        self._pose()
        count = len(worlds)
        if count not in self._first:
            self._first[count] = self._movers.first(count)
        if self._throws is not None:
            self._first[count].spray = spray_of(self._listed, self._throws, count)
        if self._lights is not None:
            self._lights.write(time, self._size.slots, self._flat)
        return self._first[count]

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
        entries, state, slots = int(self._listed.needed[0]), self._listed.state, self._size.slots
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
        if self._stand_ins is not None:
            self._leave_out_hidden(self._stand_ins)
        if self._lights is not None:
            self._lights.list()
        entries, slots = self._listed.needed.tolist()
        if entries > self._size.entries or slots > self._size.slots:
            self._grow(_Size(0, 0, entries, slots))
            self._list_for(worlds, time, row, cameras, aspect)

    def _leave_out_hidden(self, stand_ins: StandIns) -> None:
        """Take those out of the list that their worlds hide; their slots stay empty."""
        listed, slots, query = self._listed, max(self._size.slots, 1), self._query
        count = int(listed.needed[0])
        if count > self._size.entries or listed.needed[1] > self._size.slots:
            return  # it is listed again, with room for all
        slot = listed.slot[:count]
        row = slot // slots
        actor = listed.object_id.reshape(-1)[slot] - ACTOR_OBJECT
        kept = stand_ins.model[query.world[row], actor] != HIDDEN
        left = int(np.count_nonzero(kept))
        if left < count:
            for array in (*listed.state, *listed.looks):
                array[0, :left] = array[0, :count][kept]
            slot, row, actor = slot[kept], row[kept], actor[kept]
            listed.slot[:left] = slot
            listed.end[:] = np.concatenate([[0], np.cumsum(kept)])[listed.end]
            listed.needed[0] = left
        moved = actor >= stand_ins.known
        actor, row = actor[moved], row[moved]
        self._moved = slot[moved, None] + np.arange(stand_ins.slots)
        self._moved_like = stand_ins.like[actor]
        if listed.lamps.size and len(actor):
            time = query.time[row]
            lit = shining_as(stand_ins.motion, actor, self._moved_like, time)
            listed.lamps.reshape(-1)[self._moved] = lit[:, None]

    def _pose(self) -> None:
        """Let the rigs pose the actors, those of each kind at once."""
        listed, begin = self._listed, 0
        if self._stand_ins is not None:  # rigs know by the object whose wheels a vehicle has
            ids = listed.object_id.reshape(-1)
            own = ids[self._moved]
            ids[self._moved] = ACTOR_OBJECT + self._moved_like[:, None]
        for k, end in enumerate(listed.end.tolist()):
            if begin < end:
                chosen = self._chosen.get((k, begin, end)) or self._choose(k, begin, end)
                self._rigs.casts[k].rig.pose(chosen, listed.state, listed.looks, self._flat)
            begin = end
        if self._stand_ins is not None:
            ids[self._moved] = own

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
            camera=np.zeros(size.views, CAMERA),
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
        if self._lights is not None:
            self._lights.bind(self._query, self._listed)
