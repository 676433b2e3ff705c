"""The shadow map of everything static, computed once for a scene and a sun.

It is made of tiles, and only those are kept in which something may cast a shadow: a sixth of
citystreet's, whose elevated road makes the map much larger than the city.
"""

import itertools
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.render.kernels.bundles import TILE, Geometry, Projection, Row
from eyas.engine.render.kernels.light.shadow_map import BLOCK, BLOCK_TEXELS, ShadowBake, bake_tiles
from eyas.engine.render.kernels.visibility.clusters import CLUSTER
from eyas.engine.render.kernels.visibility.fill import SPAN_ROWS
from eyas.engine.render.kernels.visibility.triangles import TRIANGLE_ROWS
from eyas.engine.render.pack.clusters import corners_of
from eyas.engine.render.pack.triangles import materials_of
from eyas.engine.state.mesh import Surface
from eyas.lanes import PackedBundle, exact, thread_count
from eyas.lanes.vector import WIDTH

TEXEL = 0.2  # Side of a texel, unless the tiles would become too many [m]

MOST_TILES = 40_000  # Largest number of tiles: 83 MiB

_FLAT = 0.5
"""Static triangles less high than this above the floor cast no shadow [m]. A point is looked up
over its surface, so a kerb could shade only a line beside it, thinner than a texel."""

CARDS = 4
"""One in this many leaf cards casts a shadow: they overlap so much that all of them would
stop all light, but the shade below crowns is dappled."""


@dataclass(frozen=True, slots=True)
class ShadowMap:
    """Shadows of the static scene."""

    heights: NDArray[np.uint16]
    """Height towards the sun of the first surface that sunlight meets, or 0: tiles of the map,
    shape (tiles, TILE + 1, TILE + 1). The last line and column of a tile are also the first of
    the next one, so that four neighbours always lie in one tile. Tile 0 is empty."""
    tile: NDArray[np.int32]
    """Number of each tile of the map, shape (rows, columns); those at its edges are empty."""
    rows: NDArray[np.float64]  # World [m] to column, line and height of the map, shape (3, 4)
    texel: float  # Side of a texel [m]

    @classmethod
    def empty(cls) -> "ShadowMap":
        """Return a map without shadows."""
        heights = np.zeros((1, TILE + 1, TILE + 1), np.uint16)
        return cls(heights, np.zeros((1, 1), np.int32), np.zeros((3, 4)), 1.0)


def bake_shadows(
    geometry: Geometry,  # The scene
    sun: tuple[float, float, float],  # Unit vector towards the sun
    ground: float,  # z of the floor [m]
    folder: Path | None = None,  # Folder of the cache; None: the user's
) -> ShadowMap:
    """Return the shadow map; computed only if the cache lacks it."""
    return cached(
        EntryKind.SHADOWS,
        partial(_bake, geometry, sun, ground),
        (sun, ground, *_casters(geometry)),
        of=ShadowMap,
        folder=folder,
    )


def _bake(geometry: Geometry, sun: tuple[float, float, float], ground: float) -> ShadowMap:
    toward = np.asarray(sun, np.float64) / exact.length(sun)
    right = np.array([-toward[1], toward[0], 0.0])
    right = right / exact.length(right) if exact.length(right) > 1e-6 else np.eye(3)[0]
    axes = np.stack([right, np.cross(toward, right), toward])
    casting = _bounds(_casting_points(geometry, ground + _FLAT), axes)
    texel = TEXEL
    rows, tile = _frame(casting, axes, texel)
    while tile.max() > MOST_TILES:
        texel *= 1.05
        rows, tile = _frame(casting, axes, texel)
    heights = np.zeros((int(tile.max()) + 1, TILE + 1, TILE + 1), np.uint16)
    _draw(geometry, ground + _FLAT, rows, tile, heights)
    # Many tiles show the same: nothing, or the flat roof of something large.
    number: dict[bytes, int] = {}
    kept = np.array([number.setdefault(each.tobytes(), len(number)) for each in heights], np.int32)
    first = np.unique(kept, return_index=True)[1]
    return ShadowMap(heights[first], kept[tile], rows, texel)


