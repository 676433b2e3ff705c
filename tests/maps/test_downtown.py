"""Downtown against the original's figures, and as a scene that holds together."""

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.scene import ObjectClass
from eyas.engine.traffic.demand import RoadLinks, lasting_edges
from eyas.engine.traffic.recording_file import load
from eyas.engine.world.maps.recipe import TRAFFIC_FILE
from eyas.engine.world.roads.areas import road_area
from eyas.maps.downtown import DOWNTOWN
from eyas.maps.downtown.layout import lay_out
from eyas.maps.downtown.scenery import scenery_of
from eyas.maps.roads.markings import road_paint
from eyas.maps.roads.painting import MARGIN_HEIGHT
from eyas.maps.roads.wear import WEAR_HEIGHTS

SEEDS = range(4)
HEIGHT = 22.0


@pytest.fixture(scope="session")
def streets():
    return DOWNTOWN.shipped_network()


@pytest.fixture(scope="session")
def city():
    """Of the cache, or built once for all tests."""
    return load_scene("downtown", 0)


@pytest.fixture(scope="session")
def asphalt(streets):
    roads = road_area(streets)
    shapely.prepare(roads)
    return roads


@pytest.fixture(scope="session")
def plan(streets):
    return lay_out(streets, 0)


@pytest.fixture(scope="session")
def scenery(plan, streets):
    return scenery_of(streets, plan, 0)


@pytest.fixture(scope="session")
def recording():
    return load(DOWNTOWN.shipped(TRAFFIC_FILE))


def positions(graph):
    return {node.name: np.array([node.x, node.y]) for node in graph.nodes}


def outlines(solids):
    first = solids.prism_first
    return np.array(
        [shapely.Polygon(solids.prism_points[low:high]) for low, high in pairwise(first)]
    )


def hidden(start, end, solids):
    """Whether a building lies between points, shapes (K, 3)."""
    shapes = outlines(solids)
    lines = shapely.linestrings(np.stack([start[:, :2], end[:, :2]], axis=1))
    line, prism = shapely.STRtree(shapes).query(lines, predicate="intersects")
    inside = shapely.intersection(lines[line], shapes[prism])
    found = np.zeros(len(start), np.bool_)
    for k, part in zip(line, range(len(line)), strict=True):
        points = shapely.get_coordinates(inside[part])
        whole = np.linalg.norm(end[k, :2] - start[k, :2])
        share = np.linalg.norm(points - start[k, :2], axis=1) / whole
        z = start[k, 2] + share * (end[k, 2] - start[k, 2])
        found[k] |= z.min() < solids.prism_top[prism[part]] and (
            z.max() > solids.prism_bottom[prism[part]]
        )
    return found


@pytest.mark.parametrize("seed", SEEDS)
def test_roads_have_the_originals_figures(seed):
    graph = DOWNTOWN.roads(seed)
    at = positions(graph)
    ends = {tuple(sorted((edge.start, edge.end))) for edge in graph.edges}
    length = sum(np.linalg.norm(at[a] - at[b]) for a, b in ends)
    assert length == pytest.approx(11_050, rel=0.03 if seed == 0 else 0.12)
    size = np.ptp(list(at.values()), axis=0) + 14.0
    assert np.all(np.abs(size / [1206, 765] - 1) < (0.03 if seed == 0 else 0.2))
    assert len(graph.edges) == pytest.approx(152, rel=0.05)
    assert {edge.lanes for edge in graph.edges} == {1, 2, 3, 4}


@pytest.mark.parametrize("seed", SEEDS)
def test_every_road_leads_on_to_every_other(seed):
    graph = DOWNTOWN.roads(seed)
    following = {
        edge.name: tuple(
            other.name
            for other in graph.edges
            if other.start == edge.end and other.end != edge.start
        )
        for edge in graph.edges
    }
    links = RoadLinks(following, dict.fromkeys(following, 1.0))
    assert len(lasting_edges(links)) == len(graph.edges)


def test_some_avenues_are_one_way_and_no_street_is():
    graph = DOWNTOWN.roads(0)
    ends = {(edge.start, edge.end) for edge in graph.edges}
    one_way = [edge for edge in graph.edges if (edge.end, edge.start) not in ends]
    assert len(one_way) >= 20
    assert {edge.start[0] == edge.end[0] for edge in one_way} == {True}
    assert {edge.lanes for edge in one_way} == {3, 4}


