"""Whether the starts of episodes are inside something that stands."""

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.sensors.obstacles import Solids
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.step import offset_pose
from eyas.engine.sim.worlds import Worlds
from eyas.engine.state.motion import Motion
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.clearance import Margin, lifted_over
from eyas.engine.traffic.interpolation import interpolate_actor
from eyas.lanes import BoundCall, compiled, kernel

AROUND_BODY = Margin(aside=0.3, above=0.3, ground=-0.5)
"""Around the middle of the body, which holds the camera; the ground is let off half a metre, as
cars start on it."""

_APART = 1.0  # Least distance of two trackers of a world that follow targets of their own [m]

_NOWHERE = 1e9  # Place of trackers that have not started yet [m]


class FreeStarts:
    """Tells where the trackers that begin an episode would be free."""

    def __init__(
        self,
        solids: Callable[[], Solids],  # Returns what stands; called when it is first needed
        terrain: Terrain,  # The ground
        motion: Motion,  # The traffic
        # State of N trackers, of which targets, ticks and start offsets are drawn
        snapshot: Snapshot,
        worlds: Worlds,
        *,
        shared_target: bool,  # Whether trackers of a world start around one target, however near
    ) -> None:
        self._solids, self._terrain, self._motion = solids, terrain, motion
        self._snapshot, self._worlds = snapshot, worlds
        self._apart = 0.0 if shared_target else _APART
        count = len(worlds.of)
        self._count, self._chosen = np.zeros(1, np.int64), np.zeros(count, np.int64)
        self._lift = np.zeros(count)

    def lifts(self, trackers: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return by how much the starts of trackers would have to be higher to be free [m], shape
        (K,); 0 for those that are free.
        """
        self._count[0] = len(trackers)
        self._chosen[: len(trackers)] = trackers
        self._snapshot.trackers.position[trackers] = _NOWHERE
        self._find()
        return self._lift[: len(trackers)].copy()

    @cached_property
    def _find(self) -> BoundCall:
        return _find_lifts.bind(
            _Work(
                snapshot=self._snapshot,
                world_of=self._worlds.of,
                lasting=self._worlds.lasting,
                motion=self._motion,
                terrain=self._terrain,
                solids=self._solids(),
                margin=AROUND_BODY,
                apart=self._apart,
                starts=self._count,
                chosen=self._chosen,
                lift=self._lift,
            )
        )


def starts_in(
    assets: Assets, snapshot: Snapshot, worlds: Worlds, *, shared_target: bool
) -> FreeStarts:
    """Return what tells of starts on a map; see `FreeStarts`."""
    terrain, motion = assets.scene.terrain, assets.traffic.motion
    return FreeStarts(assets.solids, terrain, motion, snapshot, worlds, shared_target=shared_target)


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    snapshot: Snapshot
    world_of: NDArray[np.int32]  # World of each tracker, shape (N,)
    lasting: NDArray[np.bool_]  # Whether trackers share each world, shape (W,)
    motion: Motion
    terrain: Terrain
    solids: Solids
    margin: Margin
    apart: float  # Least distance of two trackers of a world [m]
    starts: NDArray[np.int64]  # Number of trackers that begin, K, shape (1,)
    chosen: NDArray[np.int64]  # Those trackers, in the first K of N elements
    lift: NDArray[np.float64]  # See `FreeStarts.lifts`, in the first K of N elements; written.


@compiled
def _find_lifts(work: _Work) -> None:
    """Write how much higher each tracker must start, and set the positions of those that may."""
    trackers, _, targets, episodes, _ = work.snapshot
    for k in range(work.starts[0]):
        n = work.chosen[k]
        actor, time = targets.actor[n], episodes.tick[n] * PHYSICS_STEP
        pose, at = interpolate_actor(work.motion, actor, time), trackers.position[n]
        at[0], at[1], at[2] = pose.x, pose.y, pose.z + targets.rise[n]
        x, y, z, _ = offset_pose(at, pose.yaw, episodes.start_offset[n])
        over = lifted_over(work.solids, work.terrain, work.margin, x, y, z)
        at[0] = _NOWHERE
        if over == z and _meets(work, n, x, y, z):
            over = z + work.apart
        work.lift[k] = over - z
        at[0], at[1], at[2] = x, y, over


@kernel(inline=True)
def _meets(work: _Work, n: int, x: float, y: float, z: float) -> bool:
    """Return whether another tracker of the world is at a place."""
    world, places = work.world_of[n], work.snapshot.trackers.position
    if not work.lasting[world]:
        return False
    for other in range(len(places)):
        if other != n and work.world_of[other] == world:
            place = places[other]
            far_x, far_y, far_z = place[0] - x, place[1] - y, place[2] - z
            if far_x * far_x + far_y * far_y + far_z * far_z < work.apart * work.apart:
                return True
    return False
