"""Clouds of the sky: computed once for a cover and a sun, always the same ones."""

import functools
import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.sky.clouds import DEEPEST, CloudRays, cloud_rays
from eyas.engine.render.kernels.sky.radiance import CLOUD_BEND, CLOUDS_FROM
from eyas.engine.render.textures.fields import SIZE, Field, blurred, fractal, source
from eyas.lanes import Held, exact, thread_count

_ROWS, _COLUMNS = 208, 2048
_SEEN = 0.65  # Correction of the cover: clouds hide more when seen from the side than from below
_TEXEL = 9.0 / SIZE  # Side of a texel of the cloud heights [km]


@functools.lru_cache(maxsize=4)
def build_clouds(cover: float, sun: tuple[float, float, float]) -> NDArray[np.uint8]:
    """Return the clouds' panorama, see `eyas.engine.render.kernels.sky.clouds`; one empty texel for
    none.

    Args:
        cover: Share of the sky that clouds cover, 0 to 1.
        sun: Unit vector towards the sun.
    """
    if cover <= 0.0:
        return np.zeros((1, 1, 2), np.uint8)
    height = (np.arange(_ROWS) + 0.5) / _ROWS
    # Lower rows are not shown.
    sines = np.maximum(CLOUD_BEND * height / (1.0 + CLOUD_BEND - height), CLOUDS_FROM)
    output = np.empty((_ROWS, _COLUMNS, 2), np.uint8)
    rays = CloudRays(
        _field(cover, sun).astype(np.float32),
        sines.astype(np.float32),
        plan_directions(_COLUMNS).astype(np.float32),
        output,
    )
    cloud_rays(thread_count(), Held(rays))
    return output


def plan_directions(columns: int) -> NDArray[np.float64]:
    """Return the horizontal unit vectors of a panorama's columns, shape (columns, 2)."""
    turn = (np.arange(columns) + 0.5) * 4 / columns
    x, y = np.abs(turn - 2.0) - 1.0, 1.0 - np.abs((turn + 1.0) % 4.0 - 2.0)
    # On |x| + |y| = 1: x falls from 1 to -1 and rises again; y is a quarter turn behind.
    return np.stack([x, y], axis=1) / exact.hypot(x, y)[:, None]


def _field(cover: float, sun: tuple[float, float, float]) -> Field:
    """Return the input of `cloud_rays`."""
    rng = source("clouds")
    tops = _heap_heights(cover, rng)
    details = _billows(rng, 40.0)
    details = np.clip(0.5 + 0.25 * details / details.std(), 0.0, 1.0)
    streaks = fractal(rng, 1.3, longest=120.0, stretch=(1.0, 4.0))
    patches = np.clip(fractal(rng, 1.8, longest=160.0) - 0.1, 0.0, 1.0)
    thin = 0.45 * patches * np.clip(0.35 + 0.4 * streaks, 0.0, 1.0)
    return np.stack([tops - _apart(tops), _sunlit(tops, sun), details, thin], axis=2)


def _heap_heights(cover: float, rng: np.random.Generator) -> Field:
    """Return the height of the clouds above their base [km], 0 where there is none.

    Each cloud is a heap of balls, larger and higher in the middle, filled down to the base.
    Clouds are added until they cover enough; from a cover of three quarters on they form a layer.
    """
    layer = 2.5 * (cover - 0.75) + 0.26 * exact.tanh(1.5 * fractal(rng, 1.6, longest=120.0))
    heights = np.maximum(layer, 0.0)
    while (heights > 0.1).mean() < _SEEN * cover:
        middle, radius = rng.uniform(0, SIZE, 2), exact.power(rng.uniform(0.35, 1.0), 1.5) * 0.9
        lengthen = rng.uniform(1.0, 1.8)
        for _ in range(int(8 + 40 * radius)):
            share = math.sqrt(rng.random())
            angle = rng.uniform(0.0, math.tau)
            way = share * np.array([exact.sin(angle), lengthen * exact.cos(angle)])
            ball = radius * rng.uniform(0.2, 0.45) * (1.2 - 0.6 * share)
            lift = rng.uniform(-0.3, 0.9) * radius * (1.0 - np.square(share)) * 0.6
            _put_ball(heights, middle + way * radius / _TEXEL, ball, lift)
    # Blurred, so that single texels do not show.
    return np.clip(blurred(heights, 0.7), 0.0, DEEPEST)


def _put_ball(heights: Field, middle: NDArray[np.float64], radius: float, lift: float) -> None:
    """Raise the heights to those of a ball [km] centred on a texel."""
    reach = int(radius / _TEXEL) + 1
    around = np.arange(-reach, reach + 1)
    whole = np.floor(middle).astype(int)
    row, column = (whole[:, None] + around) % SIZE
    off = (around[None] + (whole - middle)[:, None]) * _TEXEL
    square = np.square(radius) - np.square(off[0][:, None]) - np.square(off[1][None])
    top = lift + np.sqrt(np.maximum(square, 0.0))
    texels = np.ix_(row, column)
    heights[texels] = np.maximum(heights[texels], np.where(square > 0, top, 0.0))


def _apart(tops: Field) -> Field:
    """Return a lower bound of the distance to the nearest cloud [km], 0 in and beside clouds."""
    near = tops > 0.0
    apart = np.zeros_like(tops)
    for _ in range(12):
        for axis in (0, 1):
            near = near | np.roll(near, 1, axis) | np.roll(near, -1, axis)
        apart += np.where(near, 0.0, _TEXEL)
    return apart


def _billows(rng: np.random.Generator, longest: float) -> Field:
    """Return round bumps with creases between them, mean 0."""
    field = -np.abs(fractal(rng, 2.2, longest=longest))
    return blurred(field - field.mean(), 0.7)


def _sunlit(tops: Field, sun: tuple[float, float, float]) -> Field:
    """Return the lowest height above the base that is in sunlight [km]."""
    plan = exact.hypot(sun[0], sun[1])
    if plan < 1e-3:
        return tops
    highest = tops.copy()
    for step in range(1, 25):
        shift = (-round(step * sun[1] / plan), -round(step * sun[0] / plan))
        shadow = np.roll(tops, shift, (0, 1)) - step * _TEXEL * max(sun[2], 0.1) / plan
        highest = np.maximum(highest, shadow)
    return blurred(highest, 1.0)
