"""What the land is like around a point: under trees, open to mist."""

from eyas.engine.render.kernels.bundles import Light
from eyas.engine.render.kernels.scalars import f4, i4, u4
from eyas.lanes import kernel
from eyas.lanes.vector import gather, select, to_f4, to_i4

_OUTSIDE = f4(0.72)
"""How open to mist land beyond the map is: as fields on it, see `eyas.engine.render.bake.land`."""


@kernel(inline=True)
def land_at(light: Light, x: float, y: float) -> tuple[float, float]:
    """Return how much a place lies under trees, and how open to mist it is, each 0 to 1.

    Beyond the map it is open land without trees.

    Args:
        light: Its map, see `eyas.engine.render.bake.land.land_map`.
        x: The place [m].
        y: The place [m].
    """
    frame, zero, unit = light.ambient_frame, f4(0.0), f4(1.0 / 255.0)
    rows, columns = light.land.shape
    column, row = (x - frame.west) * frame.per_metre, (y - frame.south) * frame.per_metre
    inside = (column >= zero) & (row >= zero) & (column < f4(columns)) & (row < f4(rows))
    i, j = to_i4(select(inside, row, zero)), to_i4(select(inside, column, zero))
    word = gather(light.land, i * i4(columns) + j)
    under, open_ = to_f4(word & u4(255)) * unit, to_f4(word >> u4(8)) * unit
    return select(inside, under, zero), select(inside, open_, _OUTSIDE)
