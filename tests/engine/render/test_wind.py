"""Wind: plants lean and sway, what falls is carried, and nothing else moves."""

import dataclasses

import numpy as np
import pytest

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.solids import cylinder
from eyas.engine.render.bake.sway import sway_of
from eyas.engine.render.kernels.wind import FARTHEST_LEAN
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.state.draw import PartLibrary, Views
from eyas.engine.state.lighting import LightState
from eyas.engine.state.mesh import Material

from ...kit.small_city import DAY, city_scene, floor, looking, scene_of, trees_at

CALM = dataclasses.replace(DAY, fog_density=0.0)
WINDY = dataclasses.replace(CALM, windy=1.0)


def in_wind(views: Views, x: float, y: float, instant: float) -> Views:
    ones = np.ones((3, len(views.position)), np.float32)
    wind = np.array([[x], [y]], np.float32) + 0 * ones[:2]
    instants = np.full(len(views.position), instant)
    return dataclasses.replace(views, light=LightState(*ones, *wind), instant=instants)


@pytest.fixture(scope="module")
def grove(renderer_of):
    trees = trees_at([(30.0, 0.0)])
    trees.object_id[:] = 1
    scene = scene_of([floor()], [0], trees)
    return {light: renderer_of(scene, lighting=light) for light in (CALM, WINDY)}


@pytest.fixture
def seen(drawn, grove):
    def see(x, y, instant, lighting=WINDY):
        views = in_wind(looking([(0.0, 0.0, 4.0)], fov=0.6), x, y, instant)
        return drawn(grove[lighting], views, size=(120, 160))

    return see


def middle(picture) -> tuple[float, float]:
    """Return the row and column of the middle of a tree."""
    rows, columns = np.nonzero(picture.object_id[0] == 1)
    return float(rows.mean()), float(columns.mean())


def test_a_tree_leans_with_the_wind_more_in_more_wind_and_sways(seen):
    still = middle(seen(0.0, 0.0, 3.0))[1]
    # The camera looks east: the wind that blows north moves things to the left.
    left = [still - middle(seen(0.0, speed, 3.0))[1] for speed in (5.0, 15.0)]
    assert 0.0 < left[0] < left[1] < 10.0
    assert still - middle(seen(0.0, -15.0, 3.0))[1] < 0.0
    columns = [middle(seen(0.0, 12.0, t))[1] for t in np.arange(0.0, 3.0, 0.3)]
    assert np.ptp(columns) > 0.2
    first, again = (seen(0.0, 12.0, 1.7).rgb for _ in range(2))
    np.testing.assert_array_equal(first, again)


def test_calm_air_moves_nothing(seen):
    before, after = seen(0.0, 0.0, 1.0), seen(0.0, 0.0, 7.0)
    np.testing.assert_array_equal(before.rgb, after.rgb)
    np.testing.assert_array_equal(before.object_id, seen(9.0, 9.0, 7.0, CALM).object_id)


def test_the_boxes_of_plants_hold_them_however_they_lean(grove):
    geometry, _ = grove[WINDY].packed
    pose = geometry.fixture_pose[0].astype(float)
    low, high = geometry.box[geometry.fixture_prototype[0]].reshape(2, 3)
    corners = np.array([np.where(np.array(way), high, low) for way in np.ndindex(2, 2, 2)])
    points = corners @ pose[:, :3].T
    for angle in np.arange(0.0, 6.3, 0.4):
        a, b = FARTHEST_LEAN * np.cos(angle), FARTHEST_LEAN * np.sin(angle)
        c = np.sqrt(1.0 - a * a - b * b)
        turn = np.array([[1 - a * a / (1 + c), -a * b / (1 + c), a],
                         [-a * b / (1 + c), 1 - b * b / (1 + c), b], [-a, -b, c]])  # fmt: skip
        leaned = points @ turn.T + pose[:, 3]
        box = geometry.fixture_box[:, 0]
        assert (leaned >= box[:3]).all()
        assert (leaned <= box[3:]).all()


def test_only_what_has_leaves_sways(images):
    pole = concatenate([cylinder((0.1, 0.1), (0.0, 4.0), 6, Material("asphalt"))])
    fixtures = trees_at([(10.0, 0.0), (20.0, 0.0)])
    fixtures.levels = (*fixtures.levels, (pole,))
    fixtures.prototype[1] = 1
    scene = scene_of([floor()], [0], fixtures)
    gain = sway_of(scene, build_geometry(scene, PartLibrary(()), images))[:, 1]
    assert sorted(gain > 0) == [False, True]
    assert gain.max() <= 1.0


def test_the_wind_is_the_views_own_whatever_is_drawn_beside_it(drawn, grove):
    places = [(0.0, y, 4.0) for y in (-3.0, 0.0, 3.0)]
    views = in_wind(looking(places, fov=0.6), 0.0, 0.0, 2.0)
    views.light.wind_y[:] = (4.0, 14.0, -9.0)
    together = drawn(grove[WINDY], views)
    for k in range(3):
        alone = in_wind(looking([places[k]], fov=0.6), 0.0, float(views.light.wind_y[k]), 2.0)
        np.testing.assert_array_equal(drawn(grove[WINDY], alone).rgb[0], together.rgb[k])


def test_rain_slants_with_the_wind(drawn, renderer_of):
    grey = {"sun_colour": (0.0, 0.0, 0.0), "zenith_colour": (0.9, 0.9, 0.9)}
    light = dataclasses.replace(WINDY, rain=0.8, **grey)
    renderer = renderer_of(city_scene(), lighting=light)
    views = in_wind(looking([(0.0, 0.0, 6.0)], fov=1.0), 0.0, 8.0, 3.0)
    assert views.light is not None
    views.light.fog_density[:] = 0.0
    shown, none = (
        drawn(renderer, dataclasses.replace(views, falling=on), size=(240, 320)).rgb[0].astype(int)
        for on in (True, False)
    )
    drops = np.abs(shown - none).sum(axis=2).astype(float)
    # It blows north, to the left of a camera that looks east.
    to_left = (drops[:-5, 5:] * drops[5:, :-5]).sum()
    to_right = (drops[:-5, :-5] * drops[5:, 5:]).sum()
    assert to_left > 2.0 * to_right
