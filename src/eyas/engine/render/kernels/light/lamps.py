"""Light of street lamps, windows and other sources."""

from eyas.engine.render.kernels.bundles import Light
from eyas.engine.render.kernels.hash_noise import hashed
from eyas.engine.render.kernels.scalars import f4, i4, u4
from eyas.lanes import kernel
from eyas.lanes.vector import (
    any_of,
    gather,
    greater,
    lesser,
    like,
    root,
    select,
    to_f4,
    to_i4,
    to_u4,
    transposed,
)

_HEAD = f4(0.95 / 255.0)  # Brightest light of head lamps, for each step of `Scratch.shade`.

_TAIL = f4(0.16 / 255.0)  # The same for tail lamps

_FULL = f4(0.4536)  # Cosine of the angle up to which a beam is even: the original's 1.1 rad.

DARK_SKY = f4(0.04)  # Green of the sky overhead below which it is night

_BAYS = f4(4.0)  # Windows along a side of one repeat of a facade's texture


@kernel(inline=True)
def night_light(
    light: Light,  # Its lamps
    on: float,  # Their strength, 0 to 1
    point: tuple[float, float, float],  # The point [m]
    normal: tuple[float, float, float],  # Unit normal of the surface
    head: float,  # Light of vehicles' head lamps there, see `Scratch.shade`
    tail: float,  # Light of their tail lamps
) -> tuple[float, float, float]:
    """Return the light of street lamps and vehicles on a surface; paper in the sun gets 1."""
    street = on * _street_light(light, point, normal)
    head, tail = head * (on * _HEAD), tail * (on * _TAIL)
    return (
        street + head + tail,
        f4(0.86) * street + f4(0.93) * head + f4(0.06) * tail,
        f4(0.62) * street + f4(0.78) * head + f4(0.04) * tail,
    )


@kernel(inline=True)
def _street_light(
    light: Light, point: tuple[float, float, float], normal: tuple[float, float, float]
) -> float:
    """Return how much light of street lamps a surface gets.

    A lamp is a spot without shadow, whose optics throw up to 2.5 times as much to the sides as
    straight down, so that light reaches along the road (batwing distributions of road lamps);
    from 1.1 rad off its axis it fades, and from the cut-off on there is nothing.
    """
    frame, cells, lamps = light.lamp_frame, light.lamp_cell, light.lamp
    x, y, z = point
    zero, one = f4(0.0), f4(1.0)
    total = like(x, zero)
    rows, columns, most = cells.shape
    across, down = (x - frame.west) * frame.per_metre, (y - frame.south) * frame.per_metre
    inside = (across >= zero) & (down >= zero) & (across < f4(columns)) & (down < f4(rows))
    if not any_of(inside):
        return total
    column, row = to_i4(select(inside, across, zero)), to_i4(select(inside, down, zero))
    first = (row * i4(columns) + column) * i4(most)
    for k in range(most):
        which = gather(cells, first + i4(k))
        lit = inside & (which >= i4(0))
        if not any_of(lit):
            break  # lists end with the first empty place
        at = to_i4(greater(which, i4(0)))
        lamp = transposed(lamps, at, 0, 8, at)
        dx, dy, dz = lamp[0] - x, lamp[1] - y, lamp[2] - z
        lean = normal[0] * dx + normal[1] * dy + normal[2] * dz
        square = dx * dx + dy * dy + dz * dz + f4(0.25)
        inverse = one / root(square)
        cosine = -(lamp[3] * dx + lamp[4] * dy + lamp[5] * dz) * inverse
        spot = lesser((cosine - frame.cut_off) / (_FULL - frame.cut_off), one)
        lit &= (lean > zero) & (spot > zero)
        aside = f4(0.4) * square + f4(0.6) * dz * dz
        total += select(lit, spot * spot * lean * inverse * lamp[6] / aside, zero)
    return total


