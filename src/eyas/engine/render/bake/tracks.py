"""Map of the tracks that wheels leave in the snow on roads."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import Scene
from eyas.lanes import exact

TEXEL = 0.3  # Side of a texel, unless there would be too many [m]

MOST_TEXELS = 30_000_000  # Largest number of texels: 57 MiB

TRACK_ASIDE = 0.78
"""Distance of a track from the middle of the lane [m]; same as the dark tracks in the asphalt."""

_STEP = 0.2
"""Distance between the points of a lane whose texels are marked [m]; small enough to miss none."""

_HALF = 1.7  # Distance from the middle of a lane up to which cars drive on the snow [m]

_OTHERS = ((0.0, 1.0), (0.26, 0.5), (-0.3, 0.4))
"""Paths of cars: distance beside the usual path [m], and relative wear."""

_STRAIGHT, _BACK = np.radians(50.0), np.radians(150.0)
"""Angles up to which a path over a junction leads straight on, and from which it turns back."""

_NEAR, _FAR = 0.9, 2.4
"""Lengths over which the map is blurred, and blurred again for distant views: slightly more than a
lane's tracks [m]."""

_STREAK = 4.0, 0.6  # Length and width of the streaks of slush that wheels draw out along a lane [m]

_ROOF = (3.0, 12.0)  # Least and largest height of what keeps the snow off the road below it [m]

_MARGIN = 6.0  # Between the lanes and the edges of the map [m]

Line = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class TrackMap:
    """Wear of the snow on roads."""

    worn: NDArray[np.uint8]
    """0 for fresh snow to 255 for wet asphalt; then the same blurred, for pixels that are larger
    than tracks; shape (rows, columns, 2)."""
    frame: NDArray[np.float64]  # West and south edge [m], texels per metre

    @classmethod
    def empty(cls) -> "TrackMap":
        """Return a map without tracks."""
        return cls(np.zeros((2, 2, 2), np.uint8), np.array([0.0, 0.0, 1.0]))


def kept_track_map(
    scene: Scene,
    folder: Path | None = None,  # Folder of the cache; None: the user's
) -> TrackMap:
    """Return the `track_map` of a scene, kept in the cache."""
    inputs, make = (scene.network, scene.colliders), partial(track_map, scene)
    return cached(EntryKind.AMBIENT, make, inputs, of=TrackMap, folder=folder)


def track_map(scene: Scene) -> TrackMap:
    """Return the tracks of all lanes, and of the paths from lane to lane over junctions.

    Where a roof covers the road, as in tunnels, no snow lies.
    """
    network = scene.network
    if len(network.lane_points) == 0:
        return TrackMap.empty()
    low = network.lane_points.min(axis=0) - _MARGIN
    extent = network.lane_points.max(axis=0) + _MARGIN - low
    texel = max(TEXEL, float(np.sqrt(extent.prod() / MOST_TEXELS)))
    size = np.ceil(extent / texel).astype(int)
    worn = np.zeros((size[1], size[0]), np.float32)
    ways = [(line, 1.0) for line in _lanes(network)] + [(way, 0.75) for way in _crossings(network)]
    stations = [_stations(line) for line, _ in ways]
    middle = np.concatenate([points for points, _ in stations])
    left = np.concatenate([normal for _, normal in stations])
    # Paths wander and their wear varies, from lane to lane too; neighbouring points agree.
    sway, uneven = _waves(middle, 11.0, 1), _waves(middle, 23.0, 2)
    wander = 0.12 * sway + 0.36 * _waves(middle, 37.0, 4)
    share = np.random.default_rng(5).uniform(0.72, 1.0, len(ways))
    strength = np.array([much for _, much in ways]) * share
    strength = np.repeat(strength, [len(points) for points, _ in stations])
    along = np.concatenate([_STEP * np.arange(len(points)) for points, _ in stations])
    way = np.repeat(np.arange(len(ways)), [len(points) for points, _ in stations])
    for across in np.arange(-_HALF, _HALF + _STEP, _STEP):
        cell = ((middle + across * left - low) / texel).astype(int)
        inside = ((cell >= 0) & (cell < size)).all(axis=1)
        # Of the texel's own centre: the lattice would show as rungs across the tracks.
        away = low + (cell + 0.5) * texel - middle
        aside = (away * left).sum(axis=1)
        onward = along + away[:, 0] * left[:, 1] - away[:, 1] * left[:, 0]
        much = strength * (0.8 + 0.26 * uneven + 0.3 * _streaks(way, onward, aside))
        much *= _profile(aside + wander)
        np.maximum.at(worn, (cell[inside, 1], cell[inside, 0]), much[inside].astype(np.float32))
    worn = _sheltered(scene, worn, low, texel)
    near = blurred(worn, max(round(_NEAR / texel), 1))
    both = np.empty((*worn.shape, 2), np.uint8)
    for index, map_ in enumerate((near, blurred(near, max(round(_FAR / texel), 1)))):
        both[..., index] = np.round(255.0 * map_)
    return TrackMap(both, np.array([*low, 1.0 / texel]))


def _sheltered(
    scene: Scene, worn: NDArray[np.float32], low: Line, texel: float
) -> NDArray[np.float32]:
    """Return the wear with all snow gone below roofs."""
    solids = scene.colliders
    roofs = (solids.prism_bottom >= _ROOF[0]) & (solids.prism_bottom <= _ROOF[1])
    if not roofs.any():
        return worn
    from PIL import Image, ImageDraw  # for few maps, and only when it snows

    picture = Image.fromarray(worn)
    pen = ImageDraw.Draw(picture)
    for roof in np.flatnonzero(roofs):
        outline = solids.prism_points[solids.prism_first[roof] : solids.prism_first[roof + 1]]
        pen.polygon(((outline - low) / texel).ravel().tolist(), fill=1.0)
    return np.array(picture, np.float32)


