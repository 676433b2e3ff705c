"""The bodies of trackers, which the others in their world see."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.core.frames import rotate
from eyas.lanes import interpreted
from eyas.sim.assets import Assets
from eyas.sim.worlds import Worlds
from eyas.state.draw import DrawList
from eyas.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.state.snapshot import TrackerState

__all__ = ["Bodies"]

_rotate = interpreted(rotate)  # of scalars, but arrays do as well


class Bodies:
    """Adds to what each tracker sees the bodies of the others in its world, not its own.

    Args:
        worlds: The worlds of N trackers.
        assets: The renderer has the part, if trackers share worlds.
        visible: Whether trackers see each other at all.
    """

    def __init__(self, worlds: Worlds, assets: Assets, *, visible: bool = True) -> None:
        self._part, self._actors = assets.body_part, worlds.actors
        mates = [worlds.trackers_of(n) for n in range(len(worlds.of))]
        others = [own[own != n] for n, own in enumerate(mates)]
        self.any = visible and any(map(len, others))
        """Whether any tracker sees another."""
        self._others = np.full((len(others), max(map(len, others), default=0)), -1)
        for row, own in zip(self._others, others, strict=True):
            row[: len(own)] = own

    def added(
        self,
        chosen: NDArray[np.int32],
        rows: NDArray[np.int32],
        movers: DrawList,
        trackers: TrackerState,
    ) -> DrawList:
        """Return a draw list with a row for each view: the movers of its world, and bodies.

        Args:
            chosen: The tracker of each view, shape (V,).
            rows: Row of each view in `movers`, shape (V,).
            movers: The other moving things.
            trackers: State of all N trackers.
        """
        others = self._others[chosen]
        pose = _poses(trackers)[others]
        classes = np.full((len(chosen), len(self._others)), ObjectClass.ROBOT, np.uint8)
        colour = np.ones((*others.shape, 3))
        object_id = np.where(others < 0, -1, ACTOR_OBJECT + self._actors + others)
        return DrawList(
            part=_beside(movers.part[rows], np.where(others < 0, -1, self._part)),
            pose=_beside(movers.pose[rows], pose),
            colour=_beside(movers.colour[rows], colour),
            object_id=_beside(movers.object_id[rows], object_id),
            object_class=_beside(movers.object_class[rows], classes),
        )


def _beside(movers: NDArray[Any], bodies: NDArray[Any]) -> NDArray[Any]:
    return np.concatenate([movers, bodies.astype(movers.dtype)], axis=1)


def _poses(trackers: TrackerState) -> NDArray[np.float64]:
    """Return body to world of all trackers: rotation and translation [m], shape (N, 3, 4)."""
    columns = [_rotate(trackers.orientation.T, *axis) for axis in np.eye(3).tolist()]
    return np.stack([*(np.stack(column, axis=-1) for column in columns), trackers.position], -1)
