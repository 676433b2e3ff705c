"""Places of others: the side of the road, borders, traffic everywhere, networks of SUMO."""

import bz2
import shutil
import subprocess
from collections import Counter
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from eyas.engine.core.errors import DataFileError
from eyas.engine.sim.scenes import load_network, load_scene
from eyas.engine.state.mesh import Surface
from eyas.engine.targets.catalogue import KINDS
from eyas.engine.targets.rig import part_library
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.demand import RoadLinks, roomy_loops, ways_through
from eyas.engine.traffic.net_file import SumoNet
from eyas.engine.traffic.recording_file import load
from eyas.engine.traffic.sumo import options
from eyas.engine.traffic.sumo_install import sumo_binary, sumo_environment
from eyas.engine.world.maps.recipe import ATTRIBUTION_FILE, PLAN_FILE
from eyas.engine.world.projection import Projection
from eyas.engine.world.roads.areas import streets
from eyas.engine.world.street.signals import pole_at
from eyas.maps.commands import show
from eyas.maps.commands.info import describe
from eyas.maps.files import MAP_FILES
from eyas.maps.formats.roads import write_sumo
from eyas.maps.osm import importing
from eyas.maps.osm.driving_side import tagged_side, usual_side
from eyas.maps.osm.paint_colours import usual_paint
from eyas.maps.osm.reader import covered, read_osm
from eyas.maps.osm.streets import street_file
from eyas.maps.plan.file import read_plan
from eyas.maps.sumo import importing as sumo_importing
from eyas.maps.sumo.files import SumoFiles, demand_of, moved, place_of
from eyas.maps.sumo.projection import projection_of_net

LEFT = {
    "London": (-0.13, 51.5), "Dublin": (-6.26, 53.35), "Tokyo": (139.69, 35.69),
    "Sydney": (151.2, -33.87), "Mumbai": (72.88, 19.07), "Singapore": (103.82, 1.35),
    "Hong Kong": (114.16, 22.28), "Macau": (113.54, 22.2), "Bangkok": (100.5, 13.75),
    "Nairobi": (36.82, -1.29), "Cape Town": (18.42, -33.92), "Auckland": (174.76, -36.85),
    "Suva": (178.44, -18.14), "Kingston": (-76.79, 17.97), "Valletta": (14.51, 35.9),
    "Nicosia": (33.36, 35.17), "Kathmandu": (85.32, 27.72), "Paramaribo": (-55.17, 5.87),
    "Folkestone": (1.17, 51.08), "Apia": (-171.76, -13.83), "Stanley": (-57.85, -51.69),
}  # fmt: skip
RIGHT = {
    "Calais": (1.85, 50.95), "Paris": (2.35, 48.86), "Munich": (11.58, 48.14),
    "New York": (-74.0, 40.71), "Shenzhen": (114.06, 22.55), "Zhuhai": (113.55, 22.27),
    "Seoul": (126.98, 37.57), "Manila": (120.98, 14.6), "Yangon": (96.16, 16.8),
    "Vientiane": (102.6, 17.97), "Kabul": (69.17, 34.53), "Addis Ababa": (38.75, 9.02),
    "Luanda": (13.23, -8.84), "Kinshasa": (15.31, -4.32), "Caracas": (-66.9, 10.5),
    "Cayenne": (-52.33, 4.94), "San Juan": (-66.1, 18.47), "Beirut": (35.5, 33.89),
    "Pago Pago": (-170.7, -14.28), "Vladivostok": (131.89, 43.12), "Noumea": (166.45, -22.27),
}  # fmt: skip


def test_cities_are_driven_in_as_they_are():
    assert {name for name, place in LEFT.items() if usual_side(*place) == "left"} == set(LEFT)
    assert {name for name, place in RIGHT.items() if usual_side(*place) == "right"} == set(RIGHT)


