"""OpenStreetMap files made by hand, a few lines each: every feature, and every defect."""

import gzip
import json
import re
import sys
from collections import Counter

import numpy as np
import pytest
import shapely

from eyas.engine.core.errors import ConfigError, DataFileError, MissingExtraError
from eyas.engine.core.installed import install_command
from eyas.engine.world.projection import Projection
from eyas.maps.files import MAP_FILES
from eyas.maps.osm.features import Area, House, Survey
from eyas.maps.osm.houses import houses_of
from eyas.maps.osm.land import add_land
from eyas.maps.osm.measures import colour, length, number
from eyas.maps.osm.reader import covered, read_osm
from eyas.maps.osm.rings import OsmShapes
from eyas.maps.osm.streets import street_file
from eyas.maps.plan.file import read_plan, write_plan
from eyas.maps.plan.plan import MapPlan
from eyas.maps.towns.buildings import building_of

HERE = Projection(13.4, 52.5)
EXTENT = shapely.box(-500, -500, 500, 500)
SQUARE = [(0, 0), (20, 0), (20, 10), (0, 10)]


def node(number, x, y, **tags):
    (lon, lat), *_ = HERE.degrees([(x, y)])
    return f'<node id="{number}" lon="{lon:.8f}" lat="{lat:.8f}">{said(tags)}</node>'


def way(number, *nodes, **tags):
    refs = "".join(f'<nd ref="{one}"/>' for one in nodes)
    return f'<way id="{number}">{refs}{said(tags)}</way>'


def relation(number, *members, **tags):
    refs = "".join(f'<member type="way" ref="{ref}" role="{role}"/>' for ref, role in members)
    return f'<relation id="{number}">{refs}{said(tags)}</relation>'


def said(tags):
    return "".join(f'<tag k="{k.replace("__", ":")}" v="{v}"/>' for k, v in tags.items())


def ring(number, corners, **tags):
    """A closed way, with nodes of its own."""
    first = 1000 * number
    nodes = [node(first + k, *corner) for k, corner in enumerate(corners)]
    return "".join([*nodes, way(number, *range(first, first + len(corners)), first, **tags)])


def file(tmp_path, *elements, name="map.osm"):
    path = tmp_path / name
    path.write_text(f'<osm version="0.6">{"".join(elements)}</osm>', encoding="utf-8")
    return path


class Read:
    """A file read, and what was odd or broken in it."""

    def __init__(self, tmp_path, *elements):
        self.odd, self.broken = Counter(), Counter()
        self.data = read_osm(file(tmp_path, *elements))
        self.shapes = OsmShapes(self.data, HERE, EXTENT, lambda what: self.broken.update([what]))

    def houses(self):
        return houses_of(self.shapes, lambda key: self.odd.update([key]))

    def land(self):
        made, rng = Survey(), np.random.default_rng(1)
        add_land(made, self.shapes, lambda key: self.odd.update([key]), rng)
        return made

    def streets(self):
        bounds = (13.3, 52.4, 13.5, 52.6)
        return street_file(self.data, bounds, lambda key: self.odd.update([key])).decode()


def test_degrees_and_metres_are_inverse_and_north_is_up():
    points = np.array([(0.0, 0.0), (1200.0, -3400.0), (-2900.0, 2950.0)])
    np.testing.assert_allclose(HERE.metres(HERE.degrees(points)), points, atol=0.002)
    assert HERE.metres([(13.4, 52.51)])[0] == pytest.approx([0.0, 1112.7], abs=0.5)


@pytest.mark.parametrize(
    ("text", "metres"),
    [
        ("12", 12),
        ("12.5 m", 12.5),
        ("12,5", 12.5),
        ("40'", 12.19),
        ("5'6\"", 1.68),
        ("30 ft", 9.14),
    ],
)
def test_lengths_are_read_in_the_units_that_people_write(text, metres):
    assert length({"height": text}, "height", (0, 100), pytest.fail) == pytest.approx(
        metres, abs=0.01
    )


