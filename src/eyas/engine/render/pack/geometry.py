"""Packing of a scene and a part library into the arrays of the kernels."""

import itertools
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import GROUP, Geometry
from eyas.engine.render.kernels.visibility.clusters import CLUSTER
from eyas.engine.render.pack.boxes import (
    box_of,
    columns_of,
    group_boxes,
    posed_boxes,
    silhouette,
    sphere_of,
)
from eyas.engine.render.pack.clusters import ends_of
from eyas.engine.render.pack.materials import material_table
from eyas.engine.render.pack.pool import Pool
from eyas.engine.render.pack.triangles import looks_of, shading_rows
from eyas.engine.render.textures.mipmap import packed_layers
from eyas.engine.state.draw import PartLibrary
from eyas.engine.state.scene import ObjectClass, Scene

CHUNK = 32.0  # Side of the squares into which static triangles are sorted [m]

_FIXTURE_CELL = 6.0
"""Side of the squares by which fixtures are sorted, so that groups of them are small [m]."""

_HIGH = 4.0  # Height above which things are grouped separately [m]


def build_geometry(
    scene: Scene,  # The static scene
    parts: PartLibrary,  # Parts of the moving things
    textures: Mapping[str, NDArray[np.uint8]],  # sRGB and alpha by name, shape (256, 256, 4) each
) -> Geometry:
    """Return everything that can be drawn.

    Raises:
        UnknownNameError: A material names a missing texture.
    """
    pool = Pool()
    chunk_box = _add_chunks(pool, scene)
    prototypes = (*scene.fixtures.levels, *parts.parts)
    for mesh in itertools.chain.from_iterable(prototypes):
        pool.add(mesh)
    meshes, palette, chunks = pool.packed(), tuple(pool.palette), len(chunk_box)
    # What is culled must not stick out of the box of any of its levels.
    points = [np.concatenate([mesh.positions for mesh in levels]) for levels in prototypes]
    box = np.array([box_of(each) for each in points], np.float32).reshape(-1, 6)
    order = _fixture_order(scene.fixtures.pose[:, :, 3])
    pose = np.ascontiguousarray(scene.fixtures.pose[order], np.float32)
    prototype = scene.fixtures.prototype[order].astype(np.int32)
    names = sorted({material.texture for material in palette} | {"plain"})
    fixture_boxes = posed_boxes(box[prototype], pose)
    materials = material_table(scene, parts, palette, names)
    triangles = (meshes.pop(name) for name in ("slopes", "object_id", "material"))
    shading, bent = shading_rows(*triangles)
    ranges = meshes.pop("ranges")
    return Geometry(
        **meshes,
        shading=shading,
        bent=bent,
        look=looks_of(materials),
        object_class=np.append(scene.object_class, ObjectClass.SKY).astype(np.uint8),
        chunk_box=columns_of(chunk_box, GROUP),
        chunk_group_box=columns_of(group_boxes(chunk_box), CLUSTER),
        chunk_range=ranges[:chunks],
        mesh_range=ranges[chunks:],
        level_first=np.cumsum([0, *map(len, prototypes)]).astype(np.int32),
        part_first=len(scene.fixtures.levels),
        sphere=np.array([sphere_of(each) for each in points], np.float32).reshape(-1, 4),
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


def _add_chunks(pool: Pool, scene: Scene) -> NDArray[np.float32]:
    """Add the static mesh square by square; return boxes around them, shape (C, 6)."""
    mesh = scene.static
    corners = mesh.positions[mesh.triangles]
    least, most = ends_of(corners)
    middle = (least + most)[:, :2] / 2
    cell = np.floor(middle / CHUNK).astype(np.int64)
    cell -= cell.min(axis=0, initial=0)
    # A triangle much larger than a square would enlarge that square's box, so it is kept apart.
    span = (most - least)[:, :2].max(axis=1, initial=0)
    key = np.where(span > 4 * CHUNK, -1, _morton(cell))
    size = _detail_sizes(scene, corners)
    order = np.lexsort((-size, key))
    starts = np.flatnonzero(np.diff(key[order], prepend=-2, append=-3) != 0)
    boxes = []
    for first, last in itertools.pairwise(starts):
        index = order[first:last]
        part = replace(mesh, triangles=mesh.triangles[index], materials=mesh.materials[index])
        pool.add(part, scene.static_object[index].astype(np.int32), size[index])
        boxes.append(box_of(mesh.positions[part.triangles].reshape(-1, 3)))
    return np.array(boxes, np.float32).reshape(-1, 6)


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
