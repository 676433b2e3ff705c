"""The tiles of the shadow map join without seams, and are few."""

import numpy as np
import pytest

from eyas.engine.mesh.solids import cylinder
from eyas.engine.render.bake import shadows as module
from eyas.engine.render.bake.shadows import TEXEL, ShadowMap, bake_shadows
from eyas.engine.render.kernels.bundles import TILE, Geometry
from eyas.engine.render.kernels.light.shadow_map import BLOCK
from eyas.engine.render.kernels.light.sunlight import sunlit
from eyas.engine.render.pack.clusters import corners_of
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.pack.light import tile_starts
from eyas.engine.state.draw import PartLibrary
from eyas.engine.world.build.materials import material
from eyas.lanes import compiled

from ...kit.small_city import DAY, GROUND, TOWER, city_scene, floor, scene_of, tower, untiled

TOWERS = ((20, 6, 9), (-14, -4, 30), (55, 20, 3), (-50, -55, 12), (45, -60, 21), (-40, 50, 6))
"""East, north and height of some towers [m]."""


@pytest.fixture(scope="module")
def geometry(images) -> Geometry:
    post = cylinder((1.0, 0.3), (0.0, 17.0), 7, material("plain"))
    things = [floor(100.0), post, *[tower(x, y, 7.0, z) for x, y, z in TOWERS]]
    scene = scene_of(things, [GROUND, *[TOWER] * (len(things) - 1)])
    return build_geometry(scene, PartLibrary(()), images)


@pytest.fixture(scope="module")
def shadows(geometry, tmp_path_factory) -> ShadowMap:
    return bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path_factory.mktemp("tiles"))


def by_hand(geometry: Geometry, shadows: ShadowMap) -> np.ndarray:
    """The whole map: each texel's way to the sun against each triangle that is not flat."""
    lines, columns = (TILE * n + 1 for n in shadows.tile.shape)
    corners = corners_of(geometry.cluster).astype(float)
    corners = corners[corners[:, :, 2].max(axis=1) > 0.5]
    placed = corners @ shadows.rows[:, :3].T + shadows.rows[:, 3]
    placed[:, :, :2] = np.floor(16 * placed[:, :, :2] + 0.5) / 16  # as triangles are drawn
    whole = np.zeros((lines, columns))
    for a, b, c in placed:
        turned = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]
        if turned == 0.0:
            continue
        low = np.floor(np.min([a, b, c], axis=0)[:2]).astype(int)
        high = np.ceil(np.max([a, b, c], axis=0)[:2]).astype(int)
        i, j = np.mgrid[low[1] : high[1], low[0] : high[0]]
        x, y = j + 0.5 - a[0], i + 0.5 - a[1]
        u = (x * (c - a)[1] - y * (c - a)[0]) / turned
        v = (y * (b - a)[0] - x * (b - a)[1]) / turned
        height = np.where(
            (u >= 0) & (v >= 0) & (u + v <= 1), a[2] + u * (b - a)[2] + v * (c - a)[2], 0.0
        )
        part = whole[low[1] : high[1], low[0] : high[0]]
        np.maximum(part, height, out=part)
    return whole


def test_the_tiles_hold_what_one_map_would(geometry, shadows):
    expected, found = by_hand(geometry, shadows), untiled(shadows)
    assert min(shadows.tile.shape) >= 2 * BLOCK  # more than one block is drawn
    assert (expected > 0).sum() > 15_000
    # Corners are rounded to sixteenths of a texel, so walls seen edge on differ a little.
    unit = np.linalg.norm(shadows.rows[2, :3])
    differs = np.abs(expected - found) > 0.3 * unit
    assert differs[expected > 0].mean() < 0.002
    # At the seams no more than elsewhere.
    lines, columns = np.indices(found.shape) % TILE
    for seam in (lines == 0, lines == TILE - 1, columns == 0, columns == TILE - 1):
        assert differs[(expected > 0) & seam].mean() < 0.004


def test_neighbours_share_their_border(shadows):
    tile, heights = shadows.tile, shadows.heights
    np.testing.assert_array_equal(heights[tile[:-1], TILE], heights[tile[1:], 0])
    np.testing.assert_array_equal(heights[tile[:, :-1], :, TILE], heights[tile[:, 1:], :, 0])
    assert not heights[0].any()
    for edge in (tile[0], tile[-1], tile[:, 0], tile[:, -1]):
        assert not edge.any()


@compiled
def light_at(light, points, found):
    for k in range(len(points)):
        found[k] = sunlit(light, points[k, 0], points[k, 1], points[k, 2])


def test_the_light_of_a_point_is_blended_over_four_texels_of_the_whole_map(
    renderer_of, geometry, shadows
):
    _, light = renderer_of(city_scene()).packed
    with_towers = light._replace(
        shadow_texel=shadows.heights,
        shadow_tile=tile_starts(shadows.tile),
        shadow_rows=shadows.rows.astype(np.float32),
    )
    points = np.random.default_rng(4).uniform((-90, -90, 0), (120, 90, 6), (40_000, 3))
    found = np.zeros(len(points), np.float32)
    light_at(with_towers, points.astype(np.float32), found)
    whole = np.pad(untiled(shadows), 600)  # beyond the map the sun shines
    column, line, height = (points @ shadows.rows[:, :3].T + shadows.rows[:, 3]).T
    column, line, height = column - 0.5 + 600, line - 0.5 + 600, np.maximum(height, 0.0)
    i, j = np.floor(line).astype(int), np.floor(column).astype(int)
    down, across = line - i, column - j
    lit = [(whole[i + k // 2, j + k % 2] <= height).astype(float) for k in range(4)]
    above, below = lit[0] + across * (lit[1] - lit[0]), lit[2] + across * (lit[3] - lit[2])
    expected = above + down * (below - above)
    assert 0.01 < (expected < 0.5).mean() < 0.5
    assert (np.abs(found - expected) > 0.01).mean() < 2e-3  # float32 at the edges of surfaces


def test_only_what_casts_shadows_takes_memory(images, tmp_path):
    scene = scene_of([floor(5000.0), tower(0, 0, 8, 20), tower(900, 9, 8, 20)], [GROUND, 2, 3])
    geometry = build_geometry(scene, PartLibrary(()), images)
    shadows = bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path)
    assert shadows.tile.size > 5_000
    assert 8 < shadows.tile.max() < 100


def test_texels_grow_when_there_would_be_too_many_tiles(geometry, monkeypatch, tmp_path):
    fine = bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path)
    assert fine.texel == TEXEL
    monkeypatch.setattr(module, "MOST_TILES", 30)
    coarse = bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path / "coarse")
    assert len(coarse.heights) <= 31 < len(fine.heights)
    assert coarse.texel == pytest.approx(1 / np.linalg.norm(coarse.rows[0, :3]))
    shares = [(untiled(map_) > 0).sum() * map_.texel**2 for map_ in (fine, coarse)]
    assert shares[1] == pytest.approx(shares[0], rel=0.03)


def test_a_scene_that_casts_no_shadow_is_lit(images, tmp_path):
    geometry = build_geometry(scene_of([floor(60.0)], [GROUND]), PartLibrary(()), images)
    shadows = bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path)
    assert not shadows.tile.any()
    assert len(shadows.heights) == 1
