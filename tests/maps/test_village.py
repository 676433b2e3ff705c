"""The village against the original's figures, and as a scene that holds together."""

import numpy as np
import pytest
import shapely

from eyas.engine.sim.scenes import load_network, load_scene
from eyas.engine.state.mesh import Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.state.terrain import reliefs
from eyas.engine.traffic.recording_file import load
from eyas.engine.world.maps.recipe import TRAFFIC_FILE
from eyas.engine.world.roads.areas import road_area
from eyas.maps.street.clutter import CLUTTER
from eyas.maps.village import VILLAGE
from eyas.maps.village.layout import lay_out

from .hills import in_the_way, recorded_off_road, relief_on_lanes, surface_heights

SEEDS = range(6)
INSIDE = 15


@pytest.fixture(scope="module")
def roads():
    return VILLAGE.shipped_network()


@pytest.fixture(scope="module")
def village():
    return load_scene("village", 0)


@pytest.fixture(scope="module")
def plan(roads):
    return lay_out(roads, 0)


@pytest.mark.parametrize("seed", SEEDS)
def test_roads_have_the_originals_figures(seed):
    graph = VILLAGE.roads(seed)
    at = {node.name: np.array([node.x, node.y]) for node in graph.nodes}
    length = sum(np.linalg.norm(at[e.start] - at[e.end]) for e in graph.edges) / 2
    assert length == pytest.approx(3590, rel=0.03 if seed == 0 else 0.1)
    size = np.ptp(list(at.values()), axis=0) + 12.0
    assert np.all(np.abs(size / [605, 637] - 1) < (0.03 if seed == 0 else 0.12))
    neighbours = [sum(edge.start == name for edge in graph.edges) for name in at]
    assert neighbours.count(3) == 8
    assert neighbours.count(2) == len(neighbours) - 8
    assert {(e.lanes, e.lane_width, e.speed) for e in graph.edges} == {(2, 3.0, 13.89)}
    ends = {(edge.start, edge.end) for edge in graph.edges}
    assert ends == {(end, start) for start, end in ends}


def test_seeds_differ_and_repeat():
    graphs = [VILLAGE.roads(seed) for seed in SEEDS]
    assert len({graph.nodes for graph in graphs}) == len(graphs)
    assert graphs[3] == VILLAGE.roads(3)


def test_roads_cut_the_valley_into_five_blocks(plan, roads):
    assert len(plan.blocks) == 5
    area = road_area(roads)
    west, south, east, north = area.bounds
    assert area.area / ((east - west) * (north - south)) == pytest.approx(0.115, abs=0.006)


def test_hills_are_of_the_originals_size(plan):
    inside, ring = plan.hills[:-33], plan.hills[-33:]
    assert INSIDE - 1 <= len(inside) <= INSIDE
    assert np.median([hill.height for hill in inside]) == pytest.approx(56, rel=0.15)
    assert np.median([hill.radius for hill in inside]) == pytest.approx(83, rel=0.25)
    peaks, radii = ([getattr(h, name) for h in ring] for name in ("height", "radius"))
    assert np.percentile(peaks, [0, 50, 100]) == pytest.approx([73, 112, 157], rel=0.1)
    assert np.percentile(radii, [0, 50, 100]) == pytest.approx([87, 144, 201], rel=0.1)


def test_a_closed_ring_of_hills_ends_every_view(village):
    """From the middle, the land rises by 4 degrees or more in nearly all directions."""
    angle = np.radians(np.arange(0.0, 360.0, 2.0))
    away = np.arange(250.0, 700.0, 6.0)[:, None]
    points = np.stack([away * np.cos(angle), away * np.sin(angle)], axis=-1)
    rise = np.degrees(np.arctan2(reliefs(village.terrain, points) - 22.0, away))
    assert np.percentile(rise.max(axis=0), 3) > 4.0
    assert rise.max(axis=0).min() > 1.0


def test_hills_cover_the_originals_share_of_the_floor(village):
    x, y = np.meshgrid(np.linspace(-491, 491, 200), np.linspace(-499, 499, 200))
    heights = reliefs(village.terrain, np.stack([x, y], axis=-1))
    assert (heights > 0.3).mean() == pytest.approx(0.70, abs=0.06)


def test_no_hill_lies_on_a_road(village, roads):
    assert relief_on_lanes(village, roads).max() == 0.0


def test_the_raster_is_the_ground_that_is_drawn(village, plan):
    rng = np.random.default_rng(1)
    points = rng.uniform(-600, 600, (4000, 2))
    free = shapely.union_all([plan.roads, plan.walls, plan.lake, plan.covered])
    points = points[~shapely.contains_xy(shapely.buffer(free, 6.0), points)]
    apart = surface_heights(village, points) - reliefs(village.terrain, points) + 0.1
    assert np.abs(apart).max() < 4.0  # facets have edges between the points of the raster
    assert np.abs(apart).mean() < 0.15


