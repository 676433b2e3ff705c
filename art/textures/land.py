"""Textures of open land: sand, fields, forest floor, snow, brick roads, and waves."""

import numpy as np
from numpy.typing import NDArray

from art.textures.fields import masonry, mixed, opaque, painted
from eyas.engine.render.textures.fields import SIZE, Field, blurred, fractal, source, white
from eyas.lanes import exact

Texture = NDArray[np.uint8]


def sand() -> Texture:
    """Return pale sand with wind ripples, whose crest lines wander and fork.

    Alpha is cloudy noise, for what lies on the sand, see
    `eyas.engine.render.kernels.surface.wild_ground`.
    """
    rng = source("sand")
    y = np.arange(SIZE)[:, None] / SIZE
    x = np.arange(SIZE)[None] / SIZE
    bend = 0.9 * fractal(rng, 1.8, longest=110.0, stretch=(1.4, 0.8))
    phase = 2 * np.pi * (22 * y + 3 * x) + bend
    # Steeper on the lee side, as in blown sand.
    ripple = exact.sin(phase + 0.5 * exact.sin(phase))
    strength = np.clip(0.6 + 0.3 * fractal(rng, 1.6, longest=90.0), 0.1, 1.0)
    grain = 0.055 * white(rng) + 0.04 * fractal(rng, 0.8, longest=60.0)
    picture = painted((214.0, 190.0, 148.0), 0.11 * ripple * strength + grain)
    # Iron makes it redder here than there; dark gravel gathers in places.
    iron = fractal(source("sand iron"), 1.0, longest=60.0)
    picture += iron[..., None] * np.array([6.0, -2.0, -11.0])
    pebble = rng.random(grain.shape) + 0.01 * iron
    made = opaque(mixed(picture, (112.0, 94.0, 76.0), 0.6 * (pebble > 0.995)))
    cloud = 0.5 + 0.21 * fractal(rng, 0.85, longest=70.0)
    made[..., 3] = np.round(255.0 * np.clip(cloud, 0.0, 1.0))
    return made


def crops() -> Texture:
    """Return rows of young green plants on brown earth; rows run along u."""
    return _rows("crops", (98.0, 138.0, 52.0), (60.0, 96.0, 34.0), width=0.42)


def crops_ripe() -> Texture:
    """Return dense rows of ripe yellow grain."""
    return _rows("crops_ripe", (207.0, 176.0, 98.0), (160.0, 126.0, 62.0), width=0.72)


def crops_green() -> Texture:
    """Return dense rows of full-grown green plants."""
    return _rows("crops_green", (98.0, 160.0, 74.0), (62.0, 116.0, 48.0), width=0.86)


def crops_yellow() -> Texture:
    """Return dense rows of bright yellow flowers."""
    return _rows("crops_yellow", (252.0, 230.0, 96.0), (206.0, 184.0, 62.0), width=0.92)


def crops_lilac() -> Texture:
    """Return dense rows of lilac flowers."""
    return _rows("crops_lilac", (232.0, 176.0, 246.0), (176.0, 124.0, 198.0), width=0.86)


def crops_tan() -> Texture:
    """Return the dry stubble of a harvested field."""
    return _rows("crops_tan", (228.0, 198.0, 162.0), (188.0, 156.0, 122.0), width=0.8)


def _rows(
    name: str, leaf: tuple[float, float, float], deep: tuple[float, float, float], width: float
) -> Texture:
    """Return 16 rows of plants; `width` is the share of a row that leaves cover."""
    rng = source(name)
    y = (np.arange(SIZE)[:, None] + 0.5) / SIZE
    wander = 0.16 * fractal(rng, 1.3, longest=60.0)
    across = np.abs((16 * y + wander) % 1.0 - 0.5) * 2  # 0 in the middle of a row
    tuft = fractal(rng, 0.5, longest=14.0)
    cover = np.clip((width + 0.16 * tuft - across) * 4.0 + 0.5, 0, 1)
    # Plants shade the earth between them, the denser the more.
    shade = 1.0 - 0.65 * width
    earth = painted(
        (122.0 * shade, 98.0 * shade, 70.0 * shade), 0.1 * fractal(rng, 0.6, longest=20.0)
    )
    growth = 0.14 * fractal(rng, 0.9, longest=70.0)
    plants = painted(leaf, np.clip(0.2 * tuft + 0.08 * white(rng) + growth, -0.7, 0.7))
    plants = mixed(plants, deep, np.clip(0.5 * across + 0.2 * fractal(rng, 0.4, longest=9.0), 0, 1))
    return opaque(mixed(earth, plants, cover))


