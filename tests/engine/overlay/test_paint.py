"""Overlays on scenes whose pictures can be computed by hand."""

from dataclasses import replace

import numpy as np
import pytest

from eyas.engine.core.optics.pinhole import project, rays
from eyas.engine.overlay.items import GroundArea, Label, Overlay, Solid, ThinLine
from eyas.engine.overlay.paint import paint_overlays, with_depth
from eyas.engine.state.draw import DrawList, Picture
from eyas.engine.state.terrain import Plane
from eyas.engine.task.ground import on_plane

from ...kit.small_city import GROUND, TOWER, floor, looking, scene_of, tower

SIZE = (96, 128)
FOV = 1.0
RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
SQUARE = np.array([[12.0, -4.0], [22.0, -4.0], [22.0, 4.0], [12.0, 4.0]])


@pytest.fixture(scope="module")
def plain(renderer_of):
    return renderer_of(scene_of([floor(4000.0)], [GROUND]))


@pytest.fixture(scope="module")
def walled(renderer_of):
    return renderer_of(scene_of([floor(), tower(13.0, 0.0, 4.0, 12.0)], [GROUND, TOWER]))


@pytest.fixture
def painted(drawn):
    """Draw a scene; return the picture without and with an overlay in each view."""

    def paint(renderer, views, *overlays, size=SIZE):
        before = drawn(renderer, views, size=size)
        after = replace(before, rgb=before.rgb.copy())
        paint_overlays(views, overlays, after)
        return before, after

    return paint


def changed(before: Picture, after: Picture) -> np.ndarray:
    return (before.rgb[0] != after.rgb[0]).any(axis=-1)


def ground_area(corners, height=0.0, fill=0.0) -> GroundArea:
    """A blue area on level ground."""
    ground = Plane(0.0, 0.0, height, 0.0, 0.0)
    return GroundArea(on_plane(ground, np.asarray(corners)), ground, BLUE, fill)


def shown_ground(views, size=SIZE) -> tuple[np.ndarray, np.ndarray]:
    """Return where each pixel's centre meets z = 0."""
    ray = rays(views.rotation[0], size[1], size[0], FOV)
    with np.errstate(divide="ignore"):
        reach = -views.position[0, 2] / ray[..., 2]
    return views.position[0, 0] + reach * ray[..., 0], views.position[0, 1] + reach * ray[..., 1]


def octahedron(middle, radius: float) -> Solid:
    corners = np.concatenate([np.eye(3), -np.eye(3)]) * radius + middle
    faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    return Solid(corners, np.array(faces, np.int32), np.tile(RED, (8, 1)))


def test_an_area_covers_the_ground_inside_its_corners_and_nothing_else(plain, painted):
    views = looking([(0.0, 0.0, 20.0)], pitch=0.8, fov=FOV)
    area = ground_area(SQUARE, fill=0.5)
    before, after = painted(plain, views, Overlay(areas=(area,)))
    x, y = shown_ground(views)
    margin = 0.35  # a pixel covers up to 0.35 m there
    inside = (x > 12 + margin) & (x < 22 - margin) & (np.abs(y) < 4 - margin)
    outside = (x < 12 - margin) | (x > 22 + margin) | (np.abs(y) > 4 + margin)
    assert inside.sum() > 200
    assert changed(before, after)[inside].all()
    assert not changed(before, after)[outside].any()
    deep = (x > 14) & (x < 20) & (np.abs(y) < 2.5)
    np.testing.assert_allclose(
        after.rgb[0][deep], 0.5 * before.rgb[0][deep] + (0.0, 0.0, 127.5), atol=1.0
    )
    line = after.rgb[0].astype(int)
    lit = (line[..., 2] > 200) & (line[..., 0] < 60)
    # Between casings of a pixel the line begins a pixel inside the edge.
    edge = np.minimum(np.minimum(x - 12, 22 - x), 4 - np.abs(y))
    assert lit.any()
    assert ((edge[lit] > 0.0) & (edge[lit] < 1.2)).all()


