"""Snow: where it lies, where wheels push it off, and how it falls."""

import dataclasses

import numpy as np
import pytest

from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.solids import box
from eyas.engine.render.bake.tracks import TRACK_ASIDE, track_map
from eyas.engine.render.kernels.surface.snow import Bed
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.pack.materials import crown_middles, snow_beds
from eyas.engine.render.renderer import build_renderer
from eyas.engine.state.draw import PartLibrary
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import material
from eyas.maps.plants.trees import street_tree_levels

from ...kit.small_city import DAY, city_scene, looking, scene_of, trees_at

SNOW = dataclasses.replace(DAY, snow=1.0, fog_density=0.0)
FALLING = dataclasses.replace(SNOW, flakes=0.5)


def plate(texture, surface=Surface.MATT, z=0.0):
    corners = [[(-40, -40, z), (40, -40, z), (40, 40, z), (-40, 40, z)]]
    return quads(corners, np.zeros((1, 4, 2)), Material(texture, surface=surface))


def scene_with(mesh, kind):
    scene = scene_of([mesh], [0])
    scene.object_class = np.full(max(len(scene.object_class), 1), int(kind), np.int32)
    return scene


def with_lanes(scene, *lanes):
    """Give a scene a network whose lanes are straight lines, each an edge of its own."""
    count = len(lanes)
    scene.network = dataclasses.replace(
        scene.network,
        lane_points=np.array(lanes, np.float64).reshape(-1, 2),
        lane_first=np.arange(0, 2 * count + 1, 2, dtype=np.int32),
        lane_width=np.full(count, 3.5),
        lane_edge=np.arange(count, dtype=np.int32),
        lane_index=np.zeros(count, np.int32),
        edges=tuple(f"e{k}" for k in range(count)),
        edge_start=("a", "b")[:count],
        edge_end=("b", "c")[:count],
    )
    return scene


@pytest.fixture
def seen(drawn, images, tmp_path):
    def see(scene, lighting, views=None, size=(96, 128), parts=None):
        geometry = build_geometry(scene, PartLibrary(()), images)
        renderer = build_renderer(scene, geometry, lighting, cache=tmp_path)
        views = views or looking([(0.3, 0.2, 20.0)], pitch=1.5707, fov=1.0)
        return drawn(renderer, views, size=size).rgb[0].astype(float)

    return see


def bare(lighting):
    return dataclasses.replace(lighting, snow=0.0)


def test_grass_turns_white_and_shadows_on_it_blue(seen):
    grass = seen(scene_with(plate("lawn"), ObjectClass.GROUND), SNOW)
    assert grass.min() > 150
    assert np.ptp(grass, axis=2).mean() < 25
    shade = dataclasses.replace(SNOW, sun_colour=(0.0, 0.0, 0.0))
    shadow = seen(scene_with(plate("lawn"), ObjectClass.GROUND), shade)
    assert (shadow[..., 2] - shadow[..., 0]).mean() > 15


def test_no_noise_shows_on_open_snow_from_afar(seen):
    ground = scene_with(plate("plain"), ObjectClass.GROUND)
    grass = seen(ground, SNOW, looking([(0, 0, 60.0)], pitch=1.5707, fov=0.8))
    assert np.abs(np.diff(grass, axis=1)).mean() < 1.0


def test_tracks_are_dark_and_what_lies_between_lanes_is_white(seen):
    scene = with_lanes(scene_with(plate("asphalt"), ObjectClass.ROAD), [(-38, 0), (38, 0)])
    road = seen(scene, SNOW, looking([(0, 0, 20.0)], pitch=1.5707, fov=1.0)).mean(axis=2)
    metre = 128 / (2 * 20 * np.tan(0.5))
    # Looking down with north to the left: rows are the east axis, columns the north axis.
    column = lambda north: int(64 - north * metre)  # noqa: E731
    left, right = (road[:, column(k * TRACK_ASIDE)].mean() for k in (1, -1))
    between, verge = road[:, column(0.0)].mean(), road[:, column(6.0)].mean()
    untouched = seen(scene, bare(SNOW), looking([(0, 0, 20.0)], pitch=1.5707, fov=1.0))
    assert max(left, right) < between - 15
    assert between < verge - 15
    assert verge > 150
    assert max(left, right) < untouched.mean() + 45


