"""Street trees: size, levels of detail, how much they hide; rows."""

import numpy as np
import pytest
import shapely

from eyas.engine.state.mesh import Surface
from eyas.maps.plants.trees import VARIANTS, place_along, street_tree_levels
from eyas.maps.textures.shipped import build_textures


@pytest.fixture(scope="module", params=range(VARIANTS))
def levels(request):
    return street_tree_levels(np.random.default_rng(request.param), request.param)


def test_levels_have_the_promised_number_of_triangles(levels):
    fine, middle, coarse, tiny = (len(mesh.triangles) for mesh in levels)
    assert 2500 <= fine <= 4000
    assert 450 <= middle <= 750
    assert 80 <= coarse <= 160
    assert tiny <= 40


def test_a_tree_has_height_one_and_is_about_as_wide_as_the_originals(levels):
    for mesh, slack in zip(levels, (0.05, 0.1, 0.15, 0.3), strict=True):
        low, high = mesh.positions.min(0), mesh.positions.max(0)
        assert high[2] == pytest.approx(1.0, abs=slack)
        assert low[2] <= 0.0
        assert 0.85 < (high - low)[:2].mean() < 1.35


def test_leaves_begin_above_cars(levels):
    fine = levels[0]
    leafy = np.array([m.texture == "leaves" for m in fine.palette])
    z = fine.positions[fine.triangles[leafy[fine.materials]].ravel(), 2]
    assert 0.1 < z.min() < 0.35


def test_normals_are_unit_and_light_wraps_round_the_crown(levels):
    mesh = levels[0]
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-3)
    cards = np.array([m.surface == Surface.FOLIAGE for m in mesh.palette])
    corner = np.unique(mesh.triangles[cards[mesh.materials]])
    away = mesh.positions[corner] - np.array([0, 0, 0.52])
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    agreement = np.einsum("vi,vi->v", away, mesh.normals[corner])
    assert agreement.mean() > 0.75


def hidden_share(mesh, radius, holes, cells=48):
    """Share of a disc under the crown that is hidden from above, leaves with their holes."""
    grid = (np.arange(cells) + 0.5) / cells * 2 * radius - radius
    points = np.stack(np.meshgrid(grid, grid), axis=2).reshape(-1, 2)
    points = points[np.hypot(*points.T) < radius]
    hidden = np.zeros(len(points), bool)
    for triangle, material in zip(mesh.triangles, mesh.materials, strict=True):
        a, b, c = mesh.positions[triangle, :2].astype(np.float64)
        frame = np.stack([b - a, c - a], axis=1)
        if abs(np.linalg.det(frame)) < 1e-9:
            continue
        second, third = np.linalg.solve(frame, (points - a).T)
        inside = (second >= 0) & (third >= 0) & (second + third <= 1)
        if mesh.palette[material].surface == Surface.FOLIAGE:
            weights = np.stack([1 - second - third, second, third], axis=1)
            column, row = (np.floor(weights @ mesh.uvs[triangle] * 256) % 256).astype(int).T
            inside &= ~holes[255 - row, column]
        hidden |= inside
    return hidden.mean()


@pytest.mark.slow
def test_a_crown_hides_what_stands_under_it_at_every_level(levels):
    levels = levels[:3]  # under the last one a car is a pixel
    half_width = np.abs(levels[0].positions[:, :2]).max()
    holes = build_textures()["leaves"][..., 3] == 0
    shares = [hidden_share(mesh, 0.75 * half_width, holes) for mesh in levels]
    assert min(shares) > 0.96
    whole = [hidden_share(mesh, 0.95 * half_width, holes) for mesh in levels]
    assert min(whole) > 0.65
    assert max(whole) - min(whole) < 0.1  # a car must not appear when the level changes


def test_cards_cover_the_crown_more_than_once():
    mesh = street_tree_levels(np.random.default_rng(0), 0)[0]
    cards = np.array([m.surface == Surface.FOLIAGE for m in mesh.palette])
    corners = mesh.positions[mesh.triangles[cards[mesh.materials]]].astype(np.float64)
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    crown = np.pi * 1.1 * 0.8  # about the surface of an ellipsoid of that width and height
    assert np.linalg.norm(face, axis=1).sum() / 2 > 2 * crown


def test_uvs_of_a_card_stay_in_one_cluster(levels):
    mesh = levels[1]
    cards = np.array([m.surface == Surface.FOLIAGE for m in mesh.palette])
    uv = mesh.uvs[mesh.triangles[cards[mesh.materials]]] * 2
    middle = np.floor(uv.mean(axis=1, keepdims=True))
    assert ((uv >= middle - 1e-6) & (uv <= middle + 1 + 1e-6)).all()


def test_the_same_seed_gives_the_same_tree():
    one, two, other = (street_tree_levels(np.random.default_rng(s), 1)[0] for s in (3, 3, 4))
    assert one.positions.tobytes() == two.positions.tobytes()
    assert one.positions.tobytes() != other.positions.tobytes()


def test_rows_keep_their_spacing_and_leave_out_what_is_not_free():
    line = shapely.LineString([(0, 0), (300, 0)])
    row = place_along(line, (14.5, 20.0), np.random.default_rng(0), shapely.Polygon())
    gaps = np.diff(row[:, 0])
    assert gaps.min() >= 14.5
    assert gaps.max() <= 20.0
    assert row[0, 0] < 20
    assert row[-1, 0] > 270
    gap = shapely.box(100, -5, 200, 5)
    thinned = place_along(line, (14.5, 20.0), np.random.default_rng(0), gap)
    assert len(thinned) < len(row)
    assert not shapely.contains_xy(gap, thinned).any()


def test_a_short_line_has_no_tree_or_one():
    line = shapely.LineString([(0, 0), (3, 0)])
    row = place_along(line, (14.5, 20.0), np.random.default_rng(0), shapely.Polygon())
    assert row.shape[0] <= 1
    assert row.shape[1] == 2
