"""The desert against the original's figures, and as a scene that holds together."""

from itertools import combinations

import numpy as np
import pytest
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.sensors.obstacles import solids_of
from eyas.engine.sim.scenes import load_network, load_scene
from eyas.engine.state.mesh import Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.state.terrain import reliefs
from eyas.engine.traffic.recording_file import load
from eyas.engine.world.maps.recipe import TRAFFIC_FILE
from eyas.engine.world.roads.areas import joints, road_area, streets
from eyas.engine.world.weather import RAIN, Season
from eyas.maps.desert import DESERT
from eyas.maps.desert.layout import _drifts, lay_out
from eyas.maps.desert.plan import DRIFT_HEIGHT
from eyas.maps.land.mounds import highest
from eyas.maps.plan.build import build_scene
from eyas.maps.roads.painting import PAINT_HEIGHT

from .hills import in_the_way, recorded_off_road, relief_on_lanes, surface_heights

pytestmark = pytest.mark.slow  # what its tests share takes long to make

SEEDS = range(6)


@pytest.fixture(scope="module")
def roads():
    return DESERT.shipped_network()


@pytest.fixture(scope="module")
def desert():
    return load_scene("desert", 0)


@pytest.fixture(scope="module")
def winter(roads):
    return build_scene(DESERT.plan(roads, 0), roads, Season.WINTER)


@pytest.fixture(scope="module")
def plan(roads):
    return lay_out(roads, 0)


def lines_of(graph):
    at = {node.name: (node.x, node.y) for node in graph.nodes}
    return [shapely.LineString([at[e.start], *e.shape, at[e.end]]) for e in graph.edges]


@pytest.mark.parametrize("seed", SEEDS)
def test_roads_have_the_originals_figures(seed):
    graph = DESERT.roads(seed)
    lines = lines_of(graph)
    length = sum(line.length for line in lines) / 2
    assert length == pytest.approx(3370, rel=0.06 if seed == 0 else 0.12)
    assert {(e.lanes, e.lane_width, e.speed) for e in graph.edges} == {(2, 4.0, 13.89)}
    ends = {(edge.start, edge.end) for edge in graph.edges}
    assert ends == {(end, start) for start, end in ends}


def test_seeds_differ_and_repeat():
    graphs = [DESERT.roads(seed) for seed in SEEDS]
    assert len({graph.edges for graph in graphs}) == len(graphs)
    assert graphs[3] == DESERT.roads(3)


def test_a_rounded_square_with_an_x_makes_four_blocks(plan, roads):
    assert len(plan.blocks) == 4
    assert sorted(joints(roads).values()) == [3, 3, 3, 3, 4]
    area = road_area(roads)
    west, south, east, north = area.bounds
    assert (east - west, north - south) == pytest.approx((559, 642), rel=0.01)
    assert area.area / ((east - west) * (north - south)) == pytest.approx(0.157, abs=0.006)
    corner = shapely.Point(west, south)  # a corner of radius r lies 0.41 r from a sharp one
    assert area.distance(corner) == pytest.approx(0.414 * 58.0, rel=0.15)


def test_roads_are_curved():
    """The original's have 15 bends of more than 5 degrees on a kilometre."""
    bends = length = 0.0
    for line in lines_of(DESERT.roads(0)):
        ahead = np.diff(shapely.get_coordinates(line), axis=0)
        heading = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
        bends += np.abs(np.diff(heading)).sum()
        length += line.length
    assert np.degrees(bends) / (length / 1000) > 15 * 5


def test_dunes_are_of_the_originals_size(plan):
    inside, ring = plan.dunes[:-24], plan.dunes[-24:]
    assert 24 <= len(inside) <= 26
    assert np.median([dune.height for dune in inside]) == pytest.approx(39, rel=0.15)
    assert np.median([dune.radius for dune in inside]) == pytest.approx(84, rel=0.2)
    peaks, radii = ([getattr(d, name) for d in ring] for name in ("height", "radius"))
    assert np.percentile(peaks, [0, 50, 100]) == pytest.approx([44, 81, 130], rel=0.2)
    assert np.percentile(radii, [0, 50, 100]) == pytest.approx([111, 153, 192], rel=0.1)


