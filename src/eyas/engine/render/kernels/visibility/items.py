"""What a view shows, found in steps that its workers share: items, then clusters, then triangles.

Each step is a small kernel that reads what the last has written. All in one, most threads would
wait for those with more to do, and the card for instructions.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band, Point, Projection, Row
from eyas.engine.render.kernels.scalars import i8
from eyas.engine.render.kernels.visibility.clusters import CLUSTER, clusters_seen
from eyas.engine.render.kernels.visibility.cull import planes_of, sides_of
from eyas.engine.render.kernels.visibility.meshes import draw_cluster, draw_mesh
from eyas.engine.render.kernels.visibility.passes import item_at, list_scene
from eyas.engine.state.draw import DrawStage
from eyas.lanes import kernel
from eyas.lanes.vector import claim_some, count_bits, first_bit

CULLING = int(DrawStage.CULLING)

ITEM_COLUMNS = 21
"""Columns of `Scratch.item`: twelve of the projection, three of the eye, and those below."""

FOCAL, SMALLEST, TAG, FIRST, LAST, BOUNDS = 15, 16, 17, 18, 19, 20

_FOUND, _ROWS = 0, 1
"""Places of `Scratch.found`: how many clusters are seen; rows of `Geometry.bounds` of all items."""


class Item(NamedTuple):
    """A chunk or an instance; see `draw_mesh`."""

    screen: Projection
    eye: Point
    focal: float
    smallest: float
    tag: int


@kernel(inline=True)
def list_items(band: Band) -> int:
    """Write what a view shows to `Band.item`; return the number of its instances.

    All workers list all of it, and each writes its own share. What there is no room for is drawn.
    """
    listed, count = list_scene(band)
    rows, room = i8(0), min(listed, len(band.item))
    for k in range(room):
        band.item_row[k] = rows
        rows += _bounds_of(band, k)
    for k in range(band.member, listed, band.members):
        if k < room:
            _write_item(band, k)
        elif band.until > CULLING:
            _draw_at_once(band, k)
    band.item_row[room] = rows
    band.found[_ROWS] = rows
    return count


@kernel(inline=True)
def _bounds_of(band: Band, k: int) -> int:
    """Return how many rows of `Geometry.bounds` the mesh in row `k` of `Band.order` has."""
    geometry, item = band.geometry, band.order[k] & i8(0xFFFFFFFF)
    chunks = geometry.chunk_range.shape[0]
    if item < chunks:
        triangles = geometry.chunk_range[item, 1] - geometry.chunk_range[item, 0]
    else:
        mesh = band.mesh[item - chunks]
        triangles = geometry.mesh_range[mesh, 1] - geometry.mesh_range[mesh, 0]
    return (triangles + CLUSTER * CLUSTER - 1) // (CLUSTER * CLUSTER)


@kernel(inline=True)
def _write_item(band: Band, k: int) -> None:
    """Write what is listed in row `k` of `Band.order` to `Band.item`."""
    mesh, screen, eye, focal, smallest, tag = item_at(band, k)
    into = band.item[k]
    _write_row(into, 0, screen.column)
    _write_row(into, 4, screen.row)
    _write_row(into, 8, screen.distance)
    into[12], into[13], into[14] = eye.x, eye.y, eye.z
    into[FOCAL], into[SMALLEST], into[TAG] = focal, smallest, tag
    into[FIRST], into[LAST], into[BOUNDS] = mesh[0], mesh[1], mesh[2]


@kernel(inline=True, apart=True)
def _draw_at_once(band: Band, k: int) -> None:
    """Draw what is listed in row `k` of `Band.order`, for which there is no room in `Band.item`."""
    mesh, screen, eye, focal, smallest, tag = item_at(band, k)
    draw_mesh(band, band.key, mesh, screen, eye, focal, smallest, tag)


@kernel(inline=True)
def _write_row(into: NDArray[np.float64], at: int, row: Row) -> None:
    into[at], into[at + 1], into[at + 2], into[at + 3] = row.x, row.y, row.z, row.w


@kernel(inline=True)
def _row(item: NDArray[np.float64], at: int) -> Row:
    return Row(item[at], item[at + 1], item[at + 2], item[at + 3])


@kernel(inline=True)
def _item(band: Band, k: int) -> Item:
    item = band.item[k]
    return Item(
        Projection(_row(item, 0), _row(item, 4), _row(item, 8)),
        Point(item[12], item[13], item[14]),
        item[FOCAL],
        item[SMALLEST],
        i8(item[TAG]),
    )


@kernel(inline=True)
def find_clusters(band: Band) -> None:
    """Write the clusters of items that may be seen to `Band.seen`: a worker's share of the rows of
    `Geometry.bounds`.
    """
    if band.until <= CULLING:
        return
    view, found, bounds = band.camera, band.found, band.geometry.bounds
    bottom, k = view.top + view.rows, i8(0)
    for at in range(band.member, found[_ROWS], band.members):
        while band.item_row[k + 1] <= at:
            k += 1
        own, row = _item(band, k), at - band.item_row[k]
        first, last = i8(band.item[k, FIRST]), i8(band.item[k, LAST])
        sides = sides_of(planes_of(own.screen, view.width, view.height, view.top, bottom))
        seen = clusters_seen(bounds, i8(band.item[k, BOUNDS]) + row, sides, own.eye, own.smallest)
        clusters = (last - first + CLUSTER - 1) // CLUSTER - row * CLUSTER
        if clusters < CLUSTER:
            seen &= (1 << clusters) - 1
        if seen == 0:
            continue
        into = claim_some(found, count_bits(seen))
        while seen != 0:
            cluster = first // CLUSTER + row * CLUSTER + first_bit(seen)
            seen &= seen - 1
            if into < len(band.seen):
                band.seen[into] = (k << i8(32)) | cluster
            else:
                _draw_found(band, k, cluster)
            into += 1


@kernel(inline=True)
def draw_clusters(band: Band) -> None:
    """Find the triangles in a worker's share of the clusters, and fill or record them."""
    for at in range(band.member, min(band.found[_FOUND], len(band.seen)), band.members):
        found = band.seen[at]
        _draw_found(band, found >> i8(32), found & i8(0xFFFFFFFF))


@kernel(inline=True, apart=True)
def _draw_found(band: Band, k: int, cluster: int) -> None:
    """Draw a cluster of item `k`."""
    view, own = band.camera, _item(band, k)
    planes = planes_of(own.screen, view.width, view.height, view.top, view.top + view.rows)
    draw_cluster(band, band.key, cluster, own.screen, planes, own.focal, own.smallest, own.tag)
