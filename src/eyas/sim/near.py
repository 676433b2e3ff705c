"""The moving parts that matter for some views: those of actors that a camera may show.

An actor also matters if its shadow or the light of its lamps may be in the picture, so leaving
others out changes no byte.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import Held
from eyas.sim.chart import chart_of
from eyas.sim.near_list import Near, Plan, Query, list_near
from eyas.state.draw import DrawList
from eyas.state.motion import ActorState, Motion
from eyas.state.snapshot import CameraState
from eyas.targets.kind import Group, Looks
from eyas.targets.rig import Rigs

__all__ = ["NearMovers"]

_SLACK = 0.05
"""Distance outside a view at which actors are still posed: more than roundings [m]."""


_CHOICES = 32
"""Groups of actors that are kept: those of one picture are mostly those of the next."""


class NearMovers:
    """Poses the actors that matter for some views, in draw lists that hold no others.

    Args:
        motion: Motion of all actors.
        rigs: Their rigs.
        looks: Models and colours of the actors of all worlds; may change.
        reach: Distance up to which an actor of each of the rigs' kinds may matter [m], shape (K,).
    """

    def __init__(
        self, motion: Motion, rigs: Rigs, looks: Looks, reach: NDArray[np.float64]
    ) -> None:
        groups = [cast.group for cast in rigs.casts]
        plan = Plan(
            end=np.cumsum([len(group.actor) for group in groups], dtype=np.int64),
            slots=np.array([cast.rig.slots for cast in rigs.casts], np.int64),
            reach=np.asarray(reach, np.float64) * 1.001 + _SLACK,
        )
        actor = np.concatenate([np.zeros(0, np.int64), *(group.actor for group in groups)])
        self._rigs = rigs
        self._given = Held(motion), Held(chart_of(motion, actor)), Held(plan), Held(looks)
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
        entries, slots = self._near.needed.tolist()
        if entries > self._size.entries or slots > self._size.slots:
            self._grow(_Size(0, 0, entries, slots))
            return self.of(worlds, time, row, cameras, aspect)
        self._pose()
        if count not in self._first:
            self._first[count] = self._movers.first(count)
        return self._first[count]

    def _pose(self) -> None:
        """Let the rigs pose the actors, those of each kind at once."""
        near, begin = self._near, 0
        for k, end in enumerate(near.end.tolist()):
            if begin < end:
                chosen = self._chosen.get((k, begin, end)) or self._choose(k, begin, end)
                self._rigs.casts[k].rig.pose(chosen, near.state, near.looks, self._flat)
            begin = end

    def _choose(self, k: int, begin: int, end: int) -> Group:
        """Return entries of the list as the actors of kind `k`."""
        if len(self._chosen) >= _CHOICES:
            self._chosen.clear()
        group = self._rigs.casts[k].group
        chosen = group._replace(actor=self._entries[begin:end], slot=self._near.slot[begin:end])
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
        self._query = Query(
            worlds=np.zeros(1, np.int64),
            aspect=np.ones(1),
            world=np.zeros(size.worlds, np.int64),
            time=np.zeros(size.worlds),
            end=np.zeros(size.worlds, np.int64),
            eye=np.zeros((size.views, 3)),
            rotation=np.zeros((size.views, 3, 3)),
            field_of_view=np.ones(size.views),
            camera=np.zeros((size.views, 16), np.float32),
        )
        self._pairs = np.arange(1, size.worlds + 1)
        self._entries = np.arange(size.entries)
        self._first: dict[int, DrawList] = {}
        self._chosen: dict[tuple[int, int, int], Group] = {}
        self._movers = self._rigs.short_list(size.worlds, size.slots)
        self._flat = self._movers.flat()
        self._near = Near(
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
        )
        self._list = list_near.bind(*self._given, self._query, self._near)


class _Size(NamedTuple):
    """Capacity of the buffers."""

    worlds: int
    views: int
    entries: int
    slots: int