def test_streets_run_at_twenty_nine_degrees():
    graph = DOWNTOWN.roads(0)
    at = positions(graph)
    bearing = [math.atan2(*(at[e.end] - at[e.start])[::-1]) for e in graph.edges]
    assert np.allclose(np.degrees(bearing) % 90, 61.0, atol=0.01)


def test_seeds_differ_and_repeat():
    graphs = [DOWNTOWN.roads(seed) for seed in SEEDS]
    assert len({graph.nodes for graph in graphs}) == len(graphs)
    assert graphs[2] == DOWNTOWN.roads(2)


@pytest.mark.slow
def test_planning_again_gives_the_same_city(plan, scenery, streets, city):
    again = lay_out(streets, 0)
    again_scenery = scenery_of(streets, again, 0)
    for parts, others in zip(plan.buildings, again.buildings, strict=True):
        for part, other in zip(parts, others, strict=True):
            assert part.footprint.tobytes() == other.footprint.tobytes()
            assert (part.height, part.facade, part.tint) == (other.height, other.facade, other.tint)
    assert again_scenery.park.trees.tobytes() == scenery.park.trees.tobytes()
    assert again_scenery.kerbs.cars.tobytes() == scenery.kerbs.cars.tobytes()
    first = plan.buildings[0][0].footprint
    assert np.array_equal(city.colliders.prism_points[: len(first)], first)


def test_about_four_crossings_for_walkers_lie_at_each_crossing_of_roads(streets, asphalt):
    zebras, paved = road_paint(streets).zebras, asphalt.buffer(0.1)
    shapely.prepare(paved)
    assert len(zebras) == pytest.approx(184, rel=0.16)
    for zebra in zebras:
        assert all(paved.contains(bar.area) for bar in zebra)
        ends = np.array([bar.middle.mean(axis=0) for bar in zebra])
        width = np.linalg.norm(ends[-1] - ends[0])
        across = shapely.LineString([ends[0], ends[-1]])
        assert asphalt.contains(across)
        assert width < 13.5  # one road wide, also where it is one-way


def count(scene, kind):
    return int((scene.object_class == kind).sum())


def test_as_much_stands_in_it_as_in_the_original(city, scenery):
    assert count(city, ObjectClass.BUILDING) == pytest.approx(470, rel=0.05)
    plants = city.object_class[city.fixtures.object_id] == ObjectClass.TREE
    tall = city.fixtures.pose[plants, 2, 2] > 3.0  # others are shrubs
    assert tall.sum() == pytest.approx(243 + 32 + 59, rel=0.05)
    assert len(city.lamps.position) == pytest.approx(48, rel=0.1)
    assert count(city, ObjectClass.WATER) == 6
    assert max(part.area for part in shapely.get_parts(scenery.park.water)) == pytest.approx(
        15_325, rel=0.01
    )
    assert city.size == (2000.0, 1500.0)


def test_buildings_are_as_high_and_as_far_from_the_kerb_as_the_originals(plan, asphalt):
    top = np.array([parts[-1].bottom + parts[-1].height for parts in plan.buildings])
    assert np.percentile(top, [25, 50, 75]) == pytest.approx([19, 28, 58], rel=0.12)
    assert top.mean() == pytest.approx(50, rel=0.1)
    assert 400.0 < top.max() < 440.0
    shapes = [shapely.Polygon(corners) for corners in plan.footprints]
    assert sum(shape.area for shape in shapes) == pytest.approx(316_000, rel=0.15)
    gaps = shapely.distance(shapes, asphalt)
    assert gaps.min() > 4.0
    assert 5.0 < np.percentile(gaps, 25) < 7.5
    assert 5.5 < np.median(gaps) < 9.0


def test_towers_are_stacks_whose_parts_stand_on_each_other(plan):
    stacks = [parts for parts in plan.buildings if len(parts) > 1]
    assert len(stacks) > 100
    assert max(len(parts) for parts in stacks) >= 5
    for parts in stacks:
        for below, above in pairwise(parts):
            assert above.bottom == pytest.approx(below.bottom + below.height)
            base = shapely.Polygon(below.footprint).buffer(0.01)
            assert base.contains(shapely.Polygon(above.footprint))


def test_no_two_buildings_share_ground(plan):
    shapes = np.array([shapely.Polygon(corners) for corners in plan.footprints])
    one, other = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    pairs = one < other
    shared = shapely.area(shapely.intersection(shapes[one[pairs]], shapes[other[pairs]]))
    assert shared.max(initial=0.0) < 0.01


