"""What age leaves on roads: dark tracks along lanes, repaired patches, lids of manholes.

All of it lies in thin layers above the asphalt and below the paint.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.state.mesh import Mesh, concatenate
from eyas.state.roads import RoadNetwork
from eyas.world.materials import TEXTURES, material
from eyas.world.roads import split_on_grid
from eyas.world.shapes import flat_polygon, quads

__all__ = ["WEAR_HEIGHTS", "road_wear"]

WEAR_HEIGHTS = (0.003, 0.006, 0.009)
"""z of tracks, patches and lids: between the asphalt and the paint [m]."""

_TRACK = material("asphalt", (0.94, 0.94, 0.94))
_TRACK_HALF, _TRACK_ASIDE = 0.28, 0.78
"""Half the width of a tyre track, and its distance from the middle of the lane [m]."""

_PATCH = material("asphalt_patch")
_PATCH_EVERY = 46.0
"""Mean distance of two patches along a lane [m]."""
_PATCH_LENGTH, _PATCH_WIDTH = (1.5, 6.5), (0.9, 2.6)

_LID = material("manhole")
_LID_EVERY = 62.0
_LID_RADIUS = 0.38
_LID_CORNERS = 12

Line = NDArray[np.float64]


def road_wear(network: RoadNetwork, rng: np.random.Generator) -> Mesh:
    """Return tracks, patches and lids of all lanes.

    Args:
        network: The roads.
        rng: Of the map; says where patches and lids are.
    """
    tracks, patches, lids = [], [], []
    for low, high in pairwise(network.lane_first):
        lane = shapely.LineString(network.lane_points[low:high])
        for side in (-_TRACK_ASIDE, _TRACK_ASIDE):
            middle = shapely.offset_curve(lane, side)
            tracks.append(shapely.buffer(middle, _TRACK_HALF, cap_style="flat"))
        for start in _places(lane.length, _PATCH_EVERY, rng):
            half_width = rng.uniform(*_PATCH_WIDTH) / 2
            end = start + rng.uniform(*_PATCH_LENGTH)
            middle = rng.uniform(-1.5 + half_width, 1.5 - half_width)
            patches.append(_beside(lane, start, end, middle - half_width, middle + half_width))
        lids += [
            _beside(lane, at, at, rng.uniform(-0.5, 0.5), 0.0)[0]
            for at in _places(lane.length, _LID_EVERY, rng)
        ]
    return concatenate(
        [
            *(_flat(track) for track in tracks),
            _slabs(patches, WEAR_HEIGHTS[1]),
            *(_lid(centre) for centre in lids),
        ]
    )


def _places(length: float, every: float, rng: np.random.Generator) -> Line:
    """Return places along a lane, not near its ends [m]."""
    count = rng.poisson(length / every)
    return np.sort(rng.uniform(5.0, max(length - 14.0, 5.0), count))


def _beside(lane: shapely.LineString, start: float, end: float, right: float, left: float) -> Line:
    """Return the corners of a rectangle along a lane, counter-clockwise, shape (4, 2) [m]."""
    from_, onward = (shapely.get_coordinates(lane.interpolate(s))[0] for s in (start, start + 0.5))
    along = (onward - from_) / np.linalg.norm(onward - from_)
    across = np.array([-along[1], along[0]])
    reach = end - start
    corners = [(0.0, right), (reach, right), (reach, left), (0.0, left)]
    return np.array([from_ + x * along + y * across for x, y in corners])


def _flat(track: shapely.Geometry) -> Mesh:
    pieces: Sequence[shapely.Polygon] = split_on_grid(track)
    tile = TEXTURES["asphalt"]
    return concatenate([flat_polygon(piece, WEAR_HEIGHTS[0], _TRACK, tile) for piece in pieces])


def _slabs(patches: Sequence[Line], z: float) -> Mesh:
    flat = np.array(patches).reshape(-1, 4, 2)
    corners = np.concatenate([flat, np.full((len(flat), 4, 1), z)], axis=2)
    return quads(corners, flat / TEXTURES["asphalt_patch"], _PATCH)


def _lid(centre: Line) -> Mesh:
    """Return a round lid, its whole texture on it once."""
    turn = np.arange(_LID_CORNERS) * 2 * np.pi / _LID_CORNERS
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    mesh = flat_polygon(shapely.Polygon(centre + _LID_RADIUS * ring), WEAR_HEIGHTS[2], _LID, 1.0)
    mesh.uvs = ((mesh.positions[:, :2] - centre) / (2 * _LID_RADIUS) + 0.5).astype(np.float32)
    return mesh
