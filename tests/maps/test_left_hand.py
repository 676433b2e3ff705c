"""Generated maps on which traffic keeps left."""

import re

import numpy as np
import pytest
import shapely

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.scenes import load_network
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode, kept_left
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.network import build_network, graph_hash
from eyas.engine.world.build.scene_builder import SceneBuilder
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.engine.world.roads.areas import corridors, streets
from eyas.engine.world.street.signals import signal_places
from eyas.engine.world.weather import Season
from eyas.maps.commands.info import make_another
from eyas.maps.commands.plan import write_plan_of
from eyas.maps.downtown.layout import lay_out
from eyas.maps.downtown.scenery import scenery_of
from eyas.maps.formats.roads import sumo_files_of
from eyas.maps.plan.build import _Work
from eyas.maps.plan.file import read_plan
from eyas.maps.plan.plan import MapPlan, ThingKind
from eyas.maps.street.dressing import CITY_KERBS, DressedGround, along_kerbs
from eyas.maps.street.lamps import lamps_along

GENERATED = ("citystreet", "downtown", "simpleway-grass", "village")


def turn(onwards, aside):
    return np.sign(onwards[0] * aside[1] - onwards[1] * aside[0])


@pytest.fixture(scope="module")
def downtown():
    return load_network("downtown-left", 0)


@pytest.mark.sumo
@pytest.mark.parametrize("name", GENERATED)
def test_the_asphalt_is_that_of_the_usual_map_and_kerbs_are_on_the_left(name):
    network, usual = load_network(f"{name}-left", 0), load_network(name, 0)
    assert network.left_hand
    assert not usual.left_hand
    for street in streets(network):
        onwards, aside = street.right[-1] - street.right[0], street.right[0] - street.left[0]
        assert turn(onwards, aside) == 1.0, (street.start, street.end)
    # Junctions are shaped by who may turn there.
    both = shapely.symmetric_difference(corridors(network), corridors(usual)).area
    assert both < 0.01 * corridors(usual).area
    assert network.graph_hash == graph_hash(MAPS.get(f"{name}-left").roads(0)) != usual.graph_hash


@pytest.mark.sumo
def test_a_ring_is_driven_round_clockwise():
    corners = ((0, 0), (40, 0), (40, 40), (0, 40))  # counter-clockwise
    nodes = tuple(RoadNode("abcd"[k], *corners[k]) for k in range(4))
    edges = tuple(RoadEdge(f"{a}-{b}", a, b) for a, b in ("ab", "bc", "cd", "da"))
    network = build_network(kept_left(RoadGraph("ring", 0, nodes, edges)))
    assert [*zip(network.edge_start, network.edge_end, strict=True)] == [
        ("b", "a"), ("c", "b"), ("d", "c"), ("a", "d")
    ]  # fmt: skip
    assert network.edges == ("b-a", "c-b", "d-c", "a-d")
    middle = shapely.Polygon(corners)
    outer = [shapely.LineString(street.right) for street in streets(network)]
    assert not any(middle.buffer(2.0).contains(line) for line in outer)  # lanes are outside


@pytest.mark.sumo
@pytest.mark.slow
def test_what_stands_at_kerbs_stands_on_the_left(downtown):
    kerbs = [shapely.LineString(street.right) for street in streets(downtown)]
    roads = shapely.buffer(corridors(downtown), -0.2)

    def beyond_kerb(places):
        points = shapely.points(places)
        near = shapely.STRtree(kerbs).nearest(points)
        assert (shapely.distance(points, np.array(kerbs)[near]) < 5.0).all()
        return not shapely.intersects(roads, points).any()

    lamps = lamps_along(downtown, 40, shapely.Polygon(), np.random.default_rng(0))
    assert len(lamps) > 20
    assert beyond_kerb([(one.x, one.y) for one in lamps])
    everywhere = DressedGround(shapely.box(-2000, -2000, 2000, 2000), 0.1)
    shapely.prepare(everywhere.area)
    grounds = {"pavement": everywhere, "road": everywhere, "behind": everywhere}
    dressed = along_kerbs(downtown, grounds, CITY_KERBS, np.random.default_rng(0))
    signs = [one for one in dressed if "sign" in one.kind]
    assert len(signs) > 20
    assert beyond_kerb([(one.x, one.y) for one in signs])
    poles = [foot for foot, _ in signal_places(downtown)]
    assert beyond_kerb(poles)


