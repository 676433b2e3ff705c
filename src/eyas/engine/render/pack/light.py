"""Light and air as the kernels read them: weather, street lamps, the tone curve."""

from functools import partial
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.render.bake.ambient import AmbientMap
from eyas.engine.render.bake.clouds import build_clouds
from eyas.engine.render.bake.hills import build_hills, far_ground
from eyas.engine.render.bake.puddles import hollows, no_hollows
from eyas.engine.render.bake.shadows import ShadowMap
from eyas.engine.render.bake.smoke import chimneys
from eyas.engine.render.bake.sway import calm, sway_of
from eyas.engine.render.bake.tracks import TrackMap
from eyas.engine.render.kernels.bundles import (
    TILE,
    Air,
    Direction,
    Geometry,
    Illumination,
    LampFrame,
    Light,
    MapFrame,
    Wind,
)
from eyas.engine.render.kernels.light.ambient import BOUNCED
from eyas.engine.render.kernels.light.tone import TONE_STEPS, TONE_TOP
from eyas.engine.state.lighting import Horizon, Lighting
from eyas.engine.state.scene import Lamps, Scene
from eyas.lanes import exact

CELL = 8.0  # Side of a square of the grid of street lamps [m]

_WALLS = np.array((1.03, 1.0, 0.95))
"""Colour of walls and pavements on average, whose brightness does not matter here."""

_FRONTS = np.array((0.95, 0.76, 0.52))
"""Light of shops, signs and windows in a closed street where all windows are lit."""

_LUMA = np.array((0.2126, 0.7152, 0.0722))
"""Weights of linear red, green and blue in luminance (ITU-R BT.709)."""

SHOULDER, _CONTRAST = 1.6, 0.75  # See `tone_table`; contrast 1 is a smooth step

REACH = 32.0  # Distance beyond which a lamp's light is negligible [m]: below 1/400 of that under it

MOST = 8  # Most lamps that are listed for a square

PAPER = 0.6
"""Intensity over squared distance [m] that lights paper as the sun does: the original's lamps of
intensity 30 then give the road below about as much light as the sun."""


class Baked(NamedTuple):
    """Maps of a scene in a weather."""

    shadows: ShadowMap
    ambient: AmbientMap
    land: NDArray[np.uint16]  # See `eyas.engine.render.bake.land`.
    tracks: TrackMap


def build_light(scene: Scene, lighting: Lighting, baked: Baked, geometry: Geometry) -> Light:
    """Return the light of a weather over a scene."""
    shadows, ambient, tracks = baked.shadows, baked.ambient, baked.tracks
    lit = scene.lamps if lighting.lamps > 0 else Lamps.none()
    lamp, lamp_cell, lamp_frame = lamp_grid(lit)
    sun = np.array(lighting.sun_direction, np.float64)
    sun /= exact.length(sun)
    toward = (float(sun[0]), float(sun[1]), float(sun[2]))
    clouds, hills = cached(
        EntryKind.SKY,
        partial(_sky, lighting.clouds, scene.horizon, toward),
        (lighting.clouds, scene.horizon, toward),
        of=tuple[NDArray[np.uint8], NDArray[np.uint8]],
    )
    return Light(
        weather=_weather(lighting, toward, shadows),
        shadow_texel=shadows.heights,
        shadow_tile=tile_starts(shadows.tile),
        shadow_rows=np.ascontiguousarray(shadows.rows, np.float32),
        ambient=ambient.openness,
        ambient_frame=MapFrame(*_floats(ambient.frame)),
        land=baked.land,
        hollows=hollows() if lighting.wet > 0 else no_hollows(),
        lamp=lamp,
        lamp_cell=lamp_cell,
        lamp_frame=lamp_frame,
        tracks=tracks.worn,
        track_frame=MapFrame(*_floats([*tracks.frame, 0.0])),
        tone=tone_table(),
        ground=_direction(far_ground(geometry)),
        clouds=clouds,
        smoke=chimneys(scene, lighting.smoke),
        sway=sway_of(scene, geometry) if lighting.windy > 0 else calm(),
        hills=hills,
    )


