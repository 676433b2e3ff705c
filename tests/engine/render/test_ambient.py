"""Ambient occlusion: how much of the sky the ground sees."""

import dataclasses

import numpy as np
import pytest
import shapely

from eyas.engine.mesh.solids import box
from eyas.engine.render.bake.ambient import bake_ambient, canopy_map, height_map, openness_of
from eyas.engine.render.kernels.light.ambient import BOUNCED
from eyas.engine.state.scene import ObjectClass
from eyas.engine.state.terrain import Terrain, ground_at
from eyas.engine.world.build.materials import material
from eyas.maps.land.mounds import Mound
from eyas.maps.land.relief import relief, surface_of, terrain_of

from ...kit.small_city import (
    DAY,
    GROUND,
    TOWER,
    TREE,
    TREE_OBJECT,
    floor,
    looking,
    scene_of,
    tower,
    trees_at,
)

SHADE = dataclasses.replace(DAY, sun_colour=(0.0, 0.0, 0.0), fog_density=0.0)


def open_shares(solid, crowns=None, decks=None, workers=1) -> np.ndarray:
    """Return the share of the sky that each texel's ground sees, light that bounces left out."""
    crowns = np.zeros_like(solid) if crowns is None else crowns
    decks = np.zeros_like(solid) if decks is None else decks
    result = openness_of(solid, crowns, decks, 1.0, workers)
    return ((result & 255) / 255.0 - BOUNCED) / (1.0 - BOUNCED)


def field() -> np.ndarray:
    return np.zeros((81, 81), np.float32)


def test_an_open_field_sees_all_of_the_sky_and_the_foot_of_a_long_high_wall_half():
    assert open_shares(field()).min() > 0.995
    wall = field()
    wall[:, 40:60] = 1e6
    assert open_shares(wall)[40, 39] == pytest.approx(0.5, abs=0.01)


def test_a_wall_as_high_as_it_is_far_hides_what_the_formula_says():
    # On the way that is turned by a the wall's top stands under h with tan h = cos a: the mean of
    # sin^2 h = cos^2 a / (1 + cos^2 a) over the half circle, and nothing on the other half.
    angle = np.linspace(-np.pi / 2, np.pi / 2, 2001)
    hidden = 0.5 * (np.cos(angle) ** 2 / (1 + np.cos(angle) ** 2)).mean()
    wall = field()
    wall[:, 51:60] = 10.0  # its face is 10.5 m from the middle of column 40
    assert open_shares(wall)[40, 40] == pytest.approx(1 - hidden, abs=0.05)


def test_a_courtyard_is_darker_than_a_street_and_crowns_let_some_light_through():
    court, street, crowns = field(), field(), field()
    court[30:51, 30:51] = street[30:37, :] = street[44:51, :] = 20.0
    court[37:44, 37:44] = 0.0
    crowns[30:51, 30:51] = 12.0
    middle = [open_shares(field(), crowns)[40, 40]]
    middle += [open_shares(solid)[40, 40] for solid in (court, street)]
    assert middle[1] < 0.6 * middle[2] < 0.6
    assert 0.2 < middle[0] < 0.6


def test_below_an_elevated_road_it_is_darker_the_lower_the_road_is():
    # Straight below a long strip of half width w at height h, the share w / root(w^2 + h^2) of the
    # light is hidden.
    hidden = []
    for height in (6.0, 15.0, 50.0):
        road = field()
        road[:, 33:48] = height
        shares = open_shares(field(), decks=road)
        hidden.append(1 - shares[40, 40])
        assert shares[40, 40] < shares[40, 60] < shares[40, 80] < 1.01
    exact = [7.5 / np.hypot(7.5, height) for height in (6.0, 15.0, 50.0)]
    assert hidden == pytest.approx(exact, abs=0.08)


