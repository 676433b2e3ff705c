"""The lidar of the original's tracker, an RpLidarA2: one layer of points all around the body.

It turns at 12 Hz, so only some of its 400 points are measured in each physics step, from where the
body is then; the others stay as they are. As in Webots, point 0 looks back, and the head turns
clockwise, seen from above.
"""

import math
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import MountConfig
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.counter_rng import normal, uniform
from eyas.engine.core.frames import rotate
from eyas.engine.core.rng import EpisodeKey, room_key
from eyas.engine.sensors.config import LidarConfig
from eyas.engine.sensors.mount import turn_of
from eyas.engine.sensors.movers import find_boxes
from eyas.engine.sensors.obstacles import Obstacles
from eyas.engine.sensors.rays import Ray, cast_ray
from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.snapshot import Snapshot, TrackerState
from eyas.lanes import compiled, exact, kernel
from eyas.lanes.pcg64 import STATE, begin_stream, word

MOUNT = MountConfig(z=0.031)  # Where the original's drone has it

CAR_MOUNT = MountConfig(x=-0.1)  # Where the original's car has it

POINT_NUMBERS = 5  # Numbers of each point in a radar packet: x, y, z, layer, time

_ROOM = room_key("lidar")

_ROUNDING = 1e-9  # Keeps a point that is due at a whole step from being due one later

Floats = NDArray[np.float64]
Number = TypeVar("Number", np.float64, np.int32)


