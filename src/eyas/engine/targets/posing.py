"""What all rigs share: the slots, the frame of an actor, and the call of the posing kernel."""

import operator
from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.draw import DrawList
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.kind import Group, Looks
from eyas.lanes import BoundCall, Held, ParallelCall, kernel, parallel, specialised

_MANY = 4096
"""Actors from which on two threads pose them: waking one takes as long as some hundred actors."""


class Slots(NamedTuple):
    """The arrays of a `DrawList` that a kernel writes; ids it reads."""

    part: NDArray[np.int32]
    pose: NDArray[np.float32]
    colour: NDArray[np.float32]
    object_id: NDArray[np.int32]


class ActorFrame(NamedTuple):
    """Frame of an actor: its axes, row by row, and its origin on the ground."""

    xx: float
    xy: float
    xz: float
    yx: float
    yy: float
    yz: float
    zx: float
    zy: float
    zz: float
    x: float
    y: float
    z: float


@kernel
def _pose_one(
    table: Any,  # noqa: ANN401  # of the kind
    group: Group,
    actors: ActorState,
    looks: Looks,
    out: Slots,
    w: int,
    g: int,
) -> None:
    """Pose nothing: what a kind's kernel takes the place of."""


@lru_cache(maxsize=16)
def _pose_all_of(one: Callable[..., None]) -> ParallelCall:
    """Return the loop over the actors of a kind whose kernel for one actor is `one`."""
    return parallel(specialised(_pose_all, _pose_one=one))


def _pose_all(
    worker: int,
    workers: int,
    table: Any,  # noqa: ANN401  # of the kind
    group: Group,
    actors: ActorState,
    looks: Looks,
    out: Slots,
) -> None:
    """Write the slots of the actors of one kind in all worlds, see `Rig`."""
    count = group.actor.shape[0]
    total = looks.model.shape[0] * count
    for i in range(worker * total // workers, (worker + 1) * total // workers):
        w, g = i // count, i % count
        if actors.present[w, group.actor[g]]:
            _pose_one(table, group, actors, looks, out, w, g)
        else:
            for k in range(table.slot.shape[-1]):
                out.part[w, group.slot[g] + k] = -1


class PoseCall:
    """The call of a kernel that poses the actors of one kind; that of the next picture is mostly
    the same, and is kept.

    Attributes:
        table: What the kernel knows of the models; the last axis of its `slot` is that of slots.
        one: The kernel for one actor: `one(table, group, actors, looks, out, w, g)`.
    """

    def __init__(self, table: tuple[Any, ...], one: Callable[..., None]) -> None:
        self.table, self.one = table, one
        self._kernel, self._table = _pose_all_of(one), Held(table)
        self._held: tuple[Held[Any], ...] = ()
        self._bound: BoundCall | None = None

    def __call__(self, group: Group, actors: ActorState, looks: Looks, out: DrawList) -> None:
        """Write all slots of the kind's actors, see `Rig.pose`."""
        given = (group, actors, looks, Slots(out.part, out.pose, out.colour, out.object_id))
        before = self._held
        held = tuple(map(Held.again, before, given)) if before else tuple(map(Held, given))
        if self._bound is None or not all(map(operator.is_, held, before)):
            self._held, self._bound = held, self._kernel.bind(self._table, *held)
        if looks.model.shape[0] * len(group.actor) < _MANY:
            self._bound()
        else:
            self._kernel(2, self._table, *held)
