"""Light that comes straight from the sun."""

from eyas.engine.render.kernels.bundles import TILE, Direction, Light
from eyas.engine.render.kernels.scalars import f4, i4, u4
from eyas.lanes import kernel
from eyas.lanes.vector import (
    any_of,
    gather,
    gather_pair,
    gather_pair_after,
    greater,
    lesser,
    like,
    select,
    to_f4,
    to_i4,
)

TILE_BITS = i4(TILE.bit_length() - 1)

_EMPTY = i4((TILE + 1) * (TILE + 1))  # Texels of the first tile, in which nothing casts a shadow


@kernel(inline=True)
def _first_texel(light: Light, line: int, column: int) -> int:
    """Return the index in `Light.shadow_texel` of a texel of the map; its neighbours in the next
    column and line, and the one beside both, lie in the same tile.
    """
    tile = (line >> TILE_BITS) * i4(light.shadow_tile.shape[1]) + (column >> TILE_BITS)
    return to_i4(gather(light.shadow_tile, to_i4(tile)) + line * i4(TILE + 1) + column)


@kernel(inline=True)
def sunlit(light: Light, x: float, y: float, z: float) -> float:
    """Return how much of the sun reaches a point, 0 to 1, blended over four texels."""
    rows, texels = light.shadow_rows, light.shadow_texel
    lines, columns = light.shadow_tile.shape
    column = x * rows[0, 0] + y * rows[0, 1] + (rows[0, 3] - f4(0.5))  # which are level
    line = x * rows[1, 0] + y * rows[1, 1] + z * rows[1, 2] + (rows[1, 3] - f4(0.5))
    zero, one = f4(0.0), like(x, f4(1.0))
    # The outermost tiles are empty: places beyond them are lit, like theirs.
    column = greater(lesser(column, f4(i4(columns * TILE - 1))), zero)
    line = greater(lesser(line, f4(i4(lines * TILE - 1))), zero)
    i, j = to_i4(line), to_i4(column)
    across = column - to_f4(j)
    at, left = _first_texel(light, i, j), one - across
    lit = left + across
    if any_of(at >= _EMPTY):
        height = x * rows[2, 0] + y * rows[2, 1] + z * rows[2, 2] + rows[2, 3]
        top = to_i4(greater(height, zero))  # the map's zero is nothing at all
        upper, lower = gather_pair(texels, at), gather_pair_after(texels, at, TILE + 1)
        half, low = u4(16), u4(0xFFFF)
        above = select(to_i4(upper & low) <= top, left, zero)
        above += select(to_i4(upper >> half) <= top, across, zero)
        below = select(to_i4(lower & low) <= top, left, zero)
        below += select(to_i4(lower >> half) <= top, across, zero)
        lit = above + (line - to_f4(i)) * (below - above)
    return lit


@kernel(inline=True)
def sunlight(
    light: Light,  # Its shadow map
    sun: Direction,  # Unit vector towards the sun
    offset: float,  # See `Air.offset` [m]
    point: tuple[float, float, float],  # The point [m]
    normal: tuple[float, float, float],  # Unit normal of the surface
    sun_share: float,  # Sunlight that moving things let through, 0 to 1
    leafy: bool,  # Whether light goes through the surface
    any_leafy: bool,  # Whether it does at any point, the same for all
) -> tuple[float, float]:
    """Return the sunlight on a surface, and the share of the sun's light that reaches it."""
    zero, one = f4(0.0), f4(1.0)
    lean = normal[0] * sun.x + normal[1] * sun.y + normal[2] * sun.z
    away, through = like(lean, offset), like(lean, zero)
    if any_leafy:  # light goes through leaves, and gaps between them are not on the map
        both = f4(0.2) + select(lean > zero, f4(0.8) * lean, f4(-0.3) * lean)
        lean = select(leafy, both, lean)
        away = select(leafy, away + f4(0.7), away)
        through = select(leafy, f4(0.15), through)
    faces = lean > zero
    reaching = like(lean, zero)
    if any_of(faces):
        x, y, z = point
        x, y, z = x + away * normal[0], y + away * normal[1], z + away * normal[2]
        reaching = sun_share * (through + (one - through) * sunlit(light, x, y, z))
        reaching = select(faces, reaching, zero)
    return select(faces, lean, zero) * reaching, reaching
