"""Night: pools under street lamps, lit windows, the light that cars throw."""

import dataclasses

import numpy as np
import pytest
import shapely

from eyas.engine.mesh.flat import flat_polygon
from eyas.engine.render.kernels.light.tone import TONE_TOP
from eyas.engine.render.pack.light import lamp_grid, tone_table
from eyas.engine.sim.assets import load_assets
from eyas.engine.state.draw import DrawList, PartLibrary, Picture
from eyas.engine.state.scene import Lamps
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.build.materials import material
from eyas.engine.world.config import WorldConfig

from ...kit.small_city import DAY, car_parts, city_scene, floor, looking, put_car, scene_of, tower

DARK = dataclasses.replace(
    DAY,
    sun_colour=(0.0, 0.0, 0.0),
    ambient_up=(0.0, 0.0, 0.0),
    ambient_down=(0.0, 0.0, 0.0),
    fog_density=0.0,
    lamps=1.0,
)
HEIGHT = 7.2


def lamps_at(places) -> Lamps:
    position = np.array([(x, y, HEIGHT) for x, y in places], np.float32)
    down = np.tile(np.array([0, 0, -1], np.float32), (len(places), 1))
    return Lamps(position, down, intensity=17.0)


def paper(half: float = 100.0):
    return flat_polygon(shapely.box(-half, -half, half, half), 0.0, material("plain"), 1.0)


def radiance(pixels: np.ndarray) -> np.ndarray:
    """Undo the tone curve."""
    table = tone_table()
    return np.interp(pixels, table, np.arange(len(table))) * (TONE_TOP / len(table))


@pytest.fixture
def lit_plane(drawn, renderer_of):
    """Return the red light on white paper at some distances east of the middle [m]."""
    even = dataclasses.replace(DARK, lamps=0.0, ambient_up=(0.5, 0.5, 0.5))

    def see(lamps: Lamps, distances) -> np.ndarray:
        scene = scene_of([paper()], [0])
        scene.lamps = lamps
        views = looking([(d, 0.0, 40.0) for d in distances], pitch=np.pi / 2, fov=0.02)
        lit, known = (
            radiance(drawn(renderer_of(scene, lighting=each), views, size=(9, 9)).rgb[:, 4, 4, 0])
            for each in (DARK, even)
        )
        return 0.5 * lit / known  # the ground is worn here and there

    return see


def test_a_lamp_throws_light_aside_up_to_its_cut_off(lit_plane):
    distances = np.array([0.0, 4.0, 8.0, 12.0])
    light = lit_plane(lamps_at([(0, 0)]), distances)
    square = distances**2 + HEIGHT**2
    # Cosine over distance squared, and up to 2.5 times as much to the sides, even up to 1.1 rad.
    expected = HEIGHT / square**0.5 / (0.4 * square + 0.6 * HEIGHT**2)
    assert light[0] == pytest.approx(0.55, abs=0.06)
    np.testing.assert_allclose(light / light[0], expected / expected[0], atol=0.02)
    narrow = dataclasses.replace(lamps_at([(0, 0)]), cut_off=1.15)
    beyond = lit_plane(narrow, [0.0, HEIGHT * np.tan(1.2)])
    assert beyond[0] > 0.4
    assert beyond[1] < 0.001


def test_lights_of_several_lamps_add_up(lit_plane):
    near, far = lamps_at([(-5, 0)]), lamps_at([(9, 3)])
    both = lit_plane(lamps_at([(-5, 0), (9, 3)]), [1.0, 5.0])
    apart = lit_plane(near, [1.0, 5.0]) + lit_plane(far, [1.0, 5.0])
    np.testing.assert_allclose(both, apart, atol=0.01)


def test_the_grid_holds_every_lamp_that_is_near():
    rng = np.random.default_rng(3)
    places = rng.uniform(-150, 150, (40, 2))
    lamp, cells, frame = lamp_grid(lamps_at(places))
    assert lamp.shape == (40, 8)
    for point in rng.uniform(-170, 170, (300, 2)):
        corner = np.array([frame.west, frame.south])
        column, row = np.floor((point - corner) * frame.per_metre).astype(int)
        near = set(np.flatnonzero(np.linalg.norm(places - point, axis=1) < 30.0))
        listed = set()
        if 0 <= row < cells.shape[0] and 0 <= column < cells.shape[1]:
            listed = set(cells[row, column])
        assert near <= listed or len(listed - {-1}) == cells.shape[2]


def front_of(drawn, renderer_of, house, number, lighting):
    scene = scene_of([floor(), house], [0, number])
    views = looking([(-60.0, 0.0, 15.0)], fov=0.5)
    return drawn(renderer_of(scene, lighting=lighting), views, size=(120, 120)).rgb[0].astype(int)


