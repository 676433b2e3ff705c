"""The simple maps: their roads, and the ground of each skin."""

import numpy as np
import pytest
import shapely

from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.mesh import Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.traffic.recording_file import load
from eyas.engine.world.maps import MAPS
from eyas.engine.world.weather import Season
from eyas.maps.simpleway.layout import paved
from eyas.maps.simpleway.roads import ROADS, road_graph, road_lines
from eyas.maps.simpleway.scenery import SKINS

NAMES = [name for name in MAPS.built_in if name.startswith("simpleway-")]


@pytest.fixture(scope="module")
def network():
    return MAPS.get("simpleway-desert").shipped_network()


@pytest.fixture(scope="module")
def desert():
    return load_scene("simpleway-desert", 0, Season.WINTER)


@pytest.fixture(scope="module")
def farm():
    return load_scene("simpleway-farm", 0, Season.WINTER)


ORIGINAL = {
    "grass": "day foggy night",
    "clinker": "day foggy night",
    **dict.fromkeys(["desert", "farm", "lake", "village"], "day foggy night snow"),
    "city": "snow",
}
"""The original's 23 worlds."""


def test_there_are_the_original_s_twenty_three_worlds_and_a_lawn_in_snow():
    published = {"day", "foggy", "night", "snow"}
    ours = {
        name.removeprefix("simpleway-"): published & set(MAPS.get(name).weathers) for name in NAMES
    }
    assert set(ours) == set(SKINS)
    worlds = {(skin, weather) for skin in ours for weather in ours[skin]}
    theirs = {(skin, weather) for skin in ORIGINAL for weather in ORIGINAL[skin].split()}
    assert len(theirs) == 23
    assert worlds - theirs == {("grass", "snow")}
    assert theirs <= worlds


def test_all_skins_share_roads_and_recordings():
    assert len({MAPS.get(name).roads(0) for name in NAMES}) == 1
    assert len({MAPS.get(name).package for name in NAMES}) == 1


@pytest.mark.parametrize("seed", range(4))
def test_sixteen_almost_straight_roads_side_by_side(seed):
    lines = road_lines(seed)
    assert lines.shape == (ROADS, 2, 2)
    along = lines[:, 1] - lines[:, 0]
    length = np.linalg.norm(along, axis=1)
    assert 2570.0 < length.min() <= length.max() < 2620.0
    assert np.abs(along[:, 0] / along[:, 1]).max() < 0.02
    apart = np.diff(lines[:, :, 0].mean(axis=1))
    assert 330.0 < apart.min() <= apart.max() < 410.0
    if seed == 0:
        assert np.ptp(lines[:, :, 0]) == pytest.approx(5618, rel=0.04)
        assert length.sum() == pytest.approx(41_500, rel=0.02)


def test_a_road_ends_in_a_loop_that_leads_back():
    graph = road_graph(0)
    leads = {}
    for edge in graph.edges:
        leads.setdefault(edge.start, []).append(edge.end)
    for index in range(ROADS):
        low, high = f"{index:02d}S", f"{index:02d}N"
        assert set(leads[low]) == {high, f"{low}T"}
        assert leads[f"{low}T"] == [low]
        assert leads[f"{high}T"] == [high]
    assert {(edge.lanes, edge.lane_width) for edge in graph.edges} == {(2, 3.0)}


def test_the_recording_uses_many_roads_and_turns_at_their_ends():
    recording = load(MAPS.get("simpleway-grass").shipped_traffic()[0])
    middles = road_lines(0)[:, :, 0].mean(axis=1)
    x = recording.position[:, :, 0]
    road = np.abs(x[..., None] - middles).argmin(axis=2)
    assert len(np.unique(road)) >= 12
    assert (road == road[:1]).all()
    y = recording.position[:, :, 1]
    assert (np.ptp(y, axis=0) > 2500.0).mean() > 0.9


def test_traffic_stays_on_the_asphalt(network):
    recording = load(MAPS.get("simpleway-grass").shipped_traffic()[0])
    asphalt = paved(network)
    shapely.prepare(asphalt)
    assert shapely.contains_xy(asphalt, recording.position[::80].reshape(-1, 2)).all()


