"""Scenes whose pictures can be computed by hand."""

import dataclasses
import itertools

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.optics.pinhole import project, rays
from eyas.engine.mesh.assembly import transformed
from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.solids import box, sphere
from eyas.engine.render.kernels.light.tone import TONE_STEPS, TONE_TOP
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.pack.light import tone_table
from eyas.engine.render.renderer import build_renderer
from eyas.engine.state.draw import DrawList, PartLibrary, Picture
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.scene import ACTOR_OBJECT, SKY_OBJECT
from eyas.engine.world.build.materials import material

from ...kit.small_city import (
    DAY,
    GROUND,
    TOWER,
    TREE_OBJECT,
    car_parts,
    floor,
    looking,
    put_car,
    scene_of,
    tower,
    trees_at,
)

SIZE = (96, 128)
FOV = 1.0


def box_of(mask: np.ndarray) -> tuple[int, int, int, int]:
    rows, columns = np.nonzero(mask)
    return columns.min(), rows.min(), columns.max() + 1, rows.max() + 1


def test_depth_of_the_floor_is_that_of_the_plane(renderer_of, drawn):
    views = looking([(3.0, -5.0, 22.0)], yaw=0.3, pitch=0.5, fov=FOV)
    picture = drawn(renderer_of(scene_of([floor(4000.0)], [GROUND])), views)
    down = rays(views.rotation[0], SIZE[1], SIZE[0], FOV)[..., 2]
    ground = down < -0.02
    np.testing.assert_allclose(picture.depth[0][ground], 22.0 / -down[ground], rtol=1e-5)
    assert (picture.object_id[0][ground] == GROUND).all()
    sky = down > 0
    assert np.isinf(picture.depth[0][sky]).all()
    assert (picture.object_id[0][sky] == SKY_OBJECT).all()


@pytest.mark.parametrize("vertical", [None, 0.5])
def test_corners_of_a_box_land_where_the_pinhole_says(vertical, renderer_of, drawn):
    block = box((4.0, 6.0, 3.0), (20.0, 2.0, 1.0), material("concrete"), 6.0)
    views = looking([(1.0, -3.0, 6.0)], yaw=0.2, pitch=0.15, fov=FOV)
    views.vertical_field_of_view = vertical
    picture = drawn(renderer_of(scene_of([block], [7])), views)
    corners = [
        np.add((20.0, 2.0, 1.0), np.multiply(s, (2.0, 3.0, 1.5)))
        for s in itertools.product((-1, 1), repeat=3)
    ]
    column, row, _ = project(
        corners, views.position[0], views.rotation[0], SIZE[1], SIZE[0], FOV, vertical
    )
    expected = column.min(), row.min(), column.max(), row.max()
    np.testing.assert_allclose(box_of(picture.object_id[0] == 7), expected, atol=1.0)


def test_depth_of_a_sphere_is_that_of_the_ball(renderer_of, drawn):
    centre, radius = np.array([12.0, 0.5, 4.0]), 3.0
    pose = np.concatenate([radius * np.eye(3), centre[:, None]], axis=1)
    ball = transformed(sphere(5, material("plain")), pose)
    views = looking([(0.0, 0.0, 4.5)], fov=FOV)
    picture = drawn(renderer_of(scene_of([ball], [9])), views)
    ray = rays(views.rotation[0], SIZE[1], SIZE[0], FOV)
    offset = centre - views.position[0]
    half, square = ray @ offset, (ray * ray).sum(-1)
    below = half**2 - square * (offset @ offset - radius**2)
    inside = below > 3.0
    depth = (half - np.sqrt(np.maximum(below, 0))) / square
    assert (picture.object_id[0][inside] == 9).all()
    assert (picture.object_id[0][below < -3.0] == SKY_OBJECT).all()
    np.testing.assert_allclose(picture.depth[0][inside], depth[inside], atol=0.02)


