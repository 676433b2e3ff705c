"""Ground that nobody tends: hillsides of grass and rock, heaths of soil, dry grass and scrub."""

from eyas.lanes import kernel
from eyas.lanes.vector import any_of, greater, lesser
from eyas.render.kernels.chance import noise, seen_noise
from eyas.render.kernels.scalars import f4

__all__ = ["heath", "hillside"]

Colour = tuple[float, float, float]

_ROCK = f4(0.75)
"""Upward component of the normal below which rock shows, on average."""

_PER_SOIL = f4(4.0)
"""About half of one over the mean green of the texture `soil`."""


@kernel(inline=True)
def _clip(value: float) -> float:
    """Return a value brought into 0 to 1."""
    return lesser(greater(value, f4(0.0)), f4(1.0))


@kernel(inline=True)
def hillside(colour: Colour, point: Colour, rise: float, footprint: float) -> Colour:
    """Return the colour of a hillside, linear.

    Args:
        colour: Of the grass.
        point: The point [m].
        rise: Upward component of its normal.
        footprint: Size of a pixel on the surface [m].
    """
    one, half = f4(1.0), f4(0.5)
    x, y, z = point
    # Each turned differently, to hide the square cells of the noise.
    wide = noise(f4(0.021) * x + f4(0.012) * y, f4(0.021) * y - f4(0.012) * x)
    tuft = seen_noise(x - f4(0.6) * y, y + f4(0.6) * x, f4(0.13), footprint)
    dry = _clip(f4(1.5) * (wide - f4(0.42)) + f4(0.9) * (tuft - half))
    bright = f4(0.86) + f4(0.28) * tuft
    red = colour[0] * bright * (one + f4(0.62) * dry)
    green = colour[1] * bright * (one + f4(0.06) * dry)
    blue = colour[2] * bright * (one - f4(0.10) * dry)
    bare = _clip((_ROCK - rise + f4(0.26) * (tuft - half) + f4(0.22) * (wide - half)) * f4(7.0))
    if any_of(bare > f4(0.0)):
        layer = seen_noise(f4(0.3) * (x + y), f4(1.7) * z + f4(0.2) * x, f4(1.0), footprint)
        crack = seen_noise(x + y, f4(2.0) * z - y, f4(0.45), footprint)
        stone = f4(0.55) + f4(0.55) * layer + f4(0.4) * (crack - half)
        # Grass keeps to the ledges.
        bare = _clip(bare * (f4(1.5) - f4(0.9) * crack))
        red += bare * (f4(0.150) * stone - red)
        green += bare * (f4(0.138) * stone - green)
        blue += bare * (f4(0.118) * stone - blue)
    return red, green, blue


@kernel(inline=True)
def heath(colour: Colour, point: Colour, footprint: float) -> Colour:
    """Return the colour of a heath, linear.

    Args:
        colour: Of the soil.
        point: The point [m].
        footprint: Size of a pixel on the surface [m].
    """
    one, half = f4(1.0), f4(0.5)
    x, y = point[0], point[1]
    wide = noise(f4(0.016) * x + f4(0.009) * y, f4(0.016) * y - f4(0.009) * x)
    patch = seen_noise(x - f4(0.6) * y, y + f4(0.6) * x, f4(0.11), footprint)
    clump = seen_noise(x + f4(0.5) * y, y - f4(0.5) * x, f4(0.55), footprint)
    blade = seen_noise(x - f4(0.4) * y, y + f4(0.4) * x, f4(3.1), footprint)
    # Grass spreads from the hollows; scrub stands in it, in clumps with ragged edges.
    lush = f4(0.9) * (wide - f4(0.40)) + f4(0.8) * (patch - half)
    ragged = f4(0.62) * clump + f4(0.38) * blade
    cover = f4(0.8) * _clip(f4(2.0) * lush + f4(2.6) * (ragged - half) + f4(0.35))
    scrub = f4(0.75) * cover * _clip(f4(6.0) * (ragged - f4(0.66)) + f4(2.0) * lush)
    red, green, blue = colour
    # The grain of the soil shows through, and with it the size of what is seen.
    bright = (f4(0.55) + f4(0.5) * blade) * (f4(0.45) + green * _PER_SOIL)
    red += cover * (f4(0.215) * bright - red)
    green += cover * (f4(0.195) * bright - green)
    blue += cover * (f4(0.088) * bright - blue)
    red += scrub * (f4(0.070) * bright - red)
    green += scrub * (f4(0.088) * bright - green)
    blue += scrub * (f4(0.036) * bright - blue)
    dust = one + f4(0.2) * (wide - half)
    return red * dust, green * dust, blue * dust
