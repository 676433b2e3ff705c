"""Colours of the village: saturated greens, white houses with orange roofs."""

from eyas.state.mesh import Material, Surface
from eyas.world.build.materials import facade, material

__all__ = ["GRASS", "HILLS", "HOUSES", "MEADOWS", "ROCK", "SHORE", "VERGE", "WATER"]

GRASS = material("lawn", (0.61, 0.74, 0.74))
"""The valley."""

MEADOWS = (material("lawn", (0.70, 0.76, 0.66)), material("lawn", (0.54, 0.68, 0.69)))
"""Patches of drier and of lusher grass."""

HILLS = (
    material("lawn", (0.62, 0.77, 0.77)),
    material("lawn", (0.66, 0.82, 0.84)),
    material("lawn", (0.70, 0.87, 0.91)),
    material("lawn", (0.75, 0.91, 0.96)),
)
"""Greens of the hills, from the foot up."""

VERGE = material("roof_gravel", (0.86, 0.82, 0.74))
SHORE = material("sand", (0.80, 0.78, 0.70))
ROCK = material("stone", (0.50, 0.52, 0.47))
"""Inside of the tunnels."""

WATER = Material("water", (0.20, 0.44, 0.72), Surface.WATER)

HOUSES = (
    (facade("facade_concrete", (1.0, 1.0, 1.0)), material("roof_tiles", (1.0, 0.96, 0.94))),
    (facade("facade_plaster", (0.88, 0.94, 1.0)), material("roof_tiles", (0.96, 0.88, 0.84))),
    (facade("facade_concrete", (1.0, 0.99, 0.97)), material("roof_tiles", (1.0, 0.92, 0.86))),
)
