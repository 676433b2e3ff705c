"""Collisions: where and what the body of a tracker touches."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sensors.bodies import body_box
from eyas.engine.sensors.grid import cells_between
from eyas.engine.sensors.movers import find_boxes
from eyas.engine.sensors.obstacles import Obstacles
from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.snapshot import Snapshot, TrackerState
from eyas.engine.state.terrain import ground_at
from eyas.engine.task.done import DoneReason
from eyas.engine.task.sweep import NEVER, Sweep, sweep_cylinder, sweep_prism, while_level
from eyas.lanes import compiled, kernel


class Hit(NamedTuple):
    """The first touch of anything."""

    share: float  # Share of the motion at the touch, 0 to 1, or `NEVER`
    x: float  # Place, world frame [m]
    y: float
    thing: int  # Object id
    bottom: float  # z of the thing there [m]
    top: float


@kernel(inline=True)
def touch_solids(sweep: Sweep, obstacles: Obstacles) -> Hit:
    """Return the first solid that is touched."""
    solids, best = obstacles.solids, NEVER
    x, y, thing, low, high = 0.0, 0.0, -1, 0.0, 0.0
    wide = math.sqrt(sweep.half_length * sweep.half_length + sweep.half_width * sweep.half_width)
    to_x, to_y = sweep.x + sweep.motion_x, sweep.y + sweep.motion_y
    prisms, grid = solids.first.shape[0] - 1, solids.grid
    lowest = min(sweep.z, sweep.z + sweep.motion_z) - sweep.half_height
    first_row, last_row, left, right = cells_between(grid, (sweep.x, to_x), (sweep.y, to_y), wide)
    for row in range(first_row, last_row + 1):
        for column in range(left, right + 1):
            cell = row * grid.columns + column
            if grid.top[cell] < lowest:
                continue
            for k in range(grid.first[cell], grid.first[cell + 1]):
                item = grid.item[k]
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
                    best, x, y = touch.share, touch.x, touch.y
                    thing, low, high = int(solids.thing[item]), bottom, top
    return Hit(best, x, y, thing, low, high)


@kernel(inline=True)
def touch_movers(
    sweep: Sweep,  # The motion of the body in the last physics step
    obstacles: Obstacles,  # Everything solid
    n: int,  # The tracker
    tick: int,  # Time at the end of the step, in physics steps
) -> Hit:
    """Return the first vehicle, or body of another tracker, that is touched."""
    boxes, best = obstacles.boxes, NEVER
    x, y, thing, low, high = 0.0, 0.0, -1, 0.0, 0.0
    reach = abs(sweep.motion_x) + abs(sweep.motion_y) + abs(sweep.motion_z)
    reach += sweep.half_length + sweep.half_width + sweep.half_height
    place = (sweep.x, sweep.y, sweep.z)
    for box in range(find_boxes(obstacles.movers, n, tick, place, reach, boxes)):
        # As seen from the mover, which stands where it is at the end.
        beside = _seen_from(sweep, boxes.moved[box])
        bottom, top = boxes.bottom[box], boxes.top[box]
        start, end = while_level(beside, bottom, top)
        if start > end:
            continue
        touch = sweep_prism(beside, boxes.corners, 4 * box, 4 * box + 4, start, end)
        if touch.share < best:
            best, x, y = touch.share, touch.x, touch.y
            thing, low, high = int(boxes.thing[box]), bottom, top
    return Hit(best, x, y, thing, low, high)


@kernel(inline=True)
def _seen_from(sweep: Sweep, moved: NDArray[np.float64]) -> Sweep:
    """Return a motion relative to something that has moved, and has come to rest where it is."""
    return Sweep(
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


@kernel(inline=True)
def touch_ground(sweep: Sweep, obstacles: Obstacles) -> Hit:
    """Return the first touch of the ground, looked for at the corners and the middle of the box, in
    steps of half a cell of the relief.
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
            ground = ground_at(terrain, x, y)
            if low <= ground:
                return Hit(share, x, y, obstacles.solids.ground, ground, ground)
    return Hit(NEVER, 0.0, 0.0, obstacles.solids.ground, 0.0, 0.0)


_CRASH, _NOT_A_NUMBER = int(DoneReason.CRASH), int(DoneReason.NOT_A_NUMBER)


class Contacts:
    """Tells the contacts of N trackers in their episodes, after each physics step.

    Args:
        snapshot: State of the trackers; `crash`, `contact` and `contact_object` of its episodes are
            written, and the reasons of their ends if a crash is one.
        obstacles: What they may touch.
        active: Whether each tracker moves in a step, shape (N,); read at each.
        grace_steps: Steps after a reset in which a crash does not end the episode.
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
        )
        self._find = _find_all.bind(work)

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
    last: NDArray[np.float64]  # Where each body was after the last step [m], shape (N, 3)
    fresh: NDArray[np.bool_]  # Whether this is the first step of a command, shape (N,)
    touched: NDArray[np.bool_]
    """Whether the body has touched anything since the command began, shape (N,)."""
    crashed: NDArray[np.bool_]  # Whether a crash has ended the episode, shape (N,)
    grace_steps: int
    ends: int  # 1: a crash ends the episode; 0: it does not


@compiled
def _find_all(work: _Work) -> None:
    """Find the contacts of all active trackers."""
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


@kernel(inline=True)
def _find(trackers: TrackerState, episodes: EpisodeState, work: _Work, n: int) -> bool:
    """Find what the body of tracker `n` touches first on its way of the last step."""
    sweep = _sweep_of(trackers, work, n)
    hit = touch_solids(sweep, work.obstacles)
    mover = touch_movers(sweep, work.obstacles, n, episodes.tick[n])
    if mover.share < hit.share:
        hit = mover
    ground = touch_ground(sweep, work.obstacles)
    if ground.share < hit.share:
        hit = ground
    for axis in range(3):
        work.last[n, axis] = trackers.position[n, axis]
    if hit.share >= NEVER:
        return False
    contact = episodes.contact[n]
    contact[0], contact[1] = hit.x, hit.y
    contact[2] = min(max(sweep.z + hit.share * sweep.motion_z, hit.bottom), hit.top)
    episodes.contact_object[n] = hit.thing
    return True


@kernel(inline=True)
def _sweep_of(trackers: TrackerState, work: _Work, n: int) -> Sweep:
    """Return the way of the body in the last step."""
    at, last, box = trackers.position[n], work.last[n], body_box(trackers.orientation[n])
    return Sweep(
        last[0],
        last[1],
        last[2],
        at[0] - last[0],
        at[1] - last[1],
        at[2] - last[2],
        box.cosine,
        box.sine,
        box.half_length,
        box.half_width,
        box.half_height,
    )
