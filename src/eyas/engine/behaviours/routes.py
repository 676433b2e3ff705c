"""Paths for each behaviour: as long as a life, free of obstacles."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple, TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.behaviours.chain import Chain, chain_of, chain_through, outline
from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.behaviours.timetable import time_of
from eyas.engine.targets.habit import Behaviour, Habit
from eyas.lanes import exact

Floats = NDArray[np.float64]

Piece: TypeAlias = tuple[float, float, float]
"""Turn on the spot [rad], length [m], curvature [1/m]; see `Chain`."""

_AROUND: Final = 30.0
"""Half the side of the square in which a polyline's points lie, as in the original [m]."""

_ROUNDS: Final = 80  # How often polylines are sampled; they shrink from round to round

_DIRECTIONS: Final = 12  # Directions that are tried at an obstacle

_FIRST: Final = 4  # How many of them are tried first; they are enough in most places

_FAR: Final = 12.0  # The farthest that a leg leads [m]; the next may lead straight on

_WAY: Final = (3.0, 12.0)  # Shortest and longest leg of a wander [s of its speed]

_ENOUGH: Final = 4.0  # One that leads so far is as good as a longer one [m]

_MARGIN: Final = 0.05  # Distance from the end of a leg to where it would touch an obstacle [m]

_LEAST: Final = 1.0  # Least time that counts for a leg [s]

_WAVE: Final = 0.8  # Angular frequency of a weave [rad/s]; its yaw rate has an amplitude of 1 rad/s

_PIECES: Final = 24  # Arcs that stand for a wave


class RouteTask(NamedTuple):
    """What paths are wanted for: L lifetimes."""

    start: Floats  # [m], shape (L, 2)
    seconds: Floats  # Least duration [s], shape (L,)
    habit: Habit
    radius: float  # Distance to obstacles that is kept [m]
    obstacles: GroundObstacles
    rng: np.random.Generator


def polylines(task: RouteTask) -> list[Chain]:
    """Return closed paths through 2 to 4 random points around each start, which is the first."""
    found: dict[int, Floats] = {}
    open_ = np.arange(len(task.start))
    for round_ in range(_ROUNDS):
        if not len(open_):
            break
        around = _AROUND * exact.power(0.95, round_)
        count = task.rng.integers(2, 5, len(open_)).tolist()
        aside = task.rng.uniform(-around, around, (len(open_), 4, 2))
        aside[:, 0] = 0.0
        corners = task.start[open_, None] + aside
        tried = [chain_through(corners[k, :n], task.habit.radius, 1) for k, n in enumerate(count)]
        free = _free(tried, task)
        for k in np.flatnonzero(free).tolist():
            found[int(open_[k])] = corners[k, : count[k]]
        open_ = open_[~free]
    return [
        round_and_round(found[life], task.habit, float(task.seconds[life]))
        if life in found
        else standing(task.start[life], 0.0)
        for life in range(len(task.start))
    ]


def round_and_round(corners: Floats, habit: Habit, seconds: float) -> Chain:
    """Return a closed path past corners [m], shape (K, 2), that lasts at least so long [s]."""
    once = time_of(chain_through(corners, habit.radius, 1), habit)
    return chain_through(corners, habit.radius, max(math.ceil(seconds / max(once, 0.1)), 1))


def standing(at: Floats, yaw: float) -> Chain:
    """Return the path of what does not move."""
    return chain_of([(0.0, 0.0, 0.0)], (float(at[0]), float(at[1]), yaw))


def stops(task: RouteTask) -> list[Chain]:
    """Return paths that lead straight on, turn, and end; shorter ones where there is no room."""
    habit, found = task.habit, [standing(at, 0.0) for at in task.start]
    open_, distance = np.arange(len(task.start)), habit.distance
    bend = math.copysign(1.0 / habit.radius, habit.turn)
    arc = (0.0, abs(habit.turn) * habit.radius, bend)
    for round_ in range(_ROUNDS):
        if not len(open_):
            break
        distance = habit.distance * exact.power(0.97, round_)
        tried = []
        for life in open_.tolist():
            start = (*task.start[life].tolist(), float(task.rng.uniform(-math.pi, math.pi)))
            tried.append(chain_of([(0.0, distance, 0.0), arc], start))
        free = _free(tried, task)
        for k in np.flatnonzero(free).tolist():
            found[int(open_[k])] = tried[k]
        open_ = open_[~free]
    return found


def _free(chains: Sequence[Chain], task: RouteTask) -> NDArray[np.bool_]:
    """Return which paths keep clear of obstacles."""
    lines = np.array([shapely.LineString(outline(chain)) for chain in chains], object)
    return ~task.obstacles.blocked(lines, task.radius)