def test_dunes_are_steep_to_leeward(plan):
    """The sand falls from the summit twice as fast on one side as on the other."""
    for dune in plan.dunes:
        lean = np.array(dune.lean)
        way = lean / np.linalg.norm(lean)
        top = np.array([dune.x, dune.y]) + dune.radius * lean
        reach = 0.4 * dune.radius
        points = np.stack([top, top + reach * way, top - reach * way])
        summit, lee, windward = dune.heights(points)
        assert summit == pytest.approx(dune.height, rel=0.01)
        assert summit - lee > 1.5 * (summit - windward)


def test_dunes_come_close_to_the_road_and_cover_much_of_the_floor(desert, plan):
    area = road_area(DESERT.shipped_network())
    gaps = [area.distance(shapely.Point(d.x, d.y)) - d.radius for d in plan.dunes[:-24]]
    assert np.median(gaps) < 12.0
    x, y = np.meshgrid(np.linspace(-320, 320, 200), np.linspace(-320, 320, 200))
    heights = reliefs(desert.terrain, np.stack([x, y], axis=-1))
    assert (heights > 0.1).mean() == pytest.approx(0.53, abs=0.1)  # the original's: 0.62


def test_no_dune_lies_on_a_road(desert, roads):
    assert relief_on_lanes(desert, roads).max() == 0.0


def test_the_raster_is_the_ground_that_is_drawn(desert, plan):
    rng = np.random.default_rng(1)
    points = rng.uniform(-600, 600, (4000, 2))
    tops = [drift.fringe for drift in plan.drifts]
    free = shapely.union_all([plan.roads, plan.walls, *tops])
    points = points[~shapely.contains_xy(shapely.buffer(free, 8.0), points)]
    apart = surface_heights(desert, points) - reliefs(desert.terrain, points) + 0.1
    assert np.abs(apart).max() < 2.0
    assert np.abs(apart).mean() < 0.1


def test_as_much_stands_in_it_as_in_the_original(desert, plan):
    count = {kind: int((desert.object_class == kind).sum()) for kind in ObjectClass}
    assert count[ObjectClass.BUILDING] == len(plan.houses) == 7
    assert count[ObjectClass.TREE] == count[ObjectClass.WATER] == 0
    assert len(plan.drifts) == 11
    assert len(desert.lamps.position) == 38
    assert count[ObjectClass.POLE] == 38 + 16


def test_drifts_hide_the_road_and_its_paint(desert, plan, roads):
    """Eleven bars of about 15 x 32 m from kerb to kerb; what drives on them stays in sight."""
    area = road_area(roads)
    assert all(d.area.area == pytest.approx(15 * 32, rel=0.3) for d in plan.drifts)
    rng, tops = np.random.default_rng(0), []
    for drift in plan.drifts:
        top = shapely.buffer(shapely.intersection(drift.area, area), -0.5)
        west, south, east, north = top.bounds
        points = rng.uniform((west, south), (east, north), (60, 2))
        tops.append(points[shapely.contains_xy(top, points)])
    heights = surface_heights(desert, np.concatenate(tops))
    assert np.allclose(heights, DRIFT_HEIGHT, atol=1e-4)
    assert PAINT_HEIGHT < DRIFT_HEIGHT < 0.05
    cut = shapely.difference(area, shapely.union_all([drift.area for drift in plan.drifts]))
    assert len(shapely.get_parts(cut)) >= 8  # most drifts leave no asphalt at either kerb


def test_a_followed_car_is_often_on_sand(plan):
    recording = load(DESERT.shipped(TRAFFIC_FILE))
    places = recording.position[::7][recording.present[::7]]
    sand = shapely.union_all([drift.area for drift in plan.drifts])
    shapely.prepare(sand)
    assert 0.02 < shapely.contains_xy(sand, places[:, 0], places[:, 1]).mean() < 0.15


def test_no_car_drives_through_anything(desert, roads):
    assert in_the_way(desert, roads) == ([], [])


def test_recorded_cars_stay_on_the_roads(roads):
    assert recorded_off_road(DESERT, roads) < 1e-3


def corners_of(scene):
    """All corners of triangles, in an order that does not depend on their materials."""
    corners = scene.static.positions[scene.static.triangles.ravel()]
    return corners[np.lexsort(corners.T)]


def test_building_again_gives_the_same_bytes(desert, winter):
    """Winter is a scene of its own, with the same things at the same places."""
    assert corners_of(desert).tobytes() == corners_of(winter).tobytes()
    assert winter.fixtures.pose.tobytes() == desert.fixtures.pose.tobytes()
    assert winter.terrain.relief.tobytes() == desert.terrain.relief.tobytes()
    assert winter.colliders.prism_points.tobytes() == desert.colliders.prism_points.tobytes()