def dry_leaves() -> Texture:
    """Return the floor of a wood: brown and ochre leaves over dark earth, some twigs."""
    rng = source("dry_leaves")
    picture = painted((74.0, 58.0, 42.0), 0.14 * fractal(rng, 0.6, longest=20.0))
    for colour in (
        (112.0, 84.0, 54.0),
        (142.0, 104.0, 62.0),
        (96.0, 70.0, 46.0),
        (160.0, 122.0, 74.0),
        (124.0, 78.0, 48.0),
    ):
        height = fractal(rng, 0.9, longest=9.0)
        leaf = np.clip((height - 0.9) * 5.0, 0, 1)
        picture = mixed(picture, painted(colour, 0.09 * fractal(rng, 0.5, longest=8.0)), leaf)
        # The lower edge of a leaf is shaded.
        edge = np.clip((np.roll(height, 1, 0) - 0.9) * 5.0, 0, 1) * (1 - leaf)
        picture *= 1 - 0.25 * edge[..., None]
    moss = np.clip(0.5 * fractal(rng, 1.2, longest=40.0) - 0.55, 0, 1)
    return opaque(mixed(picture, (92.0, 98.0, 50.0), 0.5 * moss))


def snow() -> Texture:
    """Return fresh snow: nearly even, faint drifts, slightly blue hollows, glints."""
    rng = source("snow")
    drift = fractal(rng, 1.2, longest=36.0, stretch=(1.0, 0.8))
    fine = fractal(rng, 0.7, longest=20.0)
    shade = 0.012 * drift + 0.012 * fine + 0.008 * white(rng)
    picture = painted((236.0, 239.0, 244.0), shade)
    picture = mixed(picture, (206.0, 218.0, 236.0), np.clip(-0.09 * drift - 0.07 * fine, 0, 0.5))
    glint = rng.random(fine.shape)
    return opaque(mixed(picture, (255.0, 255.0, 255.0), 1.0 * (glint > 0.995)))


def clinker() -> Texture:
    """Return a road of red-brown clinker bricks, 12.5 by 25 cm at 4 m a repeat."""
    rng = source("clinker")
    bricks = masonry(rng, 32, 16, joint=1.1)
    hue = masonry(rng, 32, 16, joint=0.0).shade
    grain = 0.05 * white(rng) + 0.03 * fractal(rng, 1.0, longest=40.0)
    picture = painted((142.0, 88.0, 74.0), 0.055 * bricks.shade + grain)
    picture += hue[..., None] * np.array([4.0, 4.0, 7.0])
    picture = mixed(picture, (88.0, 74.0, 66.0), 0.8 * bricks.joint)
    dust = np.clip(0.4 * fractal(rng, 1.2, longest=60.0) - 0.2, 0, 1)
    return opaque(mixed(picture, (128.0, 112.0, 98.0), 0.3 * dust))


def water() -> Texture:
    """Return the slopes of small waves, for `Surface.WATER`: not a colour.

    Linear light of red is 0.5 + the slope along u, that of green 0.5 + the slope along v. Coarser
    mip levels then average slopes, so far water is calmer.
    """
    rng = source("water")
    waves = fractal(rng, 1.7, longest=64.0, stretch=(1.0, 0.7)) + 0.35 * fractal(
        rng, 1.2, longest=20.0
    )
    waves = blurred(waves, 1.0)
    slope_u, slope_v = _slope(waves, 1), -_slope(waves, 0)  # v grows upwards, rows downwards
    steepness = 0.15 / np.sqrt((np.square(slope_u) + np.square(slope_v)).mean() / 2)
    linear = np.stack(
        [0.5 + steepness * slope_u, 0.5 + steepness * slope_v, np.full_like(waves, 0.5)], axis=-1
    )
    srgb = 1.055 * exact.power(np.clip(linear, 0.01, 1.0), 1 / 2.4) - 0.055
    return opaque(255.0 * srgb)


def _slope(field: Field, axis: int) -> Field:
    return (np.roll(field, -1, axis) - np.roll(field, 1, axis)) / 2
