"""The farmland against the original's figures, and as a scene that holds together."""

import numpy as np
import pytest
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.mesh import Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.roads.areas import road_area
from eyas.engine.world.weather import Season
from eyas.maps.farmland import FARMLAND
from eyas.maps.farmland.layout import CROPS, SIDE, VERGE, lay_out
from eyas.maps.farmland.roads import ROAD_WIDTH, road_graph

SEEDS = range(5)


@pytest.fixture(scope="module")
def network():
    return FARMLAND.shipped_network()


@pytest.fixture(scope="module")
def scene():
    return load_scene("farmland", 0)


@pytest.fixture(scope="module")
def winter():
    return load_scene("farmland", 0, Season.WINTER)


def fields_of(seed):
    nodes = road_graph(seed).nodes
    x, y = (sorted({getattr(node, axis) for node in nodes}) for axis in "xy")
    return lay_out(x, y, stream(seed, "farmland fields"))


@pytest.mark.parametrize("seed", SEEDS)
def test_sixteen_nodes_and_twenty_four_straight_links_along_the_axes(seed):
    graph = road_graph(seed)
    at = {node.name: np.array([node.x, node.y]) for node in graph.nodes}
    ends = {(edge.start, edge.end) for edge in graph.edges}
    assert (len(at), len(ends)) == (16, 48)
    assert ends == {(end, start) for start, end in ends}
    assert {(edge.lanes, edge.lane_width, edge.shape) for edge in graph.edges} == {(2, 4.0, ())}
    along = np.array([at[end] - at[start] for start, end in sorted(ends)])
    assert (np.abs(along).min(axis=1) == 0.0).all()
    between = np.abs(along).sum(axis=1) - ROAD_WIDTH
    assert 130.0 < between.min()
    assert between.max() < 275.0
    if seed == 0:  # the original: 137 to 242 m, 193 in the middle, 4.43 km
        assert between.min() == pytest.approx(137.0, abs=8.0)
        assert between.max() == pytest.approx(242.0, abs=8.0)
        assert np.median(between) == pytest.approx(193.0, abs=8.0)
        assert between.sum() / 2 == pytest.approx(4430.0, rel=0.03)


def test_seeds_differ():
    assert len({road_graph(seed).nodes for seed in SEEDS}) == len(SEEDS)


def test_roads_cover_the_originals_share_of_their_box(network):
    area = road_area(network)
    west, south, east, north = area.bounds
    assert area.area / ((east - west) * (north - south)) == pytest.approx(0.187, abs=0.025)


@pytest.mark.parametrize("seed", SEEDS)
def test_fields_are_squares_beside_the_roads_and_apart_from_each_other(seed):
    made = fields_of(seed)
    shapes = np.array([field.area for field in made])
    sides = np.array([(b[2] - b[0], b[3] - b[1]) for b in (shape.bounds for shape in shapes)])
    assert 60.0 < sides.min() <= sides.max() <= SIDE
    tree = shapely.STRtree(shapes)
    near = tree.query(shapes, predicate="dwithin", distance=VERGE - 0.01)
    assert (near[0] == near[1]).all()
    nodes = road_graph(seed).nodes
    for axis, low in (("x", sides[:, 0]), ("y", sides[:, 1])):
        assert len(low) == len(made)
        for road in {getattr(node, axis) for node in nodes}:
            bounds = shapely.bounds(shapes)[:, [0, 2] if axis == "x" else [1, 3]]
            gap = np.abs(bounds - road).min()
            assert gap == pytest.approx(ROAD_WIDTH / 2 + VERGE, abs=1e-6)


def test_as_many_fields_of_each_crop_as_in_the_original():
    made = fields_of(0)
    assert len(made) == pytest.approx(68, abs=6)
    assert sum(field.area.area for field in made) == pytest.approx(410_000, rel=0.1)
    count = np.bincount([field.crop for field in made], minlength=len(CROPS))
    expected = [crop.share * len(made) for crop in CROPS]
    assert np.abs(count - expected).max() <= 6


def test_neighbours_mostly_bear_different_crops():
    made = fields_of(0)
    tree = shapely.STRtree([field.area for field in made])
    one, other = tree.query([field.area for field in made], predicate="dwithin", distance=20.0)
    crop = np.array([field.crop for field in made])
    aside = one < other
    assert (crop[one[aside]] == crop[other[aside]]).mean() < 0.2


def test_lamps_stand_beside_the_roads_as_in_the_original(scene, network):
    feet = scene.colliders.cylinder_centre
    pole = scene.object_class[scene.colliders.cylinder_object] == ObjectClass.POLE
    feet = feet[pole]
    assert len(feet) == len(scene.lamps.position) == pytest.approx(47, abs=2)
    road = road_area(network)
    assert shapely.distance(shapely.points(feet), road) == pytest.approx(1.4, abs=0.05)
    apart = np.linalg.norm(feet[:, None] - feet, axis=2) + 1e9 * np.eye(len(feet))
    assert np.median(apart.min(axis=1)) == pytest.approx(67.0, abs=2.0)
    over = shapely.points(scene.lamps.position[:, :2].astype(float))
    assert shapely.contains(road, over).all()
    assert scene.lamps.axis[:, 2].max() < -0.7
    assert scene.lamps.intensity == 45.0


def test_nothing_can_hide_a_car(scene, network):
    """Over the roads there is nothing at all; beside them poles, and bales farther away."""
    road = road_area(network)
    high = scene.static.positions[scene.static.positions[:, 2] > 0.5]
    assert len(high) == 0
    solid = shapely.points(scene.colliders.cylinder_centre)
    assert shapely.distance(road, solid).min() > 1.2
    assert len(scene.colliders.prism_bottom) == 0
    assert (scene.object_class != ObjectClass.TREE).all()


def test_flat_surfaces_cover_the_floor_once(scene):
    """Seen from above, roads, fields and soil leave no gap and do not overlap."""
    mesh, kinds = scene.static, scene.object_class[scene.static_object]
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    up = mesh.normals[mesh.triangles[:, 0], 2] > 0.999  # without the sides of crops
    tracks = np.array([crop.height + 0.02 for crop in CROPS])
    z = corners[:, 0, 2]
    lies = np.abs(z[:, None] - tracks).min(axis=1) < 1e-4
    wear = (kinds == ObjectClass.ROAD) & (z > 1e-4)
    inside = np.abs(corners[:, :, :2].mean(axis=1)) < 0.5 * np.array(scene.size)
    chosen = up & ~lies & ~wear & inside.all(axis=1) & (kinds != ObjectClass.MARKING)
    edges = (corners[:, 1:, :2] - corners[:, :1, :2])[chosen]
    area = (edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]) / 2
    assert area.min() > -1e-3
    assert area.sum() == pytest.approx(np.prod(scene.size), rel=1e-5)


def looks(scene):
    mesh = scene.static
    return {mesh.palette[k] for k in np.unique(mesh.materials)}


def test_winter_whitens_all_crops(scene, winter):
    summer_textures = {look.texture for look in looks(scene)}
    winter_textures = {look.texture for look in looks(winter)}
    assert {"crops_green", "crops_yellow", "crops_lilac", "crops_tan"} <= summer_textures
    assert not {"crops_green", "crops_lilac"} & winter_textures
    assert "snow" in winter_textures
    assert all(look.surface != Surface.SIGNAL for look in looks(winter))  # snow stays on them
    assert len(scene.static.triangles) == len(winter.static.triangles)
