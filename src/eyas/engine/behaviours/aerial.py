"""Motion of targets that fly: ways over the map, each at its height above what is below."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.airspace import Space, airspace_of
from eyas.engine.behaviours.chain import Chain
from eyas.engine.behaviours.ground import WalkingGround
from eyas.engine.behaviours.groups import SampleClock, ScriptedGroup
from eyas.engine.behaviours.routes import RouteTask, legs, round_and_round
from eyas.engine.behaviours.timetable import ride
from eyas.engine.state.motion import SAMPLE
from eyas.engine.targets.habit import Behaviour, Habit
from eyas.lanes import exact

Floats = NDArray[np.float64]

_ABOVE: Final = {Behaviour.CRUISE: (8.0, 16.0), Behaviour.ORBIT: (8.0, 14.0)}
"""Least and most height above all that stands nearby [m]."""

_LOW: Final = (2.0, 3.0)
"""Least and most height above the ground of those who fly among what stands [m]: over people's
heads, below the crowns of most trees."""

_ASIDE: Final = 0.4  # Room between a body and what stands [m]
_BESIDE: Final = 8.0 * np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
"""Where else heights are asked for around a place [m]."""
_CLIMB: Final = 2.5  # Fastest climb and sink [m/s]: half of what a drone that follows may
_SMOOTH: Final = 1.0  # Half the time over which heights are averaged [s]
_PLACES: Final = 12  # Places between which one cruises
_TRIED: Final = 12
"""Places that are drawn for each of them, and for an orbit: the lowest way is taken, so that none
leads over a tower of 200 m."""
_ALONG: Final = np.linspace(0.0, 1.0, 33)  # Where the height of the way to a place is asked for
_INSIDE: Final = 0.42  # Share of the map's sides, from its middle, in which they lie
_ROUND: Final = (12.0, 30.0)  # Least and most radius of an orbit [m]
_CORNERS: Final = 24  # Of what stands for a circle

_HASTE: Final = Habit(Behaviour.FLEE, speed=1.8, acceleration=2.0, yaw_rate=1.5, radius=0.5)
"""How many times as much of each those have who flee."""


def flown_table(
    ground: WalkingGround, group: ScriptedGroup, clock: SampleClock, rng: np.random.Generator
) -> NDArray[np.void]:
    """Return the samples of a group that flies, of dtype `SAMPLE`, shape (samples, objects).

    Args:
        ground: The map.
        group: Who flies; its behaviour is one of `AERIAL`.
        clock: Number of samples, and their rate.
        rng: Random numbers.

    Raises:
        SpawnError: The map has no room for it.
    """
    behaviour = group.behaviour or group.habit.behaviour
    habit = hastened(group.habit) if behaviour is Behaviour.FLEE else group.habit
    slot, enters, leaves = (part.tolist() for part in group.lifetimes)
    seconds = (group.lifetimes.leaves - group.lifetimes.enters) / clock.rate
    above = _ABOVE.get(behaviour)
    space = airspace_of(ground.scene) if above else None
    if space is None:
        ways = _among(ground, group, habit, behaviour, seconds, rng)
    else:
        ways = [_over(space, habit, behaviour, float(lasts), rng) for lasts in seconds]
    table = np.zeros((clock.samples, max(slot) + 1), SAMPLE)
    for life, way in enumerate(ways):
        rows = table[enters[life] : leaves[life] + 1, slot[life]]
        motion = ride(way, habit, np.arange(len(rows)) / clock.rate)
        points = np.stack([motion.poses.x, motion.poses.y], axis=1)
        if above is None or space is None:
            below, wanted = ground.surface.at(points).height, rng.uniform(*_LOW)
        else:
            below, wanted = over_all(_highest(space, points), clock.rate), rng.uniform(*above)
        z = averaged(below, round(_SMOOTH * clock.rate)) + wanted
        rows["x"], rows["y"], rows["yaw"], rows["z"] = *motion.poses, z
        rows["velocity_x"] = motion.speed * exact.cos(motion.poses.yaw)
        rows["velocity_y"] = motion.speed * exact.sin(motion.poses.yaw)
        rows["velocity_z"] = np.gradient(z, 1.0 / clock.rate) if len(z) > 1 else 0.0
        rows["yaw_rate"], rows["travelled"] = motion.yaw_rate, motion.travelled
        rows["present"] = 1.0
    return table


def _highest(space: Space, points: Floats) -> Floats:
    """Return how high something stands at points or beside them, where a slope may be higher."""
    around = points + _BESIDE[:, None]
    highest: Floats = space.heights(around).max(axis=0)
    return highest


def hastened(habit: Habit) -> Habit:
    """Return how those move who usually move like this, and flee."""
    return habit._replace(
        speed=_HASTE.speed * habit.speed,
        acceleration=_HASTE.acceleration * habit.acceleration,
        yaw_rate=_HASTE.yaw_rate * habit.yaw_rate,
        radius=_HASTE.radius * habit.radius,
    )


def over_all(top: Floats, rate: float) -> Floats:
    """Return the lowest heights, no lower than some, that climb and sink by `_CLIMB` at most.

    Args:
        top: Heights at the samples of a way [m], shape (S,).
        rate: Samples a second [Hz].
    """
    way = _CLIMB / rate * np.arange(len(top))
    sinking = np.maximum.accumulate(top + way) - way
    climbing = np.maximum.accumulate((top - way)[::-1])[::-1] + way
    heights: Floats = np.maximum(sinking, climbing)
    return heights


def averaged(values: Floats, half: int) -> Floats:
    """Return means over `half` samples before and after each, fewer at the ends, shape (S,)."""
    total, count = np.cumsum(np.concatenate([[0.0], values])), len(values)
    first = np.maximum(np.arange(count) - half, 0)
    last = np.minimum(np.arange(count) + half + 1, count)
    means: Floats = (total[last] - total[first]) / (last - first)
    return means


def _among(
    ground: WalkingGround,
    group: ScriptedGroup,
    habit: Habit,
    behaviour: Behaviour,
    seconds: Floats,
    rng: np.random.Generator,
) -> list[Chain]:
    """Return ways between what stands: straight on until something is in the way, or in jumps."""
    radius = 0.5 * group.breadth + _ASIDE
    start = ground.roadside.sample(len(seconds), group.offset, radius, rng, group.setting)
    task = RouteTask(start, seconds, habit, radius, ground.obstacles, rng)
    flees = behaviour is Behaviour.FLEE
    return legs(task, Behaviour.WANDER if flees else Behaviour.STRAIGHT)


def _over(
    space: Space, habit: Habit, behaviour: Behaviour, seconds: float, rng: np.random.Generator
) -> Chain:
    """Return a closed way over what stands."""
    reach = _INSIDE * space.extent
    if behaviour is Behaviour.CRUISE:
        first = rng.uniform(-reach, reach, (_TRIED, 2))
        places = [first[int(space.heights(first).argmin())]]
        while len(places) < _PLACES:
            tried = rng.uniform(-reach, reach, (_TRIED, 2))
            ways = places[-1] + _ALONG[:, None, None] * (tried - places[-1])
            if len(places) == _PLACES - 1:  # from which it goes back to the first
                ways = np.concatenate([ways, tried + _ALONG[:, None, None] * (places[0] - tried)])
            places.append(tried[int(space.heights(ways).max(axis=0).argmin())])
        return round_and_round(np.array(places), habit, seconds)
    radius, way_round = rng.uniform(*_ROUND), 1.0 if rng.random() < 0.5 else -1.0
    angle = way_round * 2.0 * math.pi / _CORNERS * np.arange(_CORNERS)
    circle = radius * np.stack([exact.cos(angle), exact.sin(angle)], axis=1)
    corners = circle[:, None] + rng.uniform(-reach, reach, (_TRIED, 2))
    lowest = int(space.heights(corners).max(axis=0).argmin())
    return round_and_round(corners[:, lowest], habit, seconds)