def test_paint_has_the_colours_of_its_country():
    swiss = {
        "Zürich": (8.54, 47.37), "Geneva": (6.14, 46.2), "Basel": (7.59, 47.55),
        "Lugano": (8.95, 46.0), "Chur": (9.53, 46.85), "Morges": (6.5, 46.51),
        "Vaduz": (9.52, 47.14),
    }  # fmt: skip
    beside = {
        "Milan": (9.19, 45.46), "Annecy": (6.13, 45.9), "Konstanz": (9.17, 47.67),
        "Mulhouse": (7.34, 47.75), "Chamonix": (6.87, 45.92), "Innsbruck": (11.4, 47.27),
    }  # fmt: skip
    yellow = {
        "New York": (-74.0, 40.71), "Los Angeles": (-118.2, 34.05), "São Paulo": (-46.6, -23.5),
        "Honolulu": (-157.86, 21.3), "Anchorage": (-149.9, 61.2), "Beijing": (116.4, 39.9),
        "Shanghai": (121.5, 31.2), "Shenzhen": (114.06, 22.55), "Zhuhai": (113.55, 22.27),
        "Ürümqi": (87.6, 43.8), "Seoul": (126.98, 37.57), "Busan": (129.07, 35.18),
    }  # fmt: skip
    for name, place in swiss.items():
        assert usual_paint(*place) == ("yellow", "white"), name
    for name, place in (beside | LEFT).items():
        if place[0] > -20.0:
            assert usual_paint(*place) == ("white", "white"), name
    for name, place in yellow.items():
        assert usual_paint(*place) == ("white", "yellow"), name
    for name in ("Calais", "Paris", "Munich", "Manila", "Vientiane", "Kabul", "Vladivostok"):
        assert usual_paint(*RIGHT[name]) == ("white", "white"), name


@pytest.mark.sumo
@pytest.mark.slow
def test_a_town_is_painted_in_the_colours_of_its_country(london, places):
    for place, crossings, middles in (
        (london, "white", "white"),
        (places("morges", grid(6.5, 46.51)), "yellow", "white"),
        (places("queens", grid(-73.8, 40.7)), "white", "yellow"),
    ):
        known = read_plan(place.folder / PLAN_FILE).survey
        assert (known.crossing_paint, known.middle_paint) == (crossings, middles)


def node(number, lon, lat, **tags):
    return f'<node id="{number}" lon="{lon:.7f}" lat="{lat:.7f}">{_tags(tags)}</node>'


def way(number, *nodes, **tags):
    refs = "".join(f'<nd ref="{one}"/>' for one in nodes)
    return f'<way id="{number}">{refs}{_tags(tags)}</way>'


def _tags(tags):
    return "".join(f'<tag k="{key.replace("__", ":")}" v="{text}"/>' for key, text in tags.items())


def bounds(west, south, east, north):
    return f'<bounds minlat="{south}" minlon="{west}" maxlat="{north}" maxlon="{east}"/>'


def file(tmp_path, *elements, name="place.osm"):
    path = tmp_path / name
    path.write_text(f'<osm version="0.6">{"".join(elements)}</osm>', encoding="utf-8")
    return path


def grid(lon, lat, **tags):
    """Four blocks of 150 m, with traffic lights in the middle, and a one-way street out."""
    step = 0.00135
    dx = step / np.cos(np.radians(lat))
    nodes = [
        node(3 * j + i, lon + (i - 1) * dx, lat + (j - 1) * step,
             **({"highway": "traffic_signals"} if i == j == 1 else {}))
        for j in range(3) for i in range(3)
    ]  # fmt: skip
    rows = [way(20 + j, *range(3 * j, 3 * j + 3), highway="tertiary", **tags) for j in range(3)]
    columns = [way(30 + i, i, i + 3, i + 6, highway="tertiary", lanes="4", **tags)
               for i in range(3)]  # fmt: skip
    out = node(9, lon + 2 * dx, lat) + way(40, 5, 9, highway="residential", oneway="yes")
    return "".join([*nodes, *rows, *columns, out])


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    """Imports places, each once."""
    made = {}

    def imported(name, *elements, **how):
        if name not in made:
            folder = tmp_path_factory.mktemp("places")
            report = importing.run(
                file(folder, *elements), name, out=folder / "map", **{"record": False, **how}
            )
            made[name] = SimpleNamespace(report=report, folder=folder / "map", said=report.lines())
        return made[name]

    return imported


@pytest.fixture
def london(places):
    return places("london", grid(-0.1, 51.5))


