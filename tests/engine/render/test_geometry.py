"""Packed arrays hold what the scene holds."""

import math
from dataclasses import replace

import numpy as np
import pytest

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.render.kernels.bundles import GROUP, Geometry
from eyas.engine.render.kernels.surface.texture import detail_of, texel
from eyas.engine.render.kernels.visibility.clusters import (
    APEX,
    AXIS,
    CLUSTER,
    CUT_OFF,
    LARGEST,
    SIZE,
)
from eyas.engine.render.pack.clusters import corners_of
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.pack.triangles import gradients, solid_triangles
from eyas.engine.render.textures.mipmap import packed_layers
from eyas.engine.state.draw import PartLibrary
from eyas.lanes import PackedBundle, kernel

from ...kit.small_city import GROUND, TREE_OBJECT, car_parts, city_scene, floor, scene_of


@kernel
def texel_at(textures, layer, detail, blend, u, v):
    low, high = texel(textures, layer, detail, blend, u, v)
    return low & 255, high & 255, (low >> 16) & 255, (high >> 16) & 255


@kernel
def detail_at(square):
    return detail_of(square)


def test_a_kept_geometry_is_read_by_the_same_kernels_as_a_new_one(images, tmp_path):
    new = build_geometry(city_scene(), car_parts(), images)
    for _ in range(2):
        old = cached(EntryKind.GEOMETRY, lambda: new, (), of=Geometry, folder=tmp_path)
    assert old is not new
    assert PackedBundle(old).kind == PackedBundle(new).kind
    for name, array in new._asdict().items():
        np.testing.assert_array_equal(getattr(old, name), array, err_msg=name)