def test_as_much_stands_in_it_as_in_the_original(village, plan):
    count = {kind: int((village.object_class == kind).sum()) for kind in ObjectClass}
    assert count[ObjectClass.BUILDING] == len(plan.cottages) == 24
    small = [village.fixtures.names[k] in CLUTTER for k in village.fixtures.prototype.tolist()]
    assert 200 < sum(small) < 600
    kinds = village.object_class[village.fixtures.object_id]
    plain = int((small & (kinds == ObjectClass.STRUCTURE)).sum())  # bicycles have their own class
    assert count[ObjectClass.STRUCTURE] - plain == len(plan.tunnels) == 10
    assert count[ObjectClass.WATER] == 1
    assert len(plan.trees) == 41
    assert len(plan.gantries) == 7
    assert len(village.lamps.position) == 47
    assert plan.lake.area == pytest.approx(41_979, rel=0.02)
    signals = count[ObjectClass.POLE] - 7 - (47 - 20)  # 20 lamps hang in tunnels
    assert 20 <= signals <= 24


def test_trees_stand_in_rows_beside_the_road(plan, roads):
    area = road_area(roads)
    beside = [area.distance(shapely.Point(trunk)) for trunk in plan.trees]
    assert 4.4 < min(beside) <= max(beside) < 5.1  # less at bends
    apart = np.linalg.norm(plan.trees[:, None] - plan.trees[None], axis=2)
    assert 11.0 <= np.median((apart + 1e9 * np.eye(len(apart))).min(axis=1)) <= 16.0


def test_houses_stand_in_clusters_and_off_the_roads(plan, roads):
    area = road_area(roads)
    shapes = [shapely.Polygon(house.outline) for house in plan.cottages]
    gaps = [shapely.distance(shape, area) for shape in shapes]
    assert min(gaps) >= 3.9
    assert 3.9 <= np.median(gaps) <= 8.0
    merged = shapely.get_parts(shapely.union_all(shapely.buffer(shapes, 24.0)))
    sizes = sorted(sum(part.contains(shape) for shape in shapes) for part in merged)
    assert 3 <= sizes[0]
    assert sizes[-1] <= 8
    apart = [shapely.distance(a, b) for i, a in enumerate(shapes) for b in shapes[:i]]
    assert min(apart) > 5.0
    assert not any(shapely.intersects(shape, plan.lake) for shape in shapes)


def test_no_car_drives_through_anything(village, roads):
    assert in_the_way(village, roads) == ([], [])


def test_recorded_cars_stay_on_the_roads(roads):
    assert recorded_off_road(VILLAGE, roads) < 1e-3


@pytest.mark.slow
def test_tunnels_hide_a_target_for_seconds(plan, village):
    """Seen from right above, a car disappears below each tunnel for about 40 m."""
    for tunnel in plan.tunnels:
        at = np.arange(-22.0, 22.0, 1.0)  # another tunnel may begin behind it
        middle = tunnel.placed(np.column_stack([at, np.full(len(at), -3.0)]))
        hidden = surface_heights(village, middle) > 5.0
        assert 36 <= hidden.sum() <= 42
        assert hidden[4:-4].all()


def test_a_followed_car_is_hidden_in_several_percent_of_the_time(plan):
    """Of the time in which cars of the recording drive, as an exact follower would see them."""
    recording = load(VILLAGE.shipped(TRAFFIC_FILE))
    places = recording.position[::7][recording.present[::7]]
    covered = plan.covered
    shapely.prepare(covered)
    share = shapely.contains_xy(covered, places[:, 0], places[:, 1]).mean()
    assert 0.04 < share < 0.25


def test_scenes_are_small_enough_for_small_machines(village):
    assert len(village.static.triangles) < 65_000
    assert np.isfinite(village.static.positions).all()
    assert np.allclose(np.linalg.norm(village.static.normals, axis=1), 1.0, atol=1e-3)


def test_another_seed_is_another_village_of_the_same_kind():
    network = load_network("village", 3)
    other = lay_out(network, 3)
    assert len(other.tunnels) == 10
    assert len(other.cottages) == 24
    assert len(other.trees) == 41
    assert other.lake.area > 25_000


def test_paths_and_what_grows_beside_them_are_off_the_roads_and_low(village, plan):
    looks = np.array([look.surface for look in village.static.palette])[village.static.materials]
    path = village.static.triangles[looks == Surface.HILLSIDE_PATH]
    corners = village.static.positions[path]
    made = shapely.union_all(shapely.polygons(corners[..., :2].astype(float)))
    assert 800 < made.area < 8000
    assert made.intersection(plan.roads).area < 0.1
    # u is the distance from the edge.
    inside = village.static.uvs[path, 0]
    assert inside.min() == 0.0
    assert 0.3 < inside.max() < 0.6
    names = np.array(village.fixtures.names)[village.fixtures.prototype]
    for start, highest in (("green tuft", 0.8), ("stones", 0.6), ("boulder", 1.3)):
        some = np.char.startswith(names, start)
        assert some.sum() > 100
        places = shapely.points(village.fixtures.pose[some][:, :2, 3])
        assert shapely.distance(places, plan.roads).min() > 1.5
        levels = [village.fixtures.levels[k] for k in np.unique(village.fixtures.prototype[some])]
        assert max(mesh[0].positions[:, 2].max() for mesh in levels) < highest
