"""The street city against the original's figures, and as a scene that holds together."""

import math

import numpy as np
import pytest
import shapely

from eyas.engine.render.pack.triangles import gradients
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.roads.areas import road_area
from eyas.maps.citystreet import CITYSTREET
from eyas.maps.roads.painting import MARGIN_HEIGHT
from eyas.maps.roads.wear import WEAR_HEIGHTS

SEEDS = range(6)


def positions(graph):
    return {node.name: np.array([node.x, node.y]) for node in graph.nodes}


def road_length(graph):
    at = positions(graph)
    return sum(np.linalg.norm(at[e.start] - at[e.end]) for e in graph.edges) / 2


@pytest.mark.parametrize("seed", SEEDS)
def test_roads_have_the_originals_figures(seed):
    graph = CITYSTREET.roads(seed)
    at = positions(graph)
    assert len(graph.nodes) == 24
    assert len(graph.edges) == 64
    assert road_length(graph) == pytest.approx(4010, rel=0.02 if seed == 0 else 0.15)
    size = np.ptp(list(at.values()), axis=0) + 14.0
    assert np.all(np.abs(size / [671, 730] - 1) < (0.07 if seed == 0 else 0.3))
    assert np.abs(list(at.values())).max() < 420
    neighbours = [sum(edge.start == name for edge in graph.edges) for name in at]
    assert sorted(neighbours) == [2] * 14 + [3] * 4 + [4] * 6
    assert {(edge.lanes, edge.lane_width, edge.speed) for edge in graph.edges} == {(2, 3.5, 13.89)}


@pytest.mark.parametrize("seed", SEEDS)
def test_every_road_is_two_way(seed):
    ends = {(edge.start, edge.end) for edge in CITYSTREET.roads(seed).edges}
    assert ends == {(end, start) for start, end in ends}


def test_streets_run_at_forty_degrees():
    graph = CITYSTREET.roads(0)
    at = positions(graph)
    straight = [e for e in graph.edges if len(e.start) == len(e.end) == 2]
    bearing = [math.atan2(*(at[e.end] - at[e.start])[::-1]) for e in straight]
    assert np.allclose(np.degrees(bearing) % 90, 40.0, atol=0.01)


def test_seeds_differ_and_repeat():
    graphs = [CITYSTREET.roads(seed) for seed in SEEDS]
    assert len({graph.nodes for graph in graphs}) == len(graphs)
    assert graphs[3] == CITYSTREET.roads(3)


def test_the_shipped_roads_are_those_of_the_graph(network):
    graph = CITYSTREET.roads(0)
    assert network.edges == tuple(edge.name for edge in graph.edges)
    assert network.junctions == tuple(node.name for node in graph.nodes)
    first = network.junction_first
    for name, place in positions(graph).items():
        index = network.junctions.index(name)
        corners = network.junction_points[first[index] : first[index + 1]]
        assert shapely.Polygon(corners).buffer(0.5).contains(shapely.Point(place))


def test_where_the_original_parks_its_car_is_no_road(network):
    assert road_area(network).distance(shapely.Point(0, 10)) > 5.0


def test_roads_cover_the_originals_share_of_their_box(network):
    area = road_area(network)
    west, south, east, north = area.bounds
    assert area.area / ((east - west) * (north - south)) == pytest.approx(0.119, abs=0.015)


def count(scene, kind):
    return int((scene.object_class == kind).sum())


def test_as_much_stands_in_it_as_in_the_original(scene):
    assert 78 <= count(scene, ObjectClass.BUILDING) <= 83
    assert len(trunks_of(scene)) == 63
    assert count(scene, ObjectClass.POLE) == 36 + 48  # traffic lights and street lamps
    assert count(scene, ObjectClass.WATER) == 1
    made = np.unique(scene.static_object)  # pillars and the elevated road, no street furniture
    assert 17 <= (scene.object_class[made] == ObjectClass.STRUCTURE).sum() - 1 <= 18
    assert scene.size == (900.0, 900.0)
    assert scene.terrain.floor == -0.1
    assert scene.terrain.relief.size == 0


def trunks_of(scene):
    """Poses of the street trees; those in gardens are far smaller."""
    kind = scene.object_class[scene.fixtures.object_id]
    pose = scene.fixtures.pose[kind == ObjectClass.TREE]
    return pose[np.linalg.norm(pose[:, 0, :2], axis=1) > 12.0]


def test_buildings_are_as_high_and_as_far_from_the_kerb_as_the_originals(scene, network):
    solids = scene.colliders
    building = scene.object_class[solids.prism_object] == ObjectClass.BUILDING
    quartiles = np.percentile(solids.prism_top[building], [25, 50, 75])
    assert quartiles == pytest.approx([12, 30, 57], rel=0.2)
    on_ground = np.flatnonzero(building & (solids.prism_bottom < 0.0))
    roads = road_area(network)
    outlines = [outline(solids, index) for index in on_ground]
    gaps = [shapely.distance(shape, roads) for shape in outlines]
    assert min(gaps) > 4.0
    assert 4.4 < np.median(gaps) < 7.7
    assert sum(shape.area for shape in outlines) == pytest.approx(94_000, rel=0.15)


