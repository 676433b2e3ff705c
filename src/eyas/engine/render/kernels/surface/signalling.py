"""Lamps with which vehicles signal: brake lamps and indicators."""

from eyas.engine.render.kernels.colours import Colour, where
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.engine.state.mesh import Surface
from eyas.lanes import kernel
from eyas.lanes.vector import any_of

_TAIL = int(Surface.TAIL_LAMP)

TAIL_LAMP = i4(_TAIL)
HIGH_BRAKE_LAMP = i4(int(Surface.HIGH_BRAKE_LAMP))
INDICATOR_LEFT = i4(int(Surface.INDICATOR_LEFT))
INDICATOR_RIGHT = i4(int(Surface.INDICATOR_RIGHT))

BRAKING = 1 << (int(Surface.TAIL_LAMP) - _TAIL) | 1 << (int(Surface.HIGH_BRAKE_LAMP) - _TAIL)
"""Bits of `eyas.engine.state.draw.DrawList.lamps` for a vehicle that brakes."""

LEFT = 1 << (int(Surface.INDICATOR_LEFT) - _TAIL)
"""The same for one whose indicators shine on the left."""

RIGHT = 1 << (int(Surface.INDICATOR_RIGHT) - _TAIL)  # The same on the right

_RED = (f4(4.2), f4(0.06), f4(0.04))
"""Radiance of brake lamps: five times that of tail lamps at night. UN Regulation 7 (R7, 6.1) asks
for 60 cd at least of the one and allows 12 cd at most of the other."""

_AMBER = (f4(3.6), f4(0.46), f4(0.03))
"""Radiance of indicators, of 50 cd and more (UN Regulation 6, 6.1)."""


@kernel(inline=True)
def signalled(
    colour: Colour,  # The radiance of points of the vehicle without them
    surface: int,  # A `Surface` of each point
    lamps: int,  # See `eyas.engine.state.draw.DrawList.lamps`, the same number for all points
) -> Colour:
    """Return radiances with those of the lamps of one vehicle that shine."""
    braking = i4(BRAKING)
    if lamps & braking == braking:
        shines = (surface == TAIL_LAMP) | (surface == HIGH_BRAKE_LAMP)
        colour = _with(colour, shines, _RED)
    if lamps & i4(LEFT) != 0:
        colour = _with(colour, surface == INDICATOR_LEFT, _AMBER)
    if lamps & i4(RIGHT) != 0:
        colour = _with(colour, surface == INDICATOR_RIGHT, _AMBER)
    return colour


@kernel(inline=True)
def _with(colour: Colour, shines: bool, light: Colour) -> Colour:
    """Return radiances with a light where it shines."""
    if any_of(shines):
        lit = colour[0] + light[0], colour[1] + light[1], colour[2] + light[2]
        colour = where(shines, lit, colour)
    return colour