class Lidar:
    """The lidars of N trackers.

    Points are numbered through an episode, those of its first turn below 0. The latest are kept, as
    many as a message may be late: what is told is the last turn of some time ago. The first turn,
    which the head had made before the episode, is measured when it is asked for, as far as no later
    point has taken its place; where trackers share a world, at once, as all that stood there moves.
    """

    def __init__(
        self,
        config: LidarConfig,  # The settings
        snapshot: Snapshot,  # State of the trackers
        obstacles: Obstacles,  # What their rays may hit
        active: NDArray[np.bool_],  # Whether each tracker moves in a step, shape (N,); read at each
        latest: int = 0,  # Most steps of 2 ms by which a message may be late, besides `delay_steps`
        mount: MountConfig = MOUNT,  # Where it is if the settings do not say
    ) -> None:
        count, points = len(active), config.points
        self._longest, self._points = config.max_range, points
        self._delay, self._clock = config.delay_steps, snapshot.episodes.step_count
        self._per_step = points * config.frequency * PHYSICS_STEP
        kept = points + math.ceil((latest + config.delay_steps) * self._per_step) + 1
        self._turned = np.zeros(count, np.int64)
        self._key = np.zeros((count, len(EpisodeKey._fields)), np.int64)
        self._range = np.full((count, kept), np.inf)
        self._thing = np.full((count, kept), -1, np.int32)
        self._time = np.zeros((count, kept))
        angle = -math.pi - 2.0 * math.pi / points * np.arange(points)
        self._ahead = np.stack([exact.cos(angle), exact.sin(angle)], axis=1)
        place = config.mount or mount
        self._waiting = np.zeros(count, np.bool_)
        alone = len(np.unique(obstacles.movers.world)) == count
        scan = _Scan(
            snapshot.trackers,
            snapshot.episodes,
            obstacles,
            active,
            np.array([place.x, place.y, place.z]),
            np.ascontiguousarray(exact.product(self._ahead, turn_of(place)[:, :2].T)),
            self._turned,
            self._key,
            np.zeros(count, np.int64),
            self._range,
            self._thing,
            self._time,
            np.zeros(STATE, np.int64),
            _Starts(
                self._waiting, np.zeros((count, 3)), np.zeros((count, 4)), np.zeros(count, np.int64)
            ),
            alone,
            self._per_step,
            config.min_range,
            config.max_range,
            config.noise,
            config.bias,
            config.resolution,
            config.drop_out,
        )
        self._scan, self._scan_first = _scan_all.bind(scan), _scan_first_turns.bind(scan)

    def begin(self, tracker: int, key: EpisodeKey) -> None:
        """Begin an episode at the next `advance`, with a whole turn from where the tracker is."""
        self._turned[tracker] = -self._points
        self._key[tracker] = key

    def advance(self) -> None:
        """Measure the points that have become due since the last call."""
        self._scan()

    def settle(self) -> None:
        """Measure the first turns that wait, before what was around the trackers changes."""
        if self._waiting.any():
            self._scan_first()

    def ranges(self, late: NDArray[np.int64] | None = None) -> Floats:
        """Return the latest distance of each point [m], infinity where nothing is within range,
        shape (N, points).

        Args:
            late: Steps of 2 ms by which the message to each tracker is late, shape (N,); None:
                none is.
        """
        return self._told(self._range, late)

    def things(self) -> NDArray[np.int32]:
        """Return the object id of what each point has hit, -1 for nothing, shape (N, points).

        The numbers are those of `Picture.object_id`.
        """
        return self._told(self._thing, None)

    def packets(self, late: NDArray[np.int64] | None = None) -> Floats:
        """Return the radar packets, shape (N, 5 x points).

        `eyas.engine.task.radar_packet.RadarPacket` names their numbers.

        Args:
            late: As for `ranges`.
        """
        ranges = self.ranges(late)
        rows = np.zeros((*ranges.shape, POINT_NUMBERS))
        rows[..., 0:2] = ranges[..., None] * self._ahead
        rows[..., 4] = self._told(self._time, late)
        packets: Floats = rows.reshape(len(rows), -1)
        return packets

    def fill(
        self,
        out: NDArray[np.float32],  # Where to write
        late: NDArray[np.int64] | None = None,  # As for `ranges`
    ) -> None:
        """Write the distances [m], the largest range where nothing is, shape (N, points)."""
        np.minimum(self.ranges(late), self._longest, out=out, casting="same_kind")

    def _told(self, kept: NDArray[Number], late: NDArray[np.int64] | None) -> NDArray[Number]:
        """Return what is told of a kept array: of each point, the last before the message."""
        self.settle()
        step = np.maximum(self._clock - self._delay - (0 if late is None else late), 0)
        due = np.floor(step * self._per_step + _ROUNDING).astype(np.int64)
        last = np.minimum(due, self._turned)[:, None] - 1
        number = last - (last - np.arange(self._points)) % self._points
        told: NDArray[Number] = np.take_along_axis(kept, number % kept.shape[1], axis=1)
        return told


class _Starts(NamedTuple):
    """Where trackers began their episodes."""

    waiting: NDArray[np.bool_]  # Whether the first turn is not measured yet, shape (N,)
    position: Floats  # World frame [m], shape (N, 3)
    orientation: Floats  # Shape (N, 4)
    tick: NDArray[np.int64]  # Time in the traffic, in physics steps, shape (N,)


class _Scan(NamedTuple):
    """Inputs and outputs of the kernel."""

    trackers: TrackerState
    episodes: EpisodeState
    obstacles: Obstacles
    active: NDArray[np.bool_]
    place: Floats  # Of the lidar, body frame [m], shape (3,)
    ahead: Floats  # Direction of each point in the body frame, shape (P, 3)
    turned: NDArray[np.int64]  # Points measured since the reset, shape (N,)
    key: NDArray[np.int64]  # `EpisodeKey` of each, shape (N, 3)
    seed: NDArray[np.int64]  # Of the noise of the episode, shape (N,)
    range: Floats
    """Of the point of each number modulo K, the points that are kept [m], shape (N, K)."""
    thing: NDArray[np.int32]  # The same [object id]
    time: Floats  # The same [s]
    stream: NDArray[np.int64]  # Working memory, see `eyas.lanes.pcg64`
    starts: _Starts
    alone: bool  # Each tracker has a world of its own
    per_step: float  # Points measured in a physics step
    nearest: float
    farthest: float
    noise: float
    bias: float
    resolution: float
    drop_out: float