def test_chunks_hold_each_triangle_once_and_lie_in_their_boxes(images):
    scene = city_scene()
    geometry = build_geometry(scene, car_parts(), images)
    ranges = geometry.chunk_range
    starts = [CLUSTER * math.ceil(last / CLUSTER) for last in (0, *ranges[:, 1])]
    np.testing.assert_array_equal(ranges[:, 0], starts[:-1])
    corners = corners_of(geometry.cluster)
    packed = np.concatenate([corners[first:last] for first, last, _ in ranges]).reshape(-1, 9)
    original = scene.static.positions[scene.static.triangles].reshape(-1, 9)
    np.testing.assert_array_equal(in_order(packed), in_order(original))
    boxes, groups = geometry.chunk_box.T, geometry.chunk_group_box.T
    assert len(boxes) % GROUP == 0
    assert len(groups) % 8 == 0
    for k, (first, last, _) in enumerate(ranges):
        points = corners[first:last].reshape(-1, 3)
        np.testing.assert_array_equal(boxes[k], [*points.min(0), *points.max(0)])
        assert (groups[k // GROUP, :3] <= boxes[k, :3]).all()
        assert (groups[k // GROUP, 3:] >= boxes[k, 3:]).all()
    assert (boxes[len(ranges) :, :3] > boxes[len(ranges) :, 3:]).all()


def in_order(rows: np.ndarray) -> np.ndarray:
    return rows[np.lexsort(rows.T)]


def test_fixtures_lie_in_their_boxes(images):
    geometry = build_geometry(city_scene(), car_parts(), images)
    mesh = geometry.mesh_range[0]
    corners = corners_of(geometry.cluster)[mesh[0] : mesh[1]].reshape(-1, 3)
    for pose, box in zip(geometry.fixture_pose, geometry.fixture_box.T, strict=False):
        points = corners @ pose[:, :3].T + pose[:, 3]
        assert (points >= box[:3] - 1e-4).all()
        assert (points <= box[3:] + 1e-4).all()


def test_what_fills_clusters_up_is_never_drawn(images):
    geometry = build_geometry(city_scene(), car_parts(), images)
    size = geometry.cluster[:, SIZE].ravel()
    real = np.zeros(len(size), np.bool_)
    for first, last, _ in (*geometry.chunk_range, *geometry.mesh_range):
        real[first:last] = True
    assert not real.all()
    np.testing.assert_array_equal(size >= 0.0, real)
    corners = corners_of(geometry.cluster)[~real]
    np.testing.assert_array_equal(corners, corners[:, :1].repeat(3, axis=1))


def behind(corners: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """Which triangles are seen from behind."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.einsum("tj,tj->t", normals, eye - corners[:, 0]) <= 0.0


def test_from_places_in_a_cone_all_triangles_of_its_cluster_are_seen_from_behind(images):
    geometry = build_geometry(city_scene(), car_parts(), images)
    rng, inside = np.random.default_rng(0), 0
    for first, last, row in (*geometry.chunk_range, *geometry.mesh_range):
        for k, cluster in enumerate(geometry.cluster[first // 8 : -(-last // 8)]):
            bounds = geometry.bounds[row + k // 8, :, k % 8].astype(float)
            apex, axis = bounds[APEX : APEX + 3], bounds[AXIS : AXIS + 3]
            corners = corners_of(cluster[None])[: last - first - 8 * k].astype(float)
            assert (corners >= bounds[:3]).all()
            assert (corners <= bounds[3:6]).all()
            assert bounds[LARGEST] == cluster[SIZE].max()
            eyes = rng.uniform(bounds[:3] - 20.0, bounds[3:6] + 20.0, (40, 3))
            way = apex - eyes
            deep = way @ axis - 0.02 > bounds[CUT_OFF] * np.linalg.norm(way, axis=1)
            inside += deep.sum()
            for eye in eyes[deep]:
                assert behind(corners, eye).all()
    assert inside > 300


def test_every_level_of_detail_lies_in_the_box_and_the_sphere(images):
    (fine, *_), *others = car_parts().parts
    coarse = replace(fine, positions=1.5 * fine.positions + np.float32(0.2))
    geometry = build_geometry(city_scene(), PartLibrary(((fine, coarse), *others)), images)
    for mesh in (fine, coarse):
        box, sphere = geometry.box[geometry.part_first], geometry.sphere[geometry.part_first]
        assert (mesh.positions >= box[:3]).all()
        assert (mesh.positions <= box[3:]).all()
        assert (np.linalg.norm(mesh.positions - sphere[:3], axis=1) <= sphere[3]).all()


def test_fixtures_and_parts_come_after_with_their_levels(images):
    geometry = build_geometry(city_scene(), car_parts(), images)
    assert geometry.part_first == 1
    np.testing.assert_array_equal(geometry.level_first, [0, 3, 4, 5, 6])
    assert set(geometry.fixture_object) == {TREE_OBJECT}
    counts = geometry.mesh_range[:, 1] - geometry.mesh_range[:, 0]
    assert (np.diff(counts[:3]) < 0).all()


def test_gradients_give_back_normals_and_texture_coordinates():
    rng = np.random.default_rng(0)
    positions = rng.normal(0, 50, (30, 3)).astype(np.float32)
    normals = rng.normal(0, 1, (30, 3)).astype(np.float32)
    uvs = rng.uniform(0, 1, (30, 2)).astype(np.float32)
    triangles = np.arange(30, dtype=np.int32).reshape(10, 3)
    each = [values[triangles] for values in (positions, normals, uvs)]
    table = gradients(*each).astype(np.float64)
    for row, corners in zip(table, triangles, strict=True):
        offset = positions[corners] - row[:3]
        uv = np.stack([offset @ row[3:6] + row[6], offset @ row[7:10] + row[10]], axis=1)
        np.testing.assert_allclose(uv, uvs[corners], atol=1e-4)
        normal = row[11:14] + offset @ row[14:23].reshape(3, 3).T
        np.testing.assert_allclose(normal, normals[corners], atol=1e-4)
        e1, e2 = np.diff(positions[corners], axis=0)
        area = np.linalg.norm(np.cross(e1, e2))
        f1, f2 = np.diff(uvs[corners].astype(float), axis=0)
        tiles = abs(f1[0] * f2[1] - f1[1] * f2[0])
        np.testing.assert_allclose(row[23] ** 2, tiles / area, rtol=1e-3)


def test_triangles_without_area_are_left_out(images):
    mesh = floor()
    mesh.triangles = np.concatenate([mesh.triangles, [[0, 0, 1]]]).astype(np.int32)
    mesh.materials = np.zeros(len(mesh.triangles), np.int32)
    geometry = build_geometry(scene_of([mesh], [GROUND]), PartLibrary(()), images)
    assert geometry.chunk_range[:, 1].tolist() == [len(mesh.triangles) - 1]
    assert np.isfinite(geometry.shading[:, :15]).all()


def test_an_empty_scene_can_be_drawn(images, renderer_of, drawn):
    from ...kit.small_city import looking

    picture = drawn(renderer_of(scene_of([], [])), looking([(0.0, 0.0, 5.0)]))
    assert (picture.object_id == -1).all()
    assert np.isinf(picture.depth).all()


def test_texels_are_blended_between_their_centres_and_v_grows_upwards():
    image = np.zeros((256, 256, 4), np.uint8)
    image[0, :, 0], image[-1, :, 1], image[..., 3] = 255, 255, 255  # top row red, bottom row green
    packed = packed_layers({"plain": image}, ["plain"])

    def colour(level, u, v):
        return list(texel_at(packed, 0, np.int32(256 * level), True, np.float32(u), np.float32(v)))

    assert colour(0, 0.3, 0.5 / 256) == [0, 255, 0, 255]
    assert colour(0, 0.3, 255.5 / 256) == [255, 0, 0, 255]
    half = colour(0, -3.7, 1.0)  # between the last row and the first: it repeats
    assert half[:2] == [127, 127]
    mean = (1 / 256) ** 0.5 * 255
    assert colour(8, 0.9, 0.1) == [round(mean), round(mean), 0, 255]


@pytest.mark.parametrize("level", range(9))
def test_each_mip_level_is_the_mean_of_the_one_before_and_repeats(level):
    image = np.random.default_rng(0).integers(0, 256, (256, 256, 4)).astype(np.uint8)
    packed = packed_layers({"other": 255 - image, "this": image}, ["other", "this"])
    side = 256 >> level
    alpha = image[::-1, :, 3].reshape(side, 1 << level, side, 1 << level).mean(axis=(1, 3))
    for row, column in ((0, 0), (side - 1, side - 1), (side // 2, side // 3), (side, -1)):
        # Half-way between four centres: the last ones of a row and the first, and of a column.
        u, v = np.float32((column + 1) / side), np.float32((row + 1) / side)
        found = texel_at(packed, 1, np.int32(256 * level), False, u, v)[3]
        rows, columns = np.add([0, 1], row) % side, np.add([0, 1], column) % side
        assert found == pytest.approx(alpha[np.ix_(rows, columns)].mean(), abs=1.5)


def test_a_level_of_detail_has_about_one_texel_in_a_pixel():
    for level in range(9):
        for factor in (0.8, 1.0, 1.3):
            found = detail_at(np.float32((factor * 2.0**level) ** 2)) / 256
            assert found == pytest.approx(np.clip(level + np.log2(factor), 0, 8), abs=0.05)
            assert round(found) == level
    assert detail_at(np.float32(0.0)) == 0
    assert detail_at(np.float32(1e12)) == 2048


def test_large_pictures_show_no_line_where_mip_levels_meet():
    image = np.zeros((256, 256, 4), np.uint8)
    image[:, ::2, :3], image[..., 3] = 255, 255  # level 0 is white here, all coarser ones are grey
    packed = packed_layers({"plain": image}, ["plain"])

    def whites(blend):
        u, v = np.float32(0.5 / 256), np.float32(0.3)
        return [texel_at(packed, 0, np.int32(k), blend, u, v)[0] for k in range(2049)]

    blended, hard = np.array(whites(True)), np.array(whites(False))
    grey = 0.5**0.5 * 255
    assert blended[0] == 255
    assert blended[-1] == round(grey)
    assert np.abs(np.diff(blended)).max() <= 2
    assert np.abs(np.diff(hard)).max() > 70
    assert np.abs(blended[::256] - hard[::256]).max() == 0


def test_a_sliver_without_width_is_left_out_and_gives_no_number_that_is_none():
    """Its corners lie on a line but for the last bits, as polygons of roads may leave them."""
    sliver = [[0.0, -35.74767, 0.15], [23.706552, -64.0, 0.15], [17.931557, -57.117638, 0.15]]
    corners = np.array([sliver, [[0, 0, 0], [1, 0, 0], [0, 1, 0]]], np.float32)
    up = np.tile(np.array([0, 0, 1], np.float32), (2, 3, 1))
    solid = solid_triangles(corners)
    assert np.isfinite(gradients(corners[solid], up[solid], corners[solid, :, :2])).all()
    assert solid[1]


def test_gradients_of_every_triangle_that_is_kept_are_right_at_its_corners():
    rng = np.random.default_rng(0)
    count = 20_000
    a, b = (rng.uniform(-600, 600, (count, 3)) for _ in range(2))
    along, aside = rng.uniform(0, 1, (count, 1)), 10.0 ** rng.uniform(-9, 0, (count, 1))
    c = a + along * (b - a) + aside * rng.normal(size=(count, 3))
    corners = np.stack([a, b, c], axis=1).astype(np.float32)
    keep = solid_triangles(corners)
    assert 0.4 < keep.mean() < 0.99
    up = np.tile(np.float32([0, 0, 1]), (count, 3, 1))
    uvs = np.tile(np.float32([[0, 0], [1, 0], [0, 1]]), (count, 1, 1))
    with np.errstate(all="raise"):
        rows = gradients(corners[keep], up[keep], uvs[keep])
    corners = corners[keep].astype(np.float64)
    slopes = rows[:, 3:6].astype(np.float64)
    for corner, u in ((1, 1.0), (2, 0.0)):
        told = np.einsum("ti,ti->t", slopes, corners[:, corner] - corners[:, 0])
        np.testing.assert_allclose(told, u, atol=0.05)