def test_a_line_far_away_keeps_its_width(plain, painted):
    views = looking([(0.0, 0.0, 6.0)], pitch=0.1, fov=FOV)
    views.tent = False  # so that one pixel says how bright the ground below the line is
    far = np.array([[150.0, -200.0], [3000.0, -200.0], [3000.0, 200.0], [150.0, 200.0]])
    before, after = painted(plain, views, Overlay(areas=(ground_area(far),)))
    assert 150 * 0.14 / 6 < 20  # the line, 0.14 m wide, would be a thirtieth of a pixel
    ink = (after.rgb[0, ..., 2].astype(float) - before.rgb[0, ..., 2])[:, 64]
    full = 255.0 - before.rgb[0, 60, 64, 2]
    assert ink[ink > 0].sum() / full > 1.4


@pytest.mark.parametrize("ground", [0.0, -0.1])
def test_a_wall_hides_the_ground_behind_it(ground, walled, painted):
    views = looking([(0.0, 0.0, 8.0)], pitch=0.4, fov=FOV)
    area = ground_area(SQUARE, ground, fill=0.5)
    before, after = painted(walled, views, Overlay(areas=(area,)))
    ray = rays(views.rotation[0], SIZE[1], SIZE[0], FOV)
    with np.errstate(invalid="ignore"):
        height = 8.0 + before.depth[0] * ray[..., 2]
    wall = (before.object_id[0] == TOWER) & (height > 0.31)  # what lies lower counts as ground
    assert wall.sum() > 500
    assert not changed(before, after)[wall].any()
    assert changed(before, after)[before.object_id[0] == GROUND].sum() > 100


def test_the_sky_stays_clear_where_an_area_reaches_the_horizon_and_behind(plain, painted):
    views = looking([(0.0, 0.0, 10.0)], pitch=0.05, fov=FOV)
    around = np.array([[-300.0, -300.0], [2500.0, -300.0], [2500.0, 300.0], [-300.0, 300.0]])
    before, after = painted(plain, views, Overlay(areas=(ground_area(around, fill=0.5),)))
    sky = np.isinf(before.depth[0])
    assert sky.any()
    assert not changed(before, after)[sky].any()
    x, y = shown_ground(views)
    assert changed(before, after)[~sky & (x < 2000) & (np.abs(y) < 200)].all()


def test_an_area_seen_from_below_or_without_corners_draws_nothing(plain, painted):
    views = looking([(0.0, 0.0, 5.0)], pitch=0.6, fov=FOV)
    above, level = (ground_area(SQUARE, height, 0.5) for height in (6.0, 4.9))
    empty = ground_area(np.zeros((0, 2)), fill=0.5)
    before, after = painted(plain, views, Overlay(areas=(above, level, empty)))
    assert not changed(before, after).any()


@pytest.mark.parametrize("backwards", [False, True])
def test_a_line_is_drawn_where_the_pinhole_says_and_clipped_at_the_camera(
    backwards, plain, painted
):
    views = looking([(0.0, 0.0, 5.0)], yaw=0.2, pitch=0.1, fov=FOV)
    ends = np.array([-30.0, 8.0, 3.0]), np.array([60.0, -3.0, 6.0])
    line = ThinLine(*(ends[::-1] if backwards else ends), BLUE)
    before, after = painted(plain, views, Overlay(lines=(line,)))
    points = ends[0] + np.linspace(0.34, 1.0, 400)[:, None] * (ends[1] - ends[0])
    column, row, depth = project(points, views.position[0], views.rotation[0], 128, 96, FOV)
    shown = (depth > 0.2) & (column > 1) & (column < 127) & (row > 1) & (row < 95)
    column, row = column[shown], row[shown]
    assert len(column) > 50
    assert changed(before, after)[row.astype(int), column.astype(int)].all()
    rows, columns = np.nonzero(changed(before, after))
    away = np.hypot(columns[:, None] + 0.5 - column, rows[:, None] + 0.5 - row).min(axis=1)
    assert np.quantile(away, 0.98) < 2.5


