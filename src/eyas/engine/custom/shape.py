"""Triangles made ready to draw: simplified, with normals and materials."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from eyas.engine.custom.mesh_file import Triangles
from eyas.engine.state.mesh import Material, Mesh
from eyas.lanes import exact

_COLOURS = 64  # Largest number of colours of a target
_CREASE = exact.cos(np.radians(40.0))
"""Cosine of the angle between two faces above which the edge between them is sharp."""

_SHARES = (1.0, 0.25, 0.06)
"""Share of the triangles that each level of detail has, at least `_FEW` of them."""

_FEW = 60

Floats = NDArray[np.float64]


def levels_of_detail(shape: Triangles) -> tuple[Mesh, ...]:
    """Return the meshes of a shape, the finest first."""
    wanted = [max(round(share * len(shape.corners)), _FEW) for share in _SHARES]
    return tuple(mesh_of(simplified(shape, most)) for most in wanted)


def simplified(shape: Triangles, most: int) -> Triangles:
    """Return a shape with at most so many triangles: vertices in one cell of a grid become one.

    The grid is the finest that suffices, to a twentieth.
    """
    if len(shape.corners) <= most:
        return shape
    extent = max(shape.size)
    low, high = 0.0, extent
    best = _clustered(shape, extent)
    while high - low > max(0.05 * high, 1e-6 * extent):  # many triangles may be mere points
        cell = 0.5 * (low + high)
        tried = _clustered(shape, cell)
        if len(tried.corners) <= most:
            best, high = tried, cell
        else:
            low = cell
    return best


def mesh_of(shape: Triangles) -> Mesh:
    """Return a mesh with smooth normals, except at sharp edges, and at most 64 colours."""
    normals = _corner_normals(shape)
    rounded = np.rint(normals * 512.0).astype(np.int64)
    keys = np.column_stack([shape.corners.ravel(), rounded.reshape(-1, 3)])
    _, chosen, triangles = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    vertex = shape.corners.ravel()[chosen]
    colour, materials = _palette(shape.colours)
    return Mesh(
        positions=shape.points[vertex].astype(np.float32),
        normals=normals.reshape(-1, 3)[chosen].astype(np.float32),
        uvs=np.zeros((len(chosen), 2), np.float32),
        triangles=triangles.reshape(-1, 3).astype(np.int32),
        materials=materials.astype(np.int32),
        palette=tuple(Material(tint=(r, g, b)) for r, g, b in colour.tolist()),
    )


def _clustered(shape: Triangles, cell: float) -> Triangles:
    cells = np.floor(shape.points / cell).astype(np.int64)
    place = np.ravel_multi_index(tuple((cells - cells.min(0)).T), tuple(np.ptp(cells, 0) + 1))
    _, member = np.unique(place, return_inverse=True)  # ten times as fast as of rows
    count = np.bincount(member)
    columns = [np.bincount(member, shape.points[:, axis]) / count for axis in range(3)]
    corners = member[shape.corners]
    a, b, c = corners.T
    kept = (a != b) & (b != c) & (c != a)
    return Triangles(np.column_stack(columns), corners[kept], shape.colours[kept])


def _corner_normals(shape: Triangles) -> Floats:
    """Return a unit normal for each corner of each triangle, shape (T, 3, 3).

    It is the mean of the faces that meet there, by their areas, without those behind an edge.
    """
    a, b, c = np.moveaxis(shape.points[shape.corners], 1, 0)
    across = np.cross(b - a, c - a)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    face = across / np.where(length > 0.0, length, 1.0)
    # Files may repeat a vertex for each face; positions tell what meets.
    _, place = np.unique(np.round(shape.points, 6), axis=0, return_inverse=True)
    corner = place.ravel()[shape.corners].ravel()
    order = np.argsort(corner, kind="stable")
    _, first, number = np.unique(corner[order], return_index=True, return_counts=True)
    total = np.zeros((len(order), 3))
    owner = order // 3
    group = np.repeat(np.arange(len(first)), number)
    for step in range(int(number.max())):
        # Each corner with the one `step` places after it, round its vertex.
        here = number[group] > step
        at = np.arange(len(order)) - first[group]
        other = first[group] + (at + step) % number[group]
        mine, theirs = owner[here], owner[other[here]]
        near = (face[mine] * face[theirs]).sum(axis=1) > _CREASE
        total[order[here]] += np.where(near[:, None], across[theirs], 0.0)
    size = np.linalg.norm(total, axis=1, keepdims=True)
    normals = np.where(size > 0.0, total / np.where(size > 0.0, size, 1.0), [0.0, 0.0, 1.0])
    return np.asarray(normals.reshape(-1, 3, 3), np.float64)


def _palette(colours: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Return at most 64 colours, and that of each triangle."""
    pixels = np.rint(np.clip(colours, 0.0, 1.0) * 255.0).astype(np.uint8)
    distinct, index = np.unique(pixels, axis=0, return_inverse=True)
    if len(distinct) > _COLOURS:
        few = Image.fromarray(pixels[:, None]).quantize(_COLOURS, Image.Quantize.MEDIANCUT)
        table = np.array(few.getpalette(), np.uint8).reshape(-1, 3)
        distinct, index = np.unique(table[np.array(few)[:, 0]], axis=0, return_inverse=True)
    return distinct / 255.0, index.ravel()
