from itertools import islice, pairwise

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.traffic.config import Demand, TrafficConfig
from eyas.engine.traffic.demand import (
    RoadLinks,
    departures,
    endless_walk,
    lasting_edges,
    random_trips,
    without_turnarounds,
)

# A square a > b > c > d > a with a way in (i > a) and a way out (c > o).
SQUARE = RoadLinks(
    successors={"i": ("a",), "a": ("b",), "b": ("c",), "c": ("d", "o"), "d": ("a",), "o": ()},
    length={"i": 10.0, "a": 100.0, "b": 100.0, "c": 100.0, "d": 100.0, "o": 50.0},
)
ONE_WAY = RoadLinks(successors={"i": ("o",), "o": ()}, length={"i": 10.0, "o": 20.0})


def test_lasting_edges_are_those_of_the_square():
    assert lasting_edges(SQUARE) == ("a", "b", "c", "d")


def test_roads_that_all_lead_out_cannot_keep_cars_alive():
    with pytest.raises(ConfigError, match="use 'respawn'"):
        lasting_edges(ONE_WAY)


def test_a_walk_is_long_enough_and_stays_inside():
    walk = endless_walk(SQUARE, lasting_edges(SQUARE), 5000.0, np.random.default_rng(0))
    assert sum(SQUARE.length[edge] for edge in walk) >= 5000.0
    assert set(walk) == {"a", "b", "c", "d"}
    assert all(after in SQUARE.successors[before] for before, after in pairwise(walk))


def test_turnarounds_stay_only_in_dead_ends():
    ends = {"up": ("s", "n"), "down": ("n", "s"), "on": ("n", "m"), "back": ("m", "n")}
    links = RoadLinks(
        {"up": ("down", "on"), "down": ("up",), "on": ("back",), "back": ("down",)},
        dict.fromkeys(ends, 1.0),
    )
    onward = without_turnarounds(links, ends).successors
    assert onward == {"up": ("on",), "down": ("up",), "on": ("back",), "back": ("down",)}


def test_of_roads_that_never_meet_all_the_largest_last():
    links = {"a": ("b",), "b": ("a",), "c": ("d",), "d": ("c",), "e": ("e",)}
    apart = RoadLinks(links, dict.fromkeys(links, 1.0))
    assert lasting_edges(apart) == ("a", "b", "c", "d")


def test_trips_are_shortest_routes_within_the_limits():
    trips = list(islice(random_trips(SQUARE, (150.0, 320.0), np.random.default_rng(1)), 50))
    for trip in trips:
        assert 150.0 <= sum(SQUARE.length[edge] for edge in trip) <= 320.0
        assert all(after in SQUARE.successors[before] for before, after in pairwise(trip))
        assert len(set(trip)) == len(trip)
    assert len(set(trips)) > 5


def test_limits_that_no_route_meets_are_an_error():
    with pytest.raises(ConfigError, match=r"no route of 900 to 1000 m .* about 10 to 450 m"):
        next(random_trips(SQUARE, (900.0, 1000.0), np.random.default_rng(1)))


def test_groups_enter_at_intervals_until_the_routes_are_used_up():
    config = TrafficConfig(demand=Demand.RESPAWN, group_size=4, group_interval=10.0, route_count=10)
    assert list(departures(config, 100.0)) == [(0.0, 4), (10.0, 4), (20.0, 2)]
    assert list(departures(config, 15.0)) == [(0.0, 4), (10.0, 4)]


@pytest.mark.parametrize("seed", range(20))
def test_the_lasting_edges_of_any_roads_reach_each_other_and_no_larger_part_does(seed):
    rng = np.random.default_rng(seed)
    names = [f"e{k:02d}" for k in range(30)]
    following = {name: tuple(rng.choice(names, int(rng.integers(3)))) for name in names}
    reach = {name: set(following[name]) for name in names}
    for _ in names:
        reach = {name: on.union(*(following[other] for other in on)) for name, on in reach.items()}
    parts = {frozenset(b for b in reach[a] if a in reach[b]) for a in names}
    largest = max(map(len, parts))
    links = RoadLinks(following, dict.fromkeys(names, 1.0))
    if largest:
        wanted = {name for part in parts if len(part) == largest for name in part}
        assert lasting_edges(links) == tuple(sorted(wanted))
    else:
        with pytest.raises(ConfigError):
            lasting_edges(links)


def test_a_very_long_loop_is_no_burden():
    names = [f"e{k:05d}" for k in range(20_000)]  # one step of each search for each edge
    links = {name: (names[(k + 1) % len(names)],) for k, name in enumerate(names)}
    assert len(lasting_edges(RoadLinks(links, dict.fromkeys(names, 1.0)))) == len(names)