@pytest.mark.parametrize("text", ["high", "", "-4", "1e9", "12 floors", "nan"])
def test_an_odd_length_is_told_and_left_out(text):
    odd = Counter()
    assert length({"height": text}, "height", (0, 900), lambda key: odd.update([key])) is None
    assert number({"height": text}, "height", (0, 900), lambda key: odd.update([key])) is None
    assert odd == {"height": 2}


def test_colours_are_names_or_numbers():
    assert colour({"c": "#ff8000"}, "c", pytest.fail) == pytest.approx((1, 0.502, 0), abs=0.001)
    assert colour({"c": "Light Grey"}, "c", pytest.fail) == pytest.approx((0.827,) * 3, abs=0.01)
    odd = []
    assert colour({"c": "brickish"}, "c", odd.append) is None
    assert odd == ["c"]


def test_compressed_and_plain_files_are_the_same(tmp_path):
    plain = file(tmp_path, ring(1, SQUARE, building="yes"))
    packed = tmp_path / "map.osm.gz"
    packed.write_bytes(gzip.compress(plain.read_bytes()))
    assert read_osm(packed) == read_osm(plain)


def test_binary_files_are_the_same_as_xml(tmp_path):
    osmium = pytest.importorskip("osmium")
    plain = file(
        tmp_path, ring(1, SQUARE), ring(2, SQUARE), node(5, 1, 2, natural="tree"),
        relation(9, (1, "outer"), (2, "inner"), type="multipolygon"),
    )  # fmt: skip
    packed = tmp_path / "map.osm.pbf"
    with osmium.SimpleWriter(str(packed)) as writer:
        for thing in osmium.FileProcessor(str(plain)):
            writer.add(thing)
    one, other = read_osm(packed), read_osm(plain)
    assert (one.nodes, one.ways, one.relations) == (other.nodes, other.ways, other.relations)
    for name, place in other.places.items():
        assert one.places[name] == pytest.approx(place, abs=1e-7)


def test_a_binary_file_without_pyosmium_says_how_to_install_it(tmp_path, monkeypatch):
    path = tmp_path / "map.osm.pbf"
    path.write_bytes(b"\x00\x00\x00\x0d\x0a\x09OSMHeader\x18")
    monkeypatch.setitem(sys.modules, "osmium", None)
    with pytest.raises(MissingExtraError, match=re.escape(install_command("osm"))):
        read_osm(path)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "not an OpenStreetMap file"),
        (b"hello", "not an OpenStreetMap file"),
        (b"<html></html>", "its content is <html>"),
        (b"<osm><node id='1' lat='1'", "not a complete OpenStreetMap file"),
        (b"<osm><node id='1' lat='a' lon='2'/></osm>", "not a readable"),
        (b"<?xml version='1.0' encoding='klingon'?><osm/>", "not a readable"),
        (b"<osm><node lat='1' lon='2'/></osm>", "not a readable"),
        (b"<osm><node id='1' lat='nan' lon='2'/></osm>", "not on the earth"),
        (b"<osm></osm>", "has no nodes"),
        (b"\x1f\x8bnot gzip", "cannot read"),
    ],
)
def test_a_broken_file_is_one_line(tmp_path, content, reason):
    path = tmp_path / "broken.osm"
    path.write_bytes(content)
    with pytest.raises(DataFileError, match=reason):
        read_osm(path)


def test_a_missing_file_is_one_line(tmp_path):
    with pytest.raises(DataFileError, match="there is no such file"):
        read_osm(tmp_path / "none.osm")


def test_a_map_of_lanelet2_in_metres_is_called_so(tmp_path):
    path = tmp_path / "lanelet2_map.osm"
    path.write_text(
        '<osm><node id="1" lat="" lon=""><tag k="local_x" v="5.5"/></node>'
        '<way id="2"><nd ref="1"/></way>'
        '<relation id="3"><member type="way" ref="2" role="left"/>'
        '<tag k="type" v="lanelet"/></relation></osm>'
    )
    with pytest.raises(DataFileError, match="a map of Lanelet2, which is not read"):
        read_osm(path)


