"""The rig of a target of one's own."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.custom.own import OwnTarget, Ride, Shaped
from eyas.engine.custom.user_class import posed
from eyas.engine.state.draw import DrawList
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.kind import Group, Looks
from eyas.lanes import exact

__all__ = ["OwnRig"]

_TRIED = np.linspace(0.0, 20.0, 64)
"""Distances at which the farthest place of each part is looked for [m]."""

_MARGIN = 1.5  # Factor on it: parts may go farther in between


class OwnRig:
    """Parts that are posed by a user's function, on the ground and along its slope.

    Attributes:
        slots: As in `Rig`.
        part_count: As in `Rig`.

    Args:
        target: The target.
        path: Its class, as users name it; empty for a mesh file.
    """

    def __init__(self, target: OwnTarget, path: str) -> None:
        self._target, self._path = target, path
        parts = target.parts()
        self._levels = [target.levels] if isinstance(target, Shaped) else [(p,) for p in parts]
        self.slots = self.part_count = len(parts)

    def part_levels(self) -> Sequence[tuple[Mesh, ...]]:
        """Return the meshes, see `Rig`."""
        return self._levels

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point may be from the reference point, see `Rig` [m]."""
        still = np.zeros_like(_TRIED)
        poses = self._poses(Ride(_TRIED, still + 1.0, still))
        away = np.linalg.norm(poses[..., 3], axis=-1).max(axis=0)
        return float((_MARGIN * away + parts).max())

    def pose(self, group: Group, actors: ActorState, looks: Looks, out: DrawList) -> None:
        """Write the slots of all actors, see `Rig`."""
        who = group.actor
        shape = actors.yaw[:, who].shape
        numbers = (actors.travelled, actors.speed, actors.yaw_rate)
        local = self._poses(Ride(*(array[:, who].ravel() for array in numbers)))
        local = np.reshape(local, (*shape, self.slots, 3, 4))
        body = _frames(actors.yaw[:, who], actors.slope[:, who])[..., None, :, :]
        poses = exact.product(body, local)
        poses[..., 3] += actors.position[:, who, None]
        present = actors.present[:, who]
        for part in range(self.slots):
            slot = group.slot + part
            out.part[:, slot] = np.where(present, group.first_part + part, -1)
            out.pose[:, slot] = poses[:, :, part]
            out.colour[:, slot] = looks.colour[:, who]

    def _poses(self, ride: Ride) -> NDArray[np.float64]:
        if not self._path:
            return self._target.pose(ride)
        return posed(self._target, self._path, ride, self.slots)


def _frames(yaw: NDArray[np.float64], slope: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return rotations, shape (..., 3, 3): x along the heading and the slope."""
    cosine, sine, rise = exact.cos(yaw), exact.sin(yaw), exact.sin(slope)
    level, none = exact.cos(slope), np.zeros_like(yaw)
    columns = [
        np.stack([cosine * level, sine * level, rise], axis=-1),
        np.stack([-sine, cosine, none], axis=-1),
        np.stack([-cosine * rise, -sine * rise, level], axis=-1),
    ]
    return np.stack(columns, axis=-1)
