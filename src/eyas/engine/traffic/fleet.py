"""The vehicles of the traffic: the class of each, and when and where they drive."""

import heapq
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from itertools import repeat
from typing import NamedTuple

import numpy as np

from eyas.engine.core.rng import stream
from eyas.engine.traffic.config import Demand, Drivers, Mix, TrafficConfig, VehicleType
from eyas.engine.traffic.demand import (
    RoadLinks,
    Route,
    departures,
    endless_walk,
    lasting_edges,
    random_trips,
    roomy_loops,
    walk_from,
    ways_through,
)

Links = Mapping[VehicleType, RoadLinks]  # The roads, as each class of vehicles may use them


class Departure(NamedTuple):
    """A vehicle that enters the roads."""

    time: float  # When it is due [s]
    route: Route
    vehicle_type: VehicleType
    place: str = "base"  # Where on its first edge it enters, in SUMO's words
    speed: str = "0"  # How fast it is then [m/s], or SUMO's word for it


ROOMS = (30.0, 60.0, 120.0)  # Tried one after the other, until traffic flows [m]
_USUAL = 8.0  # Mean speed on a way through a town, about [m/s]

Fleet = Callable[[Links], Iterator[Departure]]
"""Function of the roads that yields the vehicles, the earliest first."""


def simplest(vehicle_type: VehicleType | Mix) -> VehicleType | Mix:
    """Return the one class of a mix of one class; else a mix whose shares sum to 1."""
    if isinstance(vehicle_type, VehicleType):
        return vehicle_type
    total = sum(vehicle_type.shares.values())
    shares = {name: share / total for name, share in vehicle_type.shares.items() if share}
    if len(shares) == 1:
        return next(iter(shares))
    return Mix(**{name.value: round(share, 9) for name, share in shares.items()})


def vehicle_types(config: TrafficConfig) -> tuple[VehicleType, ...]:
    """Return the class of each actor: all alike, or by the shares of a mix, class by class.

    Each class gets the whole part of its share of `max_vehicles`; those left go to the largest
    remainders (Hamilton's method).
    """
    mix, count = config.vehicle_type, config.max_vehicles
    if isinstance(mix, VehicleType):
        return (mix,) * count
    total = sum(mix.shares.values())
    exact = {name: share / total * count for name, share in mix.shares.items()}
    numbers = {name: int(wanted) for name, wanted in exact.items()}
    left = count - sum(numbers.values())
    for name in sorted(exact, key=lambda name: numbers[name] - exact[name])[:left]:
        numbers[name] += 1
    return tuple(name for name, number in numbers.items() for _ in range(number))


def fleet_of(
    config: TrafficConfig,  # Settings from `eyas.engine.traffic.record.resolved`
    duration: float,  # Time until which they enter and drive [s]
    *,
    # Length of street in one direction for each vehicle, at least, of roads that no recipe has
    # drawn, of which not all lead back [m]; None: a recipe has drawn them
    room: float | None = None,
) -> Fleet:
    """Return the vehicles that settings ask for."""
    assert config.seed is not None
    rng = stream(config.seed, "traffic")
    actors = vehicle_types(config)

    def keep_alive(links: Links) -> Iterator[Departure]:
        edges = {name: lasting_edges(links[name]) for name in dict.fromkeys(actors)}
        for name in actors:
            walk = endless_walk(links[name], edges[name], duration * config.max_speed, rng)
            yield Departure(0.0, walk, name, "random_free")

    def coming_and_going(links: Links, room: float) -> Iterator[Departure]:
        leaving: list[tuple[float, int, VehicleType]] = []
        for name in dict.fromkeys(actors):
            roads, loops = links[name], roomy_loops(links[name])
            whole = sum(roads.length.values())
            count = min(actors.count(name), int(whole / (room * len(set(actors)))) + 1)
            share = np.array([roads.length[edge] for edge in loops])
            stay = round(count * share.sum() / max(whole, 1.0))
            stay = min(stay, count - (len(loops) < len(roads.length)))
            for _ in range(stay):
                start = loops[int(np.searchsorted(share.cumsum(), rng.uniform(0, share.sum())))]
                walk = walk_from(start, roads, loops, duration * config.max_speed, rng)
                yield Departure(0.0, walk, name, "random_free")
            leaving += [(0.5 * k, len(leaving) + k, name) for k in range(count - stay)]
        ways = {
            name: ways_through(links[name], roomy_loops(links[name]), rng)
            for name in dict.fromkeys(actors)
        }
        heapq.heapify(leaving)
        while leaving and leaving[0][0] < duration:
            time, number, name = heapq.heappop(leaving)
            way = next(ways[name])
            yield Departure(time, way, name, "base", "max")
            takes = sum(links[name].length[edge] for edge in way) / min(_USUAL, config.max_speed)
            heapq.heappush(leaving, (round(time + takes + 1.0, 1), number, name))

    def respawn(links: Links) -> Iterator[Departure]:
        lengths = config.route_length
        trips = {name: random_trips(links[name], lengths, rng) for name in dict.fromkeys(actors)}
        classes = _shuffled(actors, rng)
        for time, size in departures(config, duration):
            for name in (next(classes) for _ in range(size)):
                yield Departure(time, next(trips[name]), name)

    if config.demand is Demand.RESPAWN:
        return respawn
    if room is None or config.drivers is not Drivers.NORMAL:
        return keep_alive
    return partial(coming_and_going, room=room)


def _shuffled(actors: tuple[VehicleType, ...], rng: np.random.Generator) -> Iterator[VehicleType]:
    """Yield classes without end: all actors in a random order, again and again."""
    if len(set(actors)) == 1:
        yield from repeat(actors[0])
    while True:
        yield from (actors[k] for k in rng.permutation(len(actors)).tolist())