@compiled
def _scan_all(scan: _Scan) -> None:
    """Measure the due points of all active trackers."""
    for n in range(scan.active.shape[0]):
        due = math.floor(scan.episodes.step_count[n] * scan.per_step + _ROUNDING)
        if (scan.active[n] and scan.turned[n] < due) or scan.turned[n] < 0:
            last = due if scan.active[n] else 0
            position, orientation = scan.trackers.position[n], scan.trackers.orientation[n]
            if scan.turned[n] < 0:
                key = scan.key[n]
                begin_stream(scan.stream, key[0], _ROOM, key[1], key[2])
                scan.seed[n] = word(scan.stream)
                scan.starts.waiting[n] = scan.alone and last == 0
            if scan.turned[n] < 0 and scan.starts.waiting[n]:
                scan.starts.tick[n] = scan.episodes.tick[n]
                for k in range(3):
                    scan.starts.position[n, k] = position[k]
                for k in range(4):
                    scan.starts.orientation[n, k] = orientation[k]
            else:
                first = max(scan.turned[n], last - scan.ahead.shape[0])
                _scan_one(scan, n, position, orientation, scan.episodes.tick[n], first, last)
            scan.turned[n] = last


@compiled
def _scan_first_turns(scan: _Scan) -> None:
    """Measure what is still kept of the first turns that wait."""
    starts, points = scan.starts, scan.ahead.shape[0]
    for n in range(scan.active.shape[0]):
        if starts.waiting[n]:
            first = max(-points, scan.turned[n] - scan.range.shape[1])
            place, orientation = starts.position[n], starts.orientation[n]
            _scan_one(scan, n, place, orientation, starts.tick[n], first, 0)
            starts.waiting[n] = False


@kernel(inline=True)
def _scan_one(
    scan: _Scan,
    n: int,  # The tracker
    position: Floats,  # World frame [m], shape (3,)
    orientation: Floats,  # Shape (4,)
    tick: int,  # Time in the traffic, in physics steps
    first: int,  # Number of the first point
    last: int,  # The one after the last
) -> None:
    """Measure points of a tracker."""
    if first >= last:
        return
    place = scan.place
    off_x, off_y, off_z = rotate(orientation, place[0], place[1], place[2])
    x, y, z = position[0] + off_x, position[1] + off_y, position[2] + off_z
    points, kept, reach = scan.ahead.shape[0], scan.range.shape[1], scan.farthest
    obstacles = scan.obstacles
    boxes = find_boxes(obstacles.movers, n, tick, (x, y, z), reach, obstacles.boxes)
    for number in range(first, last):
        aim, slot = scan.ahead[number % points], number % kept
        ahead_x, ahead_y, ahead_z = rotate(orientation, aim[0], aim[1], aim[2])
        ray = Ray(x, y, z, ahead_x, ahead_y, ahead_z)
        distance, thing = cast_ray(ray, reach, obstacles, boxes)
        scan.range[n, slot] = _measured(scan, scan.seed[n], number, distance)
        scan.thing[n, slot] = thing if scan.range[n, slot] < math.inf else -1
        scan.time[n, slot] = tick * PHYSICS_STEP


@kernel(inline=True)
def _measured(scan: _Scan, seed: int, number: int, distance: float) -> float:
    """Return what is told of a distance [m]."""
    if not scan.nearest <= distance <= scan.farthest:
        return math.inf
    if scan.drop_out > 0.0 and uniform(seed, number, 2) < scan.drop_out:
        return math.inf
    if scan.noise > 0.0:
        distance += scan.noise * normal(seed, number, 0)
    if scan.bias > 0.0:
        distance += scan.bias * normal(seed, 0, 2)
    if scan.resolution > 0.0:
        distance = scan.resolution * math.floor(distance / scan.resolution + 0.5)
    return min(max(distance, scan.nearest), scan.farthest)
