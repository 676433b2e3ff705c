"""Light and air."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

TILE = 32  # Texels of the shadow map from one tile to the next


class Direction(NamedTuple):
    """A vector, or a linear colour as red, green, blue, of float32."""

    x: float
    y: float
    z: float


class Air(NamedTuple):
    """Numbers of the weather, of float32, the same in all views."""

    power: float  # 1 or 2: how the thickness of fog grows with distance
    exposure: float
    offset: float  # Distance by which points are moved off their surface for the shadow map [m]
    snow: float  # This and the following: 0 to 1, see `eyas.engine.state.lighting.Lighting`.
    lamps: float
    windows: float
    clouds: float
    flakes: float
    rain: float
    leaves: float
    wet: float
    litter: float
    mist: float  # [1/m]
    per_mist_depth: float  # One over the depth of that layer [1/m]
    glare: float
    veil: float  # Share of `glare` that a lens in the sun adds to the whole picture
    daytime_lamps: float
    stars: float
    star_cosine: float  # Of the angle by which the stars have turned round the pole; then its sine
    star_sine: float
    moon_lit: float
    limb_x: float
    """Vector to the moon's bright limb, see `eyas.engine.state.lighting.Lighting.moon_limb`."""
    limb_y: float
    limb_z: float
    longest_shadow: float
    windy: float  # 1: the wind of each view moves plants and what falls, 0: what falls has its own
    spray: float  # See `eyas.engine.state.lighting.Lighting`.
    banks: float  # 1: fog lies in banks; 0: the air is the same all over


class Wind(NamedTuple):
    """The wind of a view, of float32."""

    x: float  # Velocity eastwards [m/s]
    y: float
    speed: float
    instant: float  # Time [s]


class Illumination(NamedTuple):
    """Light and air of one view; linear colours."""

    sun: Direction  # Unit vector towards the sun
    sun_colour: Direction
    zenith: Direction
    horizon: Direction
    above: Direction  # Light of the sky on surfaces that face up
    below: Direction  # Light from the ground on surfaces that face down
    tinge: Direction
    """What a hidden part of the sky changes in `above`: walls throw light of another colour."""
    fog: Direction
    fog_density: float  # [1/m]
    air: Air
    wind: Wind


class MapFrame(NamedTuple):
    """Where a map of the ground lies, of float32."""

    west: float  # x of its western edge [m]
    south: float  # y of its southern edge [m]
    per_metre: float  # Texels in a metre
    ground: float  # z of the ground [m]


class LampFrame(NamedTuple):
    """Where the grid of street lamps lies, of float32."""

    west: float
    south: float
    per_metre: float  # Squares in a metre
    cut_off: float  # Cosine of the angle beyond which the lamps give no light


class Light(NamedTuple):
    """Light of a weather, and the maps that tell what reaches a point."""

    weather: Illumination
    shadow_texel: NDArray[np.uint16]
    """Height towards the sun of the first thing that sunlight meets, see
    `eyas.engine.render.bake.shadows.ShadowMap.heights`, shape (., TILE + 1, TILE + 1)."""
    shadow_tile: NDArray[np.int32]
    """For each tile of the map, where texel (0, 0) of the map would lie in `shadow_texel` if the
    tile went on up to there, shape (rows, columns). Those at the edges of the map are empty."""
    shadow_rows: NDArray[np.float32]
    """World to column, row and height of the shadow map, shape (3, 4)."""
    ambient: NDArray[np.uint32]
    """Share of the sky's light on the ground, height of what hides it, wear, see `AmbientMap`."""
    ambient_frame: MapFrame
    land: NDArray[np.uint16]
    """What lies under trees and what is open to mist, in the frame of `ambient`, see
    `eyas.engine.render.bake.land.land_map`; shape (2, 2) where neither leaves nor mist lie."""
    hollows: NDArray[np.uint16]
    """Where rain stands, see `eyas.engine.render.bake.puddles.hollows`; (1, 2) where none falls."""
    lamp: NDArray[np.float32]
    """Position [m], axis, strength and 0 for each street lamp, shape (L, 8)."""
    lamp_cell: NDArray[np.int32]
    """Lamps that may light each square of a grid, the nearest first, -1 after the last,
    shape (rows, columns, .)."""
    lamp_frame: LampFrame
    tracks: NDArray[np.uint8]
    """Wear of the snow on roads, see `eyas.engine.render.bake.tracks.TrackMap`."""
    track_frame: MapFrame
    tone: NDArray[np.uint8]  # Byte of the picture for each step of exposed radiance
    ground: Direction  # Colour of far land without snow, see `eyas.engine.render.bake.hills`.
    clouds: NDArray[np.uint8]
    """Opacity, and brightness times opacity, see `eyas.engine.render.bake.clouds`,
    shape (rows, columns, 2)."""
    sway: NDArray[np.float32]
    """Frequency [1/s] and relative strength with which each fixture sways, see
    `eyas.engine.render.bake.sway`, shape (F, 2), or (0, 2) in calm air."""
    smoke: NDArray[np.float32]
    """Places from which smoke rises [m], and its brightness, see `eyas.engine.render.bake.smoke`,
    shape (S, 4)."""
    hills: NDArray[np.uint8]
    """Cover, sunlight, woods and farness, see `eyas.engine.render.bake.hills`,
    shape (rows, columns, 4)."""