def test_deleted_objects_are_left_out(tmp_path):
    path = file(tmp_path, node(1, 0, 0), '<node id="2" visible="false"/>')
    assert list(read_osm(path).places) == [1]


def test_the_area_is_asked_for_or_told_or_that_of_the_streets(tmp_path):
    street = node(1, 0, 0) + node(2, 90, 30) + way(3, 1, 2, highway="residential")
    data = read_osm(file(tmp_path, street))
    assert covered(data, None, "x") == pytest.approx((13.4, 52.5, 13.4013, 52.5003), abs=1e-4)
    assert covered(data, (13.0, 52.0, 14.0, 53.0), "x") == (13.0, 52.0, 14.0, 53.0)
    with pytest.raises(ConfigError, match="nothing of x lies within"):
        covered(data, (1.0, 2.0, 3.0, 4.0), "x")
    with pytest.raises(ConfigError, match="west, south, east and north"):
        covered(data, (3.0, 2.0, 1.0, 4.0), "x")
    with pytest.raises(DataFileError, match="has no streets"):
        covered(read_osm(file(tmp_path, node(1, 0, 0))), None, "x")


def test_heights_levels_and_roofs_come_from_tags(tmp_path):
    tags = {"height": "14 m", "roof__shape": "gabled", "roof__height": "4", "roof__colour": "red"}
    read = Read(
        tmp_path, ring(1, SQUARE, building="house", **tags), ring(2, SQUARE, building__levels="5",
        building="office", roof__orientation="across", building__colour="#808080"),
    )  # fmt: skip
    house, office = read.houses()
    assert (house.kind, house.height, house.roof, house.roof_height) == ("house", 14.0, "gabled", 4)
    assert house.cover == (1, 0, 0)
    assert (office.levels, office.across, office.height) == (5, True, None)
    assert house.shape.area == pytest.approx(200, abs=0.1)
    assert not read.odd
    assert shell_of(house, 0).top == pytest.approx(9.9)
    assert shell_of(office, 0).top == pytest.approx(15.2)


def test_odd_tags_are_counted_and_never_fatal(tmp_path):
    tags = {"height": "tall", "building__levels": "many", "roof__shape": "spaceship",
            "building__colour": "rainbow", "min_height": "x"}  # fmt: skip
    read = Read(tmp_path, ring(1, SQUARE, building="yes", **tags))
    assert len(read.houses()) == 1
    keys = {key.replace("__", ":") for key in tags}
    assert read.odd == dict.fromkeys(keys, 1)


def test_what_is_under_ground_or_not_built_is_left_out(tmp_path):
    tags = ({"building": "no"}, {"building": "yes", "layer": "-1"}, {"building": "proposed"},
            {"building": "yes", "location": "underground"})  # fmt: skip
    rings = [ring(k + 1, SQUARE, **one) for k, one in enumerate(tags)]
    assert Read(tmp_path, *rings).houses() == []


def test_a_courtyard_is_a_hole(tmp_path):
    inner = [(5, 3), (15, 3), (15, 7), (5, 7)]
    (house,) = Read(
        tmp_path, ring(1, SQUARE), ring(2, inner),
        relation(9, (1, "outer"), (2, "inner"), type="multipolygon", building="apartments"),
    ).houses()  # fmt: skip
    assert house.shape.area == pytest.approx(160, abs=0.1)
    assert len(house.shape.interiors) == 1


def test_an_outline_may_be_split_over_ways_and_its_tags_stand_on_the_way(tmp_path):
    corners = [node(k + 1, *corner) for k, corner in enumerate(SQUARE)]
    ways = way(11, 1, 2, 3, building="yes") + way(12, 3, 4, 1)
    parts = relation(9, (11, "outer"), (12, "outer"), type="multipolygon")
    (house,) = Read(tmp_path, *corners, ways, parts).houses()
    assert house.shape.area == pytest.approx(200, abs=0.1)


