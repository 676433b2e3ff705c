"""Walks along pavements and over crossings, with waits at the kerb."""

import math
from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.behaviours.chain import Chain, Poses, chain_of, chain_through, headings
from eyas.engine.behaviours.crossings import Crossing
from eyas.engine.behaviours.gap_acceptance import GapAcceptance
from eyas.engine.behaviours.pavements import Walkway
from eyas.engine.behaviours.timetable import TimedMotion, ride, time_of
from eyas.engine.targets.habit import Habit
from eyas.lanes import exact

_PASSED_BY: Final = 0.4  # Share of the crossings that somebody does not take

_LEAST: Final = 2.0  # Least walk between two crossings [m]

Floats = NDArray[np.float64]


_NEAR: Final = 0.05  # Points nearer to each other are one [m]


class Streets(NamedTuple):
    """What is walked on."""

    ways: list[Walkway]
    crossings: list[list[Crossing]]
    """Those that begin at each way, in the order of their places on it."""
    gaps: GapAcceptance


class CrossingWalk(NamedTuple):
    """Paths one after the other; each is stood at the end of until the next begins."""

    legs: list[Chain]
    begins: list[float]  # When each begins, from the beginning of the life [s]


def crossing_walk(
    streets: Streets,  # Where one can walk
    habit: Habit,  # How one walks
    enters: float,  # When it begins, time of the traffic [s]
    lasts: float,  # Least duration [s]
    rng: np.random.Generator,  # Random numbers
) -> CrossingWalk:
    """Return a walk from a random place."""
    open_ = [k for k, from_here in enumerate(streets.crossings) if from_here]
    length = np.array([streets.ways[k].length for k in open_])
    way = open_[int(rng.choice(len(open_), p=length / length.sum()))]
    along, heading, time = float(rng.uniform(0.0, streets.ways[way].length)), None, 0.0
    made = CrossingWalk([], [])
    while time < lasts:
        crossing = _next(streets, way, along, rng)
        walk = _walk(streets.ways[way], along, crossing, habit, heading)
        made.legs.append(walk)
        made.begins.append(time)
        time += time_of(walk, habit)
        way, along = crossing.way, crossing.along
        heading, over = float(headings(walk)[-1]), crossing.line[1] - crossing.line[0]
        straight = chain_of(
            [(0.0, float(exact.hypot(*over)), 0.0)], (*crossing.line[0].tolist(), heading)
        )
        takes, to_kerb = time_of(straight, habit), _time_to(crossing.to_kerb, habit)
        begins = streets.gaps.first(crossing.line, enters + time, takes, crossing.light, to_kerb)
        if begins is not None:
            time = begins - enters
            made.legs.append(straight)
            made.begins.append(time)
            time += takes
            way, along = crossing.other, crossing.other_along
    return made


def walk_motion(walk: CrossingWalk, habit: Habit, time: Floats) -> TimedMotion:
    """Return the motion on a walk at increasing times [s], shape (K,), see `ride`."""
    leg = np.searchsorted(walk.begins, time, side="right") - 1
    travelled, parts = 0.0, []
    for k in range(len(walk.legs)):
        part = ride(walk.legs[k], habit, time[leg == k] - walk.begins[k])
        parts.append(part._replace(travelled=part.travelled + travelled))
        travelled += float(walk.legs[k].length.sum())
    poses = [np.concatenate(column) for column in zip(*(part.poses for part in parts), strict=True)]
    rest = [np.concatenate(column) for column in zip(*(part[1:] for part in parts), strict=True)]
    return TimedMotion(Poses(*poses), *rest)


def _next(streets: Streets, way: int, along: float, rng: np.random.Generator) -> Crossing:
    """Return the next crossing that is taken."""
    around = streets.ways[way].length
    # One that is just here is reached after going all round.
    ahead = [(one.along - along - _LEAST) % around for one in streets.crossings[way]]
    order: list[int] = np.argsort(ahead, kind="stable").tolist()
    taken: int = next((k for k in order if rng.uniform() > _PASSED_BY), order[0])
    return streets.crossings[way][taken]


def _time_to(away: float, habit: Habit) -> float:
    """Return how long one needs from a start to a line at a distance [s]."""
    return away / habit.speed + 0.5 * habit.speed / habit.acceleration


def _walk(
    way: Walkway,
    along: float,  # Where on it the path begins [m]
    crossing: Crossing,  # Where it ends
    habit: Habit,  # How one walks
    heading: float | None,  # Heading before it [rad]; None: along the way
) -> Chain:
    """Return the path on a way to a crossing, at which one turns towards it."""
    sides = np.roll(way.corners, -1, axis=0) - way.corners
    lengths = exact.hypot(sides[:, 0], sides[:, 1])
    at = np.cumsum(lengths) - lengths
    length = (crossing.along - along) % way.length
    onwards = (at - along) % way.length
    # From the beginning to the end of the path, and on to its beginning.
    order = np.argsort(onwards, kind="stable")
    clear = (onwards > _NEAR) & (onwards < way.length - _NEAR) & (np.abs(onwards - length) > _NEAR)
    corners = [(onwards[k], way.corners[k]) for k in order.tolist() if clear[k]]
    start = shapely.get_coordinates(way.line.interpolate(along))[0]
    before = [corner for place, corner in corners if place < length]
    after = [corner for place, corner in corners if place > length]
    end = [crossing.line[0]] if _NEAR < length < way.length - _NEAR else []
    before = before if end else [corner for _, corner in corners]
    points = [start, *before, *end, *(after if end else [])]
    whole = chain_through(np.array(points), habit.radius, 1)
    count = 2 * (len(before) + 1)
    spin, bends = whole.spin[:count].copy(), whole.curvature[:count]
    first = whole.start[2]
    if heading is not None:
        spin[0] = math.remainder(first - heading, 2.0 * math.pi)
        first = heading
    path = Chain((*whole.start[:2], first), spin, whole.length[:count], bends)
    over = crossing.line[1] - crossing.line[0]
    turn = math.remainder(exact.atan2(over[1], over[0]) - headings(path)[-1], 2.0 * math.pi)
    return Chain(
        path.start,
        np.append(path.spin, turn),
        np.append(path.length, 0.0),
        np.append(path.curvature, 0.0),
    )
