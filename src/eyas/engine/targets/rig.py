"""Rigs: the poses of the parts of all actors, kind by kind."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import mirrored
from eyas.engine.state.draw import DrawList, PartLibrary
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.targets.catalogue import KINDS, models_of
from eyas.engine.targets.kind import Group, Kind, Looks, Rig


class Cast(NamedTuple):
    """The actors of one kind, and the rig that poses them."""

    rig: Rig
    group: Group


class Rigs:
    """Poses the actors of a world; each has as many slots of a draw list as its kind needs.

    Attributes:
        kinds: The kinds of the actors, in the order of their parts in the library.
        first_slot: First slot of each actor, and the number of all slots, shape (A + 1,).
        casts: The actors of each of these kinds.
        owner: Actor of each of all slots, shape (I,).

    Args:
        kind: Kind of each actor, index into `KINDS`, shape (A,).
    """

    def __init__(self, kind: NDArray[np.int32]) -> None:
        present = sorted({*kind.tolist()})
        rigs = {k: KINDS[k].rig() for k in present}
        self.kinds: tuple[Kind, ...] = tuple(KINDS[k] for k in present)
        slots = np.array([rigs[k].slots for k in kind.tolist()], np.int64)
        self.first_slot: NDArray[np.int64] = np.concatenate([[0], np.cumsum(slots)])
        self.owner: NDArray[np.int64] = np.repeat(np.arange(len(kind)), slots)
        classes = [KINDS[k].object_class for k in kind.tolist()]
        self._object_class = np.array(classes, np.uint8)
        self.casts: list[Cast] = []
        part = 0
        for k in present:
            actor = np.flatnonzero(kind == k)
            group = Group(actor, self.first_slot[actor], part, models_of(k).start)
            self.casts.append(Cast(rigs[k], group))
            part += rigs[k].part_count

    def draw_list(self, worlds: int) -> DrawList:
        """Return an empty draw list for all actors of some worlds."""
        empty = DrawList.create(worlds, len(self.owner))
        empty.object_id[:] = ACTOR_OBJECT + self.owner
        empty.object_class = np.tile(self._object_class, (worlds, 1))
        return empty

    def short_list(self, worlds: int, slots: int, *, lamps: bool = False) -> DrawList:
        """Return an empty list for some of the actors of some worlds, see `DrawList.create`."""
        empty = DrawList.create(worlds, slots, lamps=lamps)
        empty.object_class = np.tile(self._object_class, (worlds, 1))
        return empty

    def reach(self, parts: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far any point of an actor may be from its reference point [m].

        Args:
            parts: How far the points of each part of the library are from its origin [m].

        Returns:
            For each kind, shape (K,).
        """
        reach = []
        for rig, group in self.casts:
            own = slice(group.first_part, group.first_part + rig.part_count)
            reach.append(rig.reach(parts[own]))
        return np.array(reach)

    def pose(
        self,
        actors: ActorState,  # State of A actors in each of W worlds
        looks: Looks,  # Models and colours of the same actors
        out: DrawList,  # A draw list from `draw_list`
    ) -> None:
        """Fill a draw list in place."""
        for rig, group in self.casts:
            rig.pose(group, actors, looks, out)


def part_library(kinds: tuple[Kind, ...], *, left_hand: bool = False) -> PartLibrary:
    """Return the parts of some kinds, in the order that `Rigs` uses; vehicles are made for traffic
    that keeps left, if they drive there: the driver sits on the right, doors of buses are left.
    """
    parts: list[tuple[Mesh, ...]] = []
    lamps: list[bool] = []
    for kind in kinds:
        rig = kind.rig()
        lamps += [kind.lamps and part not in kind.trailers for part in range(rig.part_count)]
        levels = rig.part_levels()
        if left_hand and kind.lamps:
            levels = [tuple(map(mirrored, level)) for level in levels]
        parts += levels
    return PartLibrary(tuple(parts), tuple(lamps))
