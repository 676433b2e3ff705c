"""Values of tags: lengths, numbers and colours as people write them. What is odd is None."""

import math
import re
from collections.abc import Callable

from eyas.maps.osm.reader import Tags

Odd = Callable[[str], None]  # Called with the name of a tag whose value makes no sense

Colour = tuple[float, float, float]

_UNITS = {"": 1.0, "m": 1.0, "km": 1000.0, "cm": 0.01, "ft": 0.3048, "feet": 0.3048, "'": 0.3048}
_FEET = re.compile(r"(\d+(?:\.\d+)?)\s*'\s*(?:(\d+(?:\.\d+)?)\s*\"?)?")
_LENGTH = re.compile(r"~?\s*(-?\d+(?:[.,]\d+)?)\s*([a-z']*)")


def length(
    tags: Tags,
    key: str,  # The one to read; absent, odd or outside of the limits: None
    limits: tuple[float, float],  # Least and largest believable value [m]
    odd: Odd,  # Told of a value that is not believed
) -> float | None:
    """Return the length that a tag tells, in metres."""
    text = tags.get(key)
    if text is None:
        return None
    first = text.split(";")[0].strip().lower()
    feet, plain = _FEET.fullmatch(first), _LENGTH.fullmatch(first)
    if feet:
        value = 0.3048 * float(feet[1]) + 0.0254 * float(feet[2] or 0)
    elif plain and plain[2] in _UNITS:
        value = float(plain[1].replace(",", ".")) * _UNITS[plain[2]]
    else:
        value = math.nan
    if limits[0] <= value <= limits[1]:
        return round(value, 3)
    odd(key)
    return None


def number(tags: Tags, key: str, limits: tuple[float, float], odd: Odd) -> float | None:
    """Return the number that a tag tells, such as `building:levels`; see `length`."""
    text = tags.get(key)
    if text is None:
        return None
    try:
        value = float(text.split(";")[0].strip().replace(",", "."))
    except ValueError:
        value = math.nan
    if limits[0] <= value <= limits[1]:
        return value
    odd(key)
    return None


def colour(tags: Tags, key: str, odd: Odd) -> Colour | None:
    """Return the colour that a tag names, sRGB 0 to 1: a name of CSS or a number such as `#c84`."""
    text = tags.get(key)
    if text is None:
        return None
    from PIL import ImageColor

    try:
        red, green, blue = ImageColor.getrgb(text.strip().lower().replace(" ", ""))[:3]
    except ValueError:
        odd(key)
        return None
    return red / 255, green / 255, blue / 255
