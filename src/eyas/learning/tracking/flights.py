"""Which flights the tracker learns from: all maps, weathers, targets and heights."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.protocols.lasting import LONG
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.rng import stream
from eyas.engine.targets.config import TargetName
from eyas.learning.tracking.pilots import Oracle, Pupil
from eyas.learning.tracking.shots import Shots

Pilot = Oracle | Pupil

MAPS = ("citystreet", "downtown", "village", "lake", "desert", "farmland")
"""The first three are flown twice as often: there is more to hide behind."""

WEATHERS = ("day", "night", "foggy", "snow")
_TURN = (MAPS[0], MAPS[1], MAPS[2], MAPS[3], MAPS[0], MAPS[1], MAPS[2], MAPS[4], MAPS[5])
_FLIGHTS = 8  # Flights for each weather of a batch
_WORLDS = 4  # Worlds for each batch of traffic without flights
_STEPS = 5_000  # Length of a flight [2 ms]
_WALKERS = tuple(name for name in TargetName if name is not TargetName.SUMO_VEHICLE)
_WALKING = 0.2  # Share of the flights with a target other than a vehicle
_ALIKE = 0.15  # Share of the batches in which all vehicles look like the target
_HIDING = 0.5  # Share of a pupil's batches on maps with covers in which drivers hide
_COVERED = "citystreet", "village"  # Maps for which traffic with such drivers comes with Eyas
_LATENCIES = ("0", "0", "40", "80")  # Latencies of a pupil [ms]
_SEEDS = 2**40  # Range of the seeds of episodes, which tests draw below 100,000,000

_TRAFFIC: tuple[dict[str, Any], ...] = (
    {"demand": "respawn", "group_size": 12},
    {"demand": "respawn", "group_size": 40},
    {"demand": "keep_alive"},
)
_HIDDEN = {"demand": "keep_alive", "drivers": "hiding"}


def flown(
    make: Callable[[np.random.Generator], Pilot], batches: range, seed: int
) -> Iterator[Shots]:
    """Yield the pictures of batches of flights.

    Args:
        batches: Numbers of the batches; each depends on its number and the seed only.
    """
    for number in batches:
        rng = stream(seed, "tracking flights", number)
        pilot = make(rng)
        pupil = isinstance(pilot, Pupil)
        hides = pupil and _TURN[number % len(_TURN)] in _COVERED and rng.random() < _HIDING
        protocol = protocol_of_batch(rng, varied=not pupil, hides=bool(hides))
        late = str(rng.choice(_LATENCIES)) if pupil else "0"
        flight = BatchFlight(_episodes(rng, number), protocol, pilot, delay_from(late))
        for _ in flight.fly():
            pass
        yield Shots.of(pilot.shots)


def protocol_of_batch(rng: np.random.Generator, *, varied: bool, hides: bool = False) -> Protocol:
    """Return the settings of a batch; `varied`: with other heights and pitches; `hides`: with
    drivers who hide.
    """
    traffic = _TRAFFIC[rng.integers(len(_TRAFFIC))]
    changes: dict[str, Any] = {
        "traffic": _HIDDEN if hides else traffic,
        "done": {"total_steps": _STEPS},
        "light": {"sun": {"uniform": [-0.3, 0.3]}},
    }
    if varied:
        changes["start"] = {"height": {"uniform": [18.0, 25.0]}, "pitch": {"uniform": [1.25, 1.42]}}
    protocol = LONG.changed(changes)
    return replace(protocol, alike=bool(rng.random() < _ALIKE), tells_solvable=False)


def _episodes(rng: np.random.Generator, number: int) -> list[EpisodeSpec]:
    """Return the episodes of a batch, on one map in all weathers."""
    episodes = []
    for weather in WEATHERS:
        walks = rng.random() < _WALKING
        target = str(rng.choice(_WALKERS)) if walks else TargetName.SUMO_VEHICLE.value
        place = Place(_TURN[number % len(_TURN)], weather, target)
        for _ in range(_FLIGHTS):
            direction = float(rng.uniform(-np.pi, np.pi))
            episodes.append(EpisodeSpec(place, direction, int(rng.integers(2**30, _SEEDS))))
    return episodes


def episodes_by_day(rng: np.random.Generator, number: int) -> list[EpisodeSpec]:
    """Return where and when vehicles are on one map, by day; arguments as those of a batch."""
    place = Place(_TURN[number % len(_TURN)], "day", TargetName.SUMO_VEHICLE.value)
    return [EpisodeSpec(place, 0.0, int(rng.integers(2**30, _SEEDS))) for _ in range(_WORLDS)]