def test_tracks_lead_over_junctions():
    scene = scene_with(plate("asphalt"), ObjectClass.ROAD)
    found = track_map(with_lanes(scene, [(-30, 0), (-8, 0)], [(0, 8), (0, 30)]))
    low, per = found.frame[:2], found.frame[2]

    def worn(x, y):
        column, row = ((np.array([x, y]) - low) * per).astype(int)
        return found.worn[row - 3 : row + 4, column - 3 : column + 4, 0].max()

    assert worn(-20, 0) > 200
    assert worn(-2.3, 2.3) > 100  # on the bend from one lane to the other
    assert worn(-20, 15) == 0


@pytest.mark.parametrize("turn", [0.2, 0.35, 0.65])
def test_tracks_have_no_rungs_from_the_lattice_of_the_map(turn):
    along = np.array([np.cos(turn), np.sin(turn)])
    scene = scene_with(plate("asphalt"), ObjectClass.ROAD)
    found = track_map(with_lanes(scene, [-38 * along, 38 * along]))
    at = np.linspace(-30, 30, 400)
    points = at[:, None] * along + TRACK_ASIDE * np.array([-along[1], along[0]])
    column, row = ((points - found.frame[:2]) * found.frame[2] - 0.5).T
    i, j = row.astype(int), column.astype(int)
    v, u, worn = row - i, column - j, found.worn[..., 0].astype(float)
    upper = (1 - u) * worn[i, j] + u * worn[i, j + 1]
    seen = (1 - v) * upper + v * ((1 - u) * worn[i + 1, j] + u * worn[i + 1, j + 1])
    # Streaks of slush are metres long; rungs would repeat within one.
    smooth = np.convolve(seen, np.ones(9) / 9, "same")[10:-10]
    assert np.abs(seen[10:-10] - smooth).mean() < 2.8


def test_far_pixels_see_the_mean_of_the_tracks(seen):
    scene = with_lanes(scene_with(plate("asphalt"), ObjectClass.ROAD), [(-38, 0), (38, 0)])
    views = looking([(0, 0, 120.0)], pitch=1.5707, fov=0.5)
    # Pixels of a metre; without the mean, those on tracks are as dark as wet asphalt, 78.
    assert seen(scene, SNOW, views, size=(60, 60))[10:50, 29:31].mean() > 95


def test_walls_hold_none_above_their_feet(drawn, renderer_of):
    corners = [[(10, 8, 0.5), (10, -8, 0.5), (10, -8, 8), (10, 8, 8)]]
    wall = quads(corners, np.zeros((1, 4, 2)), material("plain", (0.6, 0.2, 0.2)))
    views = looking([(0, 0, 4)], fov=0.4)  # nothing but the wall
    snowy, dry = [
        drawn(renderer_of(scene_of([wall], [0]), lighting=light), views).rgb
        for light in (SNOW, bare(SNOW))
    ]
    np.testing.assert_array_equal(snowy, dry)


def test_crowns_are_white_above_and_green_below(seen):
    scene = scene_of([plate("plain")], [0], trees_at([(0.0, 0.0)]))

    def greenness(position, pitch):
        views = looking([position], pitch=pitch, fov=0.3)
        picture = seen(scene, SNOW, views)[36:60, 52:76]
        return (picture[..., 1] - picture[..., 2]).mean() / picture.mean()

    above = greenness((0.0, 0.0, 40.0), 1.5707)
    below = greenness((-14.0, 0.0, 0.5), -0.24)
    assert above < below - 0.1


def test_crowns_have_the_same_middle_near_by_and_far_away():
    levels = street_tree_levels(np.random.default_rng(1), 0)
    scene = scene_of([], [], dataclasses.replace(trees_at([(0.0, 0.0)]), levels=(levels,)))
    palettes = [mesh.palette for mesh in levels]
    near, *_ = crown_middles(scene, palettes[0])
    assert 0.3 < near < 0.7
    for palette in palettes:
        assert (crown_middles(scene, palette) == near).all()


def test_each_material_is_a_bed_of_its_own_kind():
    road, roof = material("asphalt"), material("bitumen")
    water, lamp = Material(surface=Surface.WATER), Material(surface=Surface.LAMP)
    car, pane = Material(surface=Surface.PAINT), Material(surface=Surface.GLASS)
    sides = [box((1, 1, 1), (0, 0, 0), what, 1.0) for what in (car, pane)]
    parts = PartLibrary((tuple(sides),))
    scene = scene_with(plate("asphalt"), ObjectClass.ROAD)
    scene.fixtures = trees_at([(0.0, 0.0)])
    leaves = scene.fixtures.levels[0][0].palette[-1]
    found = snow_beds(scene, parts, (road, roof, water, lamp, car, pane, leaves))
    kinds = [Bed.DRIVEN, Bed.OPEN, Bed.BARE, Bed.BARE, Bed.VEHICLE, Bed.BARE, Bed.LEAVES]
    assert list(found) == kinds


