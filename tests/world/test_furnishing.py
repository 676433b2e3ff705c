"""Street furniture, plants, parked cars and roof units: where they stand, and what they are."""

import numpy as np
import pytest
import shapely

from eyas.state.scene import ObjectClass
from eyas.world.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.world.buildings import rooftops
from eyas.world.maps import build_scene, shipped_network
from eyas.world.maps.citystreet.plan import make_plan
from eyas.world.plants import shrubs as plants
from eyas.world.plants.trees import VARIANTS
from eyas.world.street import furniture, parked_cars

CARS = len(parked_cars.parked_car_levels())
ROOF = VARIANTS
FURNITURE = ROOF + len(rooftops.KINDS) + 2  # after traffic lights and street lamps
PLANTS = FURNITURE + len(furniture.KINDS)
PARKED = PLANTS + len(plants.KINDS)


@pytest.fixture(scope="module")
def scene():
    return build_scene("citystreet", shipped_network("citystreet"), 0)


@pytest.fixture(scope="module")
def plan(scene):
    return make_plan(scene.network, 0)


def some(scene, first, count):
    """Which fixtures are of prototypes `first` to `first + count`."""
    return np.flatnonzero((scene.fixtures.prototype >= first)
                          & (scene.fixtures.prototype < first + count))  # fmt: skip


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
    indices = some(scene, FURNITURE, len(furniture.KINDS))
    assert len(indices) > 200
    assert set(scene.fixtures.prototype[indices] - FURNITURE) == set(range(len(furniture.KINDS)))
    pose = scene.fixtures.pose[indices]
    assert shapely.contains_xy(plan.pavement, *pose[:, :2, 3].T.astype(float)).all()
    assert np.allclose(pose[:, 2, 3], KERB_HEIGHT)
    kinds = scene.object_class[scene.fixtures.object_id[indices]]
    assert (kinds == ObjectClass.STRUCTURE).all()
    shapes = outlines(scene, indices)
    assert not shapely.intersects(plan.roads, shapes).any()
    assert not shapely.intersects(plan.lots, shapes).any()


def test_furniture_faces_the_road(scene, plan):
    for index in some(scene, FURNITURE, 1):  # benches
        pose = scene.fixtures.pose[index].astype(float)
        there, behind = (shapely.Point(pose[:2, 3] + s * pose[:2, 1]) for s in (1.0, -1.0))
        assert plan.roads.distance(there) < plan.roads.distance(behind)


def test_plants_stand_on_lawn_clear_of_roads_and_walls(scene, plan):
    indices = some(scene, PLANTS, len(plants.KINDS) - 1)
    assert len(indices) > 300
    solid = shapely.union_all([shapely.Polygon(corners) for corners in plan.footprints])
    middle = scene.fixtures.pose[indices][:, :2, 3].astype(float)
    blocked = shapely.union_all([plan.roads, plan.access, plan.pavement, plan.lots, solid])
    assert not shapely.contains_xy(blocked, *middle.T).any()
    assert np.allclose(scene.fixtures.pose[indices][:, 2, 3], FLOOR_HEIGHT)
    assert not shapely.intersects(plan.roads, outlines(scene, indices)).any()


def test_parked_cars_stand_in_bays_and_are_part_of_the_scene(scene, plan):
    indices = some(scene, PARKED, CARS)
    assert len(indices) > 80
    bays = np.concatenate([park.bays for park in plan.car_parks])
    spots = scene.fixtures.pose[indices][:, :2, 3]
    apart = np.linalg.norm(spots[:, None] - bays[None, :, :2], axis=2)
    assert apart.min(axis=1).max() < 0.4
    assert len(set(apart.argmin(axis=1))) == len(indices)  # one car in a bay
    kinds = scene.object_class[scene.fixtures.object_id[indices]]
    assert (kinds == ObjectClass.STRUCTURE).all()
    lots = shapely.union_all([park.area for park in plan.car_parks])
    assert shapely.covers(lots, outlines(scene, indices)).all()


def test_roof_units_belong_to_their_building_and_stay_on_its_roof(scene):
    indices = some(scene, ROOF, len(rooftops.KINDS))
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
    "made",
    [
        furniture.furniture_levels,
        rooftops.rooftop_levels,
        parked_cars.parked_car_levels,
        lambda: plants.plant_levels(np.random.default_rng(0)),
    ],
)
def test_coarser_levels_have_fewer_triangles_and_the_same_size(made):
    for levels in made():
        counts = [len(mesh.triangles) for mesh in levels]
        assert counts == sorted(counts, reverse=True)
        assert counts[-1] <= 80
        sizes = [np.ptp(mesh.positions, axis=0) for mesh in levels]
        assert np.abs(sizes[-1] - sizes[0]).max() < 1.2


def test_car_bodies_face_outwards():
    for fine, coarse in parked_cars.parked_car_levels():
        for mesh in (fine, coarse):
            corners = mesh.positions[mesh.triangles].astype(float)
            face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            up = face[:, 2] / np.maximum(np.linalg.norm(face, axis=1), 1e-12)
            middle = corners.mean(axis=1)
            assert (up[(middle[:, 2] > 1.3)] > -0.2).all()
            assert (face[:, 2].sum() / 2) > 3.0  # what is seen from above, not from below
