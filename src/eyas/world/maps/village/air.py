"""Light and air of the village."""

from dataclasses import replace

from eyas.world.weather import CLEAR_DAY, CLEAR_NIGHT

__all__ = ["VILLAGE_FOG", "VILLAGE_NIGHT"]

# Haze that fills the valley to the original's visibility range, below a sky that stays blue: the
# sun still casts shadows.
VILLAGE_FOG = replace(
    CLEAR_DAY,
    sun_colour=(0.55, 0.53, 0.48),
    zenith_colour=(0.22, 0.34, 0.56),
    horizon_colour=(0.80, 0.84, 0.88),
    ambient_up=(0.44, 0.47, 0.51),
    ambient_down=(0.20, 0.21, 0.18),
    fog_colour=(0.74, 0.78, 0.81),
    fog_density=1.0 / 400.0,
    foggy=True,
    clouds=0.45,
)

# Darker than in a city, and greenish as under the lights of a stadium.
VILLAGE_NIGHT = replace(
    CLEAR_NIGHT,
    sun_colour=(0.062, 0.070, 0.074),
    ambient_up=(0.050, 0.059, 0.058),
    ambient_down=(0.022, 0.026, 0.022),
    horizon_colour=(0.016, 0.019, 0.022),
    fog_colour=(0.016, 0.019, 0.022),
)
