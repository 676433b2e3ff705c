"""The published test, and two of the same length that are drawn evenly: at home, and elsewhere."""

import math
from collections.abc import Sequence

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.even_choice import evenly_in
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.traffic.library import TEST_TRAFFIC
from eyas.engine.world.maps.recipe import TEST_TOWNS


def in_several_recordings(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose starts evenly in the three recordings that each map has for tests."""
    return evenly_in(TEST_TRAFFIC, places, protocol, count, first_seed)


def in_one_recording(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose starts evenly in the one recording that each town for tests has."""
    return evenly_in(TEST_TRAFFIC[:1], places, protocol, count, first_seed)


PAPER = Protocol(
    "paper", "the published test: 3 s, figures CR and TSR", rank="cr", tells_solvable=True
)

_TWELVE = tuple(math.radians(30.0 * turn) for turn in range(12))

STANDARD = Protocol(
    "standard",
    "3 s: twelve directions, starts evenly over the map, in traffic that nobody was taught in",
    {"traffic": {"demand": "keep_alive"}},
    directions=_TWELVE,
    episodes=9,
    rank="tsr",
    choose=in_several_recordings,
    tells_solvable=True,
)

UNSEEN = STANDARD.like(
    "unseen",
    "3 s: as standard, in six towns that nobody was taught in",
    episodes=2,
    choose=in_one_recording,
    elsewhere=True,
    maps=tuple(
        f"{name}:{seed}" for name in ("citystreet", "downtown", "village") for seed in TEST_TOWNS
    ),
)