def keeps(network):
    """Return on which side of the middle of two-way streets the lanes lie: 1 left, -1 right."""
    ends = dict(zip(network.edges, zip(network.edge_start, network.edge_end, strict=True),
                    strict=True))  # fmt: skip
    middle = {}
    for lane, edge in enumerate(network.lane_edge):
        points = network.lane_points[slice(*network.lane_first[lane : lane + 2])]
        middle.setdefault(network.edges[edge], []).append(points)
    sides = Counter()
    for name, (start, end) in ends.items():
        back = [other for other, pair in ends.items() if pair == (end, start)]
        if back:
            here, there = middle[name][0], middle[back[0]][0]
            onwards = here[-1] - here[0]
            aside = here.mean(axis=0) - there.mean(axis=0)
            sides[np.sign(onwards[0] * aside[1] - onwards[1] * aside[0])] += 1
    return sides


@pytest.mark.sumo
@pytest.mark.slow
def test_traffic_keeps_left_where_the_place_does(london, places):
    network = load_network(str(london.folder), 0)
    assert network.left_hand
    assert set(keeps(network)) == {1.0}
    assert "traffic keeps left (the place); --drive-on changes it" in london.said
    assert "traffic keeps left" in " ".join(describe(str(london.folder), 0))
    for street in streets(network):
        # The kerb is on the left of who drives there, and the pole of a light beyond it.
        onwards = street.right[-1] - street.right[0]
        aside = street.right[0] - street.left[0]
        assert onwards[0] * aside[1] - onwards[1] * aside[0] > 0.0
    other = places("london-right", grid(-0.1, 51.5), drive_on="right")
    assert set(keeps(load_network(str(other.folder), 0))) == {-1.0}


@pytest.mark.sumo
@pytest.mark.slow
def test_lights_stand_at_the_kerb_and_face_who_comes(london):
    scene = load_scene(str(london.folder), 0)
    names = scene.network.edges
    lit = set(MAP_FILES.get(str(london.folder)).plan(scene.network, 0).survey.signals)
    ends = [street for name, street in zip(names, streets(scene.network), strict=True)
            if name in lit]  # fmt: skip
    assert len(ends) >= 3
    for street in ends:
        foot, turn = pole_at(street)
        onwards = street.right[-1] - street.right[-2]
        aside = np.array(foot) - street.left[-1]
        assert onwards[0] * aside[1] - onwards[1] * aside[0] > 0.0
        arm = np.array([np.cos(turn), np.sin(turn)])
        assert arm @ aside < 0.0  # over the road
        # Where traffic keeps left its lights face against y.
        faced = np.array([np.sin(turn), -np.cos(turn)])
        assert faced @ onwards < 0.0


@pytest.mark.sumo
def test_pavements_are_where_tags_say_on_either_side(tmp_path):
    street = node(1, 0.0, 51.5) + node(2, 0.003, 51.5)
    for tag, north in (("left", True), ("right", False)):
        for side in ("left", "right"):
            tagged = street + way(5, 1, 2, highway="residential", sidewalk=tag)
            made = tmp_path / f"{tag}-{side}"
            importing.run(file(tmp_path, tagged), "x", out=made, drive_on=side, record=False,
                          bounds=(-0.001, 51.499, 0.004, 51.501))  # fmt: skip
            graph = MAP_FILES.get(str(made)).roads(0)
            (y,) = {
                lane.points[:, 1].mean() > lanes.mean()
                for edge in SumoNet(graph.finished).edges
                if edge.function is None
                for lane in edge.lanes
                if lane.walked
                for lanes in [load_network(str(made), 0).lane_points[:, 1]]
            }
            assert y == north, (tag, side)


def test_a_file_may_say_on_which_side_one_drives(tmp_path):
    street = node(1, 0.0, 0.0) + node(2, 0.001, 0.0)
    for tags, side in (({}, ""), ({"driving_side": "left"}, "left"), ({"drive_on": "right"},
                       "right"), ({"driving_side": "opposite"}, "")):  # fmt: skip
        data = read_osm(file(tmp_path, street + way(3, 1, 2, highway="road", **tags)))
        assert tagged_side(data) == side


