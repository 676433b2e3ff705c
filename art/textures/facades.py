"""Textures of walls: ten kinds of facades, four storeys by four bays each; ground floors, of which
each storey of the tile is one front of four bays; walls without windows.
"""

import numpy as np
from numpy.typing import NDArray

from art.textures.fields import Picture, masonry, mixed, opaque, painted
from art.textures.windows import BAY, Opening, Wall
from eyas.engine.render.textures.fields import SIZE, fractal, source, white

Texture = NDArray[np.uint8]
Colour = tuple[float, float, float]

_STOREYS = range(0, SIZE, BAY)
_ANTHRACITE = (58.0, 62.0, 66.0)
_ALUMINIUM = (148.0, 152.0, 156.0)
_WHITE = (228.0, 225.0, 217.0)
_SIGNS = ((150.0, 44.0, 40.0), (36.0, 74.0, 112.0), (44.0, 92.0, 66.0), (206.0, 168.0, 66.0))


def _plain(rng: np.random.Generator, colour: Colour, stain: float = 0.03) -> Picture:
    """Return render or concrete, slightly weathered."""
    cloud = fractal(rng, 1.1, longest=120.0)
    return painted(colour, 0.02 * white(rng) + stain * cloud)


def _bricks(rng: np.random.Generator, colour: Colour, mortar: Colour) -> Picture:
    """Return bricks two pixels larger than true, so that they are still visible as bricks."""
    courses = masonry(rng, 64, 32, joint=0.9)
    picture = painted(colour, 0.03 * white(rng) + 0.075 * courses.shade)
    return mixed(picture, mortar, 0.55 * courses.joint)


def facade_concrete() -> Texture:
    """Return panels of concrete with joints, and wide windows."""
    rng = source("facade_concrete")
    wall = Wall(_plain(rng, (182.0, 178.0, 169.0), 0.045), rng)
    opening = Opening(9, 14, 55, 45, frame=_ALUMINIUM, upright=1)
    for x, y in wall.everywhere():
        wall.shade(x, y, x + BAY, y + BAY, rng.uniform(0.95, 1.05))
        wall.rect(x - 1, y, x + 1, y + BAY, (118.0, 115.0, 109.0))
        wall.rect(x, y - 1, x + BAY, y + 1, (118.0, 115.0, 109.0))
        wall.window(x, y, opening)
        wall.sill(x, y, opening, (196.0, 193.0, 186.0))
    return wall.finished()


def facade_brick() -> Texture:
    """Return brown-red brick with tall sash windows, stone lintels and sills."""
    rng = source("facade_brick")
    wall = Wall(_bricks(rng, (150.0, 84.0, 64.0), (170.0, 148.0, 132.0)), rng)
    opening = Opening(18, 12, 46, 50, frame=_WHITE, upright=0, level=1, curtained=0.55)
    for x, y in wall.everywhere():
        wall.rect(x + 15, y + 6, x + 49, y + 12, (204.0, 192.0, 170.0))
        wall.window(x, y, opening)
        wall.sill(x, y, opening, (204.0, 192.0, 170.0))
    return wall.finished()


def facade_plaster() -> Texture:
    """Return cream render, shuttered windows and a moulding at each storey."""
    rng = source("facade_plaster")
    wall = Wall(_plain(rng, (224.0, 207.0, 176.0)), rng)
    opening = Opening(21, 14, 43, 49, frame=_WHITE, upright=1, level=1, curtained=0.5)
    for y in _STOREYS:
        wall.band(y, 4, (236.0, 226.0, 204.0))
    for x, y in wall.everywhere():
        wall.rect(x + 19, y + 12, x + 45, y + 50, (238.0, 230.0, 212.0))
        wall.window(x, y, opening)
        wall.sill(x, y, opening, (238.0, 230.0, 212.0))
        closed = rng.random() < 0.12
        spots = ((21, 32), (32, 43)) if closed else ((9, 19), (45, 55))
        for left, right in spots:
            wall.rect(x + left, y + 13, x + right, y + 50, (94.0, 116.0, 100.0))
            for slat in range(y + 16, y + 48, 3):
                wall.shade(x + left + 1, slat, x + right - 1, slat + 1, 0.74)
    return wall.finished()


