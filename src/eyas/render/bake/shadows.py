"""The shadow map of everything static, computed once for a scene and a sun."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.core.cache.cached import cached
from eyas.core.cache.folder import Kind
from eyas.core.jit import thread_count
from eyas.core.lanes import WIDTH
from eyas.core.parallel import Held
from eyas.render.kernels.bundles import Geometry, Projection, Row
from eyas.render.kernels.light.shadow_map import BAND, ShadowBake, bake_rows
from eyas.render.kernels.visibility.clusters import CLUSTER
from eyas.render.kernels.visibility.fill import SPAN_ROWS
from eyas.render.kernels.visibility.triangles import TRIANGLE_ROWS
from eyas.render.pack.clusters import corners_of
from eyas.state.mesh import Surface

__all__ = ["ShadowMap", "bake_shadows"]

TEXEL = 0.2
"""Side of a texel, unless the map would become too large [m]."""

LARGEST = 6144
"""Largest number of texels along a side."""

CARDS = 4
"""One in this many leaf cards casts a shadow: they overlap so much that all of them would
stop all light, but the shade below crowns is dappled."""

_FORMAT = "eyas shadow map 8"
"""Raise its number by 1 whenever the same scene gives different shadows."""


@dataclass(frozen=True, slots=True)
class ShadowMap:
    """Shadows of the static scene."""

    heights: NDArray[np.uint16]
    """Height towards the sun of the first surface that sunlight meets, 0 for none,
    shape (lines, columns)."""
    rows: NDArray[np.float64]
    """World [m] to column, line and height of the map, shape (3, 4)."""
    texel: float
    """Side of a texel [m]."""


def bake_shadows(
    geometry: Geometry,
    sun: tuple[float, float, float],
    ground: float,
    folder: Path | None = None,
) -> ShadowMap:
    """Return the shadow map; computed only if the cache has none.

    Args:
        geometry: The scene.
        sun: Unit vector towards the sun.
        ground: z of the floor [m].
        folder: Folder of the cache; None: the user's.
    """
    rows, lines, columns, texel = _frame(geometry, sun, ground)
    heights = cached(
        Kind.SHADOWS,
        (),
        (_FORMAT, rows, lines, columns, *_casters(geometry)),
        lambda: _bake(geometry, rows, lines, columns),
        of=NDArray[np.uint16],
        folder=folder,
    )
    return ShadowMap(heights, rows, texel)


def _frame(
    geometry: Geometry, sun: tuple[float, float, float], ground: float
) -> tuple[NDArray[np.float64], int, int, float]:
    """Return the map's rows, lines, columns and texel: it covers everything above the floor.

    Flat ground casts no shadow, so even a very wide floor costs no texels.
    """
    toward = np.asarray(sun, np.float64) / np.linalg.norm(sun)
    right = np.array([-toward[1], toward[0], 0.0])
    right = right / np.linalg.norm(right) if np.linalg.norm(right) > 1e-6 else np.eye(3)[0]
    axes = np.stack([right, np.cross(toward, right), toward])
    flat = _casting_points(geometry, ground + 0.5) @ axes.T
    # Rounded, because last bits differ between processors: where the longer side is a whole
    # number of texels, one processor would otherwise make a map of one texel more.
    low, top = np.round(flat.min(axis=0) - 1.0, 3), np.round(flat.max(axis=0) + 1.0, 3)
    texel = max(TEXEL, float((top - low)[:2].max()) / (LARGEST - 4))
    size = np.ceil(np.round((top - low)[:2] / texel, 6)).astype(int) + 2
    # The floor may reach lower than all casters; its height is then below 0.
    unit = 65000.0 / float(top[2] - low[2])
    scale = np.array([1.0 / texel, 1.0 / texel, unit])
    rows = np.concatenate(
        [axes * scale[:, None], (-low * scale + [1.0, 1.0, 1.0])[:, None]], axis=1
    )
    return rows, int(size[1]), int(size[0]), texel


def _casting_points(geometry: Geometry, height: float) -> NDArray[np.float64]:
    """Return all corners of static triangles and of fixtures' boxes that reach a height [m]."""
    last = geometry.chunk_range[-1, 1] if len(geometry.chunk_range) else 0
    static = corners_of(geometry.cluster)[:last]
    boxes = geometry.box[geometry.fixture_prototype]
    corners = np.stack(
        [boxes[:, (i, j, k)] for i in (0, 3) for j in (1, 4) for k in (2, 5)], axis=1
    )
    linear, offset = geometry.fixture_pose[:, :, :3], geometry.fixture_pose[:, :, 3]
    posed = np.einsum("fij,fcj->fci", linear, corners) + offset[:, None]
    points = [
        things[things[:, :, 2].max(axis=1) > height].reshape(-1, 3) for things in (static, posed)
    ]
    found = np.concatenate(points).astype(np.float64)
    return found if len(found) else np.zeros((1, 3))


def _bake(
    geometry: Geometry, rows: NDArray[np.float64], lines: int, columns: int
) -> NDArray[np.uint16]:
    heights = np.zeros((lines, columns), np.uint16)
    cards = _cards(geometry)
    solid = [
        not cards[geometry.material[first:last]].any()
        for first, last in geometry.mesh_range[geometry.level_first[: geometry.part_first], :2]
    ]
    workers = min(thread_count(), math.ceil(lines / BAND))
    bake = ShadowBake(
        cards=cards,
        thin=np.array(solid, np.bool_),
        sun=Projection(*[Row(*row) for row in rows.tolist()]),
        triangle=np.empty((workers, TRIANGLE_ROWS, CLUSTER)),
        span=np.empty((workers, SPAN_ROWS, WIDTH), np.int32),
        key=np.empty((workers, BAND, columns + -columns % WIDTH), np.int64),
        shadow_map=heights,
    )
    bake_rows(workers, Held(geometry), Held(bake))
    return heights


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
        geometry.corner_uv[:last],
        cards[geometry.material[:last]],
        geometry.texture[np.unique(geometry.layer[cards > 0])] >> 24,
        fixtures,
        geometry.fixture_prototype,
        geometry.fixture_pose,
    )
