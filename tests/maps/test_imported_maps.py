"""A small town that does not exist, imported, flown over, described and exported."""

import gzip
import importlib
import json
import re
import shlex
import shutil
import struct
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import ClassVar

import gymnasium
import numpy as np
import pytest
import shapely
from PIL import Image

from eyas.engine.core.errors import ConfigError, DataFileError, OutputError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim import scenes
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.crowd import Crowd
from eyas.engine.sim.scenes import load_scene
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.config import ObjectsConfig, TargetName
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.record import record
from eyas.engine.traffic.signals import Aspect
from eyas.engine.video.folder import open_folder
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.engine.world.projection import Projection
from eyas.engine.world.roads.network_file import load_network, save_network
from eyas.maps.commands import info, show
from eyas.maps.files import MAP_FILE, MAP_FILES, ROADS_FILE, origin_of
from eyas.maps.formats import layers
from eyas.maps.formats.gltf.world import write_gltf
from eyas.maps.osm import houses, importing, land, streets
from eyas.maps.osm.features import Survey
from eyas.maps.osm.reader import read_osm
from eyas.maps.osm.rings import OsmShapes
from eyas.maps.plan.build import build_scene

pytestmark = pytest.mark.sumo
NAME = "test-town"
NOTICE = "© OpenStreetMap contributors"


@pytest.fixture(scope="module")
def tool():
    """The module that writes files of towns."""
    folder = Path(__file__).parents[2] / "tools"
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        yield importlib.import_module("synthetic_osm")


@pytest.fixture(scope="module")
def source(tool, tmp_path_factory):
    """The file of a town of three by two blocks."""
    made = tmp_path_factory.mktemp("osm") / "town.osm"
    made.write_text(tool.Town(3, 2, 2).build(), encoding="utf-8")
    return made