def test_vehicles_are_mirrored_and_still_signal_to_their_own_side():
    bus = next(kind for kind in KINDS if kind.name == "bus" or "bus" in str(kind.name).lower())
    usual, left = (part_library((bus,), left_hand=hand).parts[0][0] for hand in (False, True))
    assert np.array_equal(usual.positions * [1, -1, 1], left.positions)
    for surface in (Surface.INDICATOR_LEFT, Surface.INDICATOR_RIGHT):
        for mesh in (usual, left):
            lamps = [k for k, one in enumerate(mesh.palette) if one.surface == surface]
            corners = mesh.triangles[np.isin(mesh.materials, lamps)]
            if len(corners):
                aside = mesh.positions[corners][..., 1].mean()
                assert (aside > 0) == (surface == Surface.INDICATOR_LEFT)
    a, b, c = (left.positions[left.triangles[:, k]] for k in range(3))
    faced = np.cross(b - a, c - a)
    agree = (faced * left.normals[left.triangles[:, 0]]).sum(axis=1)
    assert (agree >= -1e-6).mean() > 0.95


def cut(tmp_path, *elements, area=(8.0, 50.0, 8.006, 50.004)):
    left_out = Counter()
    data = read_osm(file(tmp_path, *elements))
    text = street_file(data, area, lambda key: None, lambda what: left_out.update([what]))
    path = tmp_path / "cut.osm"
    path.write_bytes(text)
    return read_osm(path) if b"<node" in text else None, left_out


def test_streets_are_cut_at_the_border_and_what_is_beyond_is_counted(tmp_path):
    made, left_out = cut(
        tmp_path, node(1, 7.99, 50.002), node(2, 8.016, 50.002), node(3, 8.1, 50.1),
        node(4, 8.2, 50.1), node(5, 8.003, 50.003), node(6, 8.003, 50.1),
        way(11, 1, 2, highway="primary"), way(12, 3, 4, highway="primary"),
        way(13, 5, 6, highway="residential"), way(14, 5, 3, 5, highway="residential"),
    )  # fmt: skip
    assert left_out == {"streets beyond the area": 1}
    spans = [[made.places[one] for one in each.nodes] for each in made.ways.values()]
    assert spans[0] == [(8.0, 50.002), (8.006, 50.002)]
    assert spans[1] == [(8.003, 50.003), (8.003, 50.004)]
    assert len(spans) == 4  # the last one leaves and comes back
    assert len(made.places) == 2 + 2 + 2  # the nodes on the border are new


def test_short_streets_that_lead_nowhere_are_left_out_and_counted(tmp_path):
    made, left_out = cut(
        tmp_path, node(1, 8.001, 50.001), node(2, 8.005, 50.001), node(3, 8.001, 50.003),
        node(4, 8.0015, 50.003), node(5, 8.004, 50.003), node(6, 8.0055, 50.003),
        way(11, 1, 2, highway="primary"), way(12, 3, 4, highway="primary"),
        way(13, 5, 6, highway="primary"),
    )  # fmt: skip
    assert left_out == {"short streets without a way to others": 1}
    assert sorted(made.ways) == [11, 13]


def test_the_area_is_that_of_all_downloads_and_of_what_was_drawn_beyond(tmp_path):
    street = node(1, 8.001, 50.001) + node(2, 8.002, 50.002) + way(3, 1, 2, highway="road")
    two = bounds(8.0, 50.0, 8.006, 50.004) + bounds(8.006, 50.0, 8.007, 50.005)
    assert covered(read_osm(file(tmp_path, two, street)), None, "x") == (8.0, 50.0, 8.007, 50.005)
    drawn = node(-1, 8.01, 50.01) + node(-2, 8.02, 50.01) + way(-3, -1, -2, highway="road")
    area = covered(read_osm(file(tmp_path, two, street, drawn)), None, "x")
    assert area == (8.0, 50.0, 8.02, 50.01)
    crossing = node(-1, 7.99, 50.002) + node(-2, 8.02, 50.002) + way(-3, -1, -2, highway="road")
    area = covered(read_osm(file(tmp_path, two, street, crossing)), None, "x")
    assert area == (8.0, 50.0, 8.007, 50.005)


