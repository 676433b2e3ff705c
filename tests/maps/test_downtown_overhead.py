"""What hangs over the streets of downtown: bridges between buildings, and a railway."""

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from eyas.engine.sim.scenes import load_network, load_scene
from eyas.engine.state.scene import ObjectClass
from eyas.engine.traffic.recording_file import load
from eyas.engine.world.maps.recipe import TRAFFIC_FILE
from eyas.engine.world.roads.areas import road_area
from eyas.maps.downtown import DOWNTOWN
from eyas.maps.downtown.layout import lay_out
from eyas.maps.downtown.scenery import scenery_of

TRUCK = 4.5
"""Height of the highest vehicle [m]."""
LOWEST_DRONE = 13.0
"""Least height at which episodes of the original begin [m]."""


@pytest.fixture(scope="module")
def plan():
    return lay_out(DOWNTOWN.shipped_network(), 0)


@pytest.fixture(scope="module")
def scenery(plan):
    return scenery_of(DOWNTOWN.shipped_network(), plan, 0)


@pytest.fixture(scope="module")
def asphalt():
    return road_area(DOWNTOWN.shipped_network())


@pytest.fixture(scope="module")
def fronts(plan):
    return shapely.union_all([shapely.Polygon(corners) for corners in plan.footprints])


@pytest.fixture(scope="module")
def solids():
    """Outline, bottom and top of each solid of the class of bridges and railway."""
    scene = load_scene("downtown", 0)
    all_of_them = scene.colliders
    first = all_of_them.prism_first
    shapes = [shapely.Polygon(all_of_them.prism_points[a:b]) for a, b in pairwise(first)]
    made = scene.object_class[all_of_them.prism_object] == ObjectClass.STRUCTURE
    return np.array(shapes)[made], all_of_them.prism_bottom[made], all_of_them.prism_top[made]


def test_each_skyway_leads_over_a_road_from_one_front_to_another(scenery, asphalt, fronts):
    assert len(scenery.skyways) > 40
    for skyway in scenery.skyways:
        shape = shapely.Polygon(skyway.outline())
        assert shape.intersection(asphalt).area > 0.3 * shape.area
        assert shape.intersection(fronts).area < 0.05
        for end in (skyway.start, skyway.end):
            assert fronts.distance(shapely.Point(end)) < 0.05


def test_both_buildings_of_a_skyway_are_higher_than_it(plan, scenery):
    shapes = [shapely.Polygon(corners) for corners in plan.footprints]
    for skyway in scenery.skyways:
        for end in (skyway.start, skyway.end):
            number = int(np.argmin(shapely.distance(shapes, shapely.Point(end))))
            lowest = plan.buildings[number][0]
            assert lowest.bottom + lowest.height >= skyway.top


def test_no_skyway_meets_a_tree_or_the_railway(plan, scenery):
    trunks = shapely.points(np.concatenate([scenery.kerbs.great_trees, scenery.kerbs.slim_trees]))
    for skyway in scenery.skyways:
        shape = shapely.Polygon(skyway.outline())
        assert shapely.distance(trunks, shape).min() > 4.0
        assert not shape.intersects(plan.viaduct.ground)


def test_the_railway_crosses_each_street_and_no_building(plan, scenery, fronts):
    assert len(plan.viaduct.over) == 9
    assert not plan.viaduct.ground.buffer(-0.01).intersects(fronts)
    assert not plan.viaduct.ground.intersects(scenery.park.ground)


def test_columns_stand_off_the_road_and_behind_parked_cars(plan, scenery, asphalt):
    wheels = shapely.union(asphalt, scenery.kerbs.bays)
    feet = shapely.points(plan.viaduct.feet)
    assert shapely.distance(wheels, feet).min() > 0.6
    trees = shapely.points(scenery.kerbs.slim_trees)
    assert min(shapely.distance(trees, foot).min() for foot in feet) > 4.0


def test_what_crosses_a_road_leaves_room_below_and_above(solids, asphalt):
    shapes, bottom, top = solids
    over = shapely.intersects(shapes, asphalt)
    assert over.sum() > 50
    assert bottom[over].min() > TRUCK + 0.5
    assert top[over].max() < LOWEST_DRONE


def test_it_hides_cars_from_the_drone_above_them(solids):
    """The line from a car to a drone 22 m up, exactly behind it, meets a bridge or the railway."""
    recording = load(DOWNTOWN.shipped(TRAFFIC_FILE))
    place, yaw = recording.position[::60], recording.yaw[::60]
    behind = 22.0 / math.tan(1.37)
    drone = place - behind * np.stack([np.cos(yaw), np.sin(yaw)], axis=-1)
    place, drone = place.reshape(-1, 2), drone.reshape(-1, 2)
    shapes, bottom, top = solids
    overhead = bottom > TRUCK
    hidden = np.zeros(len(place), np.bool_)
    for shape, low, high in zip(shapes[overhead], bottom[overhead], top[overhead], strict=True):
        for z in (low, high):
            share = (z - 0.8) / (22.0 - 0.8)
            hidden |= shapely.contains_xy(shape, *(place + share * (drone - place)).T)
    assert 0.02 < hidden.mean() < 0.06


@pytest.mark.sumo
@pytest.mark.parametrize("seed", [1, 2])
def test_other_cities_hold_together_too(seed):
    network = load_network("downtown", seed)
    plan = lay_out(network, seed)
    scenery = scenery_of(network, plan, seed)
    fronts = shapely.union_all([shapely.Polygon(corners) for corners in plan.footprints])
    assert fronts.is_valid
    assert not plan.viaduct.ground.buffer(-0.01).intersects(fronts)
    assert not plan.viaduct.ground.intersects(scenery.park.ground)
    wheels = shapely.union(road_area(network), scenery.kerbs.bays)
    assert shapely.distance(wheels, shapely.points(plan.viaduct.feet)).min() > 0.6
    assert len(scenery.skyways) > 40
    shapes = [shapely.Polygon(skyway.outline()) for skyway in scenery.skyways]
    assert shapely.area(shapely.intersection(shapes, fronts)).max() < 0.05
