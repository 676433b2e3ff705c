"""How high things stand, for what flies over them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.bake.ambient import canopy_map, height_map
from eyas.engine.state.scene import Scene
from eyas.engine.state.terrain import reliefs

Floats = NDArray[np.float64]

_TEXEL = 4.0  # Side of the squares in which heights are known [m]
_AROUND = 2  # Squares around a place whose heights count


class Space(NamedTuple):
    """A map, as those see it who fly over it."""

    extent: Floats  # Width and depth [m], shape (2,)
    heights: Callable[[Floats], Floats]
    """Returns how high something stands around points [m], east and north, shape (..., 2)."""


def airspace_of(scene: Scene) -> Space:
    """Return a map as those see it who fly over it."""
    extent = np.array(scene.size)
    columns, rows = np.ceil(extent / _TEXEL).astype(int)
    frame = np.array([*(-0.5 * extent), 1.0 / _TEXEL, scene.terrain.floor])
    shape = (int(rows), int(columns))
    high = np.maximum(height_map(scene, frame, shape), canopy_map(scene, frame, shape))
    high = np.maximum(high, height_map(scene, frame, shape, structures=True))
    high = np.maximum(high, _solids(scene, frame, shape))  # with posts and wires
    wide = np.pad(high, _AROUND)
    near = [
        wide[i : i + shape[0], j : j + shape[1]]
        for i in range(2 * _AROUND + 1)
        for j in range(2 * _AROUND + 1)
    ]
    highest = np.max(near, axis=0)

    def heights(points: NDArray[np.float64]) -> NDArray[np.float64]:
        place = np.floor((points - frame[:2]) * frame[2]).astype(int)
        column = np.clip(place[..., 0], 0, shape[1] - 1)
        row = np.clip(place[..., 1], 0, shape[0] - 1)
        found: NDArray[np.float64] = reliefs(scene.terrain, points) + highest[row, column]
        found += scene.terrain.floor
        return found

    return Space(extent, heights)


def _solids(scene: Scene, frame: Floats, shape: tuple[int, int]) -> Floats:
    """Return the height of the highest collider above the ground in each square [m]."""
    solid, high = scene.colliders, np.zeros(shape)
    radius = solid.cylinder_radius[:, None]
    low_, high_ = solid.cylinder_centre - radius, solid.cylinder_centre + radius
    boxes = [(low_, high_, solid.cylinder_top)]
    if len(solid.prism_top):
        first = solid.prism_first[:-1]
        least = np.minimum.reduceat(solid.prism_points, first)
        most = np.maximum.reduceat(solid.prism_points, first)
        boxes.append((least, most, solid.prism_top))
    for least, most, top in boxes:
        ground = frame[3] + reliefs(scene.terrain, 0.5 * (least + most))
        from_ = np.floor((least - frame[:2]) * frame[2]).astype(int).clip(0)
        to = np.floor((most - frame[:2]) * frame[2]).astype(int) + 1
        for (x, y), (right, up), rise in zip(from_, to, top - ground, strict=True):
            part = high[y:up, x:right]
            np.maximum(part, rise, out=part)
    return high
