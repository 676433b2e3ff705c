"""Packing of a scene and a part library into the arrays of the kernels."""

import itertools
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from eyas.render.kernels.bundles import GROUP, Geometry
from eyas.render.kernels.visibility.clusters import BOUNDS_ROWS, CLUSTER, CLUSTER_ROWS, UV_ROWS
from eyas.render.pack.boxes import (
    box_of,
    columns_of,
    group_boxes,
    posed_boxes,
    silhouette,
    sphere_of,
)
from eyas.render.pack.clusters import (
    bounds_of,
    by_clusters,
    cluster_order,
    clusters_of,
    filled_up,
)
from eyas.render.pack.materials import material_table
from eyas.render.pack.triangles import (
    gradients,
    shading_rows,
    solid_triangles,
)
from eyas.render.textures.mipmap import packed_layers
from eyas.state.draw import PartLibrary
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.scene import ObjectClass, Scene

__all__ = ["CHUNK", "build_geometry"]

CHUNK = 32.0
"""Side of the squares into which static triangles are sorted [m]."""

_FIXTURE_CELL = 6.0
"""Side of the squares by which fixtures are sorted, so that groups of them are small [m]."""

_HIGH = 4.0
"""Height above which things are grouped separately [m]."""

_Palette = tuple[tuple[Material, ...], NDArray[np.int32], NDArray[np.bool_]]
"""Materials, their indices in the palette of the pool, and whether they are of leaves."""


def build_geometry(
    scene: Scene, parts: PartLibrary, textures: Mapping[str, NDArray[np.uint8]]
) -> Geometry:
    """Return everything that can be drawn.

    Args:
        scene: The static scene.
        parts: Parts of the moving things.
        textures: sRGB and alpha by name, shape (256, 256, 4) each.

    Raises:
        UnknownNameError: A material names a missing texture.
    """
    pool = _Pool()
    chunk_range, chunk_boxes = _add_chunks(pool, scene)
    prototypes = (*scene.fixtures.levels, *parts.parts)
    mesh_range = [pool.add(mesh, None) for levels in prototypes for mesh in levels]
    # Around all levels of detail: what is culled must not stick out.
    points = [np.concatenate([mesh.positions for mesh in levels]) for levels in prototypes]
    box = np.array([box_of(positions) for positions in points], np.float32).reshape(-1, 6)
    sphere = [sphere_of(positions) for positions in points]
    order = _fixture_order(scene.fixtures.pose[:, :, 3])
    pose = np.ascontiguousarray(scene.fixtures.pose[order], np.float32)
    prototype = scene.fixtures.prototype[order].astype(np.int32)
    palette = tuple(pool.palette)
    names = sorted({material.texture for material in palette} | {"plain"})
    fixture_boxes = posed_boxes(box[prototype], pose)
    materials = material_table(scene, parts, palette, names)
    material = np.concatenate([np.zeros(0, np.int32), *pool.materials])
    objects = np.concatenate([np.zeros(0, np.int32), *pool.objects])
    slopes = np.concatenate([np.zeros((0, 24), np.float32), *pool.gradients])
    return Geometry(
        cluster=np.concatenate([np.zeros((0, CLUSTER_ROWS, CLUSTER), np.float32), *pool.clusters]),
        bounds=np.concatenate([np.zeros((0, BOUNDS_ROWS, CLUSTER), np.float32), *pool.bounds]),
        corner_uv=np.concatenate([np.zeros((0, UV_ROWS, CLUSTER), np.float32), *pool.corner_uvs]),
        shading=shading_rows(slopes, objects, materials.of(material)),
        material=material,
        object_id=objects,
        object_class=np.append(scene.object_class, ObjectClass.SKY).astype(np.uint8),
        chunk_box=columns_of(chunk_boxes, GROUP),
        chunk_group_box=columns_of(group_boxes(chunk_boxes), CLUSTER),
        chunk_range=chunk_range,
        mesh_range=np.array(mesh_range, np.int32).reshape(-1, 3),
        level_first=np.cumsum([0, *[len(levels) for levels in prototypes]]).astype(np.int32),
        part_first=len(scene.fixtures.levels),
        sphere=np.array(sphere, np.float32).reshape(-1, 4),
        box=box,
        silhouette=np.array([silhouette(m[0]) for m in prototypes], np.float32).reshape(-1, 7),
        lamps=_lamps(scene, parts),
        fixture_prototype=prototype,
        fixture_pose=pose,
        fixture_object=scene.fixtures.object_id[order].astype(np.int32),
        fixture_box=columns_of(fixture_boxes, GROUP),
        fixture_group_box=columns_of(group_boxes(fixture_boxes), CLUSTER),
        layer=materials.layer,
        surface=materials.surface,
        tint=materials.tint,
        texture=packed_layers(textures, names),
    )


def _lamps(scene: Scene, parts: PartLibrary) -> NDArray[np.bool_]:
    """Return `Geometry.lamps`."""
    of_parts = parts.lamps or (False,) * len(parts.parts)
    assert len(of_parts) == len(parts.parts), "lamps: one flag for each part is wanted"
    return np.array((False,) * len(scene.fixtures.levels) + of_parts, np.bool_)


