"""What holds for each map of the table in each of its weathers."""

from dataclasses import fields, is_dataclass
from functools import lru_cache

import numpy as np
import pytest
import shapely

from eyas.engine.core.optics.pinhole import field_along
from eyas.engine.render.renderer import build_renderer
from eyas.engine.sim.scenes import load_geometry, load_scene
from eyas.engine.state.draw import DrawList, Picture, Views
from eyas.engine.state.scene import Scene
from eyas.engine.task.spawn import StartValues, start_pose
from eyas.engine.world.maps import MAPS
from eyas.engine.world.weather import WEATHERS
from eyas.maps.plan.build import build_scene

NAMES = MAPS.built_in
ALIKE = ("simpleway-clinker", "simpleway-desert", "simpleway-farm", "simpleway-lake",
         "simpleway-village", "simpleway-city")  # fmt: skip
"""Maps that differ only in their ground from one that is drawn; each takes long to pack."""
DRAWN = [name for name in NAMES if name not in ALIKE]
ALL = ("citystreet",)
OTHERS = set(WEATHERS.built_in) - {"day", "foggy", "night", "snow"}
"""Weathers that are drawn on two maps only: packing a map in another season takes long."""
CONDITIONS = [
    pytest.param(name, weather, marks=[pytest.mark.thorough] if number and name not in ALL else [])
    for name in DRAWN
    for number, weather in enumerate(MAPS.get(name).weathers)
    if weather not in OTHERS or name in ("citystreet", "desert")
]
"""Of all maps the first weather and of one all; the others before a release."""
BUILT_AGAIN = (
    "farmland",
    *(
        pytest.param(name, marks=pytest.mark.thorough)
        for name in ("simpleway-grass", "downtown", "village", "lake")
    ),
)
"""Others are built again in the tests of their own, and all are compared in `test_plan`."""
SIDE = 96
PICTURES = 3
HALF_CAR = 1.0
"""Half the width of a car, mirrors included [m]."""
TRUCK = 4.5
"""Height of the highest vehicle [m]."""


@lru_cache(maxsize=1)
def _scene(name: str) -> Scene:
    return load_scene(name, 0)


def _middles(scene: Scene, apart: float) -> np.ndarray:
    """Points on the middle of all lanes, a distance apart [m], shape (K, 2)."""
    network = scene.network
    made = []
    for low, high in zip(network.lane_first[:-1], network.lane_first[1:], strict=True):
        lane = shapely.LineString(network.lane_points[low:high])
        along = np.arange(0.0, lane.length, apart)
        made.append(shapely.get_coordinates(shapely.line_interpolate_point(lane, along)))
    return np.concatenate(made)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_no_lane_leads_through_anything_solid(name):
    scene = _scene(name)
    points = shapely.points(_middles(scene, 2.0))
    tree = shapely.STRtree(points)
    solids, floor = scene.colliders, scene.terrain.floor
    first = solids.prism_first
    low = np.flatnonzero((solids.prism_bottom < floor + TRUCK) & (solids.prism_top > 0.5))
    shapes = [shapely.Polygon(solids.prism_points[first[k] : first[k + 1]]) for k in low]
    low = (solids.cylinder_bottom < floor + TRUCK) & (solids.cylinder_top > 0.5)
    centres, radii = solids.cylinder_centre[low], solids.cylinder_radius[low]
    shapes += list(shapely.buffer(shapely.points(centres), radii))
    solid = np.array(shapes, object)  # none on some maps
    hit = tree.query(solid, predicate="dwithin", distance=HALF_CAR)
    assert hit.shape[1] == 0, shapely.get_coordinates(points[hit[1, :5]])


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_lanes_lie_on_the_floor_and_on_roads(name):
    """The ground is not above the lanes: no hill has swallowed a road."""
    scene = _scene(name)
    points = _middles(scene, 10.0)
    assert (np.abs(points) <= 0.5 * np.array(scene.size)).all()
    recipe = MAPS.get(name)
    assert scene.network.graph_hash == recipe.shipped_network().graph_hash
    assert len(scene.network.lane_first) > 10


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_triangle_and_copy_is_finite_and_has_an_object(name):
    scene = _scene(name)
    mesh, objects = scene.static, len(scene.object_class)
    assert len(scene.static_object) == len(mesh.triangles) == len(mesh.materials) > 1000
    assert mesh.triangles.max() < len(mesh.positions)
    assert 0 <= scene.static_object.min() <= scene.static_object.max() < objects
    assert np.isfinite(mesh.positions).all()
    assert np.isfinite(mesh.uvs).all()
    assert np.isfinite(scene.fixtures.pose).all()
    assert scene.fixtures.object_id.max(initial=-1) < objects


