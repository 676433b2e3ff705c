"""Traces of age on roads: tyre tracks, repaired patches, sealed cracks, oil, manhole lids.

All of it lies in thin layers above the asphalt and below the paint.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import quads
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.materials import TEXTURES, material
from eyas.engine.world.build.millimetres import unit
from eyas.engine.world.roads.areas import GRID
from eyas.lanes import exact

WEAR_HEIGHTS = (0.003, 0.006, 0.009)
"""z of tracks; of patches and oil; of lids and seals: between the asphalt and the paint [m]."""

_LANES = (
    material("asphalt_lane"),
    material("asphalt_lane", (0.92, 0.92, 0.93)),
    material("asphalt_lane", (1.0, 0.98, 0.96)),
)
"""Asphalt of the lanes, which were not all paved in the same year."""
_LANE_HALF = 1.6  # Half the width of the strip in which tyres run [m]

_PATCH = material("asphalt_patch")
_PATCH_EVERY = 46.0  # Mean distance between two patches along a lane [m]
_PATCH_LENGTH, _PATCH_WIDTH = (1.5, 6.5), (0.9, 2.6)
_WAITING = (0.5, 13.0)  # Range in which cars wait, backwards from the end of a lane [m]
_OIL = material("asphalt_oil")
_OIL_HALF = 0.8

_LID = material("manhole")
_LID_EVERY = 62.0
_LID_HALF = 0.48  # Half the side of a lid with the asphalt around it [m]

_SEAL = material("asphalt_patch", (0.62, 0.62, 0.64))
_SEAL_EVERY = 120.0  # Mean distance between two sealed cracks along a lane [m]
_SEAL_HALF = 0.045
_SEAL_STEPS = 6

_NARROWEST = 3.0  # Narrower lanes of towns have no wear [m]

Line = NDArray[np.float64]


def road_wear(network: RoadNetwork, rng: np.random.Generator, apart: float = 1.0) -> Mesh:
    """Return the wear of all lanes, the upper layers first.

    Args:
        apart: Factor on the distances between these; larger for very long roads.
    """
    tracks, seals, patches, lids, oil = [], [], [], [], []
    for low, high in pairwise(network.lane_first):
        lane = shapely.LineString(network.lane_points[low:high])
        paved = _LANES[int(rng.integers(len(_LANES)))]
        tracks.append(_tracks(lane, float(rng.random()), paved))
        for start in _places(lane.length, apart * _PATCH_EVERY, rng):
            half_width = rng.uniform(*_PATCH_WIDTH) / 2
            end = start + rng.uniform(*_PATCH_LENGTH)
            middle = rng.uniform(-1.5 + half_width, 1.5 - half_width)
            patches.append(_beside(lane, start, end, middle - half_width, middle + half_width))
        if lane.length > 3 * _WAITING[1]:
            start, end = lane.length - _WAITING[1], lane.length - _WAITING[0]
            oil.append(_beside(lane, start, end, -_OIL_HALF, _OIL_HALF))
        for at in _places(lane.length, apart * _LID_EVERY, rng):
            aside = rng.uniform(-0.5, 0.5)
            sides = (at - _LID_HALF, at + _LID_HALF, aside - _LID_HALF, aside + _LID_HALF)
            lids.append(_beside(lane, *sides))
        seals += [_seal(lane, at, rng) for at in _places(lane.length, apart * _SEAL_EVERY, rng)]
    flat = _slabs(patches, WEAR_HEIGHTS[1], _PATCH)
    flat.uvs = (flat.positions[:, :2] / TEXTURES["asphalt_patch"]).astype(np.float32)
    stains = _slabs(oil, WEAR_HEIGHTS[1], _OIL)
    stains.uvs[:, 1] *= (_WAITING[1] - _WAITING[0]) / TEXTURES["asphalt_oil"]
    top_down = [*_clear_of(lids, seals), _slabs(lids, WEAR_HEIGHTS[2], _LID), flat, stains, *tracks]
    return concatenate(top_down)


def _clear_of(lids: Sequence[Line], seals: Sequence[Mesh]) -> list[Mesh]:
    """Return the seals that touch no lid, which lies at their height."""
    if not lids or not seals:
        return list(seals)
    around = [shapely.MultiPoint(seal.positions[:, :2]).convex_hull for seal in seals]
    touching = shapely.STRtree(shapely.polygons(np.array(lids))).query(around, "intersects")[0]
    return [seal for k, seal in enumerate(seals) if k not in touching]


def worn_lanes(network: RoadNetwork, shortest: float) -> RoadNetwork:
    """Return only those lanes that are at least so long [m], and wide enough to show wear."""
    kept, first, points = [], [0], []
    for lane in range(len(network.lane_width)):
        line = network.lane_points[network.lane_first[lane] : network.lane_first[lane + 1]]
        long = shapely.length(shapely.LineString(line)) >= shortest
        if long and network.lane_width[lane] >= _NARROWEST:
            kept.append(lane)
            points.append(line)
            first.append(first[-1] + len(line))
    chosen = np.array(kept, np.int64)
    return replace(
        network,
        lane_points=np.concatenate([np.zeros((0, 2)), *points]),
        lane_first=np.array(first, np.int32),
        lane_width=network.lane_width[chosen],
        lane_speed=network.lane_speed[chosen],
        lane_edge=network.lane_edge[chosen],
        lane_index=network.lane_index[chosen],
    )


def _places(length: float, every: float, rng: np.random.Generator) -> Line:
    """Return positions along a lane, away from its ends [m]."""
    count = rng.poisson(length / every)
    return np.sort(rng.uniform(5.0, max(length - 22.0, 5.0), count))


def _beside(lane: shapely.LineString, start: float, end: float, right: float, left: float) -> Line:
    """Return the corners of a rectangle along a lane, counter-clockwise, shape (4, 2) [m]."""
    from_, onward = (shapely.get_coordinates(lane.interpolate(s))[0] for s in (start, start + 0.5))
    along = unit(onward - from_)
    across = np.array([-along[1], along[0]])
    reach = end - start
    corners = [(0.0, right), (reach, right), (reach, left), (0.0, left)]
    return np.array([from_ + x * along + y * across for x, y in corners])


def _tracks(lane: shapely.LineString, start: float, paved: Material) -> Mesh:
    """Return the strip of a lane in which tyres run; it is one texture wide."""
    middle = shapely.get_coordinates(shapely.segmentize(lane, GRID))
    along = np.gradient(middle, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = _LANE_HALF * np.stack([-along[:, 1], along[:, 0]], axis=1)
    right, left = middle - across, middle + across
    outline = np.stack([right[:-1], right[1:], left[1:], left[:-1]], axis=1)
    corners = np.concatenate([outline, np.full((len(outline), 4, 1), WEAR_HEIGHTS[0])], axis=2)
    gone = np.linalg.norm(np.diff(middle, axis=0), axis=1).cumsum() / TEXTURES["asphalt_lane"]
    v = np.stack([np.append(0.0, gone[:-1]), gone, gone, np.append(0.0, gone[:-1])], axis=1)
    u = np.broadcast_to([0.0, 0.0, 1.0, 1.0], v.shape)
    return quads(corners, np.stack([u, v + start], axis=2), paved)


def _seal(lane: shapely.LineString, at: float, rng: np.random.Generator) -> Mesh:
    """Return a crack sealed with tar: a thin, wandering line across or along a lane."""
    here, there = (shapely.get_coordinates(lane.interpolate(s))[0] for s in (at, at + 0.5))
    onwards = unit(there - here)
    leftwards = np.array([-onwards[1], onwards[0]])
    crossing = rng.random() < 0.6
    way, aside = (leftwards, onwards) if crossing else (onwards, leftwards)
    reach = rng.uniform(1.1, 1.6) if crossing else rng.uniform(2.0, 4.5)
    steps = np.linspace(-reach, reach, _SEAL_STEPS)
    wander = np.clip(np.cumsum(exact.normal(rng, 0.0, 0.16, _SEAL_STEPS)), -1.0, 1.0)
    line = here + steps[:, None] * way + (wander - wander.mean())[:, None] * aside
    width = _SEAL_HALF * rng.uniform(0.7, 1.3, _SEAL_STEPS)[:, None] * aside
    one, other = line - width, line + width
    strip = np.stack([one[:-1], one[1:], other[1:], other[:-1]], axis=1)
    return _slabs(strip if not crossing else strip[:, ::-1], WEAR_HEIGHTS[2], _SEAL)


def _slabs(rectangles: Sequence[Line] | Line, z: float, kind: Material) -> Mesh:
    """Return flat quadrilaterals, u across them and v along, the whole texture on each."""
    flat = np.asarray(rectangles).reshape(-1, 4, 2)
    corners = np.concatenate([flat, np.full((len(flat), 4, 1), z)], axis=2)
    uvs = np.broadcast_to([(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)], flat.shape)
    return quads(corners, uvs, kind)