def test_broken_outlines_are_mended_or_left_out_and_counted(tmp_path):
    bow_tie = [(0, 0), (20, 10), (20, 0), (0, 10)]
    read = Read(
        tmp_path, ring(1, bow_tie, building="yes"), way(2, 1000, 1001, building="yes"),
        relation(9, (77, "outer"), type="multipolygon", building="yes"),
        way(3, 1000, 555, 1001, 1000, building="yes"),
    )  # fmt: skip
    houses = read.houses()
    assert sum(house.shape.area for house in houses) == pytest.approx(100, abs=0.1)
    assert read.broken["outline that crosses itself"] == 1
    assert read.broken["open outline"] == 1
    assert read.broken["relation without a closed outline"] == 1
    assert read.broken["outline with missing nodes"] == 1


def test_parts_replace_the_outline_and_inherit_its_kind(tmp_path):
    left, right = [(0, 0), (10, 0), (10, 10), (0, 10)], [(10, 0), (20, 0), (20, 10), (10, 10)]
    houses = Read(
        tmp_path, ring(1, SQUARE, building="church", height="20"),
        ring(2, left, building__part="yes", height="30"),
        ring(3, right, building__part="yes", min_height="5"),
        ring(4, right, building__part="yes", height="5"),
    ).houses()  # fmt: skip
    assert sorted(house.height for house in houses) == [5, 20, 30]
    assert {house.kind for house in houses} == {"church"}
    assert sorted(house.bottom for house in houses) == [0, 0, 5]


def test_what_parts_leave_out_of_an_outline_stays(tmp_path):
    tower = [(0, 0), (5, 0), (5, 5), (0, 5)]
    houses = Read(
        tmp_path, ring(1, SQUARE, building="yes", height="9"),
        ring(2, tower, building__part="yes", height="40"),
    ).houses()  # fmt: skip
    assert {house.height: round(house.shape.area) for house in houses} == {9.0: 175, 40.0: 25}


@pytest.mark.parametrize(
    ("tags", "kind"),
    [
        ({"natural": "water"}, "water"), ({"leisure": "park"}, "park"),
        ({"landuse": "forest"}, "forest"), ({"amenity": "parking"}, "parking"),
        ({"highway": "pedestrian", "area": "yes"}, "plaza"), ({"leisure": "pitch"}, "pitch"),
        ({"landuse": "farmland"}, "farmland"), ({"landuse": "industrial"}, "industrial"),
        ({"natural": "beach"}, "sand"), ({"natural": "water", "tunnel": "yes"}, None),
        ({"amenity": "parking", "parking": "underground"}, None),
    ],
)  # fmt: skip
def test_ground_has_a_kind(tmp_path, tags, kind):
    areas = Read(tmp_path, ring(1, SQUARE, **tags)).land().areas
    assert [area.kind for area in areas] == ([kind] if kind else [])


def test_trees_rows_lamps_paths_and_streams(tmp_path):
    read = Read(
        tmp_path, node(1, 0, 0), node(2, 100, 0), node(3, 5, 5, natural="tree", height="11"),
        node(4, 6, 9, natural="tree"), node(5, 1, 1, highway="street_lamp"),
        node(6, 50, 0, highway="crossing"), node(7, 9e3, 0, natural="tree"),
        way(11, 1, 2, natural="tree_row"), way(12, 1, 2, highway="footway"),
        way(13, 1, 2, waterway="river", width="12"), way(14, 1, 2, railway="rail"),
        way(15, 1, 2, highway="footway", footway="sidewalk"),
        way(16, 1, 2, waterway="stream", tunnel="culvert"),
    )  # fmt: skip
    land = read.land()
    assert [tall for _, _, tall in land.trees[:2]] == [11.0, 0.0]
    assert 9 <= len(land.trees) - 2 <= 13
    assert land.lamps == [pytest.approx((1, 1), abs=0.01)]
    assert len(land.crossings) == 1
    areas = {area.kind: area.shape.area for area in land.areas}
    assert areas == {"path": pytest.approx(200, 0.01), "water": pytest.approx(1200, 0.01),
                     "rail": pytest.approx(380, 0.01)}  # fmt: skip
    assert len(land.rails) == 1