def test_a_line_behind_the_camera_is_not_drawn(plain, painted):
    views = looking([(0.0, 0.0, 5.0)], fov=FOV)
    line = ThinLine(np.array([-5.0, 3.0, 5.0]), np.array([-40.0, -3.0, 9.0]), BLUE)
    before, after = painted(plain, views, Overlay(lines=(line,)))
    assert not changed(before, after).any()


def test_walls_hide_lines_and_solids(walled, painted):
    views = looking([(0.0, 0.0, 4.0)], fov=FOV)
    hidden = Overlay(
        lines=(ThinLine(np.array([30.0, -1.0, 4.0]), np.array([30.0, 1.0, 5.0]), BLUE),),
        solids=(octahedron((30.0, 0.0, 4.0), 1.0),),
    )
    before, after = painted(walled, views, hidden)
    assert not changed(before, after).any()
    before, after = painted(walled, views, Overlay(solids=(octahedron((9.0, 0.0, 4.0), 1.0),)))
    assert changed(before, after).any()


def test_a_solid_covers_its_projection_and_its_outline_lies_outside(plain, painted):
    views = looking([(0.0, 0.0, 5.0)], fov=FOV)
    focal = 64 / np.tan(0.5)
    before, after = painted(plain, views, Overlay(solids=(octahedron((20.0, 0.0, 5.0), 1.5),)))
    rgb = after.rgb[0].astype(int)
    body = (rgb[..., 0] > 120) & (rgb[..., 1] < 40)
    rows, columns = np.nonzero(body)
    radius = focal * 1.5 / 20
    assert columns.max() + 1 - columns.min() == pytest.approx(2 * radius, abs=2.5)
    assert rows.max() + 1 - rows.min() == pytest.approx(2 * radius, abs=2.5)
    assert body.sum() == pytest.approx(2 * radius**2, rel=0.15)
    around = changed(before, after) & ~body
    assert around.any()
    assert body[48, 64]


def test_a_tiny_solid_keeps_its_body(plain, painted):
    views = looking([(0.0, 0.0, 5.0)], fov=FOV)
    focal = 64 / np.tan(0.5)
    size = 2.0 * 60.0 / focal  # two pixels in radius, eight in area
    before, after = painted(plain, views, Overlay(solids=(octahedron((60.0, 0.0, 5.0), size),)))
    red = after.rgb[0, ..., 0].astype(int) - after.rgb[0, ..., 1]
    assert red.clip(0).sum() / 255 > 0.55 * 8
    assert changed(before, after).sum() > 20  # and the outline is there too


def test_a_solid_at_the_camera_is_left_out(plain, painted):
    views = looking([(0.0, 0.0, 5.0)], fov=FOV)
    before, after = painted(plain, views, Overlay(solids=(octahedron((0.5, 0.0, 5.0), 1.0),)))
    assert not changed(before, after).any()


def test_what_is_near_the_camera_is_drawn(plain, painted):
    views = looking([(0.0, 0.0, 5.0)], fov=FOV)
    line = ThinLine(np.array([0.5, -0.1, 5.0]), np.array([0.5, 0.1, 5.0]), BLUE)
    label = Label(np.array([0.5, 0.0, 5.0]), "0.8", RED)
    for near in (
        Overlay(solids=(octahedron((0.5, 0.0, 5.0), 0.1),)),
        Overlay(lines=(line,)),
        Overlay(labels=(label,)),
    ):
        before, after = painted(plain, views, near)
        assert changed(before, after).any()


def test_labels_stand_beside_their_point_or_in_the_corner(plain, painted):
    views = looking([(0.0, 0.0, 5.0)], fov=FOV)
    near = Label(np.array([20.0, 0.0, 5.0]), "0.8", RED, clear=1.0)
    before, after = painted(plain, views, Overlay(labels=(near,)))
    rows, columns = np.nonzero(changed(before, after))
    assert columns.min() > 64 + 64 / np.tan(0.5) / 20
    assert abs(rows.mean() - 48) < 3
    behind = np.array([-20.0, 0.0, 5.0])
    before, after = painted(plain, views, Overlay(labels=(Label(behind, "0.8", RED),)))
    assert not changed(before, after).any()
    always = Label(behind, "0.8", RED, always=True)
    before, after = painted(plain, views, Overlay(labels=(always,)))
    rows, columns = np.nonzero(changed(before, after))
    assert rows.max() < 20
    assert columns.max() < 40