@pytest.fixture(scope="module")
def town(source, tmp_path_factory):
    """The imported town; its folder is the user's folder of maps while this file is tested."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("EYAS_MAPS_DIR", str(tmp_path_factory.mktemp("maps")))
        yield importing.run(source, NAME, record=False)


@pytest.fixture(scope="module")
def scene(town):
    return load_scene(NAME, 0)


def test_an_import_says_what_it_found_and_guessed(town):
    assert town.lanes > 20
    assert town.signals >= 1
    assert town.buildings >= 8
    assert town.guessed["heights"] >= 1
    text = "\n".join(town.lines())
    assert f"--map {NAME}" in text
    assert text.endswith(NOTICE)


def test_a_map_in_a_folder_of_ones_own_is_used_as_the_last_line_says(source, tmp_path):
    report = importing.run(source, None, out=tmp_path / "my town", record=False)
    line = next(line for line in report.lines() if line.startswith("kept in "))
    *_, option, name = shlex.split(line)
    assert option == "--map"
    assert MAPS.get(name).name == "town"


class Asked(dict):
    """Tags that remember what is asked of them."""

    keys_asked: ClassVar[set[str]] = set()

    def get(self, key, default=None):
        self.keys_asked.add(key)
        return super().get(key, default)

    def __contains__(self, key):
        self.keys_asked.add(key)
        return super().__contains__(key)


def test_the_file_of_the_town_has_every_tag_that_the_importer_reads(source, monkeypatch):
    monkeypatch.setattr(Asked, "keys_asked", set())
    data = read_osm(source)
    told = [*data.nodes.values(), *(each.tags for each in (*data.ways.values(), *data.relations))]
    pairs = {pair for tags in told for pair in tags.items()}
    data.nodes = {name: Asked(tags) for name, tags in data.nodes.items()}
    data.ways = {name: replace(way, tags=Asked(way.tags)) for name, way in data.ways.items()}
    data.relations = [replace(each, tags=Asked(each.tags)) for each in data.relations]
    projection, everywhere = Projection(*np.mean(list(data.places.values()), axis=0)), 1e4
    extent = shapely.box(-everywhere, -everywhere, everywhere, everywhere)
    shapes = OsmShapes(data, projection, extent, lambda _: None)
    houses.houses_of(shapes, lambda _: None)
    land.add_land(Survey(), shapes, lambda _: None, np.random.default_rng(0))
    streets.street_file(data, (-180, -90, 180, 90), lambda _: None)
    assert len(Asked.keys_asked) > 40
    assert sorted(Asked.keys_asked - {key for key, _ in pairs}) == []
    kinds = {*land._KINDS, *(("waterway", kind) for kind in land._STREAMS)}
    kinds |= {("highway", kind) for kind in land._PATHS}
    kinds |= {("railway", kind) for kind in land._TRACKS}
    kinds |= {("roof:shape", shape) for shape in houses._ROOFS}
    kinds |= {("building", kind) for kind in houses._NO_HOUSES}
    assert sorted(kinds - pairs) == []


def test_an_imported_map_is_found_like_any_other(town):
    assert MAP_FILES.names() == (NAME,)
    assert NAME in MAPS.names()
    for name in (NAME, str(town.folder)):
        recipe = MAPS.get(name)
        assert recipe.name == NAME
        assert recipe.weathers == MAPS.get("citystreet").weathers
        assert recipe.attribution().startswith(NOTICE)
        assert recipe.shipped_network() is not None
    assert f"eyas/{NAME}-night-v0" in gymnasium.registry


def test_streets_lie_where_buildings_expect_them(town, source):
    """netconvert and our own projection agree to a millimetre or two."""
    origin = origin_of(town.folder)
    projection = Projection(origin.longitude, origin.latitude)
    net = gzip.decompress((town.folder / ROADS_FILE).read_bytes()).decode()
    places = read_osm(source).places
    found = re.findall(r'<junction id="(\d+)" type="\w+" x="([-\d.]+)" y="([-\d.]+)"', net)
    assert len(found) >= 5
    for name, x, y in found:
        expected = projection.metres([places[int(name)]])[0]
        assert (float(x), float(y)) == pytest.approx(tuple(expected), abs=0.003)


@pytest.mark.slow
def test_a_scene_is_the_same_each_time(scene, town):
    recipe, network = MAPS.get(NAME), scene.network
    again = build_scene(recipe.complete_plan(network, 0), network)
    np.testing.assert_array_equal(again.static.positions, scene.static.positions)
    np.testing.assert_array_equal(again.fixtures.pose, scene.fixtures.pose)


@pytest.mark.slow
def test_no_lane_leads_through_anything_solid(scene):
    solids = scene.colliders
    outlines = [
        shapely.Polygon(solids.prism_points[low:high])
        for solid, (low, high) in enumerate(pairwise(solids.prism_first))
        if solids.prism_bottom[solid] < 4.0
    ]
    round_ones = shapely.buffer(shapely.points(solids.cylinder_centre), solids.cylinder_radius)
    tree = shapely.STRtree([*outlines, *round_ones])
    first = scene.network.lane_first
    for low, high in pairwise(first):
        car = shapely.LineString(scene.network.lane_points[low:high]).buffer(0.95, cap_style="flat")
        assert len(tree.query(car, predicate="intersects")) == 0


def test_no_ground_lies_over_other_ground(scene):
    kinds = scene.object_class[scene.static_object]
    corners = scene.static.positions[scene.static.triangles].astype(np.float64)
    level = np.ptp(corners[..., 2], axis=1) < 1e-6
    flat = level & (corners[:, 0, 2] == np.float32(scene.terrain.floor))
    flat &= np.isin(kinds, [ObjectClass.GROUND, ObjectClass.PAVEMENT])
    inside = np.abs(corners[..., :2]).max(axis=(1, 2)) <= max(scene.size) / 2 + 0.01
    pieces = shapely.polygons(corners[flat & inside][..., :2])
    together = shapely.area(shapely.union_all(pieces))
    assert shapely.area(pieces).sum() == pytest.approx(together, rel=2e-4)
    assert together > 0.4 * np.prod(scene.size)


def test_cars_drive_on_the_streets_and_stop_at_signals(town, scene):
    graph = MAPS.get(NAME).roads(0)
    made = record(NAME, 0, graph, TrafficConfig(max_vehicles=6), 90.0, 1)
    lanes = shapely.union_all(
        [
            shapely.LineString(scene.network.lane_points[a:b]).buffer(2.4)
            for a, b in pairwise(scene.network.lane_first)
        ]
    )
    rings = [shapely.Polygon(scene.network.junction_points[a:b]).buffer(1.0)
             for a, b in pairwise(scene.network.junction_first) if b - a > 2]  # fmt: skip
    road = shapely.union_all([lanes, *rings])
    on_it = shapely.contains_xy(road, made.position[..., 0], made.position[..., 1])
    assert on_it.mean() > 0.995
    moved = np.linalg.norm(np.diff(made.position, axis=0), axis=2)
    standing = (moved < 0.005).mean()
    assert 0.01 < standing < 0.7


@pytest.mark.slow
def test_signals_are_seen_in_their_state_which_changes_with_time(town):
    people = Crowd(target=TargetName.PEDESTRIAN, objects=ObjectsConfig(max_count=2))
    assets = load_assets(WorldConfig(map=NAME, weather="night"), TrafficConfig(), crowd=people)
    lights, world = assets.signals, StillWorld(assets)
    pole = lights.pose[0].astype(float)
    across, faced, up = pole[:, 0], pole[:, 1], pole[:, 2]
    views = Views(
        position=(pole[:, 3] + 4.0 * across + 10.0 * faced + 5.8 * up)[None],
        rotation=np.column_stack([-faced, across, up])[None],
        world=np.zeros(1, np.int32),
        subject=np.array([-1], np.int32),
        field_of_view=np.radians(40.0),
    )
    seen = {}
    for time in np.arange(0.5, 90.0, 1.0):
        aspect = Aspect(int(lights.plan.at(np.array([time]))[0, lights.row[0]]))
        if aspect in seen:
            continue
        picture = Picture.create(1, 96, 128, object_id=True, class_id=True)
        world.draw(views, float(time), picture)
        mine = picture.object_id[0] == lights.object_id[0]
        assert (picture.class_id[0][mine] == ObjectClass.POLE).all()
        shine = picture.rgb[0][mine].astype(int)
        seen[aspect] = shine[shine.max(axis=1) > 200]
    assert set(seen) == {Aspect.RED, Aspect.AMBER, Aspect.GREEN}
    for aspect, shine in seen.items():
        assert len(shine) > 10
        red, green, _ = shine.mean(axis=0)
        share = red / (red + green)
        low, high = {0: (0.65, 1.0), 2: (0.5, 0.65), 3: (0.0, 0.45)}[aspect]
        assert low < share < high, aspect


def test_info_tells_figures_and_whose_data_it_is(scene, town):
    said = info.figures_of(scene)
    assert said.road == pytest.approx(2 * 3 * 0.25 + 0.7, abs=0.4)  # with the street of all tags
    assert said.lanes > 1.3 * said.road
    assert town.buildings * 0.9 <= said.buildings <= town.buildings * 1.2
    text = "\n".join(info.describe(NAME, 0))
    assert f"buildings: {said.buildings} (" in text
    assert NOTICE in text


def test_a_picture_from_above_shows_buildings_in_their_place(scene, tmp_path):
    path = tmp_path / "town.png"
    show.run(NAME, 0, path, 400, tracks=False)
    picture = np.asarray(Image.open(path))
    assert picture.shape[1] == 400
    paper = show._Paper(scene, 400)
    sizes = np.diff(scene.colliders.prism_first)
    big = int(np.argmax(sizes >= 4))
    low, high = scene.colliders.prism_first[big : big + 2]
    middle = shapely.Polygon(scene.colliders.prism_points[low:high]).representative_point()
    ((x, y),) = paper.at(np.array([[middle.x, middle.y]]))
    assert tuple(picture[int(y / 2), int(x / 2)]) == show._BUILDING


def test_a_gltf_file_is_read_back_with_the_stated_number_of_triangles(tmp_path, scene):
    path = tmp_path / "town.glb"
    stated = write_gltf(NAME, 0, path, 9)
    data = path.read_bytes()
    magic, version, size = struct.unpack_from("<4sII", data)
    assert (magic, version, size) == (b"glTF", 2, len(data))
    (length,) = struct.unpack_from("<I", data, 12)
    told = json.loads(data[20 : 20 + length])
    assert told["asset"]["copyright"] == NOTICE
    counts = [
        sum(told["accessors"][part["indices"]]["count"] // 3 for part in mesh["primitives"])
        for mesh in told["meshes"]
    ]
    assert sum(counts[node["mesh"]] for node in told["nodes"] if "mesh" in node) == stated
    trimesh = pytest.importorskip("trimesh")
    read = trimesh.load(path)
    faces = {name: len(shape.faces) for name, shape in read.geometry.items()}
    assert sum(faces[read.graph[node][1]] for node in read.graph.nodes_geometry) == stated
    low, high = read.bounds  # glTF's y points up
    assert high[1] == pytest.approx(float(scene.static.positions[:, 2].max()), abs=20.0)
    assert low[1] == pytest.approx(float(scene.static.positions[:, 2].min()), abs=0.5)


def test_plans_are_in_degrees_and_rasters_hold_heights(tmp_path, scene, source):
    layers.write_layers(NAME, 0, tmp_path, 1.0)
    roads, houses = (json.loads((tmp_path / f"{n}.geojson").read_text())
                     for n in ("roads", "buildings"))  # fmt: skip
    assert roads["attribution"] == NOTICE
    x, y = np.array(roads["features"][0]["geometry"]["coordinates"][0])
    assert (x, y) == pytest.approx((13.4, 52.5), abs=0.01)
    assert len(houses["features"]) == info.figures_of(scene).buildings
    raster = np.load(tmp_path / "raster.npz")
    height, occupancy = raster["height"], raster["occupancy"]
    assert height.shape == occupancy.shape == tuple(map(int, scene.size[::-1]))
    built = occupancy == 3
    assert height[built].min() > 1.0
    footprints = sum(
        shapely.Polygon(scene.colliders.prism_points[a:b]).area
        for a, b in pairwise(scene.colliders.prism_first)
    )
    assert 0.7 * footprints < built.sum() < 1.3 * footprints
    picture = np.asarray(Image.open(tmp_path / "height.png"))
    np.testing.assert_allclose(picture[::-1] / 100.0, np.maximum(height, 0), atol=0.006)
    assert (tmp_path / "ATTRIBUTION.txt").read_text().startswith(NOTICE)


def test_the_notice_lies_in_the_folder_of_a_film(town, tmp_path):
    config = EyasConfig.model_validate({"world": {"map": NAME}})
    for overwrite in (False, True):
        open_folder(tmp_path / "film", config, overwrite=overwrite, resume=False)
        assert (tmp_path / "film" / "ATTRIBUTION.txt").read_text().startswith(NOTICE)


def test_a_map_is_not_replaced_unless_asked(town, source, tmp_path):
    with pytest.raises(OutputError, match="is there already; replace it with --overwrite"):
        importing.run(source, NAME, record=False)
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(OutputError, match="no imported map"):
        importing.run(source, None, out=tmp_path, record=False, overwrite=True)
    with pytest.raises(ConfigError, match="'citystreet' is a map of Eyas"):
        importing.run(source, "citystreet", record=False)


def test_damaged_maps_are_told_in_one_line_and_hide_no_others(town, tmp_path, monkeypatch, caplog):
    monkeypatch.setenv("EYAS_MAPS_DIR", str(tmp_path))
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / MAP_FILE).write_text("{")
    assert MAP_FILES.names() == ()
    assert "an imported map is left out" in caplog.text
    with pytest.raises(DataFileError, match="not the file of an imported map"):
        MAPS.get("bad")


@pytest.mark.parametrize("file", ["network.npz", "roads.net.xml.gz", "map.plan.json"])
def test_a_changed_file_of_an_imported_map_is_one_line(town, tmp_path, file):
    folder = shutil.copytree(town.folder, tmp_path / NAME)
    content = bytearray((folder / file).read_bytes())
    content[len(content) // 2] ^= 1
    (folder / file).write_bytes(content)
    with pytest.raises(DataFileError, match=rf"{file}: damaged: its SHA-256"):
        (MAPS.get(str(folder)).roads(0), load_scene(str(folder), 0))


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("lane_points", 1e300), ("lane_points", np.nan), ("lane_first", 2**30),
        ("lane_edge", 2**30), ("lane_index", 2**30), ("lane_width", -1.7e308),
        ("junction_first", -5),
    ],
)  # fmt: skip
def test_absurd_numbers_of_an_imported_network_are_one_line(town, tmp_path, field, value):
    folder = shutil.copytree(town.folder, tmp_path / NAME)
    (folder / MAP_FILE).write_text(
        json.dumps(json.loads((folder / MAP_FILE).read_text()) | {"checksums": {}})
    )
    network = load_network(folder / "network.npz")
    array = getattr(network, field).copy()
    array.flat[3] = value
    save_network(folder / "network.npz", replace(network, **{field: array}))
    with pytest.raises(DataFileError, match=rf"network\.npz: not a readable .*'{field}"):
        info.figures_of(load_scene(str(folder), 0))


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ('<bounds minlat="52" minlon="13" maxlat="52.001" maxlon="13.001"/>'
         '<node id="1" lat="52.0005" lon="13.0005"/>', "makes no road network|no street"),
        ('<bounds minlat="52" minlon="13" maxlat="52.2" maxlon="13.2"/>'
         '<node id="1" lat="52.0005" lon="13.0005"/>', "at most 8 km"),
        ('<bounds minlat="52" minlon="13" maxlat="52.0001" maxlon="13.0001"/>'
         '<node id="1" lat="52.00005" lon="13.00005"/>', "too little for a map"),
    ],
)  # fmt: skip
def test_what_is_no_map_is_one_line_and_leaves_no_folder(content, reason, town, tmp_path):
    path = tmp_path / "odd.osm"
    path.write_text(f"<osm>{content}</osm>")
    with pytest.raises((DataFileError, ConfigError), match=reason):
        importing.run(path, None, out=tmp_path / "made", record=False)
    assert not (tmp_path / "made").exists()


@pytest.mark.slow
def test_a_city_as_found_is_imported_and_its_defects_are_counted(tool, town, tmp_path, monkeypatch):
    monkeypatch.setattr(tool, "_SHOPS", 60)
    file = tmp_path / "city.osm"
    text = tool.Town(4, 3, 1, found=True).build()
    assert "東京ラーメン" in text
    assert 'user="Ольга"' in text
    file.write_text(text, encoding="utf-8")
    report = importing.run(file, "as-found", record=False)
    said = "\n".join(report.lines())
    for defect in ("open outline", "crosses itself", "missing ways", "without a closed outline"):
        assert defect in said
    for tag in ("height", "building:levels", "lanes", "roof:shape"):
        assert re.search(rf"odd tags: .*\d {tag}\b", said)
    scene = load_scene("as-found", 0)
    assert info.figures_of(scene).buildings > 20
    scenes._scene.cache_clear()