def snowed(scene):
    """Triangles with snow, and u at their corners."""
    looks = np.array([look.surface == Surface.DESERT_SNOW for look in scene.static.palette])
    white = looks[scene.static.materials]
    return white, scene.static.uvs[scene.static.triangles[white], 0]


def test_in_winter_about_every_second_dune_is_white_and_nothing_else(desert, winter, plan):
    assert not snowed(desert)[0].any()
    white, over = snowed(winter)
    dunes = winter.static_object == winter.static_object[white][0]
    assert not (white & ~dunes).any()
    middle = winter.static.positions[winter.static.triangles[white]].mean(axis=1)
    covered = over.mean(axis=1) > 32.0  # above the line where snow begins
    assert middle[covered, 2].min() > 0.5
    assert 0.22 < covered.sum() / dunes.sum() < 0.5
    _, owners = highest(plan.dunes, middle[covered, :2].astype(float))
    assert 20 <= (np.bincount(owners) > 0.01 * len(owners)).sum() <= 22
    assert np.sort(np.bincount(owners))[:-22].sum() < 0.01 * len(owners)  # at their edges
    assert DESERT.light("snow").snow == 0.0


def test_snow_begins_at_a_line_that_no_triangle_shows(winter):
    """u goes on over the edges of triangles, and stays within one repeat of a texture."""
    white, over = snowed(winter)
    assert (over > 0.0).all()
    assert (over < 64.0).all()
    crossing = (over.min(axis=1) < 32.0) & (over.max(axis=1) > 32.0)
    assert crossing.sum() > 300
    points = winter.static.positions[winter.static.triangles[white]].reshape(-1, 3)
    _, same = np.unique(points, axis=0, return_inverse=True)
    least, most = np.full(same.max() + 1, np.inf), np.full(same.max() + 1, -np.inf)
    np.minimum.at(least, same, over.ravel())
    np.maximum.at(most, same, over.ravel())
    assert np.abs(most - least).max() == 0.0


def test_stones_and_plants_are_low_and_off_the_road(desert, plan):
    names = np.array(desert.fixtures.names)[desert.fixtures.prototype]
    wild = np.char.startswith(names, ("dry",)) | np.char.startswith(names, ("stones",))
    wild |= np.char.startswith(names, ("boulder",))
    assert 1500 < wild.sum() < 4000
    places = shapely.points(desert.fixtures.pose[wild][:, :2, 3])
    assert shapely.distance(places, plan.roads).min() > 2.0
    for kind in np.unique(desert.fixtures.prototype[wild]):
        finest, *_, last = desert.fixtures.levels[kind]
        scale = np.linalg.norm(
            desert.fixtures.pose[desert.fixtures.prototype == kind][:, 0, :3], axis=1
        )
        assert scale.max() * finest.positions[:, 2].max() < 1.4
        assert len(last.triangles) < len(finest.triangles)


def test_scenes_are_small_enough_for_small_machines(desert):
    assert len(desert.static.triangles) < 65_000
    assert np.isfinite(desert.static.positions).all()
    assert np.allclose(np.linalg.norm(desert.static.normals, axis=1), 1.0, atol=1e-3)


def test_another_seed_is_another_desert_of_the_same_kind():
    network = load_network("desert", 3)
    other = lay_out(network, 3)
    assert (len(other.drifts), len(other.houses)) == (11, 7)
    assert len(other.dunes) >= 46


def test_stones_and_plants_are_ground_for_lidar_and_bodies(desert):
    wild = desert.fixtures.object_id[desert.object_class[desert.fixtures.object_id] == 0]
    assert len(wild) > 1500
    assert not set(solids_of(desert).thing.tolist()) & set(wild.tolist())


def test_drifts_keep_away_from_each_other(roads):
    ways = [way for way in streets(roads) if way.start < way.end]
    for seed in range(4):
        middles = [drift.area.centroid for drift in _drifts(ways, stream(seed, "desert drifts"))]
        assert min(one.distance(other) for one, other in combinations(middles, 2)) > 80.0


def test_a_closed_sky_over_the_desert_is_warmer_than_elsewhere():
    plain, here = RAIN.day, DESERT.light("rain")
    for part in ("zenith_colour", "ambient_up", "fog_colour"):
        red, _, blue = getattr(plain, part)
        warm, _, cold = getattr(here, part)
        assert warm > red
        assert cold < blue