def _frame(
    # Bounds of all that casts shadows, along the axes [m], shape (N, 6)
    casting: NDArray[np.float64],
    # Directions of the map's columns and lines, and towards the sun, shape (3, 3)
    axes: NDArray[np.float64],
    texel: float,  # Side of a texel [m]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Return the rows of a map and the numbers of its tiles."""
    # Rounded, because last bits differ between processors.
    low = np.round(casting[:, :3].min(axis=0, initial=np.inf), 3) - 1.0
    top = np.round(casting[:, 3:].max(axis=0, initial=-np.inf), 3) + 1.0
    if len(casting) == 0:
        low, top = np.zeros(3), np.ones(3)
    # The floor may reach lower than all casters; its height is then below 0.
    scale = np.array([1.0 / texel, 1.0 / texel, 65000.0 / float(top[2] - low[2])])
    first = np.array([TILE, TILE, 1.0])
    rows = np.concatenate([axes * scale[:, None], (first - low * scale)[:, None]], axis=1)
    # One texel more on all sides: the light of a point is blended over four.
    edges = np.floor(
        (np.round((casting.reshape(-1, 2, 3)[:, :, :2] - low[:2]) / texel, 3) + TILE + [[-1], [1]])
        / TILE
    ).astype(np.int64)
    size = np.ceil((top - low)[:2] / (texel * TILE)).astype(int) + 2
    columns, lines = size + -size % BLOCK
    # How many rectangles begin or end at each tile; summed up, how many it lies in.
    changes = np.zeros((lines + 1, columns + 1), np.int64)
    (left, up), (over, below) = edges[:, 0].T, edges[:, 1].T + 1
    for line, column, sign in ((up, left, 1), (below, over, 1), (up, over, -1), (below, left, -1)):
        np.add.at(changes, (line, column), sign)
    shaded = changes.cumsum(axis=0).cumsum(axis=1)[:lines, :columns] > 0
    return rows, np.where(shaded, np.cumsum(shaded).reshape(shaded.shape), 0).astype(np.int32)


def _bounds(
    things: NDArray[np.float64],  # Corners of each thing [m], shape (N, K, 3)
    axes: NDArray[np.float64],  # Shape (3, 3), or (3, 4) with an offset
) -> NDArray[np.float64]:
    """Return the bounds of things along axes: three least values, three largest, shape (N, 6)."""
    places = exact.product(things, axes[:, :3].T) + (axes[:, 3] if axes.shape[1] == 4 else 0.0)
    return np.concatenate([places.min(axis=1), places.max(axis=1)], axis=1)


def _box_corners(boxes: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the corners of boxes, shape (N, 8, 3)."""
    sides = itertools.product((0, 3), (1, 4), (2, 5))
    return np.stack([boxes[:, side] for side in sides], axis=1).astype(np.float64)


def _casting_points(geometry: Geometry, height: float) -> NDArray[np.float64]:
    """Return corners of static triangles and of fixtures that reach a height [m], shape (N, 8, 3).

    Flat ground casts no shadow, so even a very wide floor costs no tiles.
    """
    last = geometry.chunk_range[-1, 1] if len(geometry.chunk_range) else 0
    static = corners_of(geometry.cluster)[:last]
    static = static[static[:, :, 2].max(axis=1) > height].astype(np.float64)
    boxes = _box_corners(geometry.box[geometry.fixture_prototype])
    linear, offset = geometry.fixture_pose[:, :, :3], geometry.fixture_pose[:, :, 3]
    posed = exact.product(boxes, linear.swapaxes(1, 2)) + offset[:, None]
    posed = posed[posed[:, :, 2].max(axis=1) > height]
    return np.concatenate([static[:, [0, 1, 2, 0, 1, 2, 0, 1]], posed])


def _draw(
    geometry: Geometry,
    flat: float,
    rows: NDArray[np.float64],
    tile: NDArray[np.int32],
    heights: NDArray[np.uint16],
) -> None:
    """Fill the tiles of a map with what reaches above z = `flat` [m]."""
    cards = _cards(geometry)
    solid = [
        not cards[materials_of(geometry.shading[first:last])].any()
        for first, last in geometry.mesh_range[geometry.level_first[: geometry.part_first], :2]
    ]
    chunks, fixtures = len(geometry.chunk_range), len(geometry.fixture_prototype)
    boxes = np.concatenate([geometry.chunk_box[:, :chunks].T, geometry.fixture_box[:, :fixtures].T])
    reach = _bounds(_box_corners(boxes), rows)[:, [0, 1, 3, 4]] + [-1.0, -1.0, 1.0, 1.0]
    blocks = tile.reshape(len(tile) // BLOCK, BLOCK, -1, BLOCK).any(axis=(1, 3))
    workers = min(thread_count(), int(blocks.sum()))
    bake = ShadowBake(
        cards=cards,
        thin=np.array(solid, np.bool_),
        flat=flat,
        sun=Projection(*[Row(*row) for row in rows.tolist()]),
        reach=np.ascontiguousarray(reach, np.float32),
        block=np.ascontiguousarray(BLOCK * np.argwhere(blocks), np.int32),
        tile=tile,
        triangle=np.empty((workers, TRIANGLE_ROWS, CLUSTER)),
        span=np.empty((workers, SPAN_ROWS, WIDTH), np.int32),
        key=np.empty((workers, BLOCK_TEXELS, BLOCK_TEXELS + -BLOCK_TEXELS % WIDTH), np.int64),
        heights=heights,
    )
    bake_tiles(workers, PackedBundle(geometry), PackedBundle(bake))


def _cards(geometry: Geometry) -> NDArray[np.int32]:
    """Return how the leaves of each material are drawn, see `ShadowBake.cards`."""
    surface = geometry.surface
    return np.where(
        surface == Surface.FOLIAGE, CARDS, np.where(surface == Surface.CROWN, -1, 0)
    ).astype(np.int32)


def _casters(geometry: Geometry) -> tuple[NDArray[np.generic], ...]:
    """Return all inputs of a shadow map."""
    cards = _cards(geometry)
    fixtures = geometry.level_first[: geometry.part_first + 1]
    ranges = np.concatenate([geometry.chunk_range, geometry.mesh_range[: fixtures[-1]]])
    last = int(ranges[:, 1].max(initial=0))
    return (
        ranges,
        corners_of(geometry.cluster)[:last],
        geometry.corner_uv,
        geometry.uv_row,
        cards[materials_of(geometry.shading[:last])],
        geometry.texture[np.flatnonzero(np.bincount(geometry.layer[cards > 0]))] >> 24,
        fixtures,
        geometry.fixture_prototype,
        geometry.fixture_pose,
    )
