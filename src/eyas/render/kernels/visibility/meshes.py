"""Drawing of meshes into the visibility buffer."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inner_kernel
from eyas.render.kernels.bundles import Geometry
from eyas.render.kernels.scalars import f4, i8
from eyas.render.kernels.surface.texture import level_of
from eyas.render.kernels.visibility.rasterise import BOTH_SIDES, FRONT, rasterise
from eyas.render.kernels.visibility.transform import clip_near, to_screen
from eyas.state.draw import DrawStage
from eyas.state.mesh import Surface

__all__ = ["draw_mesh", "level_of_detail"]

FOLIAGE = int(Surface.FOLIAGE)
VERTICES = int(DrawStage.VERTICES)

PIXELS_PER_TRIANGLE = 1.5
"""Size of the triangles for which a level of detail is fine enough [pixels]."""

SMALLEST_HOLES = 4
"""Mip level from which on leaves have no holes: a leaf would be smaller than a pixel."""


@inner_kernel
def level_of_detail(
    geometry: Geometry, prototype: int, radius: float, distance: float, focal: float
) -> int:
    """Return the mesh to draw for a prototype of a radius [m] at a distance [m]."""
    size = 2.0 * radius * focal / max(distance - radius, 1e-3)
    last = i8(geometry.level_first[prototype + 1]) - 1
    for mesh in range(geometry.level_first[prototype], last):
        triangles = geometry.mesh_range[mesh, 1] - geometry.mesh_range[mesh, 0]
        if triangles * PIXELS_PER_TRIANGLE <= size * size:
            return mesh
    return last


@inner_kernel
def draw_mesh(
    until: int,
    geometry: Geometry,
    rows: NDArray[np.float64],
    ranges: NDArray[np.int32],
    index: int,
    instance: int,
    focal: float,
    smallest: float,
    width: float,
    height: float,
    top: int,
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
    screen: NDArray[np.float64],
    polygon: NDArray[np.float64],
) -> None:
    """Draw a chunk or a level of detail.

    Args:
        until: See `DrawStage`.
        geometry: Everything that can be drawn.
        rows: Maps the mesh's vertices to the screen.
        ranges: `chunk_range` or `mesh_range`.
        index: Row of `ranges`.
        instance: -1 for the static mesh, see `Scratch.owner`.
        focal: Focal length over the scale of the object [pixels].
        smallest: Size of the smallest detail to draw, see `Geometry.size` [m].
        width: Width of the picture [pixels].
        height: Height of the picture [pixels].
        top: Row of the picture that is row 0 of `depth`.
        depth: See `Scratch`.
        owner: See `Scratch`.
        screen: See `Scratch`.
        polygon: See `Scratch`.
    """
    if until < VERTICES:
        return
    middle_x, middle_y = 0.5 * width, 0.5 * height
    offset = ranges[index, 2]
    to_screen(rows, geometry.positions, offset, ranges[index, 3], middle_x, middle_y, screen)
    if until == VERTICES:
        return
    base = (i8(instance) + 1) << i8(32)
    bottom = top + depth.shape[0]
    for triangle in range(ranges[index, 0], ranges[index, 1]):
        if geometry.size[triangle] < smallest:
            break  # all that follow are small, too
        a = geometry.corners[triangle, 0] - offset
        b = geometry.corners[triangle, 1] - offset
        c = geometry.corners[triangle, 2] - offset
        material = geometry.material[triangle]
        leafy = geometry.surface[material] == FOLIAGE
        clear = screen[a, 2] > 0.0 and screen[b, 2] > 0.0 and screen[c, 2] > 0.0
        tag = base | i8(triangle)
        if clear and not leafy:
            rasterise(
                screen, a, b, c, top, depth, owner, tag, FRONT, geometry.texture, 0, -1
            )  # fmt: skip
            continue
        if clear and max(screen[a, 1], screen[b, 1], screen[c, 1]) < top:
            continue
        if clear and min(screen[a, 1], screen[b, 1], screen[c, 1]) > bottom:
            continue
        count = clip_near(screen, geometry.uvs, offset, a, b, c, middle_x, middle_y, polygon)
        level, sides = -1, BOTH_SIDES if leafy else FRONT
        if leafy and count > 0:
            span = 256.0 * abs(geometry.gradients[triangle, 23]) / (focal * polygon[0, 2])
            level = level_of(f4(span * span))
            if level >= SMALLEST_HOLES:
                level = -1
        for k in range(1, count - 1):
            rasterise(
                polygon, 0, k, k + 1, top, depth, owner, tag, sides, geometry.texture,
                geometry.layer[material], level,
            )  # fmt: skip