@kernel(inline=True)
def lamp_gloss(
    light: Light,  # Its lamps
    on: float,  # Their strength, 0 to 1
    point: tuple[float, float, float],  # The point [m]
    normal: tuple[float, float, float],  # Unit normal of the surface
    way: tuple[float, float, float],  # Unit vector from the eye
    share: float,  # Share of light that the surface mirrors; 0: it is dry
) -> tuple[float, float, float]:
    """Return the radiance of street lamps that a wet surface mirrors, drawn out by its roughness.

    Blinn's lobe of half vectors, which is long towards the eye where it is grazed.
    """
    frame, cells, lamps = light.lamp_frame, light.lamp_cell, light.lamp
    x, y, z = point
    zero, one = f4(0.0), f4(1.0)
    total = like(x, zero)
    rows, columns, most = cells.shape
    across, down = (x - frame.west) * frame.per_metre, (y - frame.south) * frame.per_metre
    inside = (across >= zero) & (down >= zero) & (across < f4(columns)) & (down < f4(rows))
    inside &= share > zero
    if any_of(inside):
        column, row = to_i4(select(inside, across, zero)), to_i4(select(inside, down, zero))
        first = (row * i4(columns) + column) * i4(most)
        for k in range(most):
            which = gather(cells, first + i4(k))
            lit = inside & (which >= i4(0))
            if not any_of(lit):
                break  # lists end with the first empty place
            at = to_i4(greater(which, i4(0)))
            lamp = transposed(lamps, at, 0, 8, at)
            dx, dy, dz = lamp[0] - x, lamp[1] - y, lamp[2] - z
            square = dx * dx + dy * dy + dz * dz + f4(0.25)
            inverse = one / root(square)
            hx, hy, hz = dx * inverse - way[0], dy * inverse - way[1], dz * inverse - way[2]
            lean = normal[0] * hx + normal[1] * hy + normal[2] * hz
            lobe = greater(lean, zero) * lean / (hx * hx + hy * hy + hz * hz + f4(1e-6))
            for _ in range(6):
                lobe *= lobe
            total += select(lit, lobe * lamp[6] / square, zero)
    total *= (f4(130.0 / 25.0) * on) * share
    return total, f4(0.86) * total, f4(0.62) * total


@kernel(inline=True)
def window_light(
    share: float,  # Share of lit windows
    building: int,  # Object id
    detail: int,  # See `detail_of`; a bay of windows has 64 texels along a side
    u: float,  # Texture coordinates [tiles]
    v: float,  # Texture coordinates [tiles]
) -> tuple[float, float, float]:
    """Return the light behind the window at (u, v) of a facade: dark, or one of a few lights.

    The building and the position of the window determine which rooms are lit, so the result is
    the same in every picture. For windows smaller than a pixel, their mean is returned.
    """
    # Moved so that cells have numbers above 0: 64 whole repeats, see `gradients`.
    column = to_u4(to_i4(_BAYS * u + f4(1024.0))) & u4(255)
    row = to_u4(to_i4(_BAYS * v + f4(1024.0))) & u4(255)
    number = to_u4(building)
    bits = hashed(column, row, number)
    # Whole storeys are busier than others, as offices are.
    storey = hashed(row, like(row, u4(7)), number)
    low, unit = u4(0xFFFF), f4(1.0 / 65535.0)
    odds = share * (f4(0.5) + to_f4(storey & low) * unit)
    # Few rooms are bright: most lamps stand away from the window, or behind a curtain.
    bright = to_f4((bits >> u4(16)) & u4(63)) * f4(1.0 / 63.0)
    bright = f4(0.10) + f4(0.85) * bright * bright
    across, up = _BAYS * u + f4(1024.0), _BAYS * v + f4(1024.0)
    across, up = across - to_f4(to_i4(across)), up - to_f4(to_i4(up))
    drawn = to_f4(bits >> u4(26)) * f4(1.6 / 63.0)
    bright *= select(
        (across < drawn - f4(0.9)) | (up > drawn + f4(0.25)), f4(0.35), like(u, f4(1.0))
    )
    bright = select(to_f4(bits & low) * unit < odds, bright, f4(0.0))
    # Warm lamps in homes, 2,700 K; tubes, 4,000 K; few of daylight.
    kind = (bits >> u4(22)) & u4(15)
    warm, cold = kind < u4(9), kind > u4(14)
    red = bright * select(cold, like(u, f4(0.80)), f4(1.0))
    green = bright * select(warm, like(u, f4(0.64)), f4(0.86))
    blue = bright * select(warm, like(u, f4(0.33)), select(cold, like(u, f4(1.0)), f4(0.64)))
    # A bay is two pixels wide at level 5, and one at level 6.
    far = lesser(greater(f4(1.0 / 256.0) * to_f4(detail - i4(1280)), f4(0.0)), f4(1.0))
    near, mean = f4(1.0) - far, f4(0.29) * share * far
    return (near * red + mean, near * green + f4(0.75) * mean, near * blue + f4(0.48) * mean)
