"""Episodes: which there are, and what each is called."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from eyas.engine.core.errors import ConfigError

FIRST_SEED = 1_000_000
"""Seed of the first episode: far from the seeds that training begins with, 0, 1, ..."""

SETS_APART = 1_000_000
"""Least distance of the first seeds of two sets of episodes: no set is as long."""

_NEXT_SET = 10_000_000
"""From the first seed of a set to that of the next, where the user does not tell."""

_MOST_SETS = 100


class Place(NamedTuple):
    """Where episodes are, and what is followed."""

    map: str  # Name or path; a town of another seed than 0 is written `citystreet:900000001`
    weather: str
    target: str

    @property
    def town(self) -> tuple[str, int]:
        """Name or path of the map, and its seed."""
        name, _, seed = self.map.rpartition(":")
        return (name, int(seed)) if name and seed.isdecimal() else (self.map, 0)


class EpisodeSpec(NamedTuple):
    """One episode of an evaluation. Protocol and episode determine all but the policy's actions."""

    place: Place
    direction: float  # Heading of the drone relative to its target's at the start [rad]
    seed: int  # Seed of which it is the first episode
    traffic: int | None = None
    """Seed of the recorded traffic in which it happens; None: the one of the protocol."""
    variant: str = ""  # Which of the versions of one episode it is, in protocols that have several

    @property
    def name(self) -> str:
        """A unique name, for example `citystreet/day/SUMO_VEHICLE/90/1000001`."""
        words = [*self.place, f"{math.degrees(self.direction):.0f}", str(self.seed)]
        if self.traffic is not None:
            words.append(f"traffic-{self.traffic}")
        return "/".join((*words, self.variant) if self.variant else words)


def episodes_of(
    places: Sequence[Place],
    directions: tuple[float, ...],
    count: int,
    first_seed: int = FIRST_SEED,
    recordings: Sequence[int | None] = (None,),
) -> list[EpisodeSpec]:
    """Return `count` episodes for each place and direction.

    The seeds do not depend on the places, so that conditions are compared with the same traffic,
    nor on `count`, so that more episodes include the fewer ones.

    Args:
        directions: Start directions [rad].
        recordings: Seeds of the recorded traffic that episodes take in turn; None: the protocol's.
    """
    turns, taken = len(directions), len(recordings)
    return [
        EpisodeSpec(
            place,
            direction,
            first_seed + number * turns + turn,
            recordings[(number + turn) % taken],
        )
        for place in places
        for number in range(count)
        for turn, direction in enumerate(directions)
    ]


def seed_sets(
    text: str,  # The seeds with commas between them, or a number of sets, up to 100
) -> tuple[int, ...]:
    """Return the first seed of each set of episodes that a user asks for.

    Raises:
        ConfigError: It is something else.
    """
    try:
        seeds = tuple(int(part) for part in text.split(","))
    except ValueError:
        seeds = ()
    if len(seeds) == 1 and seeds[0] <= _MOST_SETS:
        seeds = tuple(FIRST_SEED + number * _NEXT_SET for number in range(seeds[0]))
    if not seeds or min(seeds) < 0 or len(seeds) > _MOST_SETS:
        raise ConfigError(
            f"--seeds: {text!r} is not allowed: the first seeds of up to {_MOST_SETS} sets, such "
            f"as {FIRST_SEED},{FIRST_SEED + _NEXT_SET}, or a number of sets, such as 3"
        )
    return seeds
