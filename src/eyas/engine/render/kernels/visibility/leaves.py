"""Which triangles are leaves, and at which mip level of their texture they are drawn."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import SHADING_COLUMNS, Geometry
from eyas.engine.render.kernels.scalars import i4, i8
from eyas.engine.render.kernels.visibility.clusters import CLUSTER, CLUSTER_ROWS, LEAVES
from eyas.engine.render.kernels.visibility.holes import LEVELS, holes_level
from eyas.engine.render.kernels.visibility.triangles import INVERSE
from eyas.lanes import kernel
from eyas.lanes.vector import bit_pattern, gather

_TEXELS = 256.0  # Texels along a side of a texture


@kernel(inline=True)
def tiles_of(geometry: Geometry, at: int) -> float:
    """Return `LEAVES` of triangle `at`."""
    row = at // CLUSTER * CLUSTER_ROWS + LEAVES
    return gather(geometry.cluster, row * CLUSTER + at % CLUSTER)


@kernel(inline=True)
def material_of(geometry: Geometry, at: int) -> int:
    """Return the material of triangle `at`."""
    word = gather(geometry.shading, at * SHADING_COLUMNS + SHADING_COLUMNS - 1)
    return i8(bit_pattern(word) & i4(0xFFFF))


@kernel(inline=True)
def leaves_of(
    geometry: Geometry,  # Everything that can be drawn
    at: int,  # The triangle's number
    triangle: NDArray[np.float64],  # See `Scratch`
    column: int,  # Its column there
    focal: float,  # See `draw_mesh`
) -> int:
    """Return the layer of a triangle's leaves times `LEVELS`, and its mip level; -1: no holes."""
    tiles = tiles_of(geometry, at)
    if tiles < 0.0:
        return i8(-1)
    level = holes_level(_TEXELS * tiles / (focal * gather(triangle, INVERSE * CLUSTER + column)))
    if level < 0:
        return i8(-1)
    return i8(gather(geometry.layer, material_of(geometry, at))) * LEVELS + level