@pytest.mark.parametrize("name", NAMES)
def test_another_seed_is_another_map_and_a_seed_repeats(name):
    recipe = MAPS.get(name)
    assert recipe.roads(3) == recipe.roads(3)
    assert recipe.roads(3).nodes != recipe.roads(0).nodes


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILT_AGAIN)
def test_building_again_gives_the_same_bytes(name):
    recipe, scene = MAPS.get(name), _scene(name)
    network = recipe.shipped_network()
    again = build_scene(recipe.plan(network, 0), network)
    for one, other in zip(_arrays(again), _arrays(scene), strict=True):
        assert one.tobytes() == other.tobytes()


def _arrays(thing: object) -> list[np.ndarray]:
    if isinstance(thing, np.ndarray):
        return [thing]
    if isinstance(thing, tuple):
        return [array for part in thing for array in _arrays(part)]
    if is_dataclass(thing):
        return [a for field in fields(thing) for a in _arrays(getattr(thing, field.name))]
    return []


@pytest.mark.slow
@pytest.mark.parametrize(("name", "weather"), CONDITIONS)
def test_pictures_from_the_drones_start_show_a_road_and_are_not_flat(name, weather):
    recipe = MAPS.get(name)
    season = recipe.season(weather)
    scene = load_scene(name, 0, season)
    geometry = load_geometry(name, 0, season, ())
    renderer = build_renderer(scene, geometry, recipe.light(weather))
    picture = Picture.create(PICTURES, SIDE, SIDE, depth=True)
    renderer.draw(_starts(scene), DrawList.create(1, 0), picture)
    grey = picture.rgb.astype(float).mean(axis=-1)
    # Single pixels may fall between surfaces that share an edge but not its points.
    assert (picture.depth < 60.0).mean() > 0.999, "sky, or a hole in the ground"
    assert 4.0 < grey.mean() < 245.0
    assert grey.std(axis=(1, 2)).max() > 2.0
    assert len(np.unique(picture.rgb.reshape(-1, 3), axis=0)) > 50, "nothing but one surface"


def _starts(scene: Scene) -> Views:
    """Views along lanes spread over the map, from 22 m."""
    network = scene.network
    lanes = np.linspace(0, len(network.lane_width) - 1, PICTURES).astype(int)
    position, rotation = [], []
    for lane in lanes:
        low = network.lane_first[lane]
        start, end = network.lane_points[low : low + 2]
        middle, along = (start + end) / 2, end - start
        yaw = float(np.arctan2(along[1], along[0]))
        place, turn = start_pose(StartValues(1.37, 22.0, 0.0, 0.0, 0.0), [*middle, 0.0], yaw, 0.0)
        position.append(place)
        rotation.append(_look(turn, 1.37))
    return Views(
        position=np.array(position),
        rotation=np.array(rotation),
        world=np.zeros(PICTURES, np.int32),
        subject=np.full(PICTURES, -1, np.int32),
        field_of_view=0.7854,
        vertical_field_of_view=field_along(0.7854, 0.75),
        instant=np.zeros(PICTURES),
    )


def _look(yaw: float, pitch: float) -> np.ndarray:
    forward = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)])
    left = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    return np.stack([forward, left, np.cross(forward, left)], axis=1)
