"""Hills all round the horizon, as a panorama: computed once for a map's hills and a sun."""

import functools

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.bake.clouds import plan_directions
from eyas.engine.render.kernels.bundles import Geometry
from eyas.engine.render.kernels.sky.fog import HAZE_END
from eyas.engine.render.kernels.sky.radiance import HILL_FARTHEST, HILL_TOP
from eyas.engine.render.kernels.surface.texture import LAST_TEXEL
from eyas.engine.render.pack.clusters import corners_of
from eyas.engine.render.pack.triangles import materials_of
from eyas.engine.render.textures.fields import SIZE, Field, blurred, fractal, source
from eyas.engine.state.lighting import Horizon
from eyas.lanes import exact

_ROWS, _COLUMNS = 96, 4096
_STEPS = 96
_TEXEL = 9.0 / SIZE  # Side of a texel of the land [km]


@functools.lru_cache(maxsize=4)
def build_hills(
    horizon: Horizon,  # Kind of hills
    sun: tuple[float, float, float],  # Unit vector towards the sun
) -> NDArray[np.uint8]:
    """Return the hills as seen from the centre of the map.

    Returns:
        Cover, sunlight, woods, and distance from `HAZE_END` to `HILL_FARTHEST`, each 0 to 255
        for 0 to 1; rows go up to `HILL_TOP`; shape (rows, columns, 4).
    """
    away = exact.geomspace(HAZE_END, HILL_FARTHEST, _STEPS)
    column, row = np.divide(plan_directions(_COLUMNS), _TEXEL).T[..., None] * away
    texel = (np.floor(row).astype(int) % SIZE, np.floor(column).astype(int) % SIZE)
    land, sunlight, woods = _land(horizon, sun)
    rise = np.clip((away - HAZE_END) / (0.45 * HILL_FARTHEST), 0.0, 1.0)
    slope = horizon.height * rise * _between(land, row, column)
    sine = slope / exact.hypot(1.0, slope)
    ridge = np.maximum.accumulate(sine, axis=1)
    step = _first_seen(ridge)
    who = np.arange(_COLUMNS)[None]
    middle = (np.arange(_ROWS)[:, None] + 0.5) * HILL_TOP / _ROWS
    cover = np.clip((ridge[:, -1][None] - middle) * _ROWS / HILL_TOP + 0.5, 0.0, 1.0)
    seen = (texel[0][who, step], texel[1][who, step])
    channels = [
        cover,
        sunlight[seen],
        woods[seen],
        (away[step] - HAZE_END) / (HILL_FARTHEST - HAZE_END),
    ]
    return np.round(255.0 * np.stack(channels, axis=2)).astype(np.uint8)


def far_ground(geometry: Geometry) -> NDArray[np.float64]:
    """Return the mean colour of all land, linear, shape (3,): the colour of far land."""
    last = geometry.chunk_range[-1, 1] if len(geometry.chunk_range) else 0
    corner = corners_of(geometry.cluster)[:last, :, :2].astype(np.float64)
    one, two = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = np.maximum(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0], 0.0)
    share = np.bincount(materials_of(geometry.shading[:last]), area, len(geometry.layer))
    # The only texel of the last level is the mean of the texture.
    packed = geometry.texture[geometry.layer, LAST_TEXEL]
    root = np.stack([packed & 255, packed >> 8 & 255, packed >> 16 & 255], axis=1) / 255.0
    mean: NDArray[np.float64] = exact.product(share, np.square(root) * geometry.tint) / max(
        share.sum(), 1e-9
    )
    return mean


def _first_seen(ridge: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the step at which each row and column's ray meets the land, shape (rows, columns).

    A ray that meets no land gets the step of the highest ridge.

    Args:
        ridge: Sine of the elevation of the highest land up to each step, shape (columns, steps).
    """
    line = np.clip(ridge * _ROWS / HILL_TOP + 0.5, 0, _ROWS).astype(np.int64)
    flat = line * _COLUMNS + np.arange(_COLUMNS)[:, None]
    count = np.bincount(flat.ravel(), minlength=(_ROWS + 1) * _COLUMNS)
    below = count.reshape(_ROWS + 1, _COLUMNS).cumsum(axis=0)[:_ROWS]
    highest = np.argmax(ridge, axis=1)
    return np.asarray(np.minimum(below, highest[None]), np.int64)


def _land(horizon: Horizon, sun: tuple[float, float, float]) -> tuple[Field, Field, Field]:
    """Return height, sunlight and woods of a tile of land, each 0 to 1."""
    rng = source(horizon.name)
    rough = fractal(rng, 1.9, longest=110.0)
    ridged = -np.abs(fractal(rng, 1.9, longest=90.0))
    land = rough / rough.std() + horizon.ridges * ridged / ridged.std()
    land = (land - land.min()) / (land.max() - land.min())
    land = blurred(land, 0.6)
    east = (np.roll(land, -1, 1) - np.roll(land, 1, 1)) * 4.5
    north = (np.roll(land, -1, 0) - np.roll(land, 1, 0)) * 4.5
    facing = (sun[2] - east * sun[0] - north * sun[1]) / np.sqrt(
        1.0 + np.square(east) + np.square(north)
    )
    woods = fractal(rng, 1.5, longest=60.0) + 1.5 * (land - 0.4)
    cover = np.clip(horizon.woods * (0.5 + 1.5 * woods), 0.0, 1.0)
    return land, np.clip(facing, 0.0, 1.0), cover


def _between(field: Field, row: Field, column: Field) -> Field:
    """Return values of a repeating field between its texels."""
    low, left = np.floor(row), np.floor(column)
    up, across = row - low, column - left
    j, i = low.astype(int) % SIZE, left.astype(int) % SIZE
    k, m = (j + 1) % SIZE, (i + 1) % SIZE
    lower = field[j, i] + across * (field[j, m] - field[j, i])
    upper = field[k, i] + across * (field[k, m] - field[k, i])
    return np.asarray(lower + up * (upper - lower), np.float64)
