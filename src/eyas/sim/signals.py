"""The lights of signals, which change with time: parts that are drawn over dark lenses."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.state.draw import DrawList
from eyas.state.scene import ObjectClass, Scene
from eyas.traffic.signals import SignalPlan

__all__ = ["SignalLights", "lights_of"]

_SAME = 0.01
"""Poles nearer to each other are one [m]."""


@dataclass(frozen=True, slots=True)
class SignalLights:
    """The lights on the P poles of a scene whose programs are known."""

    plan: SignalPlan
    row: NDArray[np.int64]
    """Edge of the plan that each pole is for, shape (P,)."""
    pose: NDArray[np.float32]
    """Poles, to world, shape (P, 3, 4)."""
    object_id: NDArray[np.int32]
    """Objects of the scene, shape (P,)."""
    first_part: int
    """Part that shows `Aspect.RED`; the other aspects follow."""

    def added(self, movers: DrawList, time: NDArray[np.float64]) -> DrawList:
        """Return a draw list with the lights after the movers.

        Args:
            movers: Lists of W worlds.
            time: Time of the traffic in each [s], shape (W,).
        """
        aspect, worlds = self.plan.at(time)[:, self.row], len(time)
        part = np.where(aspect < 0, -1, self.first_part + aspect).astype(np.int32)
        pose = np.broadcast_to(self.pose, (worlds, *self.pose.shape))
        ids = np.broadcast_to(self.object_id, part.shape)
        white = np.ones((*part.shape, 3), np.float32)
        return DrawList(
            part=np.concatenate([movers.part, part], axis=1),
            pose=np.concatenate([movers.pose, pose], axis=1),
            colour=np.concatenate([movers.colour, white], axis=1),
            object_id=np.concatenate([movers.object_id, ids], axis=1),
            object_class=movers.object_class,
        )


def lights_of(scene: Scene, plan: SignalPlan, first_part: int) -> SignalLights | None:
    """Return the lights on the poles of a scene; None if there are none.

    Args:
        scene: The scene, on the network of the plan.
        plan: Programs of the lights.
        first_part: See `SignalLights`.
    """
    # Shapely takes long to import, and few maps have signals.
    from eyas.world.roads.areas import streets
    from eyas.world.street.signals import pole_at

    fixtures, rows = scene.fixtures, {name: row for row, name in enumerate(plan.edges)}
    poles = np.flatnonzero(scene.object_class[fixtures.object_id] == ObjectClass.POLE)
    feet, found = fixtures.pose[poles][:, :2, 3], []
    for name, street in zip(scene.network.edges, streets(scene.network), strict=True):
        if name not in rows or len(street.right) < 2 or not len(poles):
            continue
        away = np.abs(feet - np.array(pole_at(street)[0])).max(axis=1)
        if away.min() < _SAME:
            found.append((rows[name], int(poles[away.argmin()])))
    if not found:
        return None
    row, fixture = np.array(found, np.int64).T
    owner = fixtures.object_id[fixture].astype(np.int32)
    return SignalLights(plan, row, fixtures.pose[fixture], owner, first_part)