def test_a_roof_beside_a_higher_wall_is_as_dark_as_ground_beside_one():
    wall, roof = field(), np.full((81, 81), 20.0, np.float32)
    wall[:, 40:60], roof[:, 40:60] = 30.0, 50.0
    ground = open_shares(wall)
    np.testing.assert_array_equal(open_shares(roof), ground)
    assert ground[40, 38] < 0.65 < 0.9 < ground[40, 5]


def test_any_number_of_workers_bakes_the_same():
    solid = np.where(np.random.default_rng(0).random((81, 81)) < 0.05, 15.0, 0.0)
    solid = solid.astype(np.float32)
    np.testing.assert_array_equal(open_shares(solid, workers=1), open_shares(solid, workers=3))


def test_walls_darken_towards_their_feet_and_roofs_stay_bright(drawn, renderer_of):
    block = box((20.0, 20.0, 30.0), (0.0, 0.0, 15.0), material("plain"), 1.0)
    scene = scene_of([floor(60.0, "plain"), block], [GROUND, TOWER], size=120.0)
    renderer = renderer_of(scene, lighting=SHADE)
    down = [(10.6, 0.0, 30.0), (40.0, 0.0, 30.0), (0.0, 0.0, 60.0)]
    foot, away, roof = (
        drawn(renderer, looking(down, pitch=np.pi / 2, fov=0.02), size=(9, 9))
        .rgb[:, 4, 4]
        .astype(int)
        .sum(axis=1)
    )
    assert foot < 0.9 * away
    low, high = drawn(
        renderer, looking([(40.0, 0.0, 1.0), (40.0, 0.0, 25.0)], yaw=np.pi, fov=0.02), size=(9, 9)
    ).rgb.mean(axis=(1, 2, 3))
    assert low < 0.9 * high
    lone = scene_of([block], [TOWER], size=1.0)  # no map reaches so far
    alone = drawn(renderer_of(lone, lighting=SHADE), looking(down[2:], pitch=np.pi / 2, fov=0.02))
    assert roof == pytest.approx(int(alone.rgb[0, 48, 64].astype(int).sum()), abs=6)


def test_ground_with_roads_is_nowhere_alike_but_as_light_as_its_texture(drawn, renderer_of):
    pictures = []
    for kind in (ObjectClass.GROUND, ObjectClass.ROAD):
        scene = scene_of([floor(60.0, "plain")], [GROUND], size=120.0)
        scene.object_class[GROUND] = kind
        above = looking([(0.0, 0.0, 60.0)], pitch=1.57)
        picture = drawn(renderer_of(scene, lighting=SHADE), above)
        pictures.append(picture.rgb[0, ..., 1].astype(float))
    even, worn = pictures
    assert even.std() < 2 < worn.std() < 25
    assert worn.mean() == pytest.approx(even.mean(), abs=8)


def test_light_on_a_roof_and_a_deck_follows_what_is_higher(drawn, renderer_of):
    low = box((60.0, 60.0, 10.0), (0.0, 0.0, 5.0), material("plain"), 1.0)
    high = box((20.0, 60.0, 30.0), (10.0, 0.0, 15.0), material("plain"), 1.0)
    deck = box((40.0, 14.0, 1.0), (80.0, 0.0, 7.5), material("plain"), 1.0)
    scene = scene_of(
        [floor(200.0, "plain"), low, high, deck], [GROUND, TOWER, TOWER, TREE], size=300.0
    )
    scene.object_class[TREE] = ObjectClass.STRUCTURE
    renderer = renderer_of(scene, lighting=SHADE)

    def light(x, y, z, pitch=np.pi / 2, yaw=0.0):
        views = looking([(x, y, z)], pitch=pitch, yaw=yaw, fov=0.02)
        return int(drawn(renderer, views, size=(9, 9)).rgb[0, 4, 4].astype(int).sum())

    by_wall, away = light(-3.0, 0.0, 20.0), light(-24.0, 0.0, 20.0)
    assert by_wall < 0.95 * away
    foot, top = (light(-15.0, 0.0, z, pitch=0.0) for z in (12.0, 28.0))
    assert foot < 0.95 * top
    below, beside = light(80.0, 0.0, 5.0), light(80.0, 60.0, 5.0)
    assert below < 0.9 * beside
    assert light(80.0, 0.0, 20.0) == pytest.approx(light(10.0, 0.0, 60.0), abs=9)  # on the deck