def facade_stone() -> Texture:
    """Return courses of sandstone with framed windows, like those of banks and town halls."""
    rng = source("facade_stone")
    blocks = masonry(rng, 32, 8, joint=1.2)
    grain = 0.025 * white(rng) + 0.03 * fractal(rng, 1.0, longest=100.0)
    face = painted((196.0, 182.0, 156.0), grain + 0.035 * blocks.shade)
    wall = Wall(mixed(face, (140.0, 128.0, 108.0), 0.7 * blocks.joint), rng)
    opening = Opening(18, 13, 46, 53, frame=(96.0, 84.0, 70.0), upright=1, level=1, curtained=0.4)
    for y in _STOREYS:
        wall.band(y + BAY - 5, 5, (208.0, 196.0, 172.0), shadow=3)
    for x, y in wall.everywhere():
        wall.rect(x + 14, y + 8, x + 50, y + 55, (212.0, 200.0, 178.0))
        wall.rect(x + 11, y + 5, x + 53, y + 9, (218.0, 207.0, 186.0))
        wall.shade(x + 11, y + 9, x + 53, y + 11, 0.78)
        wall.window(x, y, opening)
    return wall.finished()


def facade_office() -> Texture:
    """Return ribbons of windows between blue-grey panels."""
    rng = source("facade_office")
    wall = Wall(_plain(rng, (156.0, 166.0, 176.0), 0.02), rng)
    for x, y in wall.everywhere():
        wall.shade(x, y + 44, x + BAY, y + BAY, rng.uniform(0.97, 1.03))
        wall.rect(x, y + 44, x + 1, y + BAY, (112.0, 120.0, 128.0))
        for half in (0, 32):
            pane = Opening(half, 10, half + 32, 43, frame=_ANTHRACITE, thick=1, upright=0)
            wall.window(x, y, pane)
    for y in _STOREYS:
        wall.rect(0, y + 43, SIZE, y + 46, (186.0, 192.0, 198.0))
        wall.rect(0, y + 7, SIZE, y + 10, (118.0, 126.0, 134.0))
    return wall.finished()


def facade_glass() -> Texture:
    """Return a curtain wall: glass from floor to ceiling, thin bars, darker glass at the floors."""
    rng = source("facade_glass")
    wall = Wall(_plain(rng, (84.0, 96.0, 106.0), 0.01), rng)
    for x, y in wall.everywhere():
        for half in (0, 32):
            pane = Opening(
                half, 1, half + 32, 50, (122.0, 130.0, 138.0), 1, 0, 0, (58.0, 80.0, 96.0), 0.22
            )
            wall.window(x, y, pane)
            floor = Opening(
                half, 50, half + 32, 65, (122.0, 130.0, 138.0), 1, 0, 0, (40.0, 58.0, 70.0), 0.0
            )
            wall.window(x, y, floor)
    return wall.finished()


def facade_highrise() -> Texture:
    """Return pale piers that run up a tower, windows and dark panels between them."""
    rng = source("facade_highrise")
    wall = Wall(_plain(rng, (94.0, 92.0, 90.0), 0.03), rng)
    for x, y in wall.everywhere():
        opening = Opening(13, 10, 51, 46, frame=_ANTHRACITE, upright=1, curtained=0.45)
        wall.window(x, y, opening)
        wall.shade(x, y + 48, x + BAY, y + BAY, rng.uniform(0.95, 1.08))
    for x in range(0, SIZE, BAY):
        wall.rect(x - 9, 0, x + 9, SIZE, (206.0, 200.0, 188.0))
        wall.shade(x - 9, 0, x - 7, SIZE, 1.08)
        wall.shade(x + 9, 0, x + 13, SIZE, 0.66)
        for y in _STOREYS:
            wall.shade(x - 9, y, x + 9, y + 1, 0.8)
    return wall.finished()


