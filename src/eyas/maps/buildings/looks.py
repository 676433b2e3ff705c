"""Paint and roof covers of buildings, drawn so that neighbours differ."""

import numpy as np

from eyas.engine.state.mesh import Material
from eyas.engine.world.build.materials import material

Tint = tuple[float, float, float]

# Factors on the facade's own colour, sRGB: from washed out to sooty, warm to cold.
# order: bytes of plans depend on it, which draw an index of it
_WALLS: tuple[Tint, ...] = (
    (1.0, 1.0, 1.0),
    (1.0, 0.96, 0.88),
    (0.90, 0.94, 1.0),
    (0.97, 0.88, 0.78),
    (0.80, 0.80, 0.79),
    (0.92, 0.97, 0.93),
    (0.86, 0.80, 0.74),
    (0.98, 0.93, 0.97),
)

_SLOPES: tuple[tuple[float, Tint], ...] = (
    (0.4, (1.0, 0.96, 0.94)),
    (0.25, (0.88, 0.86, 0.86)),
    (0.2, (0.72, 0.74, 0.76)),
    (0.15, (0.56, 0.70, 0.84)),
)
"""Share of sloping roofs, and factor on terracotta: fresh, weathered, brown, dark."""

_FLATS: tuple[tuple[float, str, Tint], ...] = (
    (0.36, "roof_terrace", (1.0, 0.98, 0.97)),
    (0.20, "roof_terrace", (0.90, 0.90, 0.90)),
    (0.14, "roof_terrace", (0.78, 0.80, 0.82)),
    (0.10, "roof_gravel", (0.96, 0.95, 0.93)),
    (0.10, "roof_membrane", (0.97, 0.97, 0.97)),
    (0.10, "bitumen", (0.97, 0.97, 0.97)),
)
"""Share, texture and tint of flat roofs; high up, grey ones are three times as frequent."""

_HIGH = (20.0, 90.0)  # Heights between which grey roofs become more frequent [m]
_GREYER = 3.0
_FADED = 0.92  # Least random factor on the brightness of a whole roof


def wall_tint(rng: np.random.Generator) -> Tint:
    """Return the factor on a building's facade."""
    red, green, blue = _WALLS[int(rng.integers(len(_WALLS)))]
    age = float(rng.uniform(0.9, 1.0))
    return (red * age, green * age, blue * age)


def roof_cover(top: float, rng: np.random.Generator, *, pyramid: bool) -> Material:
    """Return the cover of a roof: mostly terracotta, as in the original, each a little different.

    Args:
        top: z of the roof [m].
        pyramid: Whether the roof slopes.
    """
    age = float(rng.uniform(_FADED, 1.0))
    if pyramid:
        shares = np.array([share for share, _ in _SLOPES])
        tint = _SLOPES[int(rng.choice(len(_SLOPES), p=shares / shares.sum()))][1]
        return material("roof_tiles", (tint[0] * age, tint[1] * age, tint[2] * age))
    greyer = float(np.interp(top, _HIGH, (1.0, _GREYER)))
    shares = np.array([s if name == "roof_terrace" else s * greyer for s, name, _ in _FLATS])
    _, name, tint = _FLATS[int(rng.choice(len(_FLATS), p=shares / shares.sum()))]
    return material(name, (tint[0] * age, tint[1] * age, tint[2] * age))
