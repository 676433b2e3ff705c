"""Sites of losses: things over roads, each with all the losses that happen below it.

What a policy does below one roof says little of another, so that a site is one observation. An
episode names it in its variant, as in `turn,25-60m@412`: the way below it, the length that is
hidden, and the object of the scene.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.first_fitting import first_fitting
from eyas.benchmark.episodes.from_above import seen_from_above
from eyas.benchmark.episodes.target_losses import (
    BEGUN,
    PERIOD,
    SEARCH_LIMIT,
    TargetLoss,
    hidden_spans,
    moved,
)
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.sim.scenes import load_network, load_scene
from eyas.engine.world.roads.areas import joints
from eyas.lanes import exact

_LENGTH = (1.0, 30.0)  # Shortest and longest loss [s]
_MOST = 2  # Losses that count: two roofs in a row, or two sites
_FAR = 10.0  # Least distance between where a target vanishes and where it comes out [m]
_OVERHEAD = 5.0  # Least height of what stands over a road [m]
_STRAIGHT = 0.866  # Cosine of the least turn that counts: 30 degrees
_LENGTHS = (25.0, 60.0)  # Borders of the groups of hidden ways [m]
_OFTEN = 100
"""Number of starts after which a site may come once more: else, those on busy roads would be most
of the episodes."""

Floats = NDArray[np.float64]


def losses_at_sites(episodes: Sequence[EpisodeSpec], protocol: Protocol) -> list[list[TargetLoss]]:
    """Return the losses of each episode; empty for episodes that the protocol does not choose.

    The first begins below a thing over the road. One or two of 1 to 30 s count, and of those in
    which the target comes out 10 m from where it vanished, or farther; later ones do not.
    """
    return [losses for losses, _ in _losses_and_sites(episodes, protocol)]


def at_sites(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the first episodes of each place and direction with losses, at all sites in turn.

    Raises:
        SpawnError: There are too few.
    """
    visits, named = Counter[tuple[str, str]](), dict[EpisodeSpec, str]()

    def fits(episodes: Sequence[EpisodeSpec], protocol: Protocol) -> list[bool]:
        labels = [label for _, label in _losses_and_sites(episodes, protocol)]
        fitting = []
        for episode, label in zip(episodes, labels, strict=True):
            site = episode.place.map, label.partition("@")[2]
            fitting.append(bool(label) and visits[site] <= (episode.seed - first_seed) // _OFTEN)
            visits[site] += fitting[-1]
            named[episode] = label
        return fitting

    chosen = first_fitting(
        places, protocol, count, first_seed, fits=fits, wanted="losses below a thing over the road"
    )
    return [episode._replace(variant=named[episode]) for episode in chosen]


def kind_of(variant: str) -> tuple[str, str]:
    """Return the way and the hidden length that an episode names."""
    way, _, length = variant.partition("@")[0].partition(",")
    return way, length


def _losses_and_sites(
    episodes: Sequence[EpisodeSpec], protocol: Protocol
) -> Iterator[tuple[list[TargetLoss], str]]:
    """Yield the losses of each episode and the name of its first site; none where it has none."""
    last = protocol.steps * protocol.period - SEARCH_LIMIT
    paths = seen_from_above(episodes, protocol, PERIOD)
    for episode, shares, path in zip(episodes, *paths, strict=True):
        spans, label = hidden_spans(shares), ""
        losses = [one for one in spans if one.end - one.start >= _LENGTH[0] and one.end <= last]
        losses = losses[:_MOST]
        if (
            losses
            and spans[0].start >= 1.0
            and losses[0].start >= BEGUN
            and all(one.end - one.start <= _LENGTH[1] for one in losses)
            and all(moved(path, one) >= _FAR for one in losses)
        ):
            begin, end = (round(time / PERIOD) - 1 for time in losses[0])
            label = _label(path[max(begin - 1, 0) : end + 1], *episode.place.town)
        yield losses if label else [], label


def _label(path: Floats, map_name: str, seed: int) -> str:
    shapes, objects = _overhead(map_name, seed)
    above = shapes.query(shapely.Point(path[len(path) // 2]), predicate="within")
    if not len(above):
        return ""
    steps = np.diff(path, axis=0)
    lengths = np.asarray(exact.hypot(*steps.T))
    moved = np.flatnonzero(lengths > 0.5)
    way = "straight"
    if len(_junctions(map_name, seed).query(shapely.LineString(path), predicate="intersects")):
        way = "junction"
    if len(moved):
        first, last = steps[moved[0]] / lengths[moved[0]], steps[moved[-1]] / lengths[moved[-1]]
        way = way if first[0] * last[0] + first[1] * last[1] > _STRAIGHT else "turn"
    low, high = _LENGTHS
    length = float(lengths.sum())
    group = (
        f"-{low:g}m" if length < low else f"{low:g}-{high:g}m" if length < high else f"{high:g}m-"
    )
    return f"{way},{group}@{objects[above[0]]}"


@lru_cache(maxsize=16)
def _overhead(map_name: str, seed: int) -> tuple[shapely.STRtree, NDArray[np.int32]]:
    """Return what stands over the ground of a map, and its objects."""
    scene = load_scene(map_name, seed)
    solid = scene.colliders
    high = np.flatnonzero(solid.prism_bottom > scene.terrain.floor + _OVERHEAD)
    spans = list(pairwise(solid.prism_first.tolist()))
    shapes = [shapely.Polygon(solid.prism_points[slice(*spans[prism])]) for prism in high]
    return shapely.STRtree(shapes), solid.prism_object[high]


@lru_cache(maxsize=16)
def _junctions(map_name: str, seed: int) -> shapely.STRtree:
    """Return the junctions of three roads or more."""
    network = load_network(map_name, seed)
    roads, spans = joints(network), pairwise(network.junction_first.tolist())
    shapes = [
        shapely.Polygon(network.junction_points[low:high])
        for name, (low, high) in zip(network.junctions, spans, strict=True)
        if roads[name] >= 3 and high - low >= 3
    ]
    return shapely.STRtree(shapes)
