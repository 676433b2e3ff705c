"""What can be drawn."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

GROUP = 16  # Chunks, or fixtures, that are culled together first

SHADING_COLUMNS = 16
"""Columns of `Geometry.shading`: a row fills a line of a cache of 64 bytes."""

BENT_COLUMNS = 12  # Columns of `Geometry.bent`

LOOK_COLUMNS = 8  # Columns of `Geometry.look`


class Geometry(NamedTuple):
    """Everything that can be drawn, packed once for each scene."""

    cluster: NDArray[np.float32]
    """Eight triangles in each cluster, see `eyas.engine.render.kernels.visibility.clusters`:
    corners [m], those of static chunks in the world frame, of prototypes in their own; size; tiles
    in a metre of leaves; shape (T / 8, 11, 8)."""
    bounds: NDArray[np.float32]
    """Eight clusters of a mesh in each row, see the same: box, cone of the normals, size,
    shape (., 14, 8)."""
    corner_uv: NDArray[np.float32]
    """Texture coordinates u and v of corner a, of b and of c [tiles] of the eight triangles in each
    cluster with leaves, whose holes they place, after a row of zeros, shape (., 6, 8)."""
    uv_row: NDArray[np.int32]  # Row of `corner_uv` of each cluster, 0: no leaves, shape (T / 8,)
    shading: NDArray[np.float32]
    """Data of each triangle for shading in one place: columns 0 to 13 of `gradients` in
    `eyas.engine.render.pack.triangles`; tiles in a metre, negative where the normal is not the same
    all over: there the first component of the normal gives way to a row of `bent`; material, and
    object id times 65,536, -1 for prototypes. Whole numbers lie there as int32. Shape (T,
    SHADING_COLUMNS)."""
    bent: NDArray[np.float32]
    """Gradients of the normal where it is not the same all over, and the normal at the corner,
    shape (., BENT_COLUMNS)."""
    look: NDArray[np.float32]
    """What shading needs of each material: texture; surface, and bed of snow times 256; tint;
    emission; middle of the crown; nothing. Shape (., LOOK_COLUMNS)."""
    object_class: NDArray[np.uint8]
    """`eyas.engine.state.scene.ObjectClass` of each object of the scene, then of the sky,
    shape (O + 1,)."""
    chunk_box: NDArray[np.float32]
    """Lower and upper corner [m] of each chunk in a column, then of boxes that are nowhere, up to
    a multiple of `GROUP`, shape (6, .)."""
    chunk_group_box: NDArray[np.float32]
    """Box around each `GROUP` chunks in a row, likewise up to a multiple of 8, shape (6, .)."""
    chunk_range: NDArray[np.int32]
    """First and last + 1 triangle, first row of `bounds`, shape (C, 3)."""
    mesh_range: NDArray[np.int32]  # The same for each mesh, shape (M, 3)
    level_first: NDArray[np.int32]  # First mesh of each prototype, shape (P + 1,)
    part_first: int  # Prototype of part 0
    sphere: NDArray[np.float32]  # Centre and radius around each prototype [m], shape (P, 4)
    box: NDArray[np.float32]  # Lower and upper corner of each prototype [m], shape (P, 6)
    silhouette: NDArray[np.float32]
    """Two boxes for the shadow of each prototype: height of the waist between them; back, front,
    right and left end of the upper one; right and left end of the lower one [m], shape (P, 7)."""
    lamps: NDArray[np.bool_]
    """Whether things of which each prototype is the largest part have head and tail lamps, shape
    (P,)."""
    fixture_prototype: NDArray[np.int32]  # Shape (F,)
    fixture_pose: NDArray[np.float32]  # Shape (F, 3, 4)
    fixture_object: NDArray[np.int32]  # Shape (F,)
    fixture_box: NDArray[np.float32]  # Boxes around the fixtures, like `chunk_box`, shape (6, .).
    fixture_group_box: NDArray[np.float32]
    """Box around each `GROUP` fixtures in a row, like `chunk_group_box`, shape (6, .)."""
    layer: NDArray[np.int32]  # Texture of each material
    surface: NDArray[np.int32]  # `Surface` of each material
    tint: NDArray[np.float32]  # Linear colour factor of each material, shape (., 3).
    texture: NDArray[np.uint32]
    """Texels of each layer, see `eyas.engine.render.kernels.surface.texture`, row 0 at v = 0:
    square roots of linear red, green, blue, and alpha, a byte each, the lowest byte first, shape
    (., TEXELS)."""


class Movers(NamedTuple):
    """The draw list of each world, see `eyas.engine.state.draw.DrawList`."""

    part: NDArray[np.int32]
    pose: NDArray[np.float32]
    colour: NDArray[np.float32]
    object_id: NDArray[np.int32]
    object_class: NDArray[np.uint8]
    lamps: NDArray[np.uint8]
    spray: NDArray[np.float32]