@pytest.mark.slow
def test_trees_stand_in_rows_beside_roads(scene, network):
    trunks = trunks_of(scene)[:, :2, 3].astype(np.float64)
    apart = np.linalg.norm(trunks[:, None] - trunks[None], axis=2) + 1e9 * np.eye(len(trunks))
    assert apart.min() > 12.0
    assert 14.5 <= np.median(apart.min(axis=1)) <= 19.5
    beside = [road_area(network).distance(shapely.Point(trunk)) for trunk in trunks]
    assert np.allclose(beside, 4.4, atol=0.3)
    height = trunks_of(scene)[:, 2, 2]
    assert 13.5 < height.min()
    assert height.max() <= 27.0
    assert np.median(height) == pytest.approx(19.8, rel=0.1)


def test_nothing_solid_is_in_the_way_of_cars(scene, network):
    """Up to the height of a truck there is nothing on any road."""
    roads = road_area(network)
    solids = scene.colliders
    for index in np.flatnonzero(solids.prism_bottom < 5.0):
        assert not outline(solids, index).intersects(roads)
    for centre, radius in zip(solids.cylinder_centre, solids.cylinder_radius, strict=True):
        assert roads.distance(shapely.Point(centre)) > radius


def test_the_elevated_road_runs_high_above_streets_and_through_no_building(scene, network):
    solids = scene.colliders
    kind = scene.object_class[solids.prism_object]
    structure = np.flatnonzero(kind == ObjectClass.STRUCTURE)
    deck = [i for i in structure if solids.prism_top[i] > 3.0 or outline(solids, i).area > 60]
    roads = road_area(network)
    assert max(solids.prism_top[deck]) == pytest.approx(55.5)
    above = [solids.prism_bottom[i] for i in deck if outline(solids, i).intersects(roads)]
    assert len(above) > 10
    assert min(above) > 24.0  # a drone starts at 22 m or lower
    ribbon = shapely.union_all([outline(solids, i) for i in deck])
    for index in np.flatnonzero(kind == ObjectClass.BUILDING):
        assert not outline(solids, index).intersects(ribbon)


def outline(solids, index):
    first = solids.prism_first
    return shapely.Polygon(solids.prism_points[first[index] : first[index + 1]])


def test_flat_surfaces_cover_the_floor_once(scene):
    """Seen from above, lawn, asphalt, pavement, car parks and water leave no gap and no overlap."""
    mesh, kinds = scene.static, scene.object_class[scene.static_object]
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    flat = np.isin(kinds, [ObjectClass.GROUND, ObjectClass.ROAD, ObjectClass.PAVEMENT,
                           ObjectClass.WATER])  # fmt: skip
    raised = np.unique(scene.static_object[corners[:, :, 2].max(axis=1) > 2.0])
    flat &= ~((kinds == ObjectClass.ROAD) & np.isin(scene.static_object, raised))  # the flyover
    up = mesh.normals[mesh.triangles[:, 0], 2] > 0.9
    # Tracks and the margins of lines lie on the asphalt.
    up &= ~np.isin(np.round(corners[:, 0, 2], 4), (*WEAR_HEIGHTS, MARGIN_HEIGHT))
    near = np.all(np.abs(corners[:, :, :2].mean(axis=1)) < 450, axis=1)
    edges = (corners[:, 1:, :2] - corners[:, :1, :2])[flat & up & near]
    area = (edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]) / 2
    assert np.all(area > -1e-3)
    assert area.sum() == pytest.approx(900 * 900, rel=2e-6)


def test_land_goes_on_to_the_horizon_without_being_solid(scene):
    mesh, kinds = scene.static, scene.object_class[scene.static_object]
    ground = mesh.positions[mesh.triangles[kinds == ObjectClass.GROUND]].astype(np.float64)
    far = ground[np.any(np.abs(ground[:, :, :2].mean(axis=1)) > 450, axis=1)]
    edges = far[:, 1:, :2] - far[:, :1, :2]
    area = (edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]) / 2
    assert np.all(area > 0.0)
    assert area.sum() == pytest.approx(20_000**2 - 900**2, rel=1e-5)
    assert len(far) < 1000
    assert np.abs(scene.colliders.prism_points).max() < 455


def test_every_triangle_has_an_object_and_is_finite(scene):
    mesh = scene.static
    assert len(scene.static_object) == len(mesh.triangles) == len(mesh.materials)
    assert scene.static_object.max() < len(scene.object_class)
    assert scene.static_object.min() == 0
    assert mesh.triangles.max() < len(mesh.positions)
    assert np.isfinite(mesh.positions).all()
    assert np.isfinite(mesh.uvs).all()
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-3)


def test_triangles_are_few_enough_for_small_machines(scene):
    assert len(scene.static.triangles) < 60_000


def test_every_static_triangle_can_be_shaded(scene):
    mesh = scene.static
    with np.errstate(all="raise"):
        table = gradients(
            *(each[mesh.triangles] for each in (mesh.positions, mesh.normals, mesh.uvs))
        )
    assert np.isfinite(table).all()


def test_parked_cars_are_solid(scene):
    fixtures, solids = scene.fixtures, scene.colliders
    kinds = [k for k, name in enumerate(fixtures.names) if name.startswith("parked car")]
    cars = fixtures.object_id[np.isin(fixtures.prototype, kinds)]
    assert len(cars) > 100
    assert np.isin(cars, solids.prism_object).all()
    assert (solids.prism_top[np.isin(solids.prism_object, cars)] > 1.2).all()