def test_files_packed_by_bzip2_are_read(tmp_path):
    plain = file(tmp_path, grid(8.0, 50.0))
    packed = tmp_path / "place.osm.bz2"
    packed.write_bytes(bz2.compress(plain.read_bytes()))
    assert read_osm(packed).places == read_osm(plain).places
    packed.write_bytes(packed.read_bytes()[:90])
    with pytest.raises(DataFileError, match="cannot read"):
        read_osm(packed)


def test_places_at_the_date_line_are_whole(tmp_path):
    data = read_osm(file(tmp_path, bounds(179.99, -17.0, -179.99, -16.99), node(1, 179.995, -17.0),
                         node(2, -179.995, -17.0), way(3, 1, 2, highway="road")))  # fmt: skip
    assert covered(data, None, "x") == pytest.approx((179.99, -17.0, 180.01, -16.99))
    assert covered(data, (179.99, -17.01, -179.99, -16.99), "x")[2] == pytest.approx(180.01)
    here = Projection(179.999, -17.0)
    east = here.metres([(-179.999, -17.0), (180.001, -17.0)])
    assert np.array_equal(east[0], east[1])
    assert 200.0 < east[0, 0] < 220.0


@pytest.mark.sumo
def test_a_town_across_the_date_line_is_imported(places):
    made = places(
        "date-line",
        bounds(179.997, -17.004, -179.997, -16.996),
        grid(180.0, -17.0)
        .replace('lon="180.0', 'lon="-179.9')
        .replace('lon="-179.9', 'lon="-179.9'),
    )
    network = load_network(str(made.folder), 0)
    assert np.ptp(network.lane_points[:, 0]) < 600.0
    assert "traffic keeps left (the place); --drive-on changes it" in made.said


@pytest.mark.parametrize(
    ("elements", "reason"),
    [
        (bounds(8.0, 50.0, 8.2, 50.01) + grid(8.1, 50.005),
         r"at most 8 km .* its middle: --bbox 8\.06\d+,49\.98\d+,8\.13\d+,50\.02\d+"),
        (bounds(8.0, 50.0, 8.01, 50.01) + node(1, 8.0, 50.0) + node(2, 8.01, 50.0)
         + way(3, 1, 2, highway="footway"), "no streets for cars"),
        (node(1, 8.0, 50.0) + node(2, 8.01, 50.01) + way(3, 1, 2, type="line_thin")
         + '<relation id="9"><tag k="type" v="lanelet"/></relation>', "Lanelet2"),
    ],
)  # fmt: skip
def test_what_cannot_be_a_map_says_why(tmp_path, elements, reason):
    with pytest.raises(DataFileError, match=reason):
        importing.run(file(tmp_path, elements), "x", out=tmp_path / "map", record=False)


def links(**following):
    lengths = dict.fromkeys(following, 150.0)
    return RoadLinks({name: tuple(after.split()) for name, after in following.items()}, lengths)


def test_routes_lead_from_where_streets_begin_to_where_they_end_over_all_of_them():
    roads = links(i="a x", a="b", b="c o", c="a", x="o", o="", t="x")
    ways = ways_through(roads, roomy_loops(roads), np.random.default_rng(0))
    some = [next(ways) for _ in range(12)]
    assert roomy_loops(roads) == ("a", "b", "c")
    for route in some:
        assert route[0] in "it"
        assert route[-1] == "o"
        assert all(b in roads.successors[a] for a, b in pairwise(route))
    assert set("".join("".join(route) for route in some)) == set("iabcoxt")


def test_small_loops_are_driven_through_and_turning_back_is_the_last_choice():
    roads = links(i="a", a="b", b="a o", o="")
    assert roomy_loops(RoadLinks(roads.successors, dict.fromkeys(roads.length, 40.0))) == ()
    turning = RoadLinks({"a": ("b",), "b": ("a",)}, {"a": 300.0, "b": 300.0}, frozenset("ab"))
    assert roomy_loops(turning) == ("a", "b")  # nothing else is a loop
    assert "-1" in options(TrafficConfig())
    assert "150" in options(TrafficConfig(), town=True)


