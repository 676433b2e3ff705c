"""Street lamps of the street city."""

import numpy as np
import pytest
import shapely

from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.mesh import Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.roads.areas import road_area
from eyas.maps.street.lamps import BEYOND_KERB, LIGHT, POLE_HEIGHT, lamp_levels


@pytest.fixture(scope="module")
def feet(scene):
    """Lights are 3.1 m off their poles, towards the road."""
    lean = scene.lamps.axis[:, :2] / np.linalg.norm(scene.lamps.axis[:, :2], axis=1)[:, None]
    return scene.lamps.position[:, :2] - LIGHT[0] * lean


def test_there_are_as_many_as_in_the_original_and_as_far_apart(scene):
    places = scene.lamps.position[:, :2]
    apart = np.linalg.norm(places[:, None] - places[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    assert len(places) == 48
    assert 52.0 < np.median(apart.min(axis=1)) < 66.0
    assert scene.lamps.position[:, 2] == pytest.approx(7.2)
    assert np.linalg.norm(scene.lamps.axis, axis=1) == pytest.approx(1.0)


@pytest.mark.slow
@pytest.mark.sumo
@pytest.mark.parametrize("seed", [1, 2])
def test_other_cities_have_as_many_also_where_there_is_less_room(seed):
    lamps = load_scene("citystreet", seed).lamps
    apart = np.linalg.norm(lamps.position[:, None] - lamps.position[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    assert len(lamps.position) == 48
    assert 30.0 < apart.min()
    assert 50.0 < np.median(apart.min(axis=1)) < 66.0


def test_poles_stand_beyond_the_kerb_with_their_lights_over_the_road(scene, feet):
    road = road_area(scene.network)
    away = shapely.distance(road, shapely.points(feet))
    assert np.median(away) == pytest.approx(BEYOND_KERB, abs=0.1)
    assert away.min() > 1.0
    assert shapely.contains_xy(road, *scene.lamps.position[:, :2].T).mean() > 0.9


def test_every_pole_is_a_pole_that_stands_in_no_house(scene, feet):
    fixtures = scene.fixtures
    roots = fixtures.pose[:, :2, 3]
    first = scene.colliders.prism_first
    houses = [
        shapely.Polygon(scene.colliders.prism_points[first[k] : first[k + 1]])
        for k in range(len(first) - 1)
        if scene.object_class[scene.colliders.prism_object[k]] == ObjectClass.BUILDING
    ]
    for foot in feet:
        nearest = int(np.argmin(np.linalg.norm(roots - foot, axis=1)))
        assert np.linalg.norm(roots[nearest] - foot) < 0.01
        assert scene.object_class[fixtures.object_id[nearest]] == ObjectClass.POLE
        assert not any(house.contains(shapely.Point(foot)) for house in houses)
        others = np.delete(roots, nearest, axis=0)
        assert np.linalg.norm(others - foot, axis=1).min() > 1.0


def test_a_lamp_has_a_shining_lens_under_its_arm_in_every_level():
    counts = []
    for mesh in lamp_levels():
        shining = [m.surface == Surface.LAMP and m.emission > 1.0 for m in mesh.palette]
        lens = mesh.triangles[np.isin(mesh.materials, np.flatnonzero(shining))]
        assert mesh.positions[lens].mean(axis=(0, 1)) == pytest.approx(LIGHT, abs=0.05)
        assert POLE_HEIGHT - 0.4 < mesh.positions[:, 2].max() < POLE_HEIGHT + 0.1
        counts.append(len(mesh.triangles))
    assert counts == sorted(counts, reverse=True)
