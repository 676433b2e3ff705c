"""Light and air of a weather, and the hills on the horizon: data that recipes give."""

from dataclasses import dataclass

__all__ = ["Horizon", "Lighting"]


@dataclass(frozen=True, slots=True)
class Horizon:
    """Hills all round a map, from 4 to 14 km away, and always in sight."""

    name: str = "hills"
    """Another name gives other hills with the same character."""
    height: float = 0.055
    """Of the highest hill, as a share of its distance, at most 0.08; 0: a plain."""
    ridges: float = 0.9
    """How sharp they are: 0 round like dunes, 1 with ridges and valleys."""
    woods: float = 1.0
    """How much wood grows on them: 0 none."""


@dataclass(frozen=True, slots=True)
class Lighting:
    """Light and air of a weather. Colours are linear RGB radiance, white paper in sun about 1."""

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
    """What distance turns into."""
    fog_density: float
    """One over the visibility range [1/m]; 0 for clear air."""
    fog_power: int = 1
    """1: exponential, 2: exponential squared."""
    foggy: bool = False
    """Whether the visibility range may be set (`light.visibility`); clear air has its own."""
    exposure: float = 1.0
    """Factor on everything before it becomes a picture."""
    snow: float = 0.0
    """How much snow lies on what faces up: 0 none, 1 all covered."""
    luminosity: float = 1.0
    """The original's of this weather's sky and of its sun: what settings of the light refer to."""
    lamps: float = 0.0
    """How far street lamps and the lights of vehicles are on: 0 off, 1 on."""
    windows: float = 0.0
    """Share of the windows behind which there is light."""
    clouds: float = 0.0
    """Share of the sky that clouds cover."""
    flakes: float = 0.0
    """How thick snow falls: 0 none, 1 a heavy fall."""
