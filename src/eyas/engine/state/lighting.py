"""Light and air of a weather, how they vary, and the hills on the horizon."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Horizon:
    """Hills all around a map, 4 to 14 km away and always visible."""

    name: str = "hills"
    """Seed of the shapes: another name gives different hills of the same character."""
    height: float = 0.055
    """Height of the highest hill as a share of its distance, at most 0.08; 0: a plain."""
    ridges: float = 0.9
    """Sharpness of the hills: 0 round like dunes, 1 with ridges and valleys."""
    woods: float = 1.0
    """Amount of forest on the hills; 0: none."""


@dataclass(frozen=True, slots=True)
class Lighting:
    """Light and air of a weather. Colours: linear radiance, about 1.3 for white paper in sun."""

    sun_direction: tuple[float, float, float]
    """Unit vector towards the sun."""
    sun_colour: tuple[float, float, float]
    """Sunlight on a surface that faces the sun."""
    zenith_colour: tuple[float, float, float]
    """Sky overhead."""
    horizon_colour: tuple[float, float, float]
    """Sky at the horizon."""
    ambient_up: tuple[float, float, float]
    """Sky light on a surface that faces up."""
    ambient_down: tuple[float, float, float]
    """Bounced light on a surface that faces down."""
    fog_colour: tuple[float, float, float]
    """Colour that distant surfaces fade to."""
    fog_density: float
    """One over the visibility range [1/m]; 0 for clear air."""
    fog_power: int = 1
    """1: exponential, 2: exponential squared."""
    foggy: bool = False
    """Whether it is fog, which lies in banks; its visibility range may be set (`light.visibility`),
    in clear air it is fixed."""
    exposure: float = 1.0
    """Factor on all radiance before it is converted to a picture."""
    luminance: float = 30_000.0
    """Luminance of radiance 1 [cd/m^2]; white paper in the sun has 30,000 cd/m^2. What a
    camera model counts photons by; pictures without one do not depend on it."""
    snow: float = 0.0
    """Snow on surfaces that face up: 0 none, 1 fully covered."""
    luminosity: float = 1.0
    """Luminosity of sky and sun in the original's weather, the reference of the light settings."""
    lamps: float = 0.0
    """Brightness of street lamps and vehicle lights: 0 off, 1 on."""
    windows: float = 0.0
    """Share of the windows that are lit."""
    clouds: float = 0.0
    """Share of the sky that clouds cover."""
    flakes: float = 0.0
    """Density of falling snow: 0 none, 1 heavy snowfall."""
    rain: float = 0.0
    """Density of falling rain: 0 none, 1 a cloudburst."""
    leaves: float = 0.0
    """Density of falling leaves: 0 none, 1 a gust in a wood."""
    wet: float = 0.0
    """Water on what faces up: 0 dry, 1 roads that mirror, with puddles."""
    litter: float = 0.0
    """Fallen leaves on the ground: 0 none, 1 it is covered under trees."""
    mist: float = 0.0
    """Extinction on the ground of a layer that is thick over open land and water [1/m]."""
    mist_depth: float = 8.0
    """Height over the ground at which that has thinned to 1/e [m]."""
    glare: float = 0.0
    """Sunlight that haze and lens scatter forward, against a low sun: 0 none, 1 dazzling."""
    longest_shadow: float = 4.0
    """Longest shadow of what moves, in heights; with a low sun it would be endless."""
    daytime_lamps: float = 0.0
    """Brightness of lamps that are seen, but light nothing around them: in rain by day."""
    stars: float = 1.0
    """Brightness of the stars, which are seen where lamps are on."""
    star_turn: float = 0.0
    """Turn of the stars round the pole [rad]."""
    moon_limb: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Unit vector from the middle of the moon's disc to its bright limb; 0: it is full."""
    moon_lit: float = 1.0
    """Share of its disc that is lit."""
    windy: float = 0.0
    """1: the wind around each tracker moves crowns and what falls (`world.wind`); 0: crowns are
    still, and what falls drifts by itself."""
    smoke: int = 0
    """Number of plumes of smoke over buildings."""
    spray: float = 0.0
    """Water that fast vehicles throw up: 0 none, 1 as from a road under a film of water."""


class LightState(NamedTuple):
    """Deviations from the weather's light around each of N trackers, or in each of N views."""

    sky: NDArray[np.float32]
    """Factor on the sky and its light, shape (N,)."""
    sun: NDArray[np.float32]
    """Factor on the sun, shape (N,)."""
    fog_density: NDArray[np.float32]
    """One over the visibility range [1/m], shape (N,)."""
    wind_x: NDArray[np.float32]
    """Velocity of the wind eastwards [m/s], shape (N,); used where `Lighting.windy` is 1."""
    wind_y: NDArray[np.float32]
    """Velocity of the wind northwards [m/s], shape (N,)."""

    @classmethod
    def create(cls, count: int) -> "LightState":
        """Return factors of 1, a visibility range of 1 m, and calm air."""
        return cls(*np.ones((3, count), np.float32), *np.zeros((2, count), np.float32))
