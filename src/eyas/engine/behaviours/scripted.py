"""The motion of what moves by itself, as rows of the table of all motion.

It is computed at once for the whole length of the traffic, from the map, a seed and the settings,
so it is known at any instant without stepping.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.aerial import flown_table
from eyas.engine.behaviours.chain import Chain, Poses, chain_through
from eyas.engine.behaviours.crossing_walks import CrossingWalk, Streets, crossing_walk, walk_motion
from eyas.engine.behaviours.crossings import crossings_of
from eyas.engine.behaviours.gap_acceptance import GapAcceptance
from eyas.engine.behaviours.ground import ROOM, WalkingGround, walkways
from eyas.engine.behaviours.groups import SampleClock, ScriptedGroup
from eyas.engine.behaviours.pavements import LANES, Walkway
from eyas.engine.behaviours.routes import (
    RouteTask,
    legs,
    polylines,
    round_and_round,
    stops,
    wave_of,
)
from eyas.engine.behaviours.timetable import TimedMotion, ride, time_of
from eyas.engine.core.errors import SpawnError
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.state.scene import Scene
from eyas.engine.state.terrain import reliefs
from eyas.engine.targets.habit import AERIAL, Behaviour, Habit
from eyas.lanes import exact

# Where people stand and wait: at bus stops, and beside the tables of cafes.

_SPOTS: Final = {
    "shelter": ((-1.2, 0.15), (-0.3, 0.3), (0.6, 0.2), (1.35, 0.35), (2.5, 0.2)),
    "bus stop": ((0.7, -0.15), (1.4, -0.3), (-0.8, -0.25)),
    "cafe table": ((0.1, 1.25),),
}
"""Where one stands at things whose names begin so: left of its middle and towards the road [m]."""

_TURNED: Final = 0.6  # How far one looks aside from the road, or from the table, at most [rad]

Floats = NDArray[np.float64]


class Spot(NamedTuple):
    """Where somebody stands."""

    x: float  # East [m]
    y: float  # North [m]
    yaw: float  # [rad]

    def stand(self, time: Floats) -> TimedMotion:
        """Return the motion at times, of which there is none."""
        still = np.zeros(len(time))
        return TimedMotion(
            Poses(still + self.x, still + self.y, still + self.yaw), still, still, still
        )


def waiting_spots(
    scene: Scene,  # The map
    count: int,  # How many
    rng: np.random.Generator,  # Random numbers
    setting: str = "extras",  # What a message names
) -> list[Spot]:
    """Return so many places to wait at, no two of them the same.

    Raises:
        SpawnError: There are fewer.
    """
    fixtures, found = scene.fixtures, list[Spot]()
    for number, pose in zip(fixtures.prototype.tolist(), fixtures.pose, strict=True):
        name = fixtures.names[number] if fixtures.names else ""
        own = next((spots for start, spots in _SPOTS.items() if name.startswith(start)), ())
        ahead = np.array([pose[0, 1], pose[1, 1]], np.float64)
        aside = np.array([pose[0, 0], pose[1, 0]], np.float64)
        facing = float(exact.atan2(ahead[1], ahead[0]))
        for left, onwards in own:
            place = pose[:2, 3].astype(np.float64) + left * aside + onwards * ahead
            turn = facing + (np.pi if name.startswith("cafe") else 0.0)
            found.append(Spot(float(place[0]), float(place[1]), turn))
    if len(found) < count:
        raise SpawnError(
            f"{setting}: 'wait': '{scene.name}' has {len(found)} places at bus stops and cafes, "
            f"not {count}; allowed: fewer, or another behaviour"
        )
    chosen = rng.choice(len(found), count, replace=False).tolist()
    looks = rng.uniform(-_TURNED, _TURNED, count).tolist()
    return [
        found[k]._replace(yaw=found[k].yaw + aside) for k, aside in zip(chosen, looks, strict=True)
    ]


_SPAN: Final = 0.25  # Half the distance over which the slope of the land is taken [m]

_JITTER: Final = 0.5
"""How irregularly those who go the same way follow each other, as a share of even distances."""

_WIDE: Final = 1.2
"""Who is broader than this, as no person is, may find no crossing where others do [m]."""

_TOGETHER: Final = 4
"""Objects that are laid on the ground at a time: for hundreds at once it takes gigabytes."""

_BY_KERB: Final = 0.5  # Distance from the kerb of those who ride, between it and those who walk [m]

_UNHURRIED: Final = 0.7  # Speed of the slowest who ride, as a share of the usual one


STROLL: Final = (1.1, 1.7)  # Slowest and fastest walk on a pavement [m/s]


class _Course(NamedTuple):
    """The path of a life, and how it is gone."""

    path: Chain | CrossingWalk | Spot
    habit: Habit
    begun: float = 0.0  # For how long it has been gone when the life begins [s]

    def ride(self, time: Floats) -> TimedMotion:
        """Return the motion at times since the beginning of the life [s]."""
        if isinstance(self.path, Spot):
            return self.path.stand(time)
        if isinstance(self.path, CrossingWalk):
            return walk_motion(self.path, self.habit, time)
        return ride(self.path, self.habit, self.begun + time)


def scripted_table(
    ground: WalkingGround,  # The map
    group: ScriptedGroup,  # Who moves
    clock: SampleClock,  # Number of samples, and their rate
    rng: np.random.Generator,  # Random numbers
    # Motion, at the same instants, of the vehicles for which those wait who cross
    vehicles: SampledMotion | None = None,
) -> NDArray[np.void]:
    """Return the samples of a group, of dtype `SAMPLE`, shape (samples, objects).

    Raises:
        SpawnError: The map has no room for it.
    """
    lifetimes, habit = group.lifetimes, group.habit
    if (group.behaviour or habit.behaviour) in AERIAL:
        return flown_table(ground, group, clock, rng)
    seconds = (lifetimes.leaves - lifetimes.enters) / clock.rate
    if (group.behaviour or habit.behaviour) is Behaviour.CROSSING:
        gaps = GapAcceptance(vehicles, clock.samples, clock.rate, ground.lights)
        ways = _walkways(ground, group, habit, vehicles)
        paths = _crossing_walks(
            ground, group, habit, ways, lifetimes.enters / clock.rate, seconds, gaps, rng
        )
    elif (group.behaviour or habit.behaviour) in (Behaviour.PAVEMENT, Behaviour.VERGE):
        paths = _strolls(_walkways(ground, group, habit, vehicles), habit, seconds, rng)
    elif (group.behaviour or habit.behaviour) is Behaviour.RIDE:
        pace = (_UNHURRIED * habit.speed, habit.speed)
        paths = _strolls(_walkways(ground, group, habit, vehicles), habit, seconds, rng, pace)
    elif group.behaviour is Behaviour.WAIT:
        spots = waiting_spots(ground.scene, len(seconds), rng, group.chosen_by)
        paths = [_Course(spot, habit) for spot in spots]
    else:
        paths = _paths(ground, group, habit, seconds, rng)
    return _gone(ground, group, clock, paths)


def _gone(
    ground: WalkingGround, group: ScriptedGroup, clock: SampleClock, paths: list[_Course]
) -> NDArray[np.void]:
    """Return the samples of those who go along the paths of their lifetimes.

    A few objects are done at a time, side by side in memory: in the table of all, the samples of
    one are so far apart that each would be fetched anew for each of its numbers.
    """
    slot, enters, leaves = (part.tolist() for part in group.lifetimes)
    table = np.zeros((clock.samples, max(slot) + 1), SAMPLE)
    for first in range(0, table.shape[1], _TOGETHER):
        few = np.zeros((clock.samples, min(_TOGETHER, table.shape[1] - first)), SAMPLE)
        for life, at in enumerate(slot):
            if first <= at < first + _TOGETHER:
                rows = few[enters[life] : leaves[life] + 1, at - first]
                _go(paths[life], rows, clock.rate)
        _lay(ground, few, clock.rate)
        _numbers(table)[:, first : first + _TOGETHER] = _numbers(few)
    return table


def _numbers(table: NDArray[np.void]) -> NDArray[np.float32]:
    """Return a view of samples as plain numbers, which numpy copies many times as fast."""
    return table.view(np.float32).reshape(*table.shape, -1)


def _go(course: _Course, rows: NDArray[np.void], rate: float) -> None:
    """Set where somebody is in each sample of a life, and how fast."""
    motion = course.ride(np.arange(len(rows)) / rate)
    rows["x"], rows["y"], rows["yaw"] = motion.poses
    rows["velocity_x"] = motion.speed * exact.cos(motion.poses.yaw)
    rows["velocity_y"] = motion.speed * exact.sin(motion.poses.yaw)
    rows["yaw_rate"], rows["travelled"] = motion.yaw_rate, motion.travelled
    rows["present"] = 1.0


def _paths(
    ground: WalkingGround,
    group: ScriptedGroup,
    habit: Habit,
    seconds: Floats,
    rng: np.random.Generator,
) -> list[_Course]:
    behaviour = group.behaviour or habit.behaviour
    radius = 0.5 * group.breadth + ROOM
    aside = wave_of(habit.speed).aside if behaviour is Behaviour.WEAVE else 0.0
    start = ground.roadside.sample(len(seconds), group.offset, radius + aside, rng, group.setting)
    task = RouteTask(start, seconds, habit, radius, ground.obstacles, rng)
    if behaviour is Behaviour.POLYLINE:
        chains = polylines(task)
    elif behaviour is Behaviour.STOP:
        chains = stops(task)
    else:
        chains = legs(task, behaviour)
    return [_Course(chain, habit) for chain in chains]


def _strolls(
    ways: list[Walkway],
    habit: Habit,
    seconds: Floats,
    rng: np.random.Generator,
    pace: tuple[float, float] = STROLL,
) -> list[_Course]:
    """Return ways on pavements.

    All who go the same way are equally fast and begin apart, so none overtakes or walks in another.
    """
    speed = rng.uniform(*pace, len(ways))
    length = np.array([way.length for way in ways])
    chosen = rng.choice(len(ways), size=len(seconds), p=length / length.sum())
    begun, made = np.zeros(len(seconds)), []
    paced = [habit._replace(speed=min(float(fast), habit.speed)) for fast in speed]
    for way in np.unique(chosen).tolist():
        who = np.flatnonzero(chosen == way)
        lap = time_of(chain_through(ways[way].corners, habit.radius, 1), paced[way])
        place = rng.permutation(len(who)) + rng.uniform(0.0, _JITTER, len(who))
        begun[who] = lap * place / len(who)
    for way, lasts, ahead in zip(chosen.tolist(), seconds.tolist(), begun.tolist(), strict=True):
        path = round_and_round(ways[way].corners, paced[way], lasts + ahead)
        made.append(_Course(path, paced[way], ahead))
    return made


def _crossing_walks(
    ground: WalkingGround,
    group: ScriptedGroup,
    habit: Habit,
    ways: list[Walkway],
    enters: Floats,
    seconds: Floats,
    gaps: GapAcceptance,
    rng: np.random.Generator,
) -> list[_Course]:
    """Return walks on pavements and over crossings."""
    over = crossings_of(ground.scene, ways, ground.solids, 0.5 * group.breadth)
    if not over:
        why = ""
        if group.breadth > _WIDE:
            why = f" wide enough for '{group.kind}'"
        elif len(
            ground.scene.footways.crossings
        ):  # long vehicles cut corners, where nobody walks then
            why = " that vehicles leave free"
        raise SpawnError(
            f"{group.chosen_by}: 'crossing': '{ground.scene.name}' has no crossing between "
            f"pavements{why}; allowed: another behaviour, or another map such as citystreet"
        )
    from_each = [
        sorted((one for one in over if one.way == k), key=lambda one: one.along)
        for k in range(len(ways))
    ]
    where, made = Streets(ways, from_each, gaps), []
    for begins, lasts in zip(enters.tolist(), seconds.tolist(), strict=True):
        paced = habit._replace(speed=min(float(rng.uniform(*STROLL)), habit.speed))
        made.append(_Course(crossing_walk(where, paced, begins, lasts, rng), paced))
    return made


def _walkways(
    ground: WalkingGround, group: ScriptedGroup, habit: Habit, vehicles: SampledMotion | None
) -> list[Walkway]:
    """Return the ways on pavements.

    Raises:
        SpawnError: There are none.
    """
    behaviour = group.behaviour or habit.behaviour
    verges = behaviour in (Behaviour.VERGE, Behaviour.RIDE)
    lanes = (_BY_KERB,) if behaviour is Behaviour.RIDE else LANES
    ways = walkways(ground, group.breadth, habit.radius, vehicles, verges=verges, lanes=lanes)
    if not ways:
        raise SpawnError(
            f"{group.chosen_by}: '{behaviour.value}': '{ground.scene.name}' has no pavement; "
            "allowed: another behaviour, or another map such as citystreet"
        )
    return ways


def _lay(ground: WalkingGround, table: NDArray[np.void], rate: float) -> None:
    """Set the heights and slopes of samples to those of the ground."""
    here = table["present"] > 0.0
    points = np.column_stack([table["x"][here], table["y"][here]]).astype(np.float64)
    yaw = table["yaw"][here]
    ahead = _SPAN * np.column_stack([exact.cos(yaw), exact.sin(yaw)])
    terrain = ground.scene.terrain
    rise = reliefs(terrain, points + ahead) - reliefs(terrain, points - ahead)
    table["slope"][here] = exact.atan(rise / (2.0 * _SPAN))
    table["z"][here] = ground.surface.at(points).height
    # Half the way between the neighbouring samples; a life's ends have one only.
    after, before = np.minimum(np.arange(len(table)) + 1, len(table) - 1), np.arange(len(table)) - 1
    before[0] = 0
    after_, before_ = here[after], here[before]
    z = table["z"].astype(np.float64)
    change = np.where(after_, z[after], z) - np.where(before_, z[before], z)
    steps = (after_ & (after != np.arange(len(table)))[:, None]).astype(np.int64)
    steps += before_ & (before != np.arange(len(table)))[:, None]
    table["velocity_z"] = np.where(here, change * rate / np.maximum(steps, 1), 0.0)