def legs(task: RouteTask, behaviour: Behaviour) -> list[Chain]:
    """Return paths of legs in random directions; each ends before an obstacle."""
    habit, count = task.habit, len(task.start)
    wave = wave_of(habit.speed) if behaviour is Behaviour.WEAVE else None
    radius = task.radius + (wave.aside if wave else 0.0)
    heading = task.rng.uniform(-math.pi, math.pi, count)
    first = [(*at, turn) for at, turn in zip(task.start.tolist(), heading.tolist(), strict=True)]
    pieces: list[list[Piece]] = [[] for _ in range(count)]
    at, left, begins = task.start.copy(), task.seconds.copy(), True
    enough = max(_ENOUGH, radius, 1.1 * wave.onwards if wave else 0.0)
    while (active := np.flatnonzero(left > 0.0)).size:
        far = min(_FAR, float(left.max()) * habit.speed + 1.0)
        turn, way = np.zeros(len(active)), np.zeros(len(active))
        if begins or behaviour is not Behaviour.WANDER:
            way = _reach(task, at[active], heading[active], far, radius)
        begins, stuck = False, way < min(enough, 0.5 * far)
        other = active[stuck]
        turn[stuck], way[stuck] = _turns(task, at[other], heading[other], (far, enough), radius)
        if behaviour is Behaviour.WANDER:
            way = np.minimum(way, habit.speed * task.rng.uniform(*_WAY, len(active)))
        for k, life in enumerate(active.tolist()):
            made, onwards = [(turn[k], way[k], 0.0)], way[k]
            if wave:
                made, onwards = wave.leg(turn[k], way[k])
            heading[life] += turn[k]
            at[life] += onwards * np.array([exact.cos(heading[life]), exact.sin(heading[life])])
            pieces[life] += made
            # What has no way out stands still.
            left[life] -= max(time_of(chain_of(made, (0.0, 0.0, 0.0)), habit), _LEAST)
    # A wave swings to both sides of its direction, and begins at the right.
    back = wave.swing if wave else 0.0
    starts = [(x, y, yaw - back) for x, y, yaw in first]
    return [chain_of(own, start) for own, start in zip(pieces, starts, strict=True)]


def _reach(task: RouteTask, at: Floats, heading: Floats, far: float, radius: float) -> Floats:
    """Return how far legs may lead in some directions [m], at most a little less than `far`."""
    reach = task.obstacles.reach(at, heading, far, radius)
    return np.maximum(reach - _MARGIN, 0.0)


def _turns(
    task: RouteTask,  # Where it goes on
    at: Floats,  # Where they begin [m], shape (K, 2)
    heading: Floats,  # Headings before the turns [rad], shape (K,)
    span: tuple[float, float],  # The farthest, and what is enough [m]
    radius: float,  # Distance to obstacles [m]
) -> tuple[Floats, Floats]:
    """Return random turns [rad] that lead far enough, or else farthest, and how far [m]."""
    far, enough = span
    count = len(at)
    turn = task.rng.uniform(-math.pi, math.pi, (count, _DIRECTIONS))
    reach, row = np.zeros_like(turn), np.arange(count)
    for some in (slice(0, _FIRST), slice(_FIRST, _DIRECTIONS)):
        headings = heading[row, None] + turn[row, some]
        from_ = np.repeat(at[row], headings.shape[1], axis=0)
        reach[row, some] = _reach(task, from_, headings.ravel(), far, radius).reshape(
            headings.shape
        )
        # Where one leads so far, the others need not be known: the first that is enough is taken.
        row = row[0.7 * reach[row].max(axis=1) < enough]
    least = np.minimum(0.7 * reach.max(axis=1), enough)
    row, first = np.arange(count), np.argmax(reach >= least[:, None], axis=1)
    return turn[row, first], reach[row, first]


class Wave(NamedTuple):
    """One period of a weave, during which the yaw rate is a sine."""

    period: float  # Its length [m]
    swing: float  # Amplitude of the heading [rad]
    onwards: float  # How far it leads [m]
    aside: float  # How far aside it swings [m]

    def leg(self, turn: float, way: float) -> tuple[list[Piece], float]:
        """Return the pieces of as many periods as lead so far [m], after a turn [rad], and how far
        they lead [m]; where there is no room for a wave, they are straight.
        """
        count = int(way / self.onwards)
        if count == 0:
            return [(turn + self.swing, way, 0.0), (-self.swing, 0.0, 0.0)], way
        place = 2.0 * math.pi / _PIECES * np.arange(_PIECES + 1)
        bends = -self.swing * np.diff(exact.cos(place)) * _PIECES / self.period
        once = [(0.0, self.period / _PIECES, bend) for bend in bends.tolist()]
        many = once * count
        return [(turn, *many[0][1:]), *many[1:]], count * self.onwards


def wave_of(speed: float) -> Wave:
    """Return the weave at a speed [m/s]."""
    period, swing = speed * 2.0 * math.pi / _WAVE, 1.0 / _WAVE
    flat = Wave(period, swing, 1.0, 0.0)
    path = outline(chain_of(flat.leg(0.0, 1.0)[0], (0.0, 0.0, -swing)))
    return flat._replace(onwards=float(path[-1, 0]), aside=float(np.abs(path[:, 1]).max()))