def test_some_windows_are_lit_others_in_other_houses(drawn, renderer_of):
    lit = dataclasses.replace(
        DARK,
        lamps=0.0,
        windows=0.4,
        zenith_colour=(0, 0, 0),
        horizon_colour=(0, 0, 0),
        fog_colour=(0, 0, 0),
    )
    house = tower(0.0, 0.0, 24.0, 30.0)
    first = front_of(drawn, renderer_of, house, 5, lit)
    other = front_of(drawn, renderer_of, house, 6, lit)
    shining = first.max(axis=2) > 40
    # Glass covers 35 % of this wall, and the wall a part of the picture.
    assert 0.02 < shining.mean() < 0.25
    assert (shining != (other.max(axis=2) > 40)).mean() > 0.02
    none = front_of(drawn, renderer_of, house, 5, dataclasses.replace(lit, windows=0.0))
    assert (none.max(axis=2) > 40).mean() == 0.0
    every = front_of(drawn, renderer_of, house, 5, dataclasses.replace(lit, windows=2.0))
    assert (every.max(axis=2) > 40).mean() > 2.0 * shining.mean()


def test_cars_throw_white_light_ahead_and_red_behind(drawn, renderer_of):
    scene = scene_of([paper()], [0])
    cars = DrawList.create(1, 6)
    put_car(cars, 0, 0, 0, 0.0, 0.0, 0.0)
    places = [(8.0, 0.0, 40.0), (-3.2, 0.0, 40.0), (8.0, 9.0, 40.0), (-12.0, 0.0, 40.0)]
    views = looking(places, pitch=np.pi / 2, fov=0.02)
    renderer = renderer_of(scene, car_parts(), lighting=DARK)
    ahead, behind, aside, far = radiance(drawn(renderer, views, cars, (9, 9)).rgb[:, 4, 4])
    assert ahead.min() > 0.2
    assert behind[0] > 0.02
    assert behind[0] > 5 * behind[1]
    assert max(aside.max(), far.max()) < 0.001
    off = renderer_of(scene, car_parts(), lighting=dataclasses.replace(DARK, lamps=0.0))
    assert drawn(off, views, cars, (9, 9)).rgb.max() <= 1


def test_lamps_that_face_the_camera_have_halos_where_nothing_hides_them(drawn, renderer_of):
    """Their light lies over the dark sky beside the car; from the side there is none."""
    cars = DrawList.create(1, 6)
    put_car(cars, 0, 0, 0, 0.0, 0.0, 0.0)
    dark = dataclasses.replace(
        DARK, zenith_colour=(0.0, 0.0, 0.0), horizon_colour=(0.0, 0.0, 0.0), fog_colour=(0.0,) * 3,
        stars=0.0,
    )  # fmt: skip
    sides = [((18.0, 0.0), np.pi), ((-14.0, 0.0), 0.0), ((0.0, 16.0), -np.pi / 2)]

    def beside_it(*meshes):
        scene = scene_of([floor(1.0), *meshes], [0] * (1 + len(meshes)))
        renderer = renderer_of(scene, car_parts(), dark)
        made = []
        for (x, y), yaw in sides:
            picture = drawn(
                renderer, looking([(x, y, 0.9)], yaw=yaw, pitch=0.0, fov=0.3), cars, (48, 64)
            )
            near = (picture.depth[0] > 0.0) & (picture.depth[0] < 50.0)
            made.append(np.where(near, 0, picture.rgb[0].max(axis=2)).max())
        return made

    front, rear, side = beside_it()
    assert front > 2 * rear > 0
    assert side <= 1
    hidden, *_ = beside_it(tower(9.0, 0.0, 6.0, 8.0))
    assert hidden <= 1


def test_a_street_lamp_blooms_only_by_night_and_a_wet_road_mirrors_rear_lamps(drawn, renderer_of):
    black = dict.fromkeys(("zenith_colour", "horizon_colour", "fog_colour"), (0.0,) * 3)
    dark = dataclasses.replace(DARK, stars=0.0, **black)
    scene = scene_of([floor()], [0])
    scene.lamps = lamps_at([(20.0, 0.0)])
    up = looking([(0.0, 0.0, HEIGHT)], pitch=-0.1, fov=0.6)
    bloom = [
        drawn(renderer_of(scene, lighting=light), up, size=(60, 80)).rgb[0, 38:46, 36:44].max()
        for light in (dark, dataclasses.replace(dark, zenith_colour=(0.05,) * 3))
    ]
    assert bloom[0] > bloom[1] + 60
    cars = DrawList.create(1, 6)
    put_car(cars, 0, 0, 0, 0.0, 0.0, 0.0)
    behind = looking([(-14.0, 0.0, 4.0)], pitch=0.35, fov=0.6)
    dry, wet = (
        drawn(renderer_of(scene_of([floor()], [0]), car_parts(), light), behind, cars, (90, 120))
        for light in (dark, dataclasses.replace(dark, wet=1.0))
    )
    road = dry.object_id[0] == 0
    more = (wet.rgb[0].astype(int) - dry.rgb[0])[road]
    assert more[:, 0].max() > 20
    assert more[:, 0].max() > 3 * more[:, 2].max()


