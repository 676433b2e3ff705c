"""What is seen of the static scene and of moving things: first listed, then drawn."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band, Geometry, Point, Projection, View
from eyas.engine.render.kernels.scalars import i8
from eyas.engine.render.kernels.visibility.key import instance_tag
from eyas.engine.render.kernels.visibility.listing import list_chunks, list_fixtures, list_slots
from eyas.engine.render.kernels.visibility.meshes import draw_mesh, fetch_mesh
from eyas.engine.render.kernels.visibility.occlusion import box_is_hidden, measure_tiles
from eyas.engine.render.kernels.visibility.transform import in_frame, object_projection, scale_of
from eyas.engine.render.kernels.wind import sways
from eyas.engine.state.draw import DrawStage
from eyas.lanes import kernel

CULLING = int(DrawStage.CULLING)

MEASURED_EVERY = 16
"""Things drawn before it is measured again what they hide; later a quarter of those drawn so far,
since the first are the nearest: with thousands of things, it took a fifth of the time."""

AHEAD = 2  # Things listed ahead of the one that is drawn whose meshes are brought into the cache

SMALLEST_DETAIL = 0.35  # Details whose area has a smaller root are left out [pixels]


@kernel(inline=True)
def list_scene(band: Band) -> tuple[int, int]:
    """List everything that a band shows; return how much, and how many instances there are in
    `Band.drawn`.

    They are numbered fixtures first, in the order of the arrays that hold them, so that the order
    of their tags does not depend on the band.
    """
    listed = list_chunks(band)
    count = list_fixtures(band, listed)
    count = list_slots(band, 0, band.movers.part.shape[1], listed, count)
    return listed + count, count


@kernel
def draw_scene(band: Band) -> int:
    """Draw everything that a band shows; return how many instances there are in `Band.drawn`.

    Its keys must be 0.
    """
    listed, count = list_scene(band)
    _draw_listed(band, band.key, listed)
    return count


@kernel
def draw_slots(band: Band, first: int, last: int, count: int) -> int:
    """Draw slots `first` to `last` of a draw list into `Band.alone`; `Band.order` is overwritten.

    Returns:
        How many rows of `Band.drawn` are used then; `count` are before.
    """
    after = list_slots(band, first, last, -count, count)
    _draw_listed(band, band.alone, after - count)
    return after


@kernel
def _draw_listed(band: Band, key: NDArray[np.int64], listed: int) -> None:
    """Draw what is listed in `Band.order`, the nearest first."""
    if band.until <= CULLING:
        return
    geometry, view = band.geometry, band.camera
    order, drawn, tiles = band.order, band.drawn, band.tiles
    _shell_sort(order, listed)
    measured = i8(MEASURED_EVERY)
    for k in range(listed):
        item = order[k] & i8(0xFFFFFFFF)
        if k + AHEAD < listed:
            _fetch_item(band, k + AHEAD)
        if k >= MEASURED_EVERY:
            if k == measured:
                measure_tiles(key, view.width, tiles)
                measured += max(i8(MEASURED_EVERY), measured >> i8(2))
            if _is_hidden(geometry, item, drawn, view, tiles):
                continue
        mesh, screen, eye, focal, smallest, tag = item_at(band, k)
        draw_mesh(band, key, mesh, screen, eye, focal, smallest, tag)


@kernel(inline=True)
def _fetch_item(band: Band, k: int) -> None:
    """Have what is read first of the mesh in row `k` of `Band.order` brought into the cache."""
    geometry, item = band.geometry, band.order[k] & i8(0xFFFFFFFF)
    chunks = geometry.chunk_range.shape[0]
    if item < chunks:
        fetch_mesh(geometry, geometry.chunk_range[item])
    else:
        fetch_mesh(geometry, geometry.mesh_range[band.mesh[item - chunks]])


@kernel(inline=True)
def item_at(band: Band, k: int) -> tuple[NDArray[np.int32], Projection, Point, float, float, int]:
    """Return what is listed in row `k` of `Band.order`: its row of `chunk_range` or `mesh_range`,
    and what `draw_mesh` is told of it.
    """
    geometry, view, movers, drawn = band.geometry, band.camera, band.movers, band.drawn
    chunks, fixtures = geometry.chunk_range.shape[0], len(geometry.fixture_prototype)
    item = band.order[k] & i8(0xFFFFFFFF)
    if item < chunks:
        smallest = SMALLEST_DETAIL * 0.001 * (band.order[k] >> i8(32)) / view.focal
        return geometry.chunk_range[item], view.screen, view.eye, view.focal, smallest, i8(0)
    row = item - chunks
    mesh, instance = geometry.mesh_range[band.mesh[row]], i8(drawn[row, 1])
    if instance < fixtures and sways(band.light, instance):
        screen, eye, focal = _in_frame(view, band.leaning, row)
    elif instance < fixtures:
        screen, eye, focal = _in_frame(view, geometry.fixture_pose, instance)
    else:
        poses = movers.pose[band.world]
        screen, eye, focal = _in_frame(view, poses, instance - fixtures)
    return mesh, screen, eye, focal, 0.0, instance_tag(row) - mesh[0]


@kernel(inline=True)
def _is_hidden(
    geometry: Geometry, item: int, drawn: NDArray[np.int32], view: View, tiles: NDArray[np.float32]
) -> bool:
    """Return whether a listed chunk or fixture is hidden; moving things always may be seen."""
    chunks = geometry.chunk_range.shape[0]
    if item < chunks:
        return box_is_hidden(geometry.chunk_box, item, view, tiles)
    fixture = i8(drawn[item - chunks, 1])
    if fixture < len(geometry.fixture_object):
        return box_is_hidden(geometry.fixture_box, fixture, view, tiles)
    return False


@kernel(inline=True)
def _in_frame(
    view: View, poses: NDArray[np.float32], index: int
) -> tuple[Projection, Point, float]:
    """Return projection, optical centre and focal length [pixels] for lengths in the frame of
    pose `index`.
    """
    focal = view.focal * scale_of(poses, index)
    return object_projection(view.screen, poses, index), in_frame(view.eye, poses, index), focal


@kernel(inline=True)
def _shell_sort(values: NDArray[np.int64], count: int) -> None:
    """Sort the first `count` values in place; np.sort would allocate."""
    gap = 1
    while gap < count // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, count):
            value = values[i]
            j = i
            while j >= gap and values[j - gap] > value:
                values[j] = values[j - gap]
                j -= gap
            values[j] = value
        gap //= 3
