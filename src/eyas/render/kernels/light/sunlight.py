"""Light that comes straight from the sun."""

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.bundles import Light
from eyas.render.kernels.scalars import f4, u4

__all__ = ["sunlight"]


@inlined_kernel
def _sunlit(light: Light, x: float, y: float, z: float) -> float:
    """Return how much of the sun reaches a point, 0 to 1, blended over four texels."""
    rows = light.shadow_rows
    column = rows[0, 0] * x + rows[0, 1] * y + rows[0, 2] * z + rows[0, 3] - f4(0.5)
    line = rows[1, 0] * x + rows[1, 1] * y + rows[1, 2] * z + rows[1, 3] - f4(0.5)
    height = rows[2, 0] * x + rows[2, 1] * y + rows[2, 2] * z + rows[2, 3]
    lines, columns = light.shadow_map.shape
    one, zero = f4(1.0), f4(0.0)
    height = max(height, zero)  # the map's zero is nothing at all
    if not (column > zero and line > zero and column < f4(columns - 2) and line < f4(lines - 2)):
        return one
    i, j = u4(line), u4(column)
    across, down = column - f4(j), line - f4(i)
    right, lower = j + u4(1), i + u4(1)
    a = one if f4(light.shadow_map[i, j]) <= height else zero
    b = one if f4(light.shadow_map[i, right]) <= height else zero
    c = one if f4(light.shadow_map[lower, j]) <= height else zero
    d = one if f4(light.shadow_map[lower, right]) <= height else zero
    upper = a + across * (b - a)
    return f4(upper + down * (c + across * (d - c) - upper))


@inlined_kernel
def sunlight(
    light: Light,
    x: float,
    y: float,
    z: float,
    normal: tuple[float, float, float],
    sun_share: float,
    leafy: bool,
) -> tuple[float, float]:
    """Return the sunlight on a surface, and the share of the sun's light that reaches it.

    Args:
        light: Sun and shadow map.
        x: The point [m].
        y: The point [m].
        z: The point [m].
        normal: Unit normal of the surface.
        sun_share: Sunlight that moving things let through, 0 to 1.
        leafy: Whether light goes through the surface.
    """
    zero = f4(0.0)
    lean = normal[0] * light.sun[0] + normal[1] * light.sun[1] + normal[2] * light.sun[2]
    away, through = light.air[3], zero
    if leafy:  # light goes through leaves, and gaps between them are not on the map
        lean = f4(0.2) + (f4(0.8) * lean if lean > zero else f4(-0.3) * lean)
        away += f4(0.7)
        through = f4(0.15)
    if lean <= zero:
        return zero, zero
    reaching = _sunlit(light, x + away * normal[0], y + away * normal[1], z + away * normal[2])
    reaching = sun_share * (through + (f4(1.0) - through) * reaching)
    return lean * reaching, reaching
