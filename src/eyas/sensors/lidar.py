"""The lidar of the original's tracker, an RpLidarA2: one layer of points all around the body.

It turns at 12 Hz, so only some of its 400 points are measured in each physics step, from where the
body is then; the others stay as they are. As in Webots, point 0 looks back, and the head turns
clockwise, seen from above.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.frames import rotate
from eyas.core.jit import step_kernel
from eyas.core.parallel import Held, Pointer, parallel_kernel
from eyas.sensors.chance import SEEDS, normal, uniform
from eyas.sensors.config import LidarConfig
from eyas.sensors.movers import find_boxes
from eyas.sensors.obstacles import Obstacles
from eyas.sensors.rays import Ray, cast_ray
from eyas.state.episode import EpisodeState
from eyas.state.snapshot import Snapshot, TrackerState

__all__ = ["MOUNT", "POINT_NUMBERS", "Lidar"]

MOUNT = 0.031
"""Height of the lidar above the middle of the body [m]."""

POINT_NUMBERS = 5
"""Numbers of each point in a radar packet: x, y, z, layer, time."""


class Lidar:
    """The lidars of N trackers.

    Args:
        config: The settings.
        snapshot: State of the trackers.
        obstacles: What their rays may hit.
        active: Whether each tracker moves in a step, shape (N,); read at each.
    """

    def __init__(
        self,
        config: LidarConfig,
        snapshot: Snapshot,
        obstacles: Obstacles,
        active: NDArray[np.bool_],
    ) -> None:
        count, points = len(active), config.points
        self._longest = config.max_range
        self._turned = np.zeros(count, np.int64)
        self._seed = np.zeros(count, np.int64)
        self._range = np.full((count, points), np.inf)
        self._thing = np.full((count, points), -1, np.int32)
        self._time = np.zeros((count, points))
        angle = -math.pi - 2.0 * math.pi / points * np.arange(points)
        self._ahead = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        scan = _Scan(
            snapshot.trackers,
            snapshot.episodes,
            obstacles,
            active,
            self._ahead,
            self._turned,
            self._seed,
            self._range,
            self._thing,
            self._time,
            points * config.frequency * PHYSICS_STEP,
            config.min_range,
            config.max_range,
            config.noise,
            config.resolution,
            config.drop_out,
        )
        self._scan = _scan_all.bound(Held(scan))

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode: the next `advance` measures a whole turn from where the tracker is."""
        self._turned[tracker] = -self._range.shape[1]
        self._seed[tracker] = rng.integers(SEEDS)

    def advance(self) -> None:
        """Measure the points that have become due since the last call."""
        self._scan()

    def ranges(self) -> NDArray[np.float64]:
        """Return the latest distance of each point [m], infinity where nothing is within range,
        shape (N, points).
        """
        return self._range.copy()

    def ranges_of(self, tracker: int) -> NDArray[np.float64]:
        """Return the same of one tracker, shape (points,)."""
        ranges: NDArray[np.float64] = self._range[tracker].copy()
        return ranges

    def things(self) -> NDArray[np.int32]:
        """Return the object id of what each point has hit, -1 for nothing, shape (N, points).

        The numbers are those of `Picture.object_id`.
        """
        return self._thing.copy()

    def packets(self) -> NDArray[np.float64]:
        """Return the radar packets, shape (N, 5 x points); see `eyas.task.packets.RadarPacket`."""
        rows = np.zeros((*self._range.shape, POINT_NUMBERS))
        rows[..., 0:2] = self._range[..., None] * self._ahead
        rows[..., 4] = self._time
        packets: NDArray[np.float64] = rows.reshape(len(rows), -1)
        return packets

    def filled(self, out: NDArray[np.float32]) -> None:
        """Write the distances [m], the largest range where nothing is, shape (N, points)."""
        np.minimum(self._range, self._longest, out=out, casting="same_kind")


class _Scan(NamedTuple):
    """Inputs and outputs of the kernel."""

    trackers: TrackerState
    episodes: EpisodeState
    obstacles: Obstacles
    active: NDArray[np.bool_]
    ahead: NDArray[np.float64]
    """Direction of each point in the body frame, x and y, shape (P, 2)."""
    turned: NDArray[np.int64]
    """Points measured since the reset, shape (N,)."""
    seed: NDArray[np.int64]
    """Of the noise of the episode, shape (N,)."""
    range: NDArray[np.float64]
    thing: NDArray[np.int32]
    time: NDArray[np.float64]
    per_step: float
    """Points measured in a physics step."""
    nearest: float
    farthest: float
    noise: float
    resolution: float
    drop_out: float


@parallel_kernel
def _scan_all(parts: Pointer[tuple[Pointer[_Scan]]], worker: int, workers: int) -> None:
    """Measure the due points of all active trackers."""
    scan = parts[0][0][0]
    for n in range(scan.active.shape[0]):
        due = math.floor(scan.episodes.step_count[n] * scan.per_step + 1e-9)
        if scan.active[n] and scan.turned[n] < due:
            _scan_one(scan, n, due)
        elif scan.turned[n] < 0:
            _scan_one(scan, n, 0)


@step_kernel
def _scan_one(scan: _Scan, n: int, due: int) -> None:
    """Measure the points of tracker `n` up to the number that is due."""
    trackers, tick = scan.trackers, scan.episodes.tick[n]
    position, orientation = trackers.position[n], trackers.orientation[n]
    up_x, up_y, up_z = rotate(orientation, 0.0, 0.0, MOUNT)
    x, y, z = position[0] + up_x, position[1] + up_y, position[2] + up_z
    points, reach = scan.range.shape[1], scan.farthest
    boxes = find_boxes(scan.obstacles.movers, n, tick, (x, y, z), reach, scan.obstacles.boxes)
    for number in range(max(scan.turned[n], due - points), due):
        point = number % points
        aim_x, aim_y = scan.ahead[point, 0], scan.ahead[point, 1]
        ahead_x, ahead_y, ahead_z = rotate(orientation, aim_x, aim_y, 0.0)
        ray = Ray(x, y, z, ahead_x, ahead_y, ahead_z)
        distance, thing = cast_ray(ray, reach, scan.obstacles, boxes)
        scan.range[n, point] = _measured(scan, scan.seed[n], number, distance)
        scan.thing[n, point] = thing if scan.range[n, point] < math.inf else -1
        scan.time[n, point] = tick * PHYSICS_STEP
    scan.turned[n] = due


@step_kernel
def _measured(scan: _Scan, seed: int, number: int, distance: float) -> float:
    """Return what is told of a distance [m]."""
    if not scan.nearest <= distance <= scan.farthest:
        return math.inf
    if scan.drop_out > 0.0 and uniform(seed, number, 2) < scan.drop_out:
        return math.inf
    if scan.noise > 0.0:
        distance += scan.noise * normal(seed, number, 0)
    if scan.resolution > 0.0:
        distance = scan.resolution * math.floor(distance / scan.resolution + 0.5)
    return min(max(distance, scan.nearest), scan.farthest)