@pytest.mark.sumo
@pytest.mark.slow
def test_parked_cars_face_as_the_traffic_beside_them(downtown):
    cars = scenery_of(downtown, lay_out(downtown, 0), 0).kerbs.cars
    kerbs = [shapely.LineString(street.right) for street in streets(downtown)]
    near = shapely.STRtree(kerbs).nearest(shapely.points(cars[:, :2]))
    assert len(cars) > 50
    for (x, y, heading), k in zip(cars, near, strict=True):
        along = shapely.get_coordinates(kerbs[k])
        onwards = along[-1] - along[0]
        assert np.array([np.cos(heading), np.sin(heading)]) @ onwards > 0.0
        assert turn(onwards, np.array([x, y]) - along[0]) == 1.0


@pytest.mark.sumo
def test_lights_and_boards_are_mirrored(downtown, monkeypatch):
    plan = MapPlan(name="x", size=(10.0, 10.0))
    monkeypatch.setattr(SceneBuilder, "prototype", lambda self, name, make, trees: make())
    usual = load_network("downtown", 0)
    for kind in (ThingKind(name="traffic light"), ThingKind(name="gantry"), ThingKind(name="bin")):
        works = [_Work(plan, network, Season.SUMMER) for network in (downtown, usual)]
        (left, *_), (right, *_) = (work.prototype(kind) for work in works)
        side = 1.0 if kind.name == "bin" else -1.0
        assert np.array_equal(left.positions, right.positions * [1.0, side, 1.0]), kind.name


@pytest.mark.sumo
@pytest.mark.slow
def test_cars_drive_on_the_left():
    assets = load_assets(WorldConfig(map="village-bare-left"), TrafficConfig(), 1)
    network, motion = assets.scene.network, assets.traffic.motion
    lanes = [
        shapely.LineString(network.lane_points[a:b])
        for a, b in zip(network.lane_first[:-1], network.lane_first[1:], strict=True)
    ]
    world, right, seen = StillWorld(assets), 0, 0
    assert len(motion.kind) > 10
    for time in (100.0, 300.0):
        actors = world.actors(time)
        here = np.flatnonzero(actors.present[0])
        points = shapely.points(actors.position[0, here, :2])
        for actor, lane in zip(here, shapely.STRtree(lanes).nearest(points), strict=True):
            onwards = np.diff(shapely.get_coordinates(lanes[lane])[[0, -1]], axis=0)[0]
            yaw = actors.yaw[0, actor]
            right += float(np.array([np.cos(yaw), np.sin(yaw)]) @ onwards) > 0.0
            seen += 1
    assert right > 0.9 * seen > 20


@pytest.mark.sumo
def test_its_plan_and_its_network_for_sumo_keep_left(tmp_path):
    path = tmp_path / "left.plan.json"
    write_plan_of("farmland-bare-left", 2, path)
    assert read_plan(path).roads.left_hand
    again, there = load_network(str(path), 0), load_network("farmland-bare-left", 2)
    assert again.left_hand
    assert np.array_equal(again.lane_points, there.lane_points)
    files = sumo_files_of("farmland-bare-left", 0, "farm")
    assert re.search(rb'<net [^>]*lefthand="true"', files["farm.net.xml"])


def test_other_names_and_sides_are_refused(eyas_command):
    run = eyas_command("maps", "new", "lake", "--map-seed", "1", "--drive-on", "middle")
    assert run.returncode != 0
    assert "--drive-on: 'middle' is not allowed; allowed: left, right" in run.stderr
    with pytest.raises(ConfigError, match="--drive-on: 'left' is not allowed for 'no-map'"):
        make_another("no-map", 1, left_hand=True)
    with pytest.raises(UnknownNameError):
        MAPS.get("no-map-left")
