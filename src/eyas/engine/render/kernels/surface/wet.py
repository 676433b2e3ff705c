"""Rain on surfaces: darker where it soaks in, a mirroring film on roads, puddles in hollows."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Illumination, Light
from eyas.engine.render.kernels.colours import Colour, clip
from eyas.engine.render.kernels.light.lamps import lamp_gloss
from eyas.engine.render.kernels.scalars import f4, i4, u4
from eyas.engine.render.kernels.sky.radiance import surroundings
from eyas.engine.render.kernels.surface.snow import Bed
from eyas.lanes import kernel
from eyas.lanes.vector import any_of, gather_pair, like, select, to_f4, to_i4

DRIVEN, OPEN = i4(int(Bed.DRIVEN)), i4(int(Bed.OPEN))
LEAVES, POROUS = i4(int(Bed.LEAVES)), i4(int(Bed.POROUS))

_LEAST = f4(0.02)
"""Share of light that water mirrors at normal incidence: ((1.33 - 1) / (1.33 + 1))^2."""

_SIDE = 64  # Texels along a side of the picture of hollows, see `eyas.engine.render.bake.puddles`.

_PER_METRE = 1.1  # Texels of it in a metre

_LEVEL = f4(0.92)  # Upward component of the normal from which water stays on a surface


@kernel(inline=True)
def wetted(
    light: Light,  # Its lamps
    lit: Illumination,  # Light and air
    colour: Colour,  # Radiance of the dry surface
    bed: int,  # A `Bed`
    point: Colour,  # The point [m]
    normal: Colour,  # Unit normal of the surface
    way: Colour,  # Unit vector from the eye
    open_share: float,  # Share of the sky's light that reaches it past what stands
    unblocked: float,  # The same past what moves
    footprint: float,  # Size of a pixel on the surface [m]
) -> Colour:
    """Return the radiance of a surface in rain.

    Wet asphalt has half the albedo of dry asphalt, since light is kept in by total reflection at
    the film (Lekner and Dorf, Why some things are darker when wet, Applied Optics 27, 1988); what
    is porous swallows the water and darkens less. Nothing under a roof gets wet.
    """
    zero, one, x, y, rise = f4(0.0), f4(1.0), point[0], point[1], normal[2]
    fallen = lit.air.wet * clip(f4(5.0) * open_share - f4(0.25))
    driven, porous, leaves = bed == DRIVEN, bed == POROUS, bed == LEAVES
    paved = driven | (bed == OPEN)
    taken = select(driven, f4(0.54), select(paved, f4(0.34), like(rise, zero)))
    taken = select(porous, f4(0.26), select(leaves, f4(0.16), taken))
    level = (paved | porous) & (rise > _LEVEL)
    # Walls get less of it.
    taken *= select(level | leaves, one, like(rise, f4(0.5)))
    kept = one - fallen * taken
    red, green, blue = kept * colour[0], kept * colour[1], kept * colour[2]
    if any_of(level):
        puddle = _puddle(light.hollows, x, y, driven, footprint)
        # Soil swallows it, and from what is not level it runs off.
        puddle *= select(porous, zero, clip(f4(60.0) * (rise - f4(0.98))))
        thin = select(porous, f4(0.02), select(driven, f4(0.38), like(rise, f4(0.26))))
        film = select(level, fallen * (thin + (f4(0.95) - thin) * puddle), zero)
        mirrored, share = _mirrored(lit, film, -rise * way[2], one - open_share, unblocked)
        # Water over it lets less light in and out.
        kept = (one - share) * (one - f4(0.3) * fallen * select(level, puddle, zero))
        red, green, blue = (
            kept * red + share * mirrored[0],
            kept * green + share * mirrored[1],
            kept * blue + share * mirrored[2],
        )
        if lit.air.lamps > zero:
            lamp_r, lamp_g, lamp_b = lamp_gloss(light, lit.air.lamps, point, normal, way, share)
            red, green, blue = red + lamp_r, green + lamp_g, blue + lamp_b
    return red, green, blue


@kernel(inline=True)
def _puddle(
    hollows: NDArray[np.uint16], x: float, y: float, driven: bool, footprint: float
) -> float:
    """Return the share of a level place that a puddle covers.

    A picture of hollows in the place of noise, which would double the cost of rain.
    """
    # Turned, so that it repeats along no street; moved to where cutting off is rounding down.
    u = f4(_PER_METRE * 0.92) * x + f4(_PER_METRE * 0.39) * y + f4(65536.0)
    v = f4(_PER_METRE * 0.92) * y - f4(_PER_METRE * 0.39) * x + f4(65536.0)
    column, row = to_i4(u), to_i4(v)
    across, down = u - to_f4(column), v - to_f4(row)
    mask, byte = i4(_SIDE - 1), u4(255)
    four = gather_pair(hollows, ((row & mask) * i4(_SIDE) + (column & mask)) * i4(2))
    a, b = to_f4(four & byte), to_f4((four >> u4(8)) & byte)
    c, d = to_f4((four >> u4(16)) & byte), to_f4(four >> u4(24))
    first = a + across * (b - a)
    depth = f4(1.0 / 255.0) * (first + down * (c + across * (d - c) - first))
    dry = select(driven, f4(0.63), like(x, f4(0.65)))
    # A large pixel shows a mean.
    return clip((depth - dry) * (f4(18.0) / (f4(1.0) + f4(2.0) * footprint)))


@kernel(inline=True)
def _mirrored(
    lit: Illumination,  # Sky and sun
    film: float,  # Share of the surface under a film of water
    rise: float,  # Cosine of the angle between its normal and the way to the eye
    hidden: float,  # Share of the sky's light that what stands around takes away
    unblocked: float,  # Share of it that what moves lets through
) -> tuple[Colour, float]:
    """Return what a level wet surface mirrors of a clouded sky, and the share of it.

    A cheaper `eyas.engine.render.kernels.sky.radiance.reflection`: the mirrored ray rises as
    steeply as the eye looks down, and no sun shines.
    """
    one, horizon, zenith, walls = f4(1.0), lit.horizon, lit.zenith, surroundings(lit)
    graze = one - clip(rise)
    low = graze * graze
    low *= low
    share = film * (_LEAST + (one - _LEAST) * low * graze)
    around = f4(0.8) * clip((f4(1.5) * hidden - rise) * f4(5.0))
    # What stands on the road is dark below, and so is its mirror image.
    seen = f4(0.2) + f4(0.8) * unblocked
    walls_share, low = seen * around, seen * (one - around) * low
    rest = seen - walls_share - low
    return (
        walls_share * walls[0] + low * horizon.x + rest * zenith.x,
        walls_share * walls[1] + low * horizon.y + rest * zenith.y,
        walls_share * walls[2] + low * horizon.z + rest * zenith.z,
    ), share
