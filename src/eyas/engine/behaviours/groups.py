"""Who moves: how many of a kind, where, when they come and go, and how they move.

They come and go in the original's groups, without taking anything from who follows it.
"""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.variation import Variation
from eyas.engine.targets.config import ObjectsConfig
from eyas.engine.targets.habit import Behaviour, Habit

_LEAST: Final = 60.0  # Least length of a life, where that of the original is too short [s]

_EPISODES: Final = 4.0
"""Least length of a life, in episodes: then three of four objects last one at any time."""

_BETWEEN: Final = 1.0
"""More than from the end of a life to the next, and what times are rounded by [s]."""


class Lifetimes(NamedTuple):
    """L stays in the world, shape (L,) each."""

    slot: NDArray[np.int64]
    """Number of the object that stays; one object has several, each at another place."""
    enters: NDArray[np.int64]  # First sample
    leaves: NDArray[np.int64]
    """Last sample; the next life begins two samples later, so that no motion joins the two."""


class SampleClock(NamedTuple):
    """The instants of a motion."""

    samples: int
    rate: float  # [Hz]


class ScriptedGroup(NamedTuple):
    """Some of one kind."""

    kind: str  # Name of the kind
    breadth: float  # Diameter of the circle in which it fits [m]
    behaviour: Behaviour | None  # None: that of the habit
    habit: Habit  # How they move
    lifetimes: Lifetimes
    offset: Variation  # Where it begins: distance from the middle of the road [m]
    setting: str  # Setting of the number, for messages
    chosen_by: str = "custom.behaviour"  # Setting of the behaviour, for messages


def lasting(count: int, samples: int) -> Lifetimes:
    """Return objects that stay from the first to the last sample."""
    return Lifetimes(np.arange(count), np.zeros(count, np.int64), np.full(count, samples - 1))


def recycled(
    config: ObjectsConfig, samples: int, rate: float, episode: float, followers: int = 0
) -> Lifetimes:
    """Return objects that come in groups and are moved elsewhere in the same order.

    The original moves the oldest group whenever an interval has passed, even if someone follows it;
    with its defaults, an object stays for 1.25 s. Here it is so where each object then stays for
    four episodes; otherwise groups enter as there, but are moved so rarely that each stays for four
    episodes and a minute: a target is sampled from those that stay for the whole of its episode.

    In a world whose time goes on, there are as many of these as followers at any time: as many
    objects are there from the start, and where a whole group cannot be spared, fewer are moved at a
    time, or none.

    Args:
        config: Numbers and interval.
        samples: Number of samples of the motion.
        rate: Samples per second [Hz].
        episode: Length of an episode [s].
        followers: Number of trackers in a world whose time goes on from episode to episode; 0:
            there is none, as trackers alone in their worlds may begin at another time.
    """
    made = []
    spare = max(config.max_count - followers, 0)
    batch = max(min(config.group_size, spare), 1)
    turns = math.ceil(config.max_count / batch)
    stay = turns * config.interval
    if stay < _EPISODES * episode:
        stay = max(_EPISODES * episode, _LEAST)
    settled = 0.0
    if followers and spare:
        stay = max(stay, turns * (episode + _BETWEEN) / (spare // batch))
        settled = config.max_count // config.group_size * config.interval + episode + _BETWEEN
    for slot in range(config.max_count):
        group = slot // config.group_size
        enters = 0 if slot < followers else round(group * config.interval * rate)
        first = (slot // batch + 1) / turns * stay
        moves = np.arange(first, samples / rate, stay) * rate
        moves = np.rint(moves[moves > max(enters + 2, settled * rate)]).astype(np.int64)
        moves = moves if spare else moves[:0]
        starts = [enters, *(moves + 2).tolist()]
        ends = [*moves.tolist(), samples - 1]
        made += [(slot, a, b) for a, b in zip(starts, ends, strict=True) if b > a]
    return Lifetimes(*np.array(made, np.int64).reshape(-1, 3).T)