def _profile(aside: Line) -> Line:
    """Return the wear of the snow beside the middle of a lane [m], 0 to 1."""
    worn = 0.42 * np.clip((_HALF - np.abs(aside)) / 0.7, 0.0, 1.0)
    for other, much in _OTHERS:
        off = np.abs(np.abs(aside + other) - TRACK_ASIDE)
        worn = np.maximum(worn, much * np.clip((0.56 - off) / 0.4, 0.0, 1.0))
    return worn


def _lanes(network: RoadNetwork) -> list[Line]:
    return [network.lane_points[low:high] for low, high in pairwise(network.lane_first)]


def _crossings(network: RoadNetwork) -> Iterator[Line]:
    """Yield the paths over junctions: straight on in each lane, and turns from the outer lanes."""
    lines = _lanes(network)
    lanes = [np.flatnonzero(network.lane_edge == edge) for edge in range(len(network.edges))]
    for here, end in enumerate(network.edge_end):
        for there, start in enumerate(network.edge_start):
            if start != end:
                continue
            from_, onto = np.diff(lines[lanes[here][0]][-2:], axis=0)[0], lines[lanes[there][0]]
            ahead = onto[1] - onto[0]
            angle = exact.atan2(
                from_[0] * ahead[1] - from_[1] * ahead[0], exact.product(from_, ahead)
            )
            if abs(angle) > _BACK:
                continue
            ins, outs = lanes[here], lanes[there]
            count = min(len(ins), len(outs))
            if abs(angle) < _STRAIGHT:
                pairs = list(zip(ins[:count], outs[:count], strict=True))
            else:
                pairs = [(ins[-1], outs[-1]) if angle > 0 else (ins[0], outs[0])]
            for one, other in pairs:
                yield _bent(lines[one], lines[other])


def _bent(arriving: Line, leaving: Line) -> Line:
    """Return a cubic Bezier curve from the end of one lane to the start of another."""
    start, end = arriving[-1], leaving[0]
    reach = 0.45 * exact.length(end - start)
    toward, away = np.diff(arriving[-2:], axis=0)[0], leaving[1] - leaving[0]
    one = start + reach * toward / exact.length(toward)
    other = end - reach * away / exact.length(away)
    t = np.linspace(0.0, 1.0, 12)[:, None]
    s = 1.0 - t
    return np.asarray(
        exact.power(s, 3) * start
        + 3 * np.square(s) * t * one
        + 3 * s * np.square(t) * other
        + exact.power(t, 3) * end
    )


def _stations(line: Line) -> tuple[Line, Line]:
    """Return points every `_STEP` along a line, and directions to its left, shape (K, 2) each."""
    pieces = np.diff(line, axis=0)
    length = np.linalg.norm(pieces, axis=1)
    along = np.concatenate([[0.0], np.cumsum(length)])
    at = np.arange(0.0, along[-1], _STEP)
    points = np.column_stack([np.interp(at, along, line[:, k]) for k in range(2)])
    ahead = pieces / np.maximum(length, 1e-9)[:, None]
    way = ahead[np.clip(np.searchsorted(along, at, "right") - 1, 0, len(ahead) - 1)]
    return points, np.column_stack([-way[:, 1], way[:, 0]])


def _waves(points: Line, length: float, seed: int) -> Line:
    """Return smooth noise, about -1 to 1, with features of a given length [m]: a sum of waves."""
    rng = np.random.default_rng(seed)
    angle, phase = rng.uniform(0, 2 * np.pi, 6), rng.uniform(0, 2 * np.pi, 6)
    number = 2 * np.pi / (length * rng.uniform(0.7, 1.6, 6))
    way = np.stack([exact.cos(angle), exact.sin(angle)]) * number
    return np.asarray(exact.sin(exact.product(points, way) + phase).sum(axis=1) / 2.5)


def _streaks(
    way: NDArray[np.int64],  # Number of each point's lane or path, shape (K,)
    along: Line,  # Its place along it [m], shape (K,)
    aside: Line,  # Its distance from the middle [m], shape (K,)
) -> Line:
    """Return noise drawn out along lanes, -1 to 1: value noise of the lanes' coordinates."""
    length, width = _STREAK
    table = np.random.default_rng(3).uniform(-1.0, 1.0, (256, 256))
    row, column = along / length, aside / width
    i, j = np.floor(row).astype(np.int64), np.floor(column).astype(np.int64)
    u, v = row - i, column - j
    near, far = (
        (1.0 - v) * table[each % 256, (7 * way + j) % 256]
        + v * table[each % 256, (7 * way + j + 1) % 256]
        for each in (i, i + 1)
    )
    return np.asarray((1.0 - u) * near + u * far)


def blurred(values: NDArray[np.float32], texels: int) -> NDArray[np.float32]:
    """Return means over squares of so many texels; all values beyond the edges are 0."""
    if texels == 1:
        return values
    for axis in (0, 1):
        before = [(0, 0), (0, 0)]
        before[axis] = (texels // 2 + 1, texels - texels // 2)
        sums = np.cumsum(np.pad(values, before), axis=axis, dtype=np.float64)
        count = values.shape[axis]
        high = np.take(sums, np.arange(texels, texels + count), axis=axis)
        mean = (high - np.take(sums, np.arange(count), axis=axis)) / texels
        values = mean.astype(np.float32)
    return np.clip(values, 0.0, 1.0)
