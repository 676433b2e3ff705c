"""What the tracker of a duel sees: where its target is while nothing hides it, and its memory."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sim.scenes import load_scene, load_solids
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.clearance import Clearance
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.weather import Season
from eyas.lanes import exact

SEEN: Final = 9  # Numbers that the tracker sees
_OLDEST: Final = 10.0  # Longest time for which a lost target is thought to drive on [s]

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


class DuelSight:
    """What N trackers see of their targets.

    A target is seen if its centre is in the picture and nothing that stands is between it and the
    camera. One that is lost is thought to drive on as it was seen last.

    Attributes:
        seen: Whether each target is seen now, shape (N,).
    """

    def __init__(self, world: WorldConfig, count: int, aspect: float) -> None:
        scene = load_scene(world.map, world.seed)
        nobody = SampledMotion(np.zeros((2, 0), SAMPLE), np.zeros(0, np.int32), 10.0).packed()
        solids = load_solids(world.map, world.seed, Season.SUMMER)
        self._clearance = Clearance(solids, scene.terrain, nobody)
        self._aspect = aspect  # Height of the picture over its width
        self.seen: Mask = np.zeros(count, np.bool_)
        self._place, self._velocity = np.zeros((2, count, 2))
        self._age = np.zeros(count)

    def begin(self, snapshot: Snapshot) -> Floats:
        """Begin new episodes of all, in which the target is known at first; see `look`."""
        return self.look(snapshot, 0.0, np.ones(len(self.seen), np.bool_))

    def look(self, snapshot: Snapshot, period: float, begun: Mask) -> Floats:
        """Look again after a time [s]; return what trackers see, shape (N, `SEEN`).

        In episodes that have just begun, the target is known.

        The numbers: 1 if it is seen; where it is, ahead and to the left [20 m]; its velocity there
        [10 m/s]; cosine and sine of its course, relative to the tracker's heading; how high the
        tracker is over it [20 m]; for how long it is lost [5 s].
        """
        self.seen = self._sees(snapshot)
        self._age += period
        self._place += period * self._velocity * (self._age < _OLDEST)[:, None]
        self._remember(snapshot, self.seen | begun)
        yaw = snapshot.trackers.euler[:, 2]
        cosine, sine = exact.cos(yaw), exact.sin(yaw)

        def ahead_left(vector: Floats) -> tuple[Floats, Floats]:
            east, north = vector.T
            return cosine * east + sine * north, cosine * north - sine * east

        away = ahead_left(self._place - snapshot.trackers.position[:, :2])
        velocity = ahead_left(self._velocity)
        speed = np.maximum(exact.hypot(*velocity), 0.1)
        height = snapshot.trackers.position[:, 2] - snapshot.targets.position[:, 2]
        return np.stack(
            [
                self.seen.astype(np.float64),
                *(0.05 * each for each in away),
                *(0.1 * each for each in velocity),
                *(each / speed for each in velocity),
                0.05 * height,
                0.2 * np.minimum(self._age, _OLDEST),
            ],
            axis=1,
        )

    def _remember(self, snapshot: Snapshot, which: Mask) -> None:
        self._place[which] = snapshot.targets.centre[which, :2]
        self._velocity[which] = snapshot.targets.velocity[which, :2]
        self._age[which] = 0.0

    def _sees(self, snapshot: Snapshot) -> Mask:
        cameras, centre = snapshot.cameras, snapshot.targets.centre
        away = exact.product((centre - cameras.position)[:, None], cameras.rotation)[:, 0]
        forward, left, up = away.T
        reach = np.maximum(forward, 1e-6) * exact.tan(0.5 * cameras.field_of_view)
        inside = (forward > 0.0) & (np.abs(left) < reach) & (np.abs(up) < self._aspect * reach)
        free = self._clearance.in_sight(cameras.position, centre[:, None])[:, 0]
        return np.asarray(inside & free)