def test_moving_parts_fixtures_and_houses_have_their_ids(renderer_of, drawn):
    scene = scene_of(
        [floor(), tower(30.0, 12.0, 10.0, 9.0)], [GROUND, TOWER], trees_at([(30.0, -10.0)])
    )
    draw_list = DrawList.create(1, 6)
    put_car(draw_list, 0, 0, 3, 20.0, 0.0, 1.2)
    views = looking([(0.0, 0.0, 5.0)], pitch=0.05, fov=1.2)
    picture = drawn(renderer_of(scene, car_parts()), views, draw_list)
    assert set(np.unique(picture.object_id)) == {
        SKY_OBJECT, GROUND, TOWER, TREE_OBJECT, ACTOR_OBJECT + 3,
    }  # fmt: skip
    for thing, (x, y, z) in {
        TOWER: (25.0, 12.0, 4.0),
        TREE_OBJECT: (27.7, -10.0, 5.2),
        ACTOR_OBJECT + 3: (19.2, 0.0, 1.2),
    }.items():
        column, row, depth = project(
            (x, y, z), views.position[0], views.rotation[0], SIZE[1], SIZE[0], 1.2
        )
        at = 0, int(row), int(column)
        assert picture.object_id[at] == thing
        assert picture.depth[at] == pytest.approx(depth, abs=0.6)


def test_holes_between_leaves_show_what_is_behind_in_all_outputs(renderer_of, images, drawn):
    striped = {**images, "leaves": images["leaves"].copy()}
    striped["leaves"][:, :128, 3], striped["leaves"][:, 128:, 3] = 255, 0
    leaves = Material("leaves", (0.9, 0.1, 0.1), Surface.FOLIAGE)
    corners = [[(10, 4, 1), (10, -4, 1), (10, -4, 7), (10, 4, 7)]]  # faces west
    card = quads(corners, [[(0, 0), (1, 0), (1, 1), (0, 1)]], leaves)
    wall = quads(np.add(corners, (10, 0, 0)), np.zeros((1, 4, 2)), material("plain"))
    scene = scene_of([card, wall], [4, 5])
    geometry = build_geometry(scene, PartLibrary(()), striped)
    picture = drawn(build_renderer(scene, geometry, DAY), looking([(0, 0, 4)], fov=FOV))
    left, hole = (0, 48, 45), (0, 48, 80)
    assert picture.object_id[left] == 4
    assert picture.depth[left] == pytest.approx(10.0)
    assert picture.object_id[hole] == 5
    assert picture.depth[hole] == pytest.approx(20.0)
    assert picture.rgb[left][0] > 1.5 * picture.rgb[left][2] > picture.rgb[hole][0] * 0.0
    assert abs(int(picture.rgb[hole][0]) - int(picture.rgb[hole][2])) < 70
    np.testing.assert_array_equal(picture.object_id == 4, np.isclose(picture.depth, 10.0))


def test_foliage_is_seen_from_behind_too(renderer_of, drawn):
    leaves = Material("plain", surface=Surface.FOLIAGE)
    corners = [[(10, -4, 1), (10, 4, 1), (10, 4, 7), (10, -4, 7)]]  # faces east
    for surface, expected in ((leaves, 4), (material("plain"), SKY_OBJECT)):
        card = quads(corners, np.zeros((1, 4, 2)), surface)
        picture = drawn(renderer_of(scene_of([card], [4])), looking([(0, 0, 4)], fov=FOV))
        assert picture.object_id[0, 48, 64] == expected