def of_class(scene, kind):
    mesh = scene.static
    return mesh.positions[mesh.triangles[scene.object_class[scene.static_object] == kind]]


@pytest.mark.slow
def test_sand_lies_across_the_roads_of_the_desert(desert, network):
    corners = of_class(desert, ObjectClass.GROUND)
    bars = corners[np.isclose(corners[:, 0, 2], 0.03)].astype(float)
    sand = shapely.union_all(shapely.polygons(bars[:, :, :2]))
    wide = [part for part in shapely.get_parts(sand.buffer(0.01)) if part.area > 60.0]
    assert len(wide) == 7 * ROADS
    extent = np.array([part.bounds for part in wide])
    assert np.median(extent[:, 3] - extent[:, 1]) == pytest.approx(17.5, abs=5.0)
    assert (extent[:, 2] - extent[:, 0]).min() > 11.0  # all four lanes
    # A car that follows a road sees it disappear for about one metre in twenty.
    assert sand.area / paved(network).area == pytest.approx(112 * 17.5 * 12 / 5e5, rel=0.3)
    assert bars[:, :, 2].min() > 0.015  # over the paint


def test_the_winter_of_the_desert_has_thirty_five_white_squares(desert):
    mesh = desert.static
    white = [mesh.palette[k].texture == "snow" for k in mesh.materials]
    corners = mesh.positions[mesh.triangles[np.array(white)]].astype(float)
    snow = shapely.union_all(shapely.polygons(corners[:, :, :2])).buffer(14.0).buffer(-14.0)
    assert len(shapely.get_parts(snow)) <= 35
    assert snow.area == pytest.approx(35 * 300.0**2, rel=0.08)
    assert MAPS.get("simpleway-desert").light("snow").snow == 0.0


def test_seventeen_coloured_strips_lie_between_the_roads_of_the_farm(farm, network):
    covers = SKINS["farm"].patches(road_lines(0), np.random.default_rng(1))
    assert len(covers) == 17
    assert sum(patch.cover.surface == Surface.WATER for patch in covers) == 4
    assert len({patch.cover for patch in covers}) == 6
    asphalt = paved(network)
    widths = [patch.area.area / 4000.0 for patch in covers]
    assert 290.0 < min(widths) <= max(widths) < 400.0
    for patch in covers:
        assert patch.area.distance(asphalt) < 12.0
    crops = [m for m in farm.static.palette if m.texture.startswith("crops")]
    assert all(look.surface == Surface.SIGNAL for look in crops)  # unchanged by snow


def test_winter_whitens_the_soil_of_the_farm_and_no_snow_lies_on_roads(farm):
    assert "soil" not in {farm.static.palette[k].texture for k in np.unique(farm.static.materials)}
    for name in NAMES:
        recipe = MAPS.get(name)
        assert "snow" not in recipe.weathers or recipe.light("snow").snow == 0.0
        assert recipe.seasons == ("snow" in recipe.weathers)


def test_nine_strips_of_water_lie_on_the_soil_of_the_lake():
    water = SKINS["lake"].patches(road_lines(0), np.random.default_rng(1))
    assert [patch.cover.surface for patch in water] == 9 * [Surface.WATER]


def test_the_ground_covers_the_floor_once(desert):
    corners = of_class(desert, ObjectClass.GROUND).astype(float)
    road = of_class(desert, ObjectClass.ROAD).astype(float)
    level = np.isclose(corners[:, :, 2], -0.1).all(axis=1)
    road = road[np.isclose(road[:, :, 2], 0.0, atol=1e-5).all(axis=1)]
    total = sum(_area(part) for part in (corners[level], road))
    assert total == pytest.approx(7000.0 * 5000.0, rel=1e-5)


def _area(corners):
    edges = corners[:, 1:, :2] - corners[:, :1, :2]
    return float((edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]).sum() / 2)


def test_there_is_nothing_to_hide_behind(desert, farm):
    for scene in (desert, farm):
        assert len(scene.fixtures.pose) == len(scene.lamps.position) == 0
        assert scene.static.positions[:, 2].max() < 0.1