def facade_old() -> Texture:
    """Return worn ochre render with iron balconies at every other bay."""
    rng = source("facade_old")
    surface = _plain(rng, (198.0, 172.0, 136.0), 0.05)
    bare = np.clip((fractal(rng, 1.2, longest=90.0) - 1.3) * 3, 0, 1)
    bricks = _bricks(rng, (164.0, 106.0, 80.0), (180.0, 156.0, 136.0))
    wall = Wall(mixed(surface, bricks, 0.8 * bare), rng)
    for y in _STOREYS:
        wall.band(y, 3, (216.0, 190.0, 148.0))
    opening = Opening(20, 14, 44, 49, frame=(120.0, 86.0, 62.0), upright=1, curtained=0.5)
    door = Opening(18, 12, 46, 60, frame=(120.0, 86.0, 62.0), upright=1, level=1, curtained=0.5)
    for x, y in wall.everywhere():
        with_balcony = (x // BAY + y // BAY) % 2 == 0
        wall.rect(x + 16, y + 9, x + 48, y + 13, (220.0, 198.0, 160.0))
        wall.window(x, y, door if with_balcony else opening)
        if with_balcony:
            wall.balcony(x, y, 10, 54, (190.0, 176.0, 152.0), (48.0, 46.0, 46.0))
        else:
            wall.sill(x, y, opening, (220.0, 198.0, 160.0))
    return wall.finished()


def facade_bands() -> Texture:
    """Return white parapets of continuous balconies before dark, glazed rooms."""
    rng = source("facade_bands")
    wall = Wall(_plain(rng, (122.0, 112.0, 102.0)), rng)
    for x, y in wall.everywhere():
        wall.window(x, y, Opening(6, 8, 36, 52, frame=_ANTHRACITE, upright=1, curtained=0.5))
        wall.window(x, y, Opening(44, 14, 58, 44, frame=_ANTHRACITE, upright=0, curtained=0.5))
    for y in _STOREYS:
        wall.shade(0, y + 2, SIZE, y + 12, 0.66)
        wall.band(y + 41, 22, (230.0, 227.0, 219.0), shadow=4)
        wall.rect(0, y + 60, SIZE, y + 63, (198.0, 194.0, 185.0))
        wall.rect(0, y + 38, SIZE, y + 40, (108.0, 110.0, 112.0))
    for x in range(0, SIZE, 2 * BAY):
        wall.rect(x - 2, 0, x + 2, SIZE, (206.0, 202.0, 194.0))
        wall.shade(x + 2, 0, x + 4, SIZE, 0.8)
    return wall.finished()


def facade_red_white() -> Texture:
    """Return red brick striped with white bands and corner stones."""
    rng = source("facade_red_white")
    wall = Wall(_bricks(rng, (156.0, 80.0, 66.0), (196.0, 160.0, 146.0)), rng)
    for y in _STOREYS:
        wall.band(y, 7, (232.0, 226.0, 212.0))
    opening = Opening(17, 15, 47, 49, frame=_WHITE, upright=1, level=1, curtained=0.5)
    for x, y in wall.everywhere():
        wall.rect(x + 12, y + 11, x + 52, y + 53, (232.0, 226.0, 212.0))
        wall.window(x, y, opening)
        wall.sill(x, y, opening, (222.0, 214.0, 198.0))
        for k, row in enumerate(range(y + 9, y + BAY, 9) if x % (2 * BAY) == 0 else ()):
            wide = 5 if k % 2 else 3
            wall.rect(x - wide, row, x + wide, row + 7, (232.0, 226.0, 212.0))
    return wall.finished()


def ground_shop() -> Texture:
    """Return shop windows under sign boards and striped awnings."""
    rng = source("ground_shop")
    face = painted((150.0, 144.0, 136.0), 0.02 * white(rng) + 0.03 * fractal(rng, 1.1))
    wall = Wall(face, rng)
    for x, y in wall.everywhere():
        sign = _SIGNS[int(rng.integers(len(_SIGNS)))]
        wall.window(x, y, Opening(5, 20, 40, 56, (64.0, 62.0, 60.0), 2, 1, 0, curtained=0.2))
        wall.window(x, y, Opening(43, 20, 59, 63, (64.0, 62.0, 60.0), 2, 0, 0, curtained=0.1))
        wall.rect(x + 4, y + 8, x + 60, y + 18, sign)
        for letter in range(x + 14, x + 48, 5):
            wall.rect(
                letter, y + 11, letter + int(rng.integers(2, 5)), y + 15, (236.0, 232.0, 222.0)
            )
        if rng.random() < 0.4:
            for k, stripe in enumerate(range(x + 3, x + 61, 6)):
                pale = (234.0, 228.0, 214.0)
                wall.rect(stripe, y + 18, min(stripe + 6, x + 61), y + 31, sign if k % 2 else pale)
            wall.shade(x + 3, y + 28, x + 61, y + 31, 0.82)
            wall.shade(x + 3, y + 31, x + 61, y + 38, 0.6)
    _plinth(wall)
    return wall.finished()


def ground_lobby() -> Texture:
    """Return stone piers with tall panes and glass doors between them."""
    rng = source("ground_lobby")
    blocks = masonry(rng, 16, 8, joint=1.4)
    grain = 0.025 * white(rng) + 0.03 * fractal(rng, 1.0, longest=90.0)
    face = painted((176.0, 168.0, 156.0), grain + 0.04 * blocks.shade)
    wall = Wall(mixed(face, (118.0, 112.0, 104.0), 0.7 * blocks.joint), rng)
    for x, y in wall.everywhere():
        doors = (x // BAY) % 4 == 1
        bars = (72.0, 66.0, 58.0) if doors else (84.0, 86.0, 88.0)
        opening = Opening(
            9, 8, 55, 63 if doors else 54, bars, 2, 3 if doors else 1, 1, curtained=0.15
        )
        wall.window(x, y, opening)
        if not doors:
            wall.sill(x, y, opening, (194.0, 187.0, 176.0))
    _plinth(wall)
    return wall.finished()


def _plinth(wall: Wall) -> None:
    """Darken the feet of the walls, where rain splashes, except at doors."""
    for y in range(0, SIZE, BAY):
        wall.shade(0, y + 58, SIZE, y + BAY, 0.86)


def concrete() -> Texture:
    """Return cast concrete: clouds, pores, streaks left by water."""
    rng = source("concrete")
    cloud = 0.035 * fractal(rng, 1.1, longest=90.0) + 0.03 * white(rng)
    streaks = fractal(rng, 1.0, longest=60.0, stretch=(7.0, 1.0))
    picture = painted((172.0, 168.0, 160.0), cloud + 0.025 * streaks)
    picture = mixed(picture, (128.0, 124.0, 116.0), 0.3 * np.clip(streaks - 1.0, 0, 1))
    pores = rng.random(cloud.shape) > 0.992
    return opaque(mixed(picture, (110.0, 106.0, 100.0), 0.5 * pores))


def brick() -> Texture:
    """Return red bricks in running bond with pale mortar."""
    rng = source("brick")
    bricks = masonry(rng, 32, 16, joint=1.4)
    grain = 0.05 * white(rng) + 0.04 * fractal(rng, 1.0, longest=70.0)
    picture = painted((158.0, 82.0, 62.0), grain + 0.1 * bricks.shade)
    burnt = masonry(rng, 32, 16, joint=0.0).shade
    picture = mixed(picture, painted((98.0, 62.0, 56.0), grain), 0.6 * (burnt > 1.5))
    picture = mixed(picture, painted((186.0, 116.0, 82.0), grain), 0.5 * (burnt < -1.5))
    return opaque(mixed(picture, painted((178.0, 166.0, 150.0), grain), 0.85 * bricks.joint))


def stone() -> Texture:
    """Return courses of dressed sandstone."""
    rng = source("stone")
    blocks = masonry(rng, 8, 4, joint=2.0)
    grain = 0.035 * white(rng) + 0.045 * fractal(rng, 0.9, longest=60.0)
    bed = 0.03 * fractal(rng, 1.0, longest=40.0, stretch=(0.6, 4.0))
    edge = 0.07 * (blocks.down < 0.08) - 0.09 * (blocks.down > 0.92)
    picture = painted((194.0, 180.0, 154.0), grain + bed + edge + 0.04 * blocks.shade)
    return opaque(mixed(picture, (112.0, 101.0, 86.0), 0.75 * blocks.joint))
