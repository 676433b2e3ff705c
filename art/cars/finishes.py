"""Materials of vehicles."""

from eyas.engine.state.mesh import Material, Surface


def plain(red: float, green: float, blue: float) -> Material:
    """Return a matt material, sRGB 0 to 1."""
    return Material(tint=(red, green, blue))


PAINT = Material(surface=Surface.PAINT)  # The body colour

BLACK_PAINT = Material(
    texture="bodywork_hatch_sunroof", tint=(0.26, 0.26, 0.26), surface=Surface.PAINT
)
"""A nearly black shade of the body colour, with the seams of a roof."""

GLASS = Material(tint=(0.115, 0.12, 0.125), surface=Surface.GLASS)  # Tinted windows
PANE = Material(texture="panes", tint=(0.62, 0.65, 0.67), surface=Surface.GLASS)
"""Tinted windows with their frames, and what is behind them."""

ROOF_GLASS = Material(
    texture="bodywork_saloon_sunroof", tint=(0.13, 0.14, 0.16), surface=Surface.GLASS
)
"""A glass roof, with the bars at its ends."""

HEAD_LAMP = Material(tint=(0.93, 0.94, 0.90), surface=Surface.LAMP, emission=4.5)
"""Front lamps; they shine when the weather has lamps on."""

TAIL_LAMP = Material(tint=(0.72, 0.05, 0.04), surface=Surface.TAIL_LAMP, emission=1.8)
"""Rear lamps; they shine when the weather has lamps on, and brighter when the vehicle brakes."""

HIGH_BRAKE_LAMP = Material(tint=(0.30, 0.03, 0.03), surface=Surface.HIGH_BRAKE_LAMP)
"""The third brake lamp."""

INDICATOR_LEFT = Material(tint=(0.80, 0.36, 0.05), surface=Surface.INDICATOR_LEFT)
"""Indicators, on the left of the vehicle."""

INDICATOR_RIGHT = Material(tint=(0.80, 0.36, 0.05), surface=Surface.INDICATOR_RIGHT)
"""Indicators, on the right of the vehicle."""

TRIM = plain(0.10, 0.10, 0.11)  # Grilles, bumpers, undersides
TYRE = plain(0.12, 0.12, 0.12)  # Rubber
RIM = plain(0.68, 0.69, 0.71)  # Wheel discs
STEEL = plain(0.34, 0.35, 0.37)  # Frames and tanks below the body
BRIGHT = plain(0.74, 0.75, 0.76)  # Polished metal
PLATE = plain(0.88, 0.88, 0.84)  # Number plates
SKIN_WHITE = plain(0.86, 0.87, 0.86)  # White panels of trailers and helmets
CLOTH = plain(0.24, 0.25, 0.29)  # A rider's suit
FREIGHT = Material(texture="freight", tint=(0.94, 0.95, 0.94))
"""White panels of boxes on wheels, with seams, doors and bars."""
