"""Routes of vehicles: endless random walks, groups that cross the map and leave, ways through."""

import heapq
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eyas.engine.core.errors import ConfigError
from eyas.engine.traffic.config import TrafficConfig

Route = tuple[str, ...]  # Names of the edges, in driving order

TRIES = 1000  # Number of edge pairs tried for one route before giving up


@dataclass(frozen=True, slots=True)
class RoadLinks:
    """Connections between edges, for one class of vehicles."""

    successors: dict[str, Route]  # Edges that can be entered from each edge
    length: dict[str, float]  # [m]
    turning: frozenset[str] = frozenset()  # Edges at whose ends one can only turn back


def without_turnarounds(
    links: RoadLinks,
    ends: dict[str, tuple[str, str]],  # Junctions that each edge leaves and reaches
) -> RoadLinks:
    """Return the links without U-turns, except where there is no other way on.

    Long vehicles swing out widely in a U-turn, and drivers rarely turn around at a crossing.
    """
    onward = {
        edge: tuple(name for name in following if ends[name] != ends[edge][::-1])
        for edge, following in links.successors.items()
    }
    successors = {edge: onward[edge] or links.successors[edge] for edge in onward}
    turning = frozenset(edge for edge in onward if links.successors[edge] and not onward[edge])
    return RoadLinks(successors, links.length, turning)


def lasting_edges(links: RoadLinks) -> Route:
    """Return the edges of the largest part of the roads where all can be reached from each other.

    Where several parts are the largest, as with roads that never meet, the edges of all of them.

    Raises:
        ConfigError: Every route comes to an end.
    """
    parts = [part for part in _loops(links) if len(part) > 1 or _turns_back(links, part[0])]
    largest = max(map(len, parts), default=0)
    if not largest:
        raise ConfigError(
            "traffic.demand: 'keep_alive' needs roads that form a loop, but all roads of this "
            "map lead out of it; use 'respawn'"
        )
    return tuple(sorted(edge for part in parts if len(part) == largest for edge in part))


_LOOP = 200.0  # Loops of streets below this are driven through, not round and round [m]
_ROUND = 0.4  # Least share of the streets that loops without turning back must have to be used


def roomy_loops(links: RoadLinks) -> Route:
    """Return the edges of all loops in which vehicles may stay, of streets that no recipe has
    drawn: those without a place where one turns back, if these are much of the streets.
    """
    onward = {
        edge: () if edge in links.turning else after for edge, after in links.successors.items()
    }
    found: Route = ()
    for successors in (onward, links.successors):
        parts = _loops(RoadLinks(successors, links.length))
        large = [part for part in parts if _length(links, part) >= _LOOP and len(part) > 1]
        found = tuple(sorted(edge for part in large for edge in part))
        if _length(links, found) >= _ROUND * _length(links, links.successors):
            break
    return found


def ways_through(
    links: RoadLinks,
    known: Iterable[str],  # Edges on which there is traffic without them
    rng: np.random.Generator,
) -> Iterator[Route]:
    """Yield routes from where streets begin, at the border or a dead end, to where they end.

    Each leads over the edge on which the fewest have led so far, of these the longest.
    """
    back: dict[str, list[str]] = {edge: [] for edge in links.successors}
    onward: dict[str, Sequence[str]] = {}
    for edge, following in links.successors.items():
        onward[edge] = () if edge in links.turning else following
        for other in onward[edge]:
            back[other].append(edge)
    to_end = _towards([edge for edge in sorted(onward) if not onward[edge]], back, links.length)
    from_start = _towards([edge for edge in sorted(back) if not back[edge]], onward, links.length)
    driven = dict.fromkeys(sorted(links.successors), 0)
    driven.update(dict.fromkeys(known, 1))
    while True:
        over = min(driven, key=lambda edge: (driven[edge], -links.length[edge]))
        before = _way(over, back, from_start, links.length, rng)[::-1]
        route = (*before[:-1], *_way(over, onward, to_end, links.length, rng))
        for edge in route:
            driven[edge] += 1
        yield route


_ASTRAY = 1500.0  # Longest way at random, before a route takes the shortest way out [m]


def _way(
    edge: str,
    onward: Mapping[str, Sequence[str]],
    shortest: Mapping[str, str],  # The next edge on the shortest way out; of the last, itself
    length: Mapping[str, float],
    rng: np.random.Generator,
) -> list[str]:
    """Return a way from an edge, at random and then to where it ends."""
    way, left = [edge], float(rng.uniform(0.0, _ASTRAY))
    while onward[way[-1]] and left > 0.0:
        way.append(onward[way[-1]][int(rng.integers(len(onward[way[-1]])))])
        left -= length[way[-1]]
    while shortest.get(way[-1], way[-1]) != way[-1]:
        way.append(shortest[way[-1]])
    return way


def _towards(
    goals: list[str], back: Mapping[str, Sequence[str]], length: Mapping[str, float]
) -> dict[str, str]:
    """Return the next edge on the shortest way to a goal, for each from where one is reached."""
    found = {goal: goal for goal in goals}
    front = [(0.0, goal) for goal in goals]
    while front:
        so_far, edge = heapq.heappop(front)
        for other in back[edge]:
            if other not in found:
                found[other] = edge
                heapq.heappush(front, (so_far + length[other], other))
    return found


