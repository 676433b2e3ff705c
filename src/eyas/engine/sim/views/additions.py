"""What is added to the actors of a view: the bodies of other trackers, and lights of signals."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.frames import rotate
from eyas.engine.state.draw import DrawList
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass, Scene
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.traffic.signals import SignalPlan
from eyas.lanes import interpreted

_SAME = 0.01  # Poles nearer to each other are one [m]

_rotate = interpreted(rotate)  # of scalars, but arrays do as well


class TrackerBodies:
    """Adds to what each tracker sees the bodies of the others in its world, not its own."""

    def __init__(
        self,
        # The trackers in the world of each of N trackers, itself among them
        mates: Sequence[NDArray[np.int64]],
        actors: int,  # Number of actors in each world
        part: int,  # The renderer's part of a body; it has one if trackers share worlds
        *,
        visible: bool = True,  # Whether trackers see each other at all
        itself: bool = False,  # Whether its own body is seen, too: by another camera than its own
    ) -> None:
        others = [own[(own != n) | itself] for n, own in enumerate(mates)]
        self.any = visible and any(map(len, others))  # Whether any tracker sees another
        self._others = np.full((len(others), max(map(len, others), default=0)), -1)
        for row, own in zip(self._others, others, strict=True):
            row[: len(own)] = own
        none = self._others < 0
        self._parts = np.where(none, -1, part).astype(np.int32)
        self._ids = np.where(none, -1, ACTOR_OBJECT + actors + self._others).astype(np.int32)

    def added(
        self,
        chosen: NDArray[np.int32],
        rows: NDArray[np.int32],
        movers: DrawList,
        trackers: TrackerState,
        later: NDArray[np.float64] | None = None,
    ) -> DrawList:
        """Return a draw list with a row for each view: the movers of its world, and bodies.

        Args:
            chosen: The tracker of each view, shape (V,).
            rows: Row of each view in `movers`, shape (V,).
            movers: The other moving things.
            trackers: State of all N trackers.
            later: How long after that each view is [s], shape (V,): the bodies have moved on, but
                not turned; None: all are at it.
        """
        others = self._others[chosen]
        pose = _poses(trackers)[others]
        if later is not None:
            pose[..., 3] += trackers.velocity[others] * later[:, None, None]
        classes = np.full((len(chosen), len(self._others)), ObjectClass.ROBOT, np.uint8)
        bodies = others.shape[1]
        return DrawList(
            part=_beside(movers.part[rows], self._parts[chosen]),
            pose=_beside(movers.pose[rows], pose.astype(np.float32)),
            colour=_beside(movers.colour[rows], np.ones((*others.shape, 3), np.float32)),
            object_id=_beside(movers.object_id[rows], self._ids[chosen]),
            object_class=_beside(movers.object_class[rows], classes),
            lamps=_and_dark(movers.lamps[rows] if movers.lamps.size else movers.lamps, bodies),
            spray=movers.spray[rows] if len(movers.spray) else movers.spray,
        )


def _beside(movers: NDArray[Any], bodies: NDArray[Any]) -> NDArray[Any]:
    return np.concatenate([movers, bodies], axis=1)


def _and_dark(lamps: NDArray[np.uint8], more: int) -> NDArray[np.uint8]:
    """Return `DrawList.lamps` with so many slots more, which have none."""
    return _beside(lamps, np.zeros((len(lamps), more), np.uint8)) if lamps.size else lamps


def _poses(trackers: TrackerState) -> NDArray[np.float64]:
    """Return body to world of all trackers: rotation and translation [m], shape (N, 3, 4)."""
    poses = np.empty((len(trackers.position), 3, 4))
    rows = _rotate(trackers.orientation.T[..., None], *np.eye(3))  # of all three axes at once
    poses[..., :3], poses[..., 3] = np.stack(rows, axis=1), trackers.position
    return poses


@dataclass(frozen=True, slots=True)
class SignalLights:
    """The lights on the P poles of a scene whose programs are known."""

    plan: SignalPlan
    row: NDArray[np.int64]  # Edge of the plan that each pole is for, shape (P,)
    pose: NDArray[np.float32]  # Poles, to world, shape (P, 3, 4)
    object_id: NDArray[np.int32]  # Objects of the scene, shape (P,)
    first_part: int  # Part that shows `Aspect.RED`; the other aspects follow.

    def parts(self, time: NDArray[np.float64], pole: NDArray[np.int64]) -> NDArray[np.int32]:
        """Return what poles show at times of the traffic [s], of shapes that fit; -1: nothing."""
        aspect = self.plan.shown(time, self.row[pole])
        return np.where(aspect < 0, -1, self.first_part + aspect).astype(np.int32)

    def added(
        self,
        movers: DrawList,  # Lists of W worlds
        time: NDArray[np.float64],  # Time of the traffic in each [s], shape (W,)
    ) -> DrawList:
        """Return a draw list with the lights after the movers."""
        worlds = len(time)
        part = self.parts(time[:, None], np.arange(len(self.row))[None])
        pose = np.broadcast_to(self.pose, (worlds, *self.pose.shape))
        ids = np.broadcast_to(self.object_id, part.shape)
        white = np.ones((*part.shape, 3), np.float32)
        return DrawList(
            part=np.concatenate([movers.part, part], axis=1),
            pose=np.concatenate([movers.pose, pose], axis=1),
            colour=np.concatenate([movers.colour, white], axis=1),
            object_id=np.concatenate([movers.object_id, ids], axis=1),
            object_class=movers.object_class,
            lamps=_and_dark(movers.lamps, part.shape[1]),
            spray=movers.spray,
        )


def signal_poles(scene: Scene) -> dict[str, int]:
    """Return the fixture of the traffic light at the end of each edge that has one."""
    # Shapely takes long to import, and few maps have signals.
    from eyas.engine.world.roads.areas import streets
    from eyas.engine.world.street.signals import pole_at

    fixtures, found = scene.fixtures, {}
    poles = np.flatnonzero(scene.object_class[fixtures.object_id] == ObjectClass.POLE)
    feet = fixtures.pose[poles][:, :2, 3]
    for name, street in zip(scene.network.edges, streets(scene.network), strict=True):
        if len(street.right) >= 2 and len(poles):
            away = np.abs(feet - np.array(pole_at(street)[0])).max(axis=1)
            if away.min() < _SAME:
                found[name] = int(poles[away.argmin()])
    return found


def lights_of(
    scene: Scene,  # The scene, on the network of the plan
    plan: SignalPlan,  # Programs of the lights
    first_part: int,  # See `SignalLights`
) -> SignalLights | None:
    """Return the lights on the poles of a scene; None if there are none."""
    rows, fixtures = {name: row for row, name in enumerate(plan.edges)}, scene.fixtures
    found = [(rows[name], pole) for name, pole in signal_poles(scene).items() if name in rows]
    if not found:
        return None
    row, fixture = np.array(found, np.int64).T
    owner = fixtures.object_id[fixture].astype(np.int32)
    return SignalLights(plan, row, fixtures.pose[fixture], owner, first_part)
