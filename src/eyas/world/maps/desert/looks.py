"""Colours of the desert: sand and asphalt, and houses of the same sand."""

from eyas.world.build.materials import facade, material

__all__ = ["DUSTY", "HOUSES", "SAND", "SNOW", "THIN_SNOW"]

SAND = material("sand", (1.0, 0.93, 0.60))
"""The ground, the dunes, and the drifts on the roads."""

DUSTY = material("sand", (0.76, 0.70, 0.48))
"""Asphalt under a thin layer of sand."""

SNOW = material("snow", (0.97, 0.97, 0.97))
"""Dunes under snow."""

THIN_SNOW = material("snow", (0.98, 0.91, 0.72))
"""Their feet, where sand shows through."""

HOUSES = (
    (facade("facade_plaster", (1.0, 0.95, 0.82)), material("roof_tiles", (1.0, 0.90, 0.80))),
    (facade("facade_plaster", (0.98, 0.90, 0.74)), material("roof_tiles", (0.94, 0.84, 0.74))),
    (facade("facade_stone", (1.0, 0.96, 0.84)), material("roof_tiles", (0.98, 0.88, 0.78))),
)