def test_what_reaches_out_of_the_map_is_cut(tmp_path):
    wide = [(-900, -900), (900, -900), (900, 900), (-900, 900)]
    (area,) = Read(tmp_path, ring(1, wide, natural="water")).land().areas
    assert area.shape.area == pytest.approx(EXTENT.area)


def test_streets_keep_what_netconvert_needs_and_lose_what_it_stumbles_over(tmp_path):
    read = Read(
        tmp_path, node(1, 0, 0), node(2, 90, 0, highway="traffic_signals", ref="x"),
        node(3, 9e5, 0), node(4, 100, 50), way(11, 1, 2, 3, highway="primary",
        lanes="two", maxspeed="fast", oneway="yes", name="A &amp; B"),
        way(12, 2, 4, highway="footway"), way(13, 1, 4, highway="service", service="driveway"),
    )  # fmt: skip
    text = read.streets()
    assert read.odd == {"lanes": 1, "maxspeed": 1}
    assert "traffic_signals" in text
    assert 'k="oneway" v="yes"' in text
    assert not any(
        word in text for word in ("two", "fast", "footway", "service", "name", 'ref="3"')
    )


def test_features_come_back_from_the_file_of_their_plan(tmp_path):
    house = House(
        shapely.box(0, 0, 9, 9).difference(shapely.box(2, 2, 4, 4)), "yes", 3.0, roof="dome",
        cover=(0.5, 0.25, 1.0),
    )  # fmt: skip
    area = Area("park", shapely.box(0, 0, 50, 50))
    rail = shapely.LineString([(0, 0), (5, 5)])
    whole = Survey(
        [house], [area], [(1.0, 2.0, 0.0)], [(3.0, 4.0)], signals=("a#1",), rails=[rail],
        pavement=shapely.box(0, 0, 1, 1), lit_crossings={":1_c0": rail},
    )  # fmt: skip
    path = tmp_path / "x.plan.json"
    write_plan(path, MapPlan(name="x", size=(100.0, 100.0), survey=whole))
    again = read_plan(path).survey
    assert again.houses == [house]
    assert hash(again.houses[0].cover)  # colours are parts of materials, which are looked up
    assert again.houses[0].wall is None
    assert again == whole


def shell_of(house, seed):
    return building_of(house, seed).parts[0]


def test_what_is_not_told_is_guessed_by_kind_and_seed():
    def house(kind, size=10.0):
        return House(shapely.box(0, 0, size, size), kind)

    assert shell_of(house("garage"), 0).top < 6 < shell_of(house("office", 30.0), 0).top
    assert shell_of(house("house"), 0) == shell_of(house("house"), 0)
    tops = {shell_of(house("apartments", 20.0), seed).top for seed in range(20)}
    assert len(tops) > 3
    carport = shell_of(house("carport"), 0)
    assert carport.bottom > 1.5  # one can drive below it


@pytest.mark.parametrize("name", ["someones:x", "../x", "", "a b", 5, None, ["a"]])
def test_a_folder_whose_map_has_an_odd_name_is_told_and_hides_no_others(
    name, tmp_path, monkeypatch, caplog
):
    monkeypatch.setenv("EYAS_MAPS_DIR", str(tmp_path))
    (tmp_path / "town").mkdir()
    said = {"title": "", "source": "", "longitude": 0, "latitude": 0, "size": [100, 100]}
    (tmp_path / "town" / "map.json").write_text(json.dumps({"name": name, **said}))
    assert MAP_FILES.names() == ()
    assert "an imported map is left out" in caplog.text
    with pytest.raises(DataFileError, match=r"town/map\.json: "):
        MAP_FILES.get(str(tmp_path / "town"))
