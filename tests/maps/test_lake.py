"""The lake district against the original's figures, and as a scene that holds together."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.scene import ObjectClass
from eyas.engine.traffic.recording_file import load
from eyas.engine.world.weather import Season
from eyas.maps.lake import LAKE
from eyas.maps.lake.layout import MIXED, lay_out
from eyas.maps.lake.roads import lattice, road_graph
from eyas.maps.plants.forest import FROSTED, SPECIES, STAND, TREES, stand_levels
from eyas.maps.plants.gardens import BORDERS

SEEDS = range(4)


@pytest.fixture(scope="module")
def network():
    return LAKE.shipped_network()


@pytest.fixture(scope="module")
def plan(network):
    return lay_out(network, 0)


@pytest.fixture(scope="module")
def scene():
    return load_scene("lake", 0)


def places(graph):
    return {node.name: np.array([node.x, node.y]) for node in graph.nodes}


@pytest.mark.parametrize("seed", SEEDS)
def test_all_roads_are_two_way_and_none_is_a_dead_end(seed):
    graph = road_graph(seed)
    ends = {(edge.start, edge.end) for edge in graph.edges}
    assert len(ends) == len(graph.edges) == len({edge.name for edge in graph.edges})
    assert ends == {(end, start) for start, end in ends}
    degree = [sum(edge.start == name for edge in graph.edges) for name in places(graph)]
    assert min(degree) >= 2
    assert sum(count >= 3 for count in degree) > 50
    assert {edge.lanes for edge in graph.edges} == {1, 2}


def test_roads_have_the_originals_length_and_extent():
    graph = road_graph(0)
    at = places(graph)
    length = sum(np.linalg.norm(at[edge.end] - at[edge.start]) for edge in graph.edges) / 2
    assert length == pytest.approx(19_670, rel=0.12)
    assert np.ptp(list(at.values()), axis=0) == pytest.approx([1508, 1463], rel=0.03)
    narrow = sum(edge.lanes == 1 for edge in graph.edges) / len(graph.edges)
    assert narrow > 0.85


def test_seeds_differ():
    assert len({road_graph(seed).nodes for seed in SEEDS}) == len(SEEDS)


def test_ponds_lakes_forests_and_houses_are_as_many_as_in_the_original(plan):
    assert len(plan.ponds) == 25
    size = np.array([(b[2] - b[0], b[3] - b[1]) for b in (pond.bounds for pond in plan.ponds)])
    regular = np.isclose(size[:, 0], 35.0) & (150.0 <= size[:, 1]) & (size[:, 1] <= 180.0)
    assert regular.sum() == 21
    assert sum(pond.area for pond in plan.ponds) == pytest.approx(145_000, rel=0.12)
    lakes = sorted(lake.area / 1e6 for lake in plan.lakes)
    assert lakes == pytest.approx([0.20, 0.26, 0.31, 0.34, 1.86], rel=0.1)
    assert [strip.kind for strip in plan.strips] == [*range(len(SPECIES)), MIXED]
    assert [round(strip.area.area) for strip in plan.strips] == [40 * 190] * 7 + [80 * 180]
    west = [strip.area.bounds[0] for strip in plan.strips[:-1]]
    assert west == sorted(west)
    assert len(plan.houses) == 50
    assert len(plan.car_parks) == 1


def test_nothing_overlaps(plan):
    shapes = [*plan.ponds, *plan.lakes, *(strip.area for strip in plan.strips)]
    shapes += [shapely.Polygon(house.footprint) for house in plan.houses]
    shapes += [park.area.difference(plan.roads) for park in plan.car_parks]
    tree = shapely.STRtree(shapes)
    one, other = tree.query(shapes, predicate="intersects")
    assert (one == other).all()
    assert min(shapely.distance(shapes[: 25 + 5 + 8], plan.roads)) > 4.0
    # The original's trees begin 20 m from the axis of the streets along their strips.
    west = [strip.area.bounds[0] for strip in plan.strips[:-1]]
    beside = np.abs(lattice(0).x[:, None] - west).min(axis=0)
    assert beside == pytest.approx(20.0, abs=2.0)


def trees_of(scene):
    names = np.array(scene.fixtures.names)[scene.fixtures.prototype]
    kind = scene.object_class[scene.fixtures.object_id]
    return names[(kind == ObjectClass.TREE) & ~np.isin(names, BORDERS)]


def test_there_are_thirteen_and_a_half_thousand_trees(scene):
    names = trees_of(scene)
    assert TREES * len(names) == pytest.approx(13_500, rel=0.01)
    assert TREES / STAND**2 == 0.2
    kinds, count = np.unique([name.rsplit(" ", 1)[0] for name in names], return_counts=True)
    assert set(kinds) == {kind.name for kind in SPECIES} | {"mixed"}
    assert dict(zip(kinds, TREES * count, strict=True))["mixed"] == 2880


@pytest.mark.parametrize("kind", SPECIES, ids=lambda kind: kind.name)
def test_a_stand_keeps_its_size_and_gets_cheaper_from_level_to_level(kind):
    levels = stand_levels((kind,), np.random.default_rng(1), Season.SUMMER)
    counts = [len(mesh.triangles) for mesh in levels]
    assert 2500 <= counts[0] <= 4500
    assert all(fine > 2.0 * coarse for fine, coarse in pairwise(counts))
    assert counts[-1] == 32
    for mesh in levels:
        low, high = mesh.positions.min(axis=0), mesh.positions.max(axis=0)
        assert 2.0 <= high[2] <= 11.5
        assert np.abs([low[:2], high[:2]]).max() <= STAND / 2 + 3.5
        assert np.isfinite(mesh.normals).all()


def test_winter_frosts_the_leaves():
    summer, winter = (
        stand_levels(SPECIES[:1], np.random.default_rng(1), season)
        for season in (Season.SUMMER, Season.WINTER)
    )
    for one, other in zip(summer, winter, strict=True):
        assert (one.positions == other.positions).all()
    leafy = [look.tint for look in winter[0].palette if look.texture != "bark"]
    assert all(
        np.allclose(np.array(tint) / tint[2], np.array(FROSTED) / FROSTED[2]) for tint in leafy
    )


def test_trees_and_water_change_the_background_of_a_street(plan, network):
    """What makes the lake hard: along a street, the colour beside it changes every block."""
    changes = 0
    kinds = [(shapely.union_all(plan.ponds), "water")]
    kinds += [(strip.area, strip.kind) for strip in plan.strips]
    at = places(road_graph(0))
    for row in range(4):
        line = shapely.LineString([at[f"A{row + 1}"], at[f"L{row + 1}"]])
        seen = []
        for along in np.arange(0.0, line.length, 5.0):
            spot = line.interpolate(along).buffer(70.0)
            seen.append(tuple(kind for area, kind in kinds if area.intersects(spot)))
        changes += sum(a != b for a, b in pairwise(seen))
    assert changes > 25
    assert len(network.edges) == len(road_graph(0).edges)


def test_traffic_stays_on_the_asphalt(plan):
    recording = load(LAKE.shipped_traffic()[0])
    roads = plan.roads
    shapely.prepare(roads)
    assert shapely.contains_xy(roads, recording.position[::80].reshape(-1, 2)).all()
    assert recording.present.all()


def test_lamps_stand_free(scene, plan):
    assert len(scene.lamps.position) == 48
    pole = scene.object_class[scene.colliders.cylinder_object] == ObjectClass.POLE
    feet = shapely.points(scene.colliders.cylinder_centre[pole])
    for area in (plan.roads, *plan.ponds, *plan.lakes):
        assert shapely.distance(area, feet).min() > 1.0


def test_shores_are_uneven_within_their_basins_and_jetties_reach_the_water(plan, scene):
    wet = scene.object_class[scene.static_object] == ObjectClass.WATER
    corners = scene.static.positions[scene.static.triangles[wet]][..., :2]
    water = shapely.union_all(shapely.polygons(corners.astype(float)))
    basins = shapely.union_all([*plan.ponds, *plan.lakes])
    assert water.difference(shapely.buffer(basins, 0.01)).area < 1.0
    assert 0.85 < water.area / basins.area < 0.99
    names = np.array(scene.fixtures.names)[scene.fixtures.prototype]
    jetties = scene.fixtures.pose[names == "jetty"]
    assert 8 <= len(jetties) <= 25
    for pose in jetties:
        foot, end = (shapely.Point(pose[:2, 3] + out * pose[:2, 0]) for out in (-1.9, 6.5))
        assert water.contains(end)
        assert not water.contains(foot)
    reeds = scene.fixtures.pose[np.char.startswith(names, "reeds")][:, :2, 3]
    assert len(reeds) > 1000
    assert shapely.distance(shapely.points(reeds), plan.roads).min() > 3.0