def _sky(
    cover: float, horizon: Horizon, sun: tuple[float, float, float]
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    return build_clouds(cover, sun), build_hills(horizon, sun)


def tile_starts(tile: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return `Light.shadow_tile` of the numbers of tiles."""
    line, column = np.indices(tile.shape, np.int32) * TILE
    starts: NDArray[np.int32] = tile * (TILE + 1) * (TILE + 1) - line * (TILE + 1) - column
    return starts


def _weather(
    lighting: Lighting, sun: tuple[float, float, float], shadows: ShadowMap
) -> Illumination:
    """Return the light of a weather; `sun` is of length 1."""
    air = Air(
        power=_float(lighting.fog_power),
        exposure=_float(lighting.exposure),
        offset=_float(1.1 * shadows.texel),  # its map's largest error within a texel
        snow=_float(lighting.snow),
        lamps=_float(lighting.lamps),
        windows=_float(lighting.windows),
        clouds=_float(lighting.clouds),
        flakes=_float(lighting.flakes),
        rain=_float(lighting.rain),
        leaves=_float(lighting.leaves),
        wet=_float(lighting.wet),
        litter=_float(lighting.litter),
        mist=_float(lighting.mist),
        per_mist_depth=_float(1.0 / lighting.mist_depth),
        glare=_float(lighting.glare),
        veil=_float(1.0),
        daytime_lamps=_float(lighting.daytime_lamps),
        stars=_float(lighting.stars if lighting.lamps > 0 else 0.0),
        star_cosine=_float(float(exact.cos(lighting.star_turn))),
        star_sine=_float(float(exact.sin(lighting.star_turn))),
        moon_lit=_float(lighting.moon_lit),
        limb_x=_float(lighting.moon_limb[0]),
        limb_y=_float(lighting.moon_limb[1]),
        limb_z=_float(lighting.moon_limb[2]),
        longest_shadow=_float(lighting.longest_shadow),
        windy=_float(lighting.windy),
        spray=_float(lighting.spray),
        banks=_float(lighting.foggy),
    )
    return Illumination(
        sun=_direction(sun),
        sun_colour=_direction(lighting.sun_colour),
        zenith=_direction(lighting.zenith_colour),
        horizon=_direction(lighting.horizon_colour),
        above=_direction(lighting.ambient_up),
        below=_direction(lighting.ambient_down),
        tinge=_direction(_tinge(lighting)),
        fog=_direction(lighting.fog_colour),
        fog_density=_float(lighting.fog_density),
        air=air,
        wind=Wind(*_floats(np.zeros(4))),
    )


def _tinge(lighting: Lighting) -> NDArray[np.float64]:
    """Return `Illumination.tinge`: as bright as the sky's light in its place, of the walls' colour.

    Walls lie half in the sun. `BOUNCED` is what arrives where all the sky is hidden. By night
    fronts shine themselves.
    """
    sky = np.asarray(lighting.ambient_up)
    thrown = (0.5 * np.asarray(lighting.sun_colour) + sky) * _WALLS
    bright = exact.product(sky, _LUMA) / max(exact.product(thrown, _LUMA), 1e-9)
    tinge: NDArray[np.float64] = (thrown * bright - sky) * (BOUNCED / (1.0 - BOUNCED))
    return tinge + lighting.windows * _FRONTS


def tone_table() -> NDArray[np.uint8]:
    """Return the byte for each step of exposed radiance, 0 to `TONE_TOP`.

    `1 - exp(-SHOULDER x)`, which keeps some contrast above the brightness of white paper, then sRGB
    (IEC 61966-2-1), then an S-curve as cameras' standard pictures have: real ones have blacks.
    """
    return encoded_tone(TONE_TOP)


def encoded_tone(
    top: float,  # Radiance of the last step
    white: float = 1.0,  # Value of the curve that is shown as white
) -> NDArray[np.uint8]:
    """Return the byte for each step of exposed radiance by that curve."""
    radiance = (np.arange(TONE_STEPS) + 0.5) * (top / TONE_STEPS)
    tone = (1.0 - exact.exp(-SHOULDER * radiance)) / white
    encoded = np.where(tone <= 0.0031308, 12.92 * tone, 1.055 * exact.power(tone, 1 / 2.4) - 0.055)
    encoded = np.clip(encoded, 0.0, 1.0)
    encoded += _CONTRAST * encoded * (1.0 - encoded) * (2.0 * encoded - 1.0)
    table: NDArray[np.uint8] = np.round(255.0 * encoded).astype(np.uint8)
    return table


def _floats(values: ArrayLike) -> tuple[float, ...]:
    """Return numbers of float32, whose type decides that of the kernels' arithmetic."""
    return cast("tuple[float, ...]", tuple(np.asarray(values, np.float32)))


def _float(value: float) -> float:
    return cast("float", np.float32(value))


def _direction(values: ArrayLike) -> Direction:
    return Direction(*_floats(values))


def lamp_grid(
    lamps: Lamps,  # L lamps
    cell: float = CELL,  # Side of a square [m]
) -> tuple[NDArray[np.float32], NDArray[np.int32], LampFrame]:
    """Return `Light.lamp`, `Light.lamp_cell` and `Light.lamp_frame`."""
    count = len(lamps.position)
    strength = np.full((count, 1), lamps.intensity / PAPER, np.float32)
    nothing = np.zeros((count, 1), np.float32)  # eight numbers, so that lanes can be loaded
    lamp = np.concatenate([lamps.position, lamps.axis, strength, nothing], axis=1)
    lamp = lamp.astype(np.float32)
    cut_off = float(exact.cos(lamps.cut_off))
    if count == 0:
        return lamp, np.full((0, 0, 1), -1, np.int32), _frame(0.0, 0.0, cell, cut_off)
    low = lamps.position[:, :2].min(axis=0).astype(np.float64) - REACH
    high = lamps.position[:, :2].max(axis=0).astype(np.float64) + REACH
    columns, rows = np.ceil((high - low) / cell).astype(int)
    middle = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1) + 0.5
    apart = np.linalg.norm((low + cell * middle)[:, :, None] - lamps.position[:, :2], axis=3)
    order = np.argsort(apart, axis=2, kind="stable")[:, :, :MOST]
    near = np.take_along_axis(apart, order, axis=2) < REACH + cell * np.sqrt(0.5)
    cells = np.where(near, order, -1).astype(np.int32)
    return lamp, np.ascontiguousarray(cells), _frame(low[0], low[1], cell, cut_off)


def _frame(west: float, south: float, cell: float, cut_off: float) -> LampFrame:
    numbers = np.array([west, south, 1 / cell, cut_off], np.float32)
    return LampFrame(numbers[0], numbers[1], numbers[2], numbers[3])
