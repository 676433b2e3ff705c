"""Textures of the ground: asphalt, paving, lawn, soil."""

import numpy as np
from numpy.typing import NDArray

from art.textures.fields import Picture, cracks, masonry, mixed, opaque, painted
from eyas.engine.render.textures.fields import SIZE, blurred, fractal, source, white
from eyas.lanes import exact

Texture = NDArray[np.uint8]


def asphalt() -> Texture:
    """Return a dark grey road surface: aggregate, sealed cracks, a few darker patches."""
    return _asphalt("asphalt", (81.0, 80.5, 79.0), stones=0.5, cracked=0.16)


def asphalt_light() -> Texture:
    """Return the worn, light surface of car parks."""
    return _asphalt("asphalt_light", (122.0, 121.0, 117.0), stones=0.3, cracked=0.03)


def _asphalt(
    name: str, colour: tuple[float, float, float], stones: float, cracked: float
) -> Texture:
    rng = source(name)
    grain = 0.085 * white(rng) + 0.05 * blurred(white(rng), 1.0) / 0.28
    cloud = 0.035 * fractal(rng, 1.0, longest=90.0)
    picture = painted(colour, grain + cloud)
    # Pale and dark stones of the aggregate, about 3 cm.
    stone = rng.random(grain.shape)
    picture = mixed(picture, (150.0, 147.0, 140.0), stones * (stone > 0.985))
    picture = mixed(picture, (42.0, 42.0, 42.0), 0.6 * (stone < 0.03))
    patch = np.clip((fractal(rng, 2.0, longest=110.0) - 1.55) * 2.5, 0, 1)
    picture = mixed(
        picture,
        painted((0.7 * colour[0], 0.7 * colour[1], 0.7 * colour[2]), 0.6 * grain),
        0.45 * patch,
    )
    dust = np.clip((fractal(rng, 1.4, longest=120.0) - 0.9) * 0.6, 0, 1)
    picture = mixed(picture, (128.0, 122.0, 112.0), 0.14 * dust)
    picture = mixed(picture, (48.0, 48.0, 48.0), 0.55 * cracks(rng, 1.0, cracked))
    return opaque(picture)


def paving() -> Texture:
    """Return pinkish beige stone slabs of half a metre."""
    rng = source("paving")
    slabs = masonry(rng, 8, 8, joint=1.6)
    grain = 0.035 * white(rng) + 0.03 * fractal(rng, 0.8, longest=60.0)
    vein = 0.02 * fractal(rng, 1.2, longest=60.0, stretch=(0.5, 2.0))
    picture = painted((198.0, 173.0, 156.0), grain + vein + 0.045 * slabs.shade)
    warm = masonry(rng, 8, 8, joint=0.0).shade
    picture += warm[..., None] * np.array([2.0, -1.0, -4.0])
    # A light upper and a dark lower edge make the slabs stand out.
    picture *= 1 + 0.05 * (slabs.down[..., None] < 0.06) - 0.05 * (slabs.down[..., None] > 0.93)
    stain = np.clip(fractal(rng, 1.5, longest=110.0) - 0.8, 0, 1)
    picture = mixed(picture, (140.0, 122.0, 108.0), 0.16 * stain)
    return opaque(mixed(picture, (118.0, 104.0, 94.0), 0.85 * slabs.joint))


def lawn() -> Texture:
    """Return yellow-green grass, lively from near and even from far, as in the original."""
    return opaque(_grass(source("lawn"), dryness=0.7))


def lawn_mown() -> Texture:
    """Return grass that was mown to and fro along u: four pairs of a light and a dark swath."""
    rng = source("lawn_mown")
    picture = _grass(rng, dryness=0.45)
    y = (np.arange(SIZE)[:, None] + 0.5) / SIZE
    wander = 0.1 * fractal(rng, 1.6, longest=120.0)
    swath = np.clip(5.0 * exact.sin(2 * np.pi * (4 * y) + wander), -1, 1)
    return opaque(picture * (1.0 + 0.06 * swath[..., None] * np.array([1.0, 0.9, 1.1])))


def _grass(rng: np.random.Generator, dryness: float) -> Picture:
    """Return grass; `dryness` is the difference of its dry spots."""
    blades = fractal(rng, 0.35, longest=10.0, stretch=(1.5, 0.8))
    tufts = fractal(rng, 0.9, longest=28.0)
    cloud = fractal(rng, 1.2, longest=70.0)
    clumps = fractal(rng, 0.5, longest=30.0)
    light = 0.16 * blades + 0.19 * tufts + 0.19 * clumps + 0.05 * cloud
    picture = painted((143.0, 178.0, 88.0), np.clip(light, -0.75, 0.75))
    dry = np.clip(0.6 * fractal(rng, 0.9, longest=34.0) - 0.3, 0, 1)
    picture = mixed(picture, painted((196.0, 186.0, 112.0), 0.1 * blades), dryness * dry)
    # Shade between tufts.
    deep = np.clip(0.7 * tufts + 0.5 * clumps - 0.6 + 0.35 * white(rng), 0, 1)
    picture = mixed(picture, painted((52.0, 80.0, 32.0), 0.12 * blades), 0.85 * deep)
    flower = rng.random(blades.shape)
    return mixed(picture, (226.0, 222.0, 150.0), 0.5 * (flower > 0.997))


def soil() -> Texture:
    """Return brown earth with crumbs, small stones and cracks."""
    rng = source("soil")
    crumbs = fractal(rng, 0.5, longest=14.0)
    cloud = fractal(rng, 1.2, longest=70.0)
    picture = painted((134.0, 112.0, 83.0), 0.18 * crumbs + 0.05 * cloud + 0.06 * white(rng))
    picture += fractal(rng, 1.0, longest=50.0)[..., None] * np.array([5.0, 1.0, -4.0])
    stone = blurred(white(rng), 0.8)
    stone /= stone.std()
    picture = mixed(picture, painted((172.0, 158.0, 134.0), 0.1 * crumbs), 0.7 * (stone > 2.2))
    picture = mixed(picture, (84.0, 66.0, 46.0), 0.5 * cracks(rng, 0.8, 0.3))
    return opaque(picture)