def test_light_of_cars_does_not_depend_on_where_a_picture_begins(drawn, renderer_of):
    """Eight samples are lit at once; none of them twice, wherever the first of them is."""
    cars = DrawList.create(1, 12)
    put_car(cars, 0, 0, 0, 0.0, 0.0, 0.3)
    put_car(cars, 0, 6, 1, 4.0, 4.0, -0.5)  # their beams cross
    renderer = renderer_of(scene_of([paper()], [0]), car_parts(), lighting=DARK)
    wide = looking([(6.0, 0.0, 40.0)], pitch=np.pi / 2, fov=1.0)
    wide.tent = False
    whole = drawn(renderer, wide, cars, (80, 90)).rgb[0].astype(int)
    assert ((whole > 20) & (whole < 240)).mean() > 0.1
    for width in (36, 44, 58, 84):
        fov = 2 * np.arctan(np.tan(0.5) * width / 90)
        views = looking([(6.0, 0.0, 40.0)], pitch=np.pi / 2, fov=fov)
        views.vertical_field_of_view = 2 * np.arctan(np.tan(0.5) * 80 / 90)
        views.tent = False
        part = drawn(renderer, views, cars, (80, width)).rgb[0]
        left = (90 - width) // 2
        assert np.abs(part - whole[:, left : left + width]).max() <= 1


def test_lamps_of_cars_on_a_bridge_do_not_light_the_road_below(drawn, renderer_of):
    cars = DrawList.create(1, 6)
    put_car(cars, 0, 0, 0, 0.0, 0.0, 0.0)
    views = looking([(8.0, 0.0, 40.0), (-3.2, 0.0, 40.0)], pitch=np.pi / 2, fov=0.02)
    renderer = renderer_of(scene_of([paper()], [0]), car_parts(), lighting=DARK)
    on_road = drawn(renderer, views, cars, (9, 9)).rgb.max(axis=(1, 2, 3))
    cars.pose[..., 2, 3] += 6.0
    above_it = drawn(renderer, views, cars, (9, 9)).rgb.max(axis=(1, 2, 3))
    assert on_road.min() > 20
    assert above_it.max() <= 1


def test_movers_without_lamps_throw_no_light(drawn, renderer_of):
    """A car that has them lights the road beside one that has none."""
    lit = car_parts()
    parts = PartLibrary((*lit.parts, *lit.parts), (True,) * 3 + (False,) * 3)
    renderer = renderer_of(scene_of([paper()], [0]), parts, lighting=DARK)
    cars = DrawList.create(1, 12)
    put_car(cars, 0, 0, 0, 0.0, 0.0, 0.0)
    put_car(cars, 0, 6, 1, 0.0, 50.0, 0.0)
    cars.part[0, 6:] += 3
    places = [(x, y, 40.0) for y in (0.0, 50.0) for x in (8.0, -3.2)]
    views = looking(places, pitch=np.pi / 2, fov=0.02)
    seen = radiance(drawn(renderer, views, cars, (9, 9)).rgb[:, 4, 4]).max(axis=1)
    assert seen[:2].min() > 0.02
    assert seen[2:].max() < 0.001


def test_small_windows_fade_to_their_mean(drawn, renderer_of):
    lit = dataclasses.replace(
        DARK,
        lamps=0.0,
        windows=0.4,
        zenith_colour=(0, 0, 0),
        horizon_colour=(0, 0, 0),
        fog_colour=(0, 0, 0),
    )
    scene = city_scene()
    means = []
    for size in ((400, 400), (40, 40)):
        views = looking([(-900.0, 0.0, 25.0)], fov=0.14)
        picture = drawn(renderer_of(scene, lighting=lit), views, size=size)
        walls = (picture.object_id >= 2) & (picture.object_id < 80)
        means.append(radiance(picture.rgb)[walls].mean())
    assert means[1] == pytest.approx(means[0], rel=0.35)


def test_the_street_city_at_night_has_a_third_of_the_days_brightness_and_bright_pools():
    pictures = {}
    for weather in ("day", "night"):
        assets = load_assets(WorldConfig(weather=weather), TrafficConfig(), 1)
        spots = [(*point, 22.0) for point in assets.scene.network.lane_points[::5]]
        picture = Picture.create(len(spots), 30, 40)
        movers = DrawList.create(1, 1)
        assets.renderer.draw(looking(spots, pitch=1.37), movers, picture)
        pictures[weather] = picture.rgb.astype(float)
    assert 0.3 < pictures["night"].mean() / pictures["day"].mean() < 0.5
    by_view = pictures["night"].mean(axis=(1, 2, 3))
    assert by_view.max() > 2.0 * by_view.min()
