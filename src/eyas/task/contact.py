"""Collisions: where and what the body of a tracker touches."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.frames import rotate
from eyas.core.jit import step_kernel
from eyas.core.parallel import Held, Pointer, parallel_kernel
from eyas.sensors.movers import find_boxes
from eyas.sensors.obstacles import Obstacles
from eyas.state.snapshot import EpisodeState, Snapshot, TrackerState
from eyas.state.terrain import ground_at
from eyas.task.done import DoneReason
from eyas.task.sweep import NEVER, Sweep, sweep_cylinder, sweep_prism, while_level

__all__ = ["BODY", "Contacts"]

BODY = (0.806, 0.806, 0.366)
"""Length, width, height of the original's drone [m]; its camera, a few cm below, is neglected."""

_CRASH, _NOT_A_NUMBER = int(DoneReason.CRASH), int(DoneReason.NOT_A_NUMBER)


class Contacts:
    """Tells the contacts of N trackers in their episodes, after each physics step.

    Args:
        snapshot: State of the trackers; `crash`, `contact` and `contact_object` of its episodes are
            written, and the reasons of their ends if a crash is one.
        obstacles: What they may touch.
        active: Whether each tracker moves in a step, shape (N,); read at each.
        grace_steps: Steps after a reset in which a crash is no end.
        ends: Whether a crash ends the episode.
    """

    def __init__(
        self,
        snapshot: Snapshot,
        obstacles: Obstacles,
        active: NDArray[np.bool_],
        grace_steps: int,
        *,
        ends: bool,
    ) -> None:
        count = len(active)
        self._snapshot, self._active = snapshot, active
        self._last = np.zeros((count, 3))
        self._fresh = np.zeros(count, np.bool_)
        self._touched = np.zeros(count, np.bool_)
        self._crashed = np.zeros(count, np.bool_)
        work = _Work(
            snapshot.trackers,
            snapshot.episodes,
            obstacles,
            active,
            self._last,
            self._fresh,
            self._touched,
            self._crashed,
            grace_steps,
            int(ends),
            *(0.5 * size for size in BODY),
        )
        self._find = _find_all.bound(Held(work))

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode, without a contact, where the tracker is now."""
        self._last[tracker] = self._snapshot.trackers.position[tracker]
        self._touched[tracker] = self._crashed[tracker] = False

    def renew(self) -> None:
        """Begin a command: `crash` tells of contacts from now on."""
        self._fresh[:] = True

    def advance(self) -> None:
        """Tell the contacts of the last physics step."""
        self._find()


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    trackers: TrackerState
    episodes: EpisodeState
    obstacles: Obstacles
    active: NDArray[np.bool_]
    last: NDArray[np.float64]
    """Where each body was after the last step [m], shape (N, 3)."""
    fresh: NDArray[np.bool_]
    """Whether this is the first step of a command, shape (N,)."""
    touched: NDArray[np.bool_]
    """Whether the body has touched anything since the command began, shape (N,)."""
    crashed: NDArray[np.bool_]
    """Whether a crash has ended the episode, shape (N,)."""
    grace_steps: int
    ends: int
    """1: a crash ends the episode; 0: it does not."""
    half_length: float
    half_width: float
    half_height: float


@parallel_kernel
def _find_all(parts: Pointer[tuple[Pointer[_Work]]], worker: int, workers: int) -> None:
    """Find the contacts of all active trackers."""
    work = parts[0][0][0]
    trackers, episodes = work.trackers, work.episodes
    for n in range(work.active.shape[0]):
        if not work.active[n] or episodes.step_count[n] == 0:
            continue
        touched = _find(trackers, episodes, work, n)
        # The step has set what the original calls a crash.
        work.touched[n] = touched or (work.touched[n] and not work.fresh[n])
        episodes.crash[n] = work.touched[n]
        work.fresh[n] = False
        if work.ends == 1 and touched and episodes.step_count[n] >= work.grace_steps:
            work.crashed[n] = True
        if work.crashed[n] and episodes.reason[n] != _NOT_A_NUMBER:
            episodes.reason[n] = _CRASH


@step_kernel
def _find(trackers: TrackerState, episodes: EpisodeState, work: _Work, n: int) -> bool:
    """Find what the body of tracker `n` touches first on its way of the last step."""
    sweep = _sweep_of(trackers, work, n)
    share, x, y, thing, bottom, top = _touch_solids(sweep, work.obstacles)
    at, tick = trackers.position[n], episodes.tick[n]
    way = abs(sweep.motion_x) + abs(sweep.motion_y) + abs(sweep.motion_z)
    reach = way + work.half_length + work.half_width + work.half_height
    place = (at[0], at[1], at[2])
    boxes = work.obstacles.boxes
    for box in range(find_boxes(work.obstacles.movers, n, tick, place, reach, boxes)):
        moved = boxes.moved[box]
        # As seen from the vehicle, which stands where it is now.
        beside = Sweep(
            sweep.x + moved[0],
            sweep.y + moved[1],
            sweep.z + moved[2],
            sweep.motion_x - moved[0],
            sweep.motion_y - moved[1],
            sweep.motion_z - moved[2],
            sweep.cosine,
            sweep.sine,
            sweep.half_length,
            sweep.half_width,
            sweep.half_height,
        )
        start, end = while_level(beside, boxes.bottom[box], boxes.top[box])
        if start > end:
            continue
        touch = sweep_prism(beside, boxes.corners, 4 * box, 4 * box + 4, start, end)
        if touch.share < share:
            share, x, y, thing = touch.share, touch.x, touch.y, int(boxes.thing[box])
            bottom, top = boxes.bottom[box], boxes.top[box]
    ground, ground_x, ground_y = _touch_ground(sweep, work.obstacles)
    if ground < share:
        share, x, y, thing = ground, ground_x, ground_y, work.obstacles.solids.ground
        bottom = top = ground_at(work.obstacles.terrain, x, y)
    for axis in range(3):
        work.last[n, axis] = at[axis]
    if share >= NEVER:
        return False
    contact = episodes.contact[n]
    contact[0], contact[1] = x, y
    contact[2] = min(max(sweep.z + share * sweep.motion_z, bottom), top)
    episodes.contact_object[n] = thing
    return True


@step_kernel
def _sweep_of(trackers: TrackerState, work: _Work, n: int) -> Sweep:
    """Return the way of the body in the last step, as an upright box around the tilted one."""
    at, last, orientation = trackers.position[n], work.last[n], trackers.orientation[n]
    ahead = rotate(orientation, work.half_length, 0.0, 0.0)
    left = rotate(orientation, 0.0, work.half_width, 0.0)
    up = rotate(orientation, 0.0, 0.0, work.half_height)
    level = math.sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1])
    cosine, sine = (ahead[0] / level, ahead[1] / level) if level > 0.0 else (1.0, 0.0)
    length = abs(cosine * ahead[0] + sine * ahead[1]) + abs(cosine * left[0] + sine * left[1])
    width = abs(cosine * ahead[1] - sine * ahead[0]) + abs(cosine * left[1] - sine * left[0])
    return Sweep(
        last[0],
        last[1],
        last[2],
        at[0] - last[0],
        at[1] - last[1],
        at[2] - last[2],
        cosine,
        sine,
        length + abs(cosine * up[0] + sine * up[1]),
        width + abs(cosine * up[1] - sine * up[0]),
        abs(ahead[2]) + abs(left[2]) + abs(up[2]),
    )


@step_kernel
def _touch_solids(
    sweep: Sweep, obstacles: Obstacles
) -> tuple[float, float, float, int, float, float]:
    """Return share, x, y, object, bottom and top of the first solid that is touched."""
    solids, best = obstacles.solids, NEVER
    best_x, best_y, thing, low, high = 0.0, 0.0, -1, 0.0, 0.0
    wide = math.sqrt(sweep.half_length * sweep.half_length + sweep.half_width * sweep.half_width)
    to_x, to_y = sweep.x + sweep.motion_x, sweep.y + sweep.motion_y
    prisms, spacing = solids.first.shape[0] - 1, solids.spacing
    lowest = min(sweep.z, sweep.z + sweep.motion_z) - sweep.half_height
    left = max(math.floor((min(sweep.x, to_x) - wide - solids.west) / spacing), 0)
    right = math.floor((max(sweep.x, to_x) + wide - solids.west) / spacing)
    lower = max(math.floor((min(sweep.y, to_y) - wide - solids.south) / spacing), 0)
    upper = math.floor((max(sweep.y, to_y) + wide - solids.south) / spacing)
    for row in range(lower, min(upper, solids.rows - 1) + 1):
        for column in range(left, min(right, solids.columns - 1) + 1):
            cell = row * solids.columns + column
            if solids.cell_top[cell] < lowest:
                continue
            for k in range(solids.cell_first[cell], solids.cell_first[cell + 1]):
                item = solids.cell_item[k]
                bottom, top = solids.bottom[item], solids.top[item]
                start, end = while_level(sweep, bottom, top)
                if start > end:
                    continue
                if item < prisms:
                    first, last = solids.first[item], solids.first[item + 1]
                    touch = sweep_prism(sweep, solids.points, first, last, start, end)
                else:
                    touch = sweep_cylinder(sweep, solids.round[item - prisms], start, end)
                if touch.share < best:
                    best, best_x, best_y = touch.share, touch.x, touch.y
                    thing, low, high = int(solids.thing[item]), bottom, top
    return best, best_x, best_y, thing, low, high


@step_kernel
def _touch_ground(sweep: Sweep, obstacles: Obstacles) -> tuple[float, float, float]:
    """Return share, x and y of the first touch of the ground, looked for at the corners and the
    middle of the box, in steps of half a cell of the relief.
    """
    terrain = obstacles.terrain
    way = abs(sweep.motion_x) + abs(sweep.motion_y)
    hills = terrain.relief.shape[0] > 0
    steps = int(way / (0.5 * terrain.spacing)) + 1 if hills else 1
    for step in range(steps):
        share = (step + 1.0) / steps
        low = sweep.z + share * sweep.motion_z - sweep.half_height
        for corner in range(5 if hills else 1):
            ahead = 0.0 if corner == 0 else sweep.half_length if corner < 3 else -sweep.half_length
            aside = sweep.half_width if corner % 2 else -sweep.half_width
            left = 0.0 if corner == 0 else aside
            x = sweep.x + share * sweep.motion_x + sweep.cosine * ahead - sweep.sine * left
            y = sweep.y + share * sweep.motion_y + sweep.sine * ahead + sweep.cosine * left
            if low <= ground_at(terrain, x, y):
                return share, x, y
    return NEVER, 0.0, 0.0