@pytest.mark.sumo
@pytest.mark.slow
def test_cars_drive_on_every_street_though_no_loop_is_there(places, tmp_path, capsys):
    town = (
        node(1, 11.4973098, 48.1) + node(2, 11.5, 48.1000898) + node(3, 11.5026902, 48.1)
        + node(4, 11.5, 48.0986525)
        + way(21, 1, 2, 3, highway="residential", oneway="yes")
        + way(23, 4, 2, highway="residential", oneway="yes")
    )  # fmt: skip
    made = places("no-loop", town, record=True)
    assert "on 100 % of the streets' length" in made.report.traffic
    told = load(made.folder / "traffic.npz")
    assert told.present.any(axis=1)[::100].all()
    assert not told.present.all(axis=0).any()  # all of them leave
    show.run(str(made.folder), 0, tmp_path / "map.png", 200, tracks=True)
    assert "without" not in capsys.readouterr().err  # the ways of its cars are drawn
    assert (tmp_path / "map.png").is_file()


@pytest.mark.sumo
@pytest.mark.slow
def test_a_network_of_sumo_comes_back_with_its_traffic(london, tmp_path):
    out = tmp_path / "sumo"
    write_sumo(str(london.folder), 0, out)
    (config,), (net,) = out.glob("*.sumocfg"), out.glob("*.net.xml")
    report = sumo_importing.run(config, "back", out=tmp_path / "back")
    there, back = load_network(str(london.folder), 0), load_network(report.known_as, 0)
    assert back.left_hand
    assert back.edges == there.edges
    shift = back.lane_points - there.lane_points
    assert np.ptp(shift, axis=0) == pytest.approx([0.0, 0.0], abs=0.002)
    middle = 0.5 * (back.lane_points.max(axis=0) + back.lane_points.min(axis=0))
    assert np.abs(middle).max() < 60.0
    told = load(tmp_path / "back" / "traffic.npz")
    assert told.present.sum(axis=1).mean() > 10
    lanes = shapely.union_all([
        shapely.buffer(shapely.LineString(back.lane_points[a:b]), 12.0)
        for a, b in pairwise(back.lane_first)
    ])  # fmt: skip
    inside = shapely.contains_xy(lanes, told.position[told.present])
    assert inside.mean() > 0.99
    assert report.buildings > 3
    assert "traffic keeps left, as in the file" in report.lines()
    shutil.rmtree(tmp_path / "back")
    plain = sumo_importing.run(net, "back", out=tmp_path / "back", buildings=False, record=False)
    assert plain.buildings == 0


def test_a_network_is_moved_and_nothing_else_is_changed():
    lane = '<lane id="a_0" index="0" speed="13" length="9" shape="100.00,7.00 200.00,7.00,3.5"/>'
    xml = (
        '<net version="1.20"><location netOffset="5.00,6.00" convBoundary="100.00,0.00,200.00,9.00"'
        ' origBoundary="6.90,50.90,6.92,50.92" projParameter="+proj=utm +zone=32"/>'
        f'<edge id="a" from="x" to="y">{lane}</edge>'
        '<junction id="x" x="100.00" y="7.00" shape="100,7 101,8"/></net>'
    )
    place = place_of(xml.encode(), "x")
    assert place.middle == (150.0, 7.0)
    assert place.size == (100.0, 0.0)
    assert place.projection is not None
    text = moved(xml.encode(), (-150.0, -7.0), "x").decode()
    for part in ('shape="-50.000,0.000 50.000,0.000,3.5"', 'x="-50.000" y="0.000"',
                 'netOffset="-145.000,-1.000"', 'length="9"'):  # fmt: skip
        assert part in text
    assert place_of(text.encode(), "x").middle == (0.0, 0.0)
    for broken, reason in (("<net/>", "no streets"), ("<osm/>", "<osm>"),
                           (xml.replace("100.00,7.00 ", "x,7 "), "a shape")):  # fmt: skip
        with pytest.raises(DataFileError, match=reason):
            place_of(broken.encode(), "x")