def _length(links: RoadLinks, edges: Iterable[str]) -> float:
    return sum(links.length[edge] for edge in edges)


def endless_walk(
    links: RoadLinks,
    edges: Route,  # The edges to stay on
    distance: float,  # A distance longer than any vehicle can drive in the recording [m]
    rng: np.random.Generator,  # Generator for the start and the turns
) -> Route:
    """Return a random walk of at least `distance` [m]."""
    return walk_from(edges[int(rng.integers(len(edges)))], links, edges, distance, rng)


def walk_from(
    edge: str, links: RoadLinks, edges: Route, distance: float, rng: np.random.Generator
) -> Route:
    """Return a random walk that begins with an edge; the other arguments as of `endless_walk`."""
    inside = set(edges)
    walk, length = [edge], links.length[edge]
    while length < distance:
        following = [name for name in links.successors[edge] if name in inside]
        edge = following[int(rng.integers(len(following)))]
        walk.append(edge)
        length += links.length[edge]
    return tuple(walk)


def random_trips(
    links: RoadLinks, lengths: tuple[float, float], rng: np.random.Generator
) -> Iterator[Route]:
    """Yield shortest routes between random edges, with a length between two limits [m].

    Raises:
        ConfigError: No such route was found.
    """
    edges = sorted(links.successors)
    trees: dict[str, dict[str, str]] = {}
    while True:
        tried = []
        for _ in range(TRIES):
            start, end = (edges[int(index)] for index in rng.integers(len(edges), size=2))
            if start not in trees:
                trees[start] = _shortest_tree(links, start)
            route = _path(trees[start], start, end)
            if route:
                tried.append(sum(links.length[edge] for edge in route))
                if lengths[0] <= tried[-1] <= lengths[1]:
                    break
        else:
            found = f"{min(tried):.0f} to {max(tried):.0f} m" if tried else "none"
            raise ConfigError(
                f"traffic.route_length: no route of {lengths[0]:g} to {lengths[1]:g} m found in "
                f"{TRIES} tries; allowed: what the map has, about {found}"
            )
        yield route


def departures(
    config: TrafficConfig,  # Settings with a number as `group_size`
    duration: float,  # Time since the first group within which groups enter [s]
) -> Iterator[tuple[float, int]]:
    """Yield the entry time [s] and the number of vehicles of each group."""
    size = config.group_size
    assert size is not None
    left = config.route_count
    group = 0
    while left > 0 and group * config.group_interval <= duration:
        yield group * config.group_interval, min(size, left)
        left -= size
        group += 1


def _turns_back(links: RoadLinks, edge: str) -> bool:
    return edge in links.successors[edge]


def _loops(links: RoadLinks) -> list[list[str]]:
    """Return the edges in parts in which all can be reached from each other.

    Kosaraju's algorithm (in Aho, Hopcroft, Ullman 1983, Data Structures and Algorithms, 6.7): in
    the order in which a search through all edges leaves them last, each search against the traffic
    finds one part.
    """
    before: dict[str, list[str]] = {edge: [] for edge in links.successors}
    for edge, following in links.successors.items():
        for other in following:
            before[other].append(edge)
    seen: set[str] = set()
    order = [edge for start in sorted(before) for edge in _search(links.successors, start, seen)]
    seen.clear()
    parts = [_search(before, edge, seen) for edge in reversed(order)]
    return [part for part in parts if part]


def _search(links: Mapping[str, Sequence[str]], start: str, seen: set[str]) -> list[str]:
    """Return what can be reached and was not seen, in the order in which it is left."""
    if start in seen:
        return []
    seen.add(start)
    left: list[str] = []
    open_ = [(start, iter(links[start]))]
    while open_:
        edge, rest = open_[-1]
        fresh = next((other for other in rest if other not in seen), None)
        if fresh is None:
            left.append(edge)
            open_.pop()
        else:
            seen.add(fresh)
            open_.append((fresh, iter(links[fresh])))
    return left


def _shortest_tree(links: RoadLinks, start: str) -> dict[str, str]:
    """Return the predecessor of each edge on the shortest route from `start` (Dijkstra)."""
    distance = {start: links.length[start]}
    before: dict[str, str] = {}
    front = [(distance[start], start)]
    while front:
        so_far, edge = heapq.heappop(front)
        if so_far > distance[edge]:
            continue
        for following in links.successors[edge]:
            total = so_far + links.length[following]
            if total < distance.get(following, float("inf")):
                distance[following] = total
                before[following] = edge
                heapq.heappush(front, (total, following))
    return before


def _path(before: dict[str, str], start: str, end: str) -> Route:
    """Return the edges from `start` to `end`; empty if there is no route."""
    route = [end]
    while route[-1] != start:
        if route[-1] not in before:
            return ()
        route.append(before[route[-1]])
    return tuple(reversed(route))