class _Pool:
    """All triangles, one mesh after the other, with one palette."""

    def __init__(self) -> None:
        self.palette: dict[Material, int] = {}
        self.clusters: list[NDArray[np.float32]] = []
        self.bounds: list[NDArray[np.float32]] = []
        self.corner_uvs: list[NDArray[np.float32]] = []
        self.gradients: list[NDArray[np.float32]] = []
        self.materials: list[NDArray[np.int32]] = []
        self.objects: list[NDArray[np.int32]] = []
        self._cluster_count = 0
        self._bounds_count = 0
        self._last: _Palette = ((), np.zeros(0, np.int32), np.zeros(0, np.bool_))

    def add(
        self,
        mesh: Mesh,
        objects: NDArray[np.int32] | None,
        sizes: NDArray[np.float32] | None = None,
    ) -> tuple[int, int, int]:
        """Append a mesh; return its ranges as in `Geometry.mesh_range`."""
        keep = np.flatnonzero(solid_triangles(mesh))
        if len(keep) == 0:  # the level of detail of what is too small to be seen
            first = CLUSTER * self._cluster_count
            return first, first, self._bounds_count
        lookup, leafy = self._looked_up(mesh.palette)
        size = np.full(len(keep), np.inf, np.float32) if sizes is None else sizes[keep]
        order = cluster_order(
            mesh.positions[mesh.triangles[keep]], size, leafy[mesh.materials[keep]]
        )
        keep, size = keep[order], size[order]
        triangles, material = mesh.triangles[keep], mesh.materials[keep]
        slopes = gradients(mesh.positions, mesh.normals, mesh.uvs, triangles)
        clusters = clusters_of(
            mesh.positions[triangles],
            size,
            np.where(leafy[material], np.abs(slopes[:, 23]), -1.0),
        )
        bounds = bounds_of(clusters)
        self.clusters.append(clusters)
        self.bounds.append(bounds)
        self.corner_uvs.append(by_clusters(mesh.uvs[triangles].reshape(-1, UV_ROWS)))
        self.gradients.append(filled_up(slopes))
        self.materials.append(filled_up(lookup[material]))
        none = np.full(len(keep), -1, np.int32)
        self.objects.append(filled_up(none if objects is None else objects[keep]))
        first, row = CLUSTER * self._cluster_count, self._bounds_count
        self._cluster_count += len(clusters)
        self._bounds_count += len(bounds)
        return first, first + len(keep), row

    def _looked_up(
        self, palette: tuple[Material, ...]
    ) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
        """Return the index in the pool's palette of each material, and whether it is of leaves."""
        if self._last[0] is not palette:  # all chunks have the same
            index = [self.palette.setdefault(m, len(self.palette)) for m in palette]
            leafy = [material.surface == Surface.FOLIAGE for material in palette]
            self._last = palette, np.array(index, np.int32), np.array(leafy, np.bool_)
        return self._last[1:]


def _add_chunks(pool: _Pool, scene: Scene) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Add the static mesh square by square; return `chunk_range` and boxes, shape (C, 6)."""
    mesh = scene.static
    corners = mesh.positions[mesh.triangles]
    middle = (corners.min(axis=1) + corners.max(axis=1))[:, :2] / 2
    cell = np.floor(middle / CHUNK).astype(np.int64)
    cell -= cell.min(axis=0, initial=0)
    # A triangle much larger than a square would enlarge that square's box, so it is kept apart.
    span = (corners.max(axis=1) - corners.min(axis=1))[:, :2].max(axis=1, initial=0)
    key = np.where(span > 4 * CHUNK, -1, _morton(cell))
    size = _detail_sizes(scene, corners)
    order = np.lexsort((-size, key))
    starts = np.flatnonzero(np.diff(key[order], prepend=-2, append=-3) != 0)
    ranges, boxes = [], []
    for first, last in itertools.pairwise(starts):
        index = order[first:last]
        part = Mesh(
            positions=mesh.positions,
            normals=mesh.normals,
            uvs=mesh.uvs,
            triangles=mesh.triangles[index],
            materials=mesh.materials[index],
            palette=mesh.palette,
        )
        objects = scene.static_object[index].astype(np.int32)
        ranges.append(pool.add(part, objects, size[index]))
        boxes.append(box_of(mesh.positions[part.triangles].reshape(-1, 3)))
    return (
        np.array(ranges, np.int32).reshape(-1, 3),
        np.array(boxes, np.float32).reshape(-1, 6),
    )


def _detail_sizes(scene: Scene, corners: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return `Geometry.size`: details are paint on roads, and parts of buildings before others."""
    kind = scene.object_class[scene.static_object]
    detail = np.isin(kind, (ObjectClass.MARKING, ObjectClass.BUILDING))
    sides = corners[:, 1:] - corners[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return np.where(detail, np.sqrt(area), np.inf).astype(np.float32)


def _fixture_order(points: NDArray[np.float32]) -> NDArray[np.intp]:
    """Return an order that keeps neighbours together and high things apart."""
    cell = np.floor(points[:, :2] / _FIXTURE_CELL).astype(np.int64)
    key = _morton(cell - cell.min(axis=0, initial=0))
    return np.lexsort((key, points[:, 2] > _HIGH))


def _morton(cell: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return numbers that interleave the bits of x and y (G. M. Morton, 1966)."""
    number = np.zeros(len(cell), np.int64)
    for bit in range(16):
        for axis in range(2):
            number |= ((cell[:, axis] >> bit) & 1) << (2 * bit + axis)
    return number