def flakes_at(drawn, renderer, instant, size=(240, 320), position=(0.0, 0.0, 12.0)):
    views = looking([position], pitch=0.5, fov=0.8)
    views.instant = None if instant is None else np.array([instant])
    return drawn(renderer, views, size=size).rgb[0].astype(int)


def test_no_instant_and_no_snowfall_leave_the_picture_alone(drawn, renderer_of):
    falling, lying = (renderer_of(city_scene(), lighting=light) for light in (FALLING, SNOW))
    still = flakes_at(drawn, lying, 3.0)
    np.testing.assert_array_equal(flakes_at(drawn, falling, None), still)
    assert (flakes_at(drawn, falling, 3.0) != still).any()


def test_flakes_fall_with_time_and_are_the_same_at_the_same_time(drawn, renderer_of):
    falling = renderer_of(city_scene(), lighting=FALLING)
    still = flakes_at(drawn, falling, None)
    now, again, next_ = (flakes_at(drawn, falling, t) - still for t in (5.0, 5.0, 5.04))
    np.testing.assert_array_equal(now, again)
    now, next_ = np.abs(now).sum(axis=2), np.abs(next_).sum(axis=2)

    def agreement(rows):  # of one picture with the other moved down
        return (now[: 200 - rows, 4:-4] * next_[rows:200, 4:-4]).sum()

    # 4 hundredths of a second at 1.25 m/s: 5 cm, 3 pixels and more at 6 m and less.
    assert max(agreement(rows) for rows in range(2, 12)) > 1.5 * agreement(0)
    assert max(agreement(rows) for rows in range(2, 12)) > 1.5 * agreement(40)


def test_flakes_are_few_and_small_in_small_pictures(drawn, renderer_of):
    falling = renderer_of(city_scene(), lighting=FALLING)
    for size, most in (((84, 84), 0.03), ((480, 640), 0.12)):
        still = flakes_at(drawn, falling, None, size)
        touched = np.abs(flakes_at(drawn, falling, 8.0, size) - still).max(axis=2) > 16
        assert 0 < touched.mean() < most


def test_near_things_hide_flakes(drawn, renderer_of):
    falling = renderer_of(scene_of([plate("plain", z=-0.55)], [0]), lighting=FALLING)
    views = looking([(0, 0, 0)], pitch=1.5707, fov=0.8)
    views.instant = np.array([2.0])
    seen = drawn(falling, views).rgb
    views.instant = None
    np.testing.assert_array_equal(seen, drawn(falling, views).rgb)


def test_no_snow_lies_on_the_road_in_a_tunnel():
    scene = with_lanes(scene_with(plate("asphalt"), ObjectClass.ROAD), [(-38, 0), (38, 0)])
    fresh = track_map(scene).worn[..., 0]
    scene.colliders = dataclasses.replace(
        scene.colliders,
        prism_points=np.array([(-5.0, -4.0), (5.0, -4.0), (5.0, 4.0), (-5.0, 4.0)] * 2)
        + np.repeat([[0.0, 0.0], [25.0, 0.0]], 4, axis=0),
        prism_first=np.array([0, 4, 8], np.int32),
        prism_bottom=np.array([6.0, 50.0]),
        prism_top=np.array([9.0, 52.0]),
        prism_object=np.zeros(2, np.int32),
    )
    found = track_map(scene)
    x = np.arange(found.worn.shape[1]) / found.frame[2] + found.frame[0]
    y = np.arange(found.worn.shape[0]) / found.frame[2] + found.frame[1]
    inside = np.ix_(np.abs(y) < 3.0, np.abs(x) < 4.0)
    assert found.worn[(*inside, 0)].min() == 255
    away = np.abs(x) > 7.0  # under the other roof, 50 m high, snow falls
    assert (found.worn[:, away, 0] == fresh[:, away]).all()


def test_the_map_of_tracks_of_very_long_roads_has_larger_texels(monkeypatch):
    scene = scene_with(plate("asphalt"), ObjectClass.ROAD)
    scene = with_lanes(scene, [(-900, 0), (900, 0)], [(0, -700), (0, 700)])
    monkeypatch.setattr("eyas.engine.render.bake.tracks.MOST_TEXELS", 300_000)
    found = track_map(scene)
    assert found.worn[..., 0].size < 303_000  # whole rows and columns
    assert found.frame[2] == pytest.approx(300_000**0.5 / (1812 * 1412) ** 0.5)
    column = int((500.0 - found.frame[0]) * found.frame[2])
    assert found.worn[:, column, 0].max() > 100