def test_far_things_fade_into_the_fog(renderer_of, drawn):
    scene = scene_of([floor(4000.0)], [GROUND])
    views = looking([(0.0, 0.0, 8.0)], fov=FOV)
    thick = dataclasses.replace(DAY, fog_density=1 / 100)
    clear = dataclasses.replace(DAY, fog_density=0.0)
    foggy = drawn(renderer_of(scene, lighting=thick), views).rgb[0].astype(int)
    fine = drawn(renderer_of(scene, lighting=clear), views).rgb[0].astype(int)
    far, near = 50, 90  # rows: over 300 m and 20 m away
    haze = foggy[40].mean(axis=0)  # the sky just above the horizon
    assert np.abs(foggy[far].mean(axis=0) - haze).max() < 25
    assert np.abs(fine[far].mean(axis=0) - haze).max() > 50
    assert np.abs(foggy[near] - fine[near]).mean() < np.abs(foggy[far] - fine[far]).mean()


@pytest.mark.parametrize("power", [1, 2])
def test_the_veil_is_as_thick_as_webots_fog(renderer_of, drawn, power):
    away, reach = 150.0, 400.0
    corners = [[(away, 40, -30), (away, -40, -30), (away, -40, 50), (away, 40, 50)]]
    wall = quads(corners, np.zeros((1, 4, 2)), material("plain", (0.3, 0.3, 0.3)))
    scene = scene_of([wall], [TOWER])

    def radiance(density):
        light = dataclasses.replace(DAY, fog_density=density, fog_power=power)
        picture = drawn(renderer_of(scene, lighting=light), looking([(0, 0, 4)], fov=0.2))
        # The middle of the steps of radiance that make this byte.
        made = [np.flatnonzero(tone_table() == byte).mean() for byte in picture.rgb[0, 48, 64]]
        return (np.array(made) + 0.5) * TONE_TOP / TONE_STEPS

    hidden = 1 - np.exp(-((away / reach) ** power))
    clear = radiance(0.0)
    expected = clear + hidden * (np.array(DAY.fog_colour) - clear)
    np.testing.assert_allclose(radiance(1 / reach), expected, atol=0.006)


def test_four_samples_smooth_edges_and_leave_depth_and_ids_alone(renderer_of, drawn):
    renderer = renderer_of(scene_of([floor(), tower(30.0, 3.0, 9.0, 12.0)], [GROUND, TOWER]))
    views = looking([(0.0, 0.0, 5.0)], yaw=0.1, pitch=0.1, fov=FOV)
    views.tent = False
    one, four = drawn(renderer, views), drawn(renderer, views, samples=4)
    np.testing.assert_array_equal(one.depth, four.depth)
    np.testing.assert_array_equal(one.object_id, four.object_id)

    def jumps(picture):
        steps = np.abs(np.diff(picture.rgb[0].astype(int).sum(-1), axis=1))
        return (steps[:40] > 150).sum()  # the tower against the sky

    assert 0 < jumps(four) < jumps(one)
    assert np.abs(one.rgb.astype(int) - four.rgb).mean() < 6


def test_paint_takes_the_colour_of_the_instance(renderer_of, drawn):
    renderer = renderer_of(scene_of([floor()], [GROUND]), car_parts())
    draw_list = DrawList.create(1, 6)
    put_car(draw_list, 0, 0, 0, 0.0, 0.0, 0.0)
    views = looking([(1.6, 0.0, 12.0)], pitch=np.pi / 2, fov=0.3)
    for colour in np.eye(3):
        draw_list.colour[:] = colour
        pixel = drawn(renderer, views, draw_list).rgb[0, 48, 64]
        assert pixel.argmax() == colour.argmax()


def test_wrong_arguments_are_refused_in_one_line(renderer_of, images):
    scene = scene_of([floor()], [GROUND])
    views = looking([(0.0, 0.0, 5.0)])
    with pytest.raises(ConfigError, match="samples: 3 is not allowed; allowed: 1, 2, 4"):
        renderer_of(scene).draw(views, DrawList.create(1, 1), Picture.create(1, 8, 8), 3)
    without = {name: image for name, image in images.items() if name != "lawn"}
    with pytest.raises(UnknownNameError, match=r"texture.*'lawn'"):
        build_geometry(scene, PartLibrary(()), without)
