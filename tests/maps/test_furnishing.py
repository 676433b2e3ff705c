"""Street furniture, plants, parked cars and roof units: where they stand, and what they are."""

from functools import partial

import numpy as np
import pytest
import shapely

from eyas.engine.state.scene import ObjectClass
from eyas.maps.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.maps.buildings import rooftops
from eyas.maps.citystreet.layout import lay_out
from eyas.maps.plants import shrubs as plants
from eyas.maps.street import furniture, parked_cars

FURNITURE = tuple(furniture.FURNITURE)
PLANTS = tuple(plants.PLANTS)
CARS = tuple(f"parked car {k}" for k in range(parked_cars.VARIANTS))
UNITS = tuple(f"roof {kind}" for kind in rooftops.UNITS)


@pytest.fixture(scope="module")
def plan(scene):
    return lay_out(scene.network, 0)


def some(scene, names):
    """Which fixtures are copies of prototypes with one of these names."""
    wanted = [scene.fixtures.names.index(name) for name in names]
    return np.flatnonzero(np.isin(scene.fixtures.prototype, wanted))


def outlines(scene, indices):
    """The ground that each fixture's finest mesh covers."""
    made = []
    for index in indices:
        pose = scene.fixtures.pose[index].astype(float)
        mesh = scene.fixtures.levels[scene.fixtures.prototype[index]][0]
        flat = mesh.positions.astype(float) @ pose[:2, :3].T + pose[:2, 3]
        made.append(shapely.MultiPoint(flat).convex_hull)
    return made


def test_furniture_stands_on_pavements_and_not_in_the_way_of_cars(scene, plan):
    indices = some(scene, FURNITURE)
    assert len(indices) > 200
    assert len(set(scene.fixtures.prototype[indices])) == len(FURNITURE)
    pose = scene.fixtures.pose[indices]
    assert shapely.contains_xy(plan.pavement, *pose[:, :2, 3].T.astype(float)).all()
    assert np.allclose(pose[:, 2, 3], KERB_HEIGHT)
    kinds = scene.object_class[scene.fixtures.object_id[indices]]
    assert (kinds == ObjectClass.STRUCTURE).all()
    shapes = outlines(scene, indices)
    assert not shapely.intersects(plan.roads, shapes).any()
    assert not shapely.intersects(plan.lots, shapes).any()


def test_furniture_faces_the_road(scene, plan):
    for index in some(scene, ["bench"]):
        pose = scene.fixtures.pose[index].astype(float)
        there, behind = (shapely.Point(pose[:2, 3] + s * pose[:2, 1]) for s in (1.0, -1.0))
        assert plan.roads.distance(there) < plan.roads.distance(behind)


def test_plants_stand_on_lawn_clear_of_roads_and_walls(scene, plan):
    indices = some(scene, set(PLANTS) - {"island"})
    assert len(indices) > 300
    solid = shapely.union_all([shapely.Polygon(corners) for corners in plan.footprints])
    middle = scene.fixtures.pose[indices][:, :2, 3].astype(float)
    blocked = shapely.union_all([plan.roads, plan.access, plan.pavement, plan.lots, solid])
    assert not shapely.contains_xy(blocked, *middle.T).any()
    assert np.allclose(scene.fixtures.pose[indices][:, 2, 3], FLOOR_HEIGHT)
    assert not shapely.intersects(plan.roads, outlines(scene, indices)).any()


def test_parked_cars_stand_in_bays_and_are_part_of_the_scene(scene, plan):
    indices = some(scene, CARS)
    assert len(indices) > 80
    bays = np.concatenate([park.bays for park in plan.car_parks])
    spots = scene.fixtures.pose[indices][:, :2, 3]
    apart = np.linalg.norm(spots[:, None] - bays[None, :, :2], axis=2)
    assert apart.min(axis=1).max() < 0.4
    assert len(set(apart.argmin(axis=1))) == len(indices)  # one car in a bay
    kinds = scene.object_class[scene.fixtures.object_id[indices]]
    assert np.isin(kinds, [ObjectClass.CAR, ObjectClass.TRUCK]).all()
    lots = shapely.union_all([park.area for park in plan.car_parks])
    assert shapely.covers(lots, outlines(scene, indices)).all()


def test_roof_units_belong_to_their_building_and_stay_on_its_roof(scene):
    indices = some(scene, UNITS)
    assert len(indices) > 200
    owner = scene.fixtures.object_id[indices]
    assert (scene.object_class[owner] == ObjectClass.BUILDING).all()
    solids = scene.colliders
    for index, building, shape in zip(indices, owner, outlines(scene, indices), strict=True):
        prism = int(np.flatnonzero(solids.prism_object == building)[0])
        low, high = solids.prism_first[prism : prism + 2]
        assert shapely.Polygon(solids.prism_points[low:high]).contains(shape)
        z = float(scene.fixtures.pose[index, 2, 3])
        assert z == pytest.approx(solids.prism_top[prism] - 0.9, abs=1e-3)


@pytest.mark.parametrize(
    "makers",
    [
        furniture.FURNITURE,
        rooftops.UNITS,
        {k: partial(parked_cars.parked_car, k) for k in range(parked_cars.VARIANTS)},
        {name: partial(make, np.random.default_rng(0)) for name, make in plants.PLANTS.items()},
    ],
)
def test_coarser_levels_have_fewer_triangles_and_the_same_size(makers):
    for levels in (make() for make in makers.values()):
        counts = [len(mesh.triangles) for mesh in levels]
        assert counts == sorted(counts, reverse=True)
        assert counts[-1] <= 84
        sizes = [np.ptp(mesh.positions, axis=0) for mesh in levels]
        assert np.abs(sizes[-1] - sizes[0]).max() < 1.2


def test_car_bodies_face_outwards():
    for variant in range(parked_cars.VARIANTS):
        for mesh in parked_cars.parked_car(variant):
            corners = mesh.positions[mesh.triangles].astype(float)
            face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            high = corners[..., 2].mean(axis=1) > 1.3
            assert face[high & (face[:, 2] < 0), 2].sum() / 2 > -0.5  # small parts, a rack's bars
            assert face[face[:, 2] > 0, 2].sum() / 2 > 3.0  # what is seen from above