def test_lanes_are_free_of_everything_solid(city, streets, asphalt):
    solids = city.colliders
    low = solids.prism_bottom < 5.0
    tree = shapely.STRtree(outlines(solids)[low])
    trunks = shapely.buffer(shapely.points(solids.cylinder_centre), solids.cylinder_radius)
    poles = shapely.STRtree(trunks)
    assert shapely.distance(asphalt, shapely.points(solids.cylinder_centre)).min() > 0.3
    first = streets.lane_first
    for lane, (start, end) in enumerate(pairwise(first)):
        way = shapely.LineString(streets.lane_points[start:end])
        strip = way.buffer(streets.lane_width[lane] / 2 - 0.05, cap_style="flat")
        assert len(tree.query(strip, predicate="intersects")) == 0
        assert len(poles.query(strip, predicate="intersects")) == 0


def test_parked_cars_stand_beside_the_road(scenery, asphalt):
    assert len(scenery.kerbs.cars) > 150
    for x, y, _ in scenery.kerbs.cars:
        assert asphalt.distance(shapely.Point(x, y)) > 0.85


def test_traffic_keeps_to_the_roads(recording, asphalt):
    assert recording.actors >= 30
    seen = recording.position[::50].reshape(-1, 2)
    assert shapely.distance(asphalt, shapely.points(seen)).max() < 0.5


def test_most_of_the_streets_lie_in_shade(city, streets):
    places = streets.lane_points
    along = np.concatenate([places + s * (np.roll(places, -1, 0) - places) for s in (0.25, 0.6)])
    inside = along[shapely.contains_xy(road_area(streets), along)][::2]
    start = np.column_stack([inside, np.zeros(len(inside))])
    sun = np.array(DOWNTOWN.light("day").sun_direction)
    shaded = hidden(start, start + 600.0 * sun, city.colliders)
    assert len(inside) > 200
    assert 0.55 < shaded.mean() < 0.95


def test_corners_hide_cars_from_a_drone_that_looks_ahead(city, recording):
    """A tracker that keeps exactly behind, at a low pitch, loses its car at corners."""
    behind = HEIGHT / math.tan(0.6)
    here = recording.position[::100]
    yaw = recording.yaw[::100]
    back = behind * np.stack([np.cos(yaw), np.sin(yaw)], axis=-1)
    car = np.concatenate([here, np.full((*here.shape[:2], 1), 0.8)], axis=-1).reshape(-1, 3)
    drone = np.concatenate([here - back, np.full((*here.shape[:2], 1), HEIGHT)], axis=-1)
    lost = hidden(drone.reshape(-1, 3)[::3], car[::3], city.colliders)
    assert 0.02 < lost.mean() < 0.4


def test_slim_and_great_trees_hang_over_lanes(scenery, asphalt):
    kerbs = scenery.kerbs
    assert len(kerbs.great_trees) == pytest.approx(32, abs=3)
    assert len(kerbs.slim_trees) == pytest.approx(59, abs=4)
    great = shapely.distance(asphalt, shapely.points(kerbs.great_trees))
    slim = shapely.distance(asphalt, shapely.points(kerbs.slim_trees))
    assert np.all(great < 13.6 * 0.5 - 3.0)  # crowns are as wide as high
    assert np.all(slim < 11.5 * 0.28 - 0.8)


def test_flat_surfaces_cover_the_floor_once(city):
    """Seen from above, ground, asphalt, pavement and water leave no gap and no overlap."""
    mesh, kinds = city.static, city.object_class[city.static_object]
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    flat = np.isin(kinds, [ObjectClass.GROUND, ObjectClass.ROAD, ObjectClass.PAVEMENT,
                           ObjectClass.WATER])  # fmt: skip
    flat &= mesh.normals[mesh.triangles[:, 0], 2] > 0.9
    flat &= ~np.isin(np.round(corners[:, 0, 2], 4), (*WEAR_HEIGHTS, MARGIN_HEIGHT))
    middle = np.abs(corners[:, :, :2].mean(axis=1))
    flat &= (middle[:, 0] < 1000) & (middle[:, 1] < 750)
    edges = (corners[:, 1:, :2] - corners[:, :1, :2])[flat]
    area = (edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]) / 2
    assert np.all(area > -1e-3)
    assert area.sum() == pytest.approx(2000 * 1500, rel=2e-6)


def test_triangles_are_few_enough_for_small_machines(city):
    assert len(city.static.triangles) < 160_000
    assert len(city.fixtures.prototype) < 6_000