def test_a_hill_is_no_wall_and_what_stands_on_it_is_as_high_as_it_is():
    ground = relief(Mound(0.0, 0.0, 50.0, 30.0).heights, (60.0, 64.0), (2.0, 2.0),
                    shapely.Polygon(), np.random.default_rng(0))  # fmt: skip
    terrain = terrain_of(ground, 0.0, 60.0, spacing=2.0)
    none = np.zeros(len(ground.triangles), np.int64)
    hill = surface_of(ground, 0.0, [material("plain")], none, smooth=True)
    top = tower(0.0, 0.0, 10.0, 12.0)
    top.positions[:, 2] += np.where(top.positions[:, 2] > 0, 30.0, 0.0)
    scene = scene_of([hill, top], [GROUND, TOWER], size=120.0)
    scene.terrain = terrain
    scene.fixtures = trees_at([(25.0, 0.0)])
    scene.object_class[TREE_OBJECT] = ObjectClass.TREE
    scene.fixtures.pose[:, 2, 3] = ground_at(terrain, 25.0, 0.0)
    frame = np.array([-60.0, -60.0, 1.0, 0.0])
    solid, crowns = (make(scene, frame, (120, 120)) for make in (height_map, canopy_map))
    corner = 42.0 - ground_at(terrain, 5.0, 5.0)  # of the roof, where it is highest
    assert solid[60, 60] == pytest.approx(corner, abs=0.01)
    solid[54:67, 54:67] = 0.0
    assert solid.max() == 0.0
    assert 5.0 < crowns.max() < 10.0
    bare = bake_ambient(dataclasses.replace(scene, terrain=Terrain.flat(0.0)), None)
    assert (bake_ambient(scene, None).openness != bare.openness).any()


def test_the_map_is_kept_and_follows_what_stands(tmp_path):
    scene = scene_of([floor(), tower(0, 0, 10, 20)], [GROUND, TOWER])
    first = bake_ambient(scene, tmp_path)
    (file,) = tmp_path.rglob("*.npy")
    file.unlink()  # it is mapped
    file.write_bytes(b"no arrays")
    np.testing.assert_array_equal(bake_ambient(scene, tmp_path).openness, first.openness)
    assert len(list(tmp_path.rglob("*.npy"))) == 1
    scene.fixtures = trees_at([(30.0, 30.0)])
    bake_ambient(scene, tmp_path)
    assert len(list(tmp_path.rglob("*.npy"))) == 2


def test_shade_is_blue_in_the_open_and_less_so_between_walls(drawn, renderer_of):
    # Seen from above, in the shade of everything; the light of walls is that of a lit street.
    shade = dataclasses.replace(DAY, fog_density=0.0, ambient_down=(0.0, 0.0, 0.0))
    court = [tower(x, y, 8.0, 30.0) for x, y in ((-9, 0), (9, 0), (0, -9), (0, 9))]
    views = looking([(0.0, 0.0, 60.0)], pitch=1.5707, fov=0.02)

    def blue(meshes, light):
        scene = scene_of([floor(), *meshes], [GROUND, *[TOWER] * len(meshes)])
        picture = drawn(renderer_of(scene, lighting=light), views).rgb.astype(float)
        return (picture[..., 2] / picture[..., 0]).mean()

    low_sun = dataclasses.replace(shade, sun_direction=(0.995, 0.0, 0.1))
    open_shade = blue([], dataclasses.replace(shade, sun_colour=(0.0, 0.0, 0.0)))
    assert blue(court, low_sun) < open_shade - 0.05
