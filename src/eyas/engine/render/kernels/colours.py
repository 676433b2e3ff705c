"""Numbers and colours of points: brought into a range, chosen, blended."""

from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import kernel
from eyas.lanes.vector import greater, lesser, select

Colour = tuple[float, float, float]
Vector = Colour


@kernel(inline=True)
def clip(value: float) -> float:
    """Return a value brought into 0 to 1."""
    return lesser(greater(value, f4(0.0)), f4(1.0))


@kernel(inline=True)
def where(mask: int, a: Colour, b: Colour) -> Colour:
    """Return the colour, or the vector, `a` where the mask is set, else `b`."""
    return select(mask, a[0], b[0]), select(mask, a[1], b[1]), select(mask, a[2], b[2])


@kernel(inline=True)
def blended(a: Colour, b: Colour, share: float) -> Colour:
    """Return a colour on the way from one to another."""
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])
