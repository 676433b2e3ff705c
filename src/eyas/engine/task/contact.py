"""Collisions: where and what the body of a tracker touches."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sensors.bodies import body_box
from eyas.engine.sensors.obstacles import Obstacles
from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.snapshot import Snapshot, TrackerState
from eyas.engine.task.done import DoneReason
from eyas.engine.task.sweep import NEVER, Sweep
from eyas.engine.task.touch import touch_ground, touch_movers, touch_solids
from eyas.lanes import compiled, kernel

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