def test_vehicles_begin_with_the_first_of_them(tmp_path):
    path = tmp_path / "x.rou.xml"
    path.write_text(
        '<routes><vType id="v" vClass="bus"/><vehicle id="b" depart="1:00:30"/>'
        '<vehicle id="a" depart="3600"/><flow id="f" begin="0" end="7200" number="9"/>'
        '<trip id="t" depart="10"/><person id="p"/></routes>'
    )
    left_out = Counter()
    text = demand_of(
        SumoFiles(tmp_path, (path,), 3600.0), lambda what: left_out.update([what])
    ).decode()
    order = [text.index(part) for part in ('id="v"', 'id="a"', 'id="b"')]
    assert order == sorted(order)
    assert 'depart="30.00" id="b"' in text or 'id="b" depart="30.00"' in text
    assert 'begin="0.00" end="3600.00"' in text
    assert left_out == {"<person>": 1, "vehicles from before the beginning": 1}
    path.write_text("<routes/>")
    with pytest.raises(DataFileError, match="has no vehicles"):
        demand_of(SumoFiles(tmp_path, (path,)), lambda what: None)


@pytest.mark.parametrize(
    ("words", "place", "metres"),  # Metres by pyproj
    [
        ("+proj=utm +zone=30 +ellps=WGS84", (-0.1, 51.5), (701277.66513, 5709417.12485)),
        ("+proj=utm +zone=56 +south", (151.2, -33.87), (333510.65008, 6250800.24118)),
        (
            "+proj=tmerc +lat_0=49 +lon_0=-2 +k=0.9996012717 +x_0=400000 +y_0=-100000",
            (-0.1, 51.5),
            (531878.95744, 179685.29785),
        ),
    ],
)
def test_a_network_lies_where_its_projection_says(words, place, metres):
    lon, lat = place
    location = {
        "projParameter": words,
        "netOffset": f"{-metres[0]:.2f},{-metres[1]:.2f}",
        "origBoundary": f"{lon - 0.01},{lat - 0.01},{lon + 0.01},{lat + 0.01}",
    }
    projection = projection_of_net(location, (0.0, 0.0))
    assert projection is not None
    np.testing.assert_allclose(projection.metres(place), [[0.0, 0.0]], atol=0.02)
    np.testing.assert_allclose(projection.degrees((0.0, 0.0)), [place], atol=3e-7)
    for unknown in ("!", "+proj=lcc +lat_1=33", "", "+proj=utm"):
        assert projection_of_net(location | {"projParameter": unknown}, (0.0, 0.0)) is None


@pytest.mark.sumo
@pytest.mark.slow
def test_a_network_of_sumo_has_the_buildings_of_openstreetmap(places, tmp_path):
    house = "".join(
        node(100 + k, -0.1 + dx, 51.5 + dy)
        for k, (dx, dy) in enumerate(((4e-4, 3e-4), (8e-4, 3e-4), (8e-4, 6e-4), (4e-4, 6e-4)))
    ) + way(50, 100, 101, 102, 103, 100, building="yes", building__levels="3")  # fmt: skip
    town = grid(-0.1, 51.5) + house
    there = places("with-house", town)
    osm = file(tmp_path, town)
    # As osmWebWizard makes it: in UTM, whose north is 2 degrees beside the true one here.
    net = tmp_path / "city.net.xml"
    command = [sumo_binary("netconvert"), "--osm-files", osm, "-o", net, "--proj.utm", "--lefthand"]
    subprocess.run(command, check=True, capture_output=True, env=sumo_environment())
    how = {"buildings": osm, "record": False}
    report = sumo_importing.run(net, "back", out=tmp_path / "back", **how)
    assert report.buildings == 1
    assert "© OpenStreetMap contributors" in report.lines()
    assert (tmp_path / "back" / ATTRIBUTION_FILE).read_text()
    apart = [_gaps(folder) for folder in (there.folder, tmp_path / "back")]
    np.testing.assert_allclose(*apart, atol=0.3)
    with pytest.raises(
        DataFileError, match=r"of another place: the network is about latitude 51\.5"
    ):
        sumo_importing.run(
            net, "c", out=tmp_path / "c", buildings=file(tmp_path, grid(2.0, 48.0), name="b.osm")
        )


def _gaps(folder):
    """Return how far each corner of the only house is from the nearest middle of a lane [m]."""
    (house,) = read_plan(folder / PLAN_FILE).survey.houses
    network = load_network(str(folder), 0)
    lanes = shapely.MultiLineString([
        network.lane_points[a:b] for a, b in pairwise(network.lane_first)
    ])  # fmt: skip
    corners = shapely.get_coordinates(house.shape)[:4]
    return sorted(lanes.distance(shapely.Point(*corner)) for corner in corners)
