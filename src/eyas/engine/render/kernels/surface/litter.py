"""Autumn on the ground: fallen leaves under trees, and yellowed grass."""

from eyas.engine.render.kernels.bundles import Light
from eyas.engine.render.kernels.colours import Colour, clip, where
from eyas.engine.render.kernels.hash_noise import noise, seen_noise
from eyas.engine.render.kernels.light.land import land_at
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.engine.render.kernels.surface.snow import Bed
from eyas.lanes import kernel
from eyas.lanes.vector import any_of, like, select

DRIVEN, OPEN, POROUS = i4(int(Bed.DRIVEN)), i4(int(Bed.OPEN)), i4(int(Bed.POROUS))


@kernel(inline=True)
def littered(
    colour: Colour,  # Without leaves
    light: Light,  # Its map of trees
    litter: float,  # How many have fallen, 0 to 1
    bed: int,  # A `Bed`
    point: Colour,  # The point [m]
    rise: float,  # Upward component of its normal
    footprint: float,  # Size of a pixel on the surface [m]
) -> Colour:
    """Return the colour of the ground with the leaves that lie on it."""
    one, half, x, y = f4(1.0), f4(0.5), point[0], point[1]
    red, green, blue = colour
    porous, driven = bed == POROUS, bed == DRIVEN
    grass = porous & (green > f4(1.15) * red)
    if any_of(grass):
        dry = one + f4(0.34) * litter, one - f4(0.04) * litter, one - f4(0.22) * litter
        yellowed = red * dry[0], green * dry[1], blue * dry[2]
        red, green, blue = where(grass, yellowed, (red, green, blue))
    ground = (porous | driven | (bed == OPEN)) & (rise > f4(0.8))
    # Roofs and decks are above the crowns' leaves.
    ground &= point[2] < light.ambient_frame.ground + f4(2.5)
    if any_of(ground):
        under, _ = land_at(light, x, y)
        # Wind heaps them up, and wheels blow them off the road.
        heap = noise(f4(0.31) * x + f4(0.17) * y, f4(0.31) * y - f4(0.17) * x)
        single = seen_noise(x + half * y, y - half * x, f4(8.0), footprint)
        patch = seen_noise(x - f4(0.7) * y, y + f4(0.7) * x, f4(1.7), footprint)
        many = litter * under * select(driven, f4(0.5), like(under, one))
        cover = clip((many * (half + heap) + f4(0.55) * (patch - half) - f4(0.16)) * f4(2.4))
        cover = clip((f4(1.5) * cover + f4(1.3) * (single - half) - f4(0.2)) * f4(1.7))
        cover = select(ground, f4(0.9) * clip(f4(5.0) * many) * cover, like(under, f4(0.0)))
        # From yellow over orange to brown.
        brown = clip(f4(1.6) * noise(f4(3.1) * x + y, f4(3.1) * y - x) - f4(0.3))
        red += cover * (f4(0.52) - f4(0.32) * brown - red)
        green += cover * (f4(0.30) - f4(0.20) * brown - green)
        blue += cover * (f4(0.055) - f4(0.02) * brown - blue)
    return red, green, blue