def luminance(srgb: np.ndarray) -> np.ndarray:
    """Return the relative luminance of colours 0 to 255 (WCAG 2.2)."""
    share = srgb / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return linear @ (0.2126, 0.7152, 0.0722)


def test_labels_are_legible_on_black_and_on_white():
    """Letters against their outline have the contrast of small text, 4.5 to 1 (WCAG 2.2, 1.4.3)."""
    views = looking([(0.0, 0.0, 5.0)], fov=FOV)
    overlay = Overlay(labels=(Label(np.array([20.0, 0.0, 5.0]), "reward 0.80", (1.0, 1.0, 1.0)),))
    on = []
    for background in (0, 255):
        picture = with_depth(Picture.create(1, 480, 640))
        picture.rgb[:], picture.depth[:] = background, np.inf
        paint_overlays(views, (overlay,), picture)
        on.append(luminance(picture.rgb[0].astype(np.float64)))
    letters = on[0] > 0.9
    assert letters.sum() > 100
    around = (on[0] < 0.1) & (on[1] < 0.9)  # covered by the outline, and not by a letter's rim
    assert around.sum() > letters.sum()
    for drawn in on:
        contrast = (drawn[letters].min() + 0.05) / (np.median(drawn[around]) + 0.05)
        assert contrast > 4.5


def test_the_same_bytes_twice_and_in_any_company(plain, painted):
    one, other = (0.0, 0.0, 20.0), (3.0, 1.0, 15.0)
    overlay = Overlay(
        areas=(ground_area(SQUARE, fill=0.2),),
        lines=(ThinLine(np.array([5.0, 0.0, 9.0]), np.array([22.0, 4.0, 0.0]), RED),),
        solids=(octahedron((17.0, 0.0, 2.0), 1.0),),
        labels=(Label(np.array([17.0, 0.0, 3.0]), "reward 0.50", RED),),
    )
    both = looking([one, other], pitch=0.8, fov=FOV)
    first = painted(plain, both, overlay, overlay)[1].rgb
    assert np.array_equal(first, painted(plain, both, overlay, overlay)[1].rgb)
    alone = painted(plain, looking([other], pitch=0.8, fov=FOV), overlay)[1].rgb
    assert np.array_equal(first[1], alone[0])


def test_depth_is_added_only_where_it_is_not_wanted_and_colours_are_needed(plain):
    picture = Picture.create(1, *SIZE)
    deep = with_depth(picture)
    assert picture.depth is None
    assert deep.rgb is picture.rgb
    plain.draw(looking([(0.0, 0.0, 5.0)], fov=FOV), DrawList.create(1, 1), deep)
    assert with_depth(deep) is deep
    with pytest.raises(ValueError, match="rgb is needed"):
        with_depth(Picture.create(1, *SIZE, rgb=False, depth=True))


def test_the_nearest_face_of_a_solid_is_seen_in_whatever_order_faces_come(plain, painted):
    def facing(x, half, colour):
        corners = np.array([[x, half, 5 - half], [x, -half, 5 - half], [x, 0.0, 5 + half]])
        return corners, colour

    for order in (1, -1):
        parts = [facing(10.0, 0.7, BLUE), facing(20.0, 4.0, RED)][::order]
        corners = np.concatenate([part[0] for part in parts])
        triangles = np.arange(6, dtype=np.int32).reshape(2, 3)
        both = Solid(corners, triangles, np.array([part[1] for part in parts]))
        _, after = painted(plain, looking([(0.0, 0.0, 5.0)], fov=FOV), Overlay(solids=(both,)))
        rgb = after.rgb[0].astype(int)
        assert rgb[48, 64, 2] > rgb[48, 64, 0] + 50
        assert rgb[30, 64, 0] > rgb[30, 64, 2] + 50  # beside the nearer one
