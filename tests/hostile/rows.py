"""Feeds each reader of the package contents that nobody wrote for it, and says what came out.

    python tests/hostile/rows.py FOLDER MOST SEED [ROW ...]

A row writes a small valid file, mostly with the product's own writer, then damaged and hostile ones
in its place. Only an `EyasError` of one line or a value may come out, within limits of memory and
of processor time. The report is JSON on the standard output: for each row how many contents were
tried and refused, and the faults.
"""

import gzip
import io
import json
import logging
import random
import resource
import shutil
import signal
import sys
import time
import warnings
import zipfile
import zlib
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from values import json_contents, mutated  # beside this file

import eyas
from eyas.engine.core.errors import EyasError

BUDGET, BOMB = 16 << 20, 256 << 20
"""What readers may unpack here, which keeps the test quick, and what a bomb unpacks to [bytes]."""
MEMORY = 160 << 20
"""Memory that a content may make resident, beside what was needed before [bytes]."""
SECONDS = 20
"""Processor time that a content may take; usual are milliseconds."""


class Row(NamedTuple):
    """One reader, or several that read the same file."""

    path: Path
    read: Callable[[], object]
    contents: Iterator[bytes]
    """Hostile contents of the file; it holds a valid one at first."""
    refuses: bool = True
    """Whether what is refused raises; otherwise it is left out, or read as nothing."""


Make = Callable[[Path, random.Random, int], Row]
ROWS: dict[str, Make] = {}


def limited(module: Any, name: str = "_LARGEST") -> None:
    """Give a module that reads a smaller budget than its own."""
    assert getattr(module, name) > BUDGET
    setattr(module, name, BUDGET)


def row(*names: str) -> Callable[[Make], Make]:
    def entered(make: Make) -> Make:
        ROWS.update(dict.fromkeys(names, make))
        return make

    return entered


def of_json(path: Path, read: Callable[[], object], chance: random.Random, most: int, **more: Any):
    """Return the row of a JSON file."""
    content = path.read_bytes()
    values = json.loads(content)

    def contents() -> Iterator[bytes]:
        yield from json_contents(values, chance, most)
        yield from mutated(content, chance, most)

    return Row(path, read, contents(), **more)


def of_bytes(
    path: Path,
    read: Callable[[], object],
    chance: random.Random,
    most: int,
    *bombs: Any,
    refuses: bool = True,
):
    """Return the row of another file, with contents that unpack to much."""
    content = path.read_bytes()

    def contents() -> Iterator[bytes]:
        for bomb in bombs:
            yield bomb() if callable(bomb) else bomb
        yield from mutated(content, chance, most)

    return Row(path, read, contents(), refuses)


def with_words(text: str, words: tuple[str, ...]) -> Iterator[bytes]:
    """Yield a text in which one number after the other is an absurd one."""
    import re

    found = list(re.finditer(r"-?\d+(?:\.\d+)?", text))
    for place in found[:40]:
        for word in words:
            yield (text[: place.start()] + word + text[place.end() :]).encode()


ABSURD_WORDS = ("1e300", "-1.7e308", "inf", "nan", "9" * 400, "1e999", str(2**62))


# Files of settings, maps and roads.


@row("json")
def _json(folder, chance, most):
    from eyas.engine.core.decoding import read_json

    path = folder / "a.json"
    path.write_text(json.dumps({"a": [1, 2.5, "x", True], "b": {"c": None}}))
    return of_json(path, lambda: json.dumps(read_json(path, 1 << 20)).encode(), chance, most)


@row("settings")
def _settings(folder, chance, most):
    from eyas.engine.settings.config import EyasConfig
    from eyas.engine.settings.file import load_settings, save_settings

    path = folder / "config.json"
    save_settings(EyasConfig(), path)
    return of_json(path, lambda: load_settings(path), chance, most)


EXAMPLE = {
    "format": "eyas-plan-1", "name": "own", "size": [300.0, 300.0], "seed": 3,
    "roads": {
        "nodes": [{"name": "a", "x": -90, "y": 0}, {"name": "b", "x": 90, "y": 0}],
        "edges": [{"name": "ab", "start": "a", "end": "b", "lanes": 2, "lane_width": 3.5,
                   "speed": 13.9, "shape": [[0, 5]]}],
    },
    "library": [{"name": "bench"}],
    "layers": [{"layer": "things", "kinds": ["bench"], "kind": [0], "pose": [[1, 2, 0, 0, 1]]}],
    "survey": {"trees": [[1.0, 2.0, 8.0]], "lamps": [[3.0, 4.0]]},
}  # fmt: skip


@row("plan")
def _plan(folder, chance, most):
    from eyas.maps.commands.plan import named_file_problems
    from eyas.maps.plan.file import problems

    path = folder / "own.plan.json"
    path.write_text(json.dumps(EXAMPLE))

    def read() -> None:
        wrong = problems(path, named_file_problems)
        if wrong:
            raise EyasError(wrong[0])

    return of_json(path, read, chance, most)


@cache
def gzip_bomb() -> bytes:
    """Return zeros, packed once for all rows: that takes longer than to refuse them."""
    return gzip.compress(bytes(BOMB), 1)


@row("plan.gz")
def _plan_gz(folder, chance, most):
    from eyas.maps.plan import file

    limited(file)
    path = folder / "own.plan.json.gz"
    path.write_bytes(gzip.compress(json.dumps(EXAMPLE).encode()))
    return of_bytes(path, lambda: file.read_plan(path), chance, most, gzip_bomb)


@row("map.json")
def _map_json(folder, chance, most):
    from dataclasses import asdict

    from eyas.maps.files import Origin, origin_of

    path = folder / "map.json"
    origin = Origin("own", "Own", "own.osm", 8.5, 47.4, (300.0, 300.0), checksums={"a": "0" * 64})
    path.write_text(json.dumps(asdict(origin)))
    return of_json(path, lambda: origin_of(folder), chance, most)


NET = """<net version="1.20"><edge id="a" from="s" to="e"><lane id="a_0" index="0" speed="13.5"
width="3.2" shape="-50,0 50,0"/></edge><junction id="s" shape="0,0 1,0 1,1"/><junction id="e"
shape="9,0 9,1 8,1"/><connection from="a" to="a" fromLane="0" toLane="0" tl="t" linkIndex="0"
dir="s"/><tlLogic id="t" type="static" offset="5"><phase duration="30" state="G"/>
</tlLogic></net>"""


@row("roads")
def _roads(folder, chance, most):
    from eyas.engine.traffic.net_file import SumoNet, road_network
    from eyas.engine.traffic.signals import signal_plan
    from eyas.maps import files

    limited(files, "_LARGEST_ROADS")
    path = folder / "roads.net.xml"
    path.write_text(NET)

    def read() -> None:
        net = SumoNet(files.roads_in(path))
        road_network(net, "")
        signal_plan(net).at(np.array([0.0, 1.5, 1e4]))

    laughs = "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10 if k else "ha"}">' for k in range(12))
    bombs = (
        gzip_bomb,
        f"<?xml version='1.0'?><!DOCTYPE net [{laughs}]><net>&a11;</net>".encode(),
        b"<net>" + b"<edge>" * 300_000,
        *with_words(NET, ABSURD_WORDS),
    )
    return of_bytes(path, read, chance, most, *bombs)


@row("sumo net")
def _sumo_net(folder, chance, most):
    from eyas.maps import files
    from eyas.maps.sumo.files import moved, place_of

    path, head = folder / "x.net.xml", '<net version="1.20">'
    place = (
        f'{head}<location netOffset="1,2" convBoundary="-50,0,50,0" origBoundary="6.9,50.9,7,51"'
        ' projParameter="+proj=utm"/>'
    )
    path.write_text(NET.replace(head, place))

    def read() -> None:
        xml = files.roads_in(path)
        place_of(moved(xml, place_of(xml, "x").middle, "x"), "x")

    return of_bytes(path, read, chance, most, *with_words(NET, ABSURD_WORDS))


ROUTES = """<routes><vType id="v" vClass="bus"/><flow id="f" begin="0:10" end="7200" number="9"/>
<vehicle id="a" depart="3600"><route edges="a"/></vehicle><person id="p" depart="1"/></routes>"""


@row("sumo routes")
def _sumo_routes(folder, chance, most):
    from eyas.maps.sumo import files

    limited(files)
    path = folder / "x.rou.xml"
    path.write_text(ROUTES)
    asked = files.SumoFiles(path, (path,))
    bombs = gzip_bomb, *with_words(ROUTES, ABSURD_WORDS)
    return of_bytes(path, lambda: files.demand_of(asked, str), chance, most, *bombs)


@row("network")
def _network(folder, chance, most):
    from dataclasses import replace

    from eyas.engine.traffic.net_file import SumoNet, road_network
    from eyas.engine.world.roads import network_file
    from eyas.engine.world.roads.network_file import load_network, save_network
    from eyas.maps.commands.info import _lengths, street_lines

    limited(network_file)
    path = folder / "network.npz"
    network = road_network(SumoNet(NET.encode()), "0" * 64)
    save_network(path, network)

    def read() -> None:
        found = load_network(path)
        street_lines(found)
        _lengths(found)

    def spoilt() -> Iterator[bytes]:
        for name in ("lane_points", "lane_width", "lane_speed", "junction_points"):
            for value in (1e300, -1.7e308, np.inf, np.nan, 1e18):
                array = getattr(network, name).copy()
                array.flat[0] = value
                yield saved(replace(network, **{name: array}))
        for name in ("lane_first", "lane_edge", "lane_index", "junction_first"):
            for value in (2**30, -1, -(2**31)):
                array = getattr(network, name).copy()
                array.flat[-1] = value
                yield saved(replace(network, **{name: array}))
            yield saved(replace(network, **{name: getattr(network, name)[:-1]}))
            yield saved(replace(network, **{name: getattr(network, name).astype(np.float64)}))
        for name in ("edges", "edge_start", "junctions"):
            yield saved(replace(network, **{name: ()}))
            yield saved(replace(network, **{name: ("\0x",) * len(getattr(network, name))}))
        yield npz_bomb()

    def saved(other) -> bytes:
        beside = folder / "other.npz"
        save_network(beside, other)
        return beside.read_bytes()

    good = path.read_bytes()
    return of_bytes(path, read, chance, most, *spoilt(), good[:100])


@cache
def npz_bomb() -> bytes:
    """Return an npz whose array claims to be as large as it is."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        with archive.open("lane_points.npy", "w", force_zip64=True) as file:
            np.lib.format.write_array_header_1_0(
                file, {"descr": "<f8", "fortran_order": False, "shape": (BOMB >> 4, 2)}
            )
            for _ in range(BOMB >> 20):
                file.write(bytes(1 << 20))
    return buffer.getvalue()


OSM = """<osm version="0.6"><bounds minlat="48.1" minlon="11.5" maxlat="48.102" maxlon="11.503"/>
<node id="1" lat="48.1005" lon="11.501"/><node id="2" lat="48.1015" lon="11.502"/>
<node id="3" lat="48.1012" lon="11.5012"><tag k="natural" v="tree"/><tag k="height" v="12"/></node>
<way id="21"><nd ref="1"/><nd ref="2"/><tag k="highway" v="residential"/>
<tag k="lanes" v="2"/></way><way id="22"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="1"/>
<tag k="building" v="yes"/>
<tag k="height" v="9"/><tag k="building:levels" v="3"/></way></osm>"""


@row("osm")
def _osm(folder, chance, most):
    from eyas.engine.world.projection import Projection
    from eyas.maps.osm import reader
    from eyas.maps.osm.houses import houses_of
    from eyas.maps.osm.reader import covered, read_osm
    from eyas.maps.osm.rings import OsmShapes
    from eyas.maps.osm.streets import street_file

    limited(reader)
    path = folder / "town.osm"
    path.write_text(OSM)

    def read() -> None:
        import shapely

        data = read_osm(path)
        limits = covered(data, None, str(path))
        projection = Projection(round((limits[0] + limits[2]) / 2, 7), (limits[1] + limits[3]) / 2)
        street_file(data, limits, lambda key: None)
        extent = shapely.box(-200, -200, 200, 200)
        for house in houses_of(
            OsmShapes(data, projection, extent, lambda what: None), lambda key: None
        ):
            sizes = house.height, house.levels, house.roof_height
            assert all(size is None or 0 <= size <= 1000 for size in sizes), sizes

    bombs = (
        lambda: gzip.compress(b"<osm>" + b" " * BOMB, 1),
        lambda: gzip.compress(b"<osm><node id='1' lat='1' lon='1'>" + b"x" * BOMB, 1),
        b"<osm>" + b"<way>" * 100_000,
        *with_words(OSM, ABSURD_WORDS),
    )
    return of_bytes(path, read, chance, most, *bombs)


@row("pbf")
def _pbf(folder, chance, most):
    import osmium

    from eyas.maps.osm.reader import read_osm

    path = folder / "town.osm.pbf"
    source = folder / "source.osm"
    source.write_text(OSM.replace(" lon", " version='1' lon").replace("<way", "<way version='1'"))
    with osmium.SimpleWriter(str(path)) as writer:
        for thing in osmium.FileProcessor(str(source)):
            writer.add(thing)
    return of_bytes(path, lambda: read_osm(path), chance, most)


# Traffic, and targets of one's own.


@row("traffic")
def _traffic(folder, chance, most):
    from eyas.engine.traffic import recording_file
    from eyas.engine.traffic.config import TrafficConfig, VehicleType
    from eyas.engine.traffic.recording import Provenance, TrafficRecording
    from eyas.engine.traffic.recording_file import RecordingFile, load, save

    limited(recording_file)
    path = folder / "traffic.npz"
    position = np.rint(np.cumsum(np.ones((60, 2, 2)), axis=0) * 80) * 0.01
    origin = Provenance(
        map_name="own", map_seed=0, graph_hash="0" * 16, config=TrafficConfig(max_vehicles=2),
        duration=5.9, warm_up=60.0, options=("--x",), sumo_version="1", eyas_version="1",
    )  # fmt: skip
    save(
        TrafficRecording(10.0, position, np.zeros((60, 2)), np.ones((60, 2), np.bool_),
                  (VehicleType.PASSENGER,) * 2, np.full(2, 5.0), origin),
        path,
    )  # fmt: skip

    def read() -> None:
        RecordingFile.read(path).outline()
        load(path)

    return of_bytes(path, read, chance, most, npz_bomb)


TRACK = "t,x,y,z,yaw\n0,0,0,0,0\n1,1,0,0.5,0.1\n2,2,1,0,0.2\n3,3,1,0,0.1\n"


@row("trajectory")
def _trajectory(folder, chance, most):
    from eyas.engine.custom.problems import of_noise, of_trajectory, worst
    from eyas.engine.custom.smoothing import smoothed
    from eyas.engine.custom.trajectory import read_trajectory

    path = folder / "track.csv"
    path.write_text(TRACK)

    def read() -> None:
        trajectory = read_trajectory(path)
        problem = worst(of_trajectory(trajectory, (900.0, 900.0), "citystreet"))
        list(of_noise(trajectory))
        if problem:
            raise EyasError(f"{path}: {problem}")
        trajectory.at(np.arange(int(10 * trajectory.time[-1]) + 1) / 10.0)
        smoothed(trajectory, 1.0)

    return of_bytes(path, read, chance, most, *with_words(TRACK, ABSURD_WORDS))


VEHICLES = "track_id,timestamp_ms,agent_type,x,y,psi_rad,length,width\n" + "".join(
    f"{car},{100 * k},car,{8 * car + k},{car},0.1,4.5,1.8\n" for car in (1, 2) for k in range(5)
)


@row("vehicle table")
def _vehicle_table(folder, chance, most):
    from eyas.engine.world.maps import MAPS
    from eyas.maps.traffic import tables
    from eyas.maps.traffic.tracks_traffic import Put, traffic_of

    limited(tables)
    path, graph = folder / "tracks.csv", MAPS.get("citystreet").roads(0)
    path.write_text(VEHICLES)

    def read() -> None:
        tables.form_of(path)
        traffic_of(tables.read_tracks(path), graph, Put(), path)

    return of_bytes(path, read, chance, most, *with_words(VEHICLES, ABSURD_WORDS))


@row("chat file")
def _chat_file(folder, chance, most):
    from eyas.benchmark.policies.chat_agent import open_agent

    path = folder / "agent.json"
    path.write_text('{"url": "http://localhost:1/v1", "model": "m", "rate": 1, "size": [64, 48]}')
    return of_json(path, lambda: open_agent(path, {}), chance, most)


@row("robot policy")
def _robot_policy(folder, chance, most):
    from eyas.benchmark.policies.local_model import _refuse_classes

    path = folder / "policy_preprocessor.json"
    path.write_text('{"name": "a", "steps": [{"registry_name": "b", "config": {"features": {}}}]}')
    return of_json(path, lambda: _refuse_classes(path), chance, most)


@row("chat reply")
def _chat_reply(folder, chance, most):
    from eyas.benchmark.policies.chat_agent import answer_in, text_of

    path = folder / "reply.json"
    said = {"role": "assistant", "content": 'So: {"waypoints": [[1, 2], [3, 4, 0.5]], "step": 1}'}
    path.write_text(json.dumps({"choices": [{"message": said}]}))

    def read() -> None:
        try:
            answer_in(text_of(path.read_bytes(), "http://localhost"), 0.5, (64, 48))
        except ConnectionError as error:
            raise EyasError(str(error)) from None

    return of_json(path, read, chance, most)


@row("vehicle columns")
def _vehicle_columns(folder, chance, most):
    from eyas.maps.traffic.tables import read_columns

    path = folder / "columns.json"
    path.write_text('{"id": "who", "time": "t", "x": "x", "y": "y", "classes": {"VAN": "car"}}')
    return of_json(path, lambda: read_columns(path), chance, most)


TRACKS = {
    "a.gpx": "<gpx><trk><trkseg>"
    + "".join(
        f"<trkpt lat='51.{k}' lon='0.1'><ele>5</ele><time>2026-05-01T10:00:0{k}Z</time></trkpt>"
        for k in range(3)
    )
    + "</trkseg></trk></gpx>",
    "a.kml": "<kml><Track><when>2026-05-01T10:00:01Z</when><when>2026-05-01T10:00:02Z</when>"
    "<coord>0.1 51.5 3</coord><coord>0.2 51.5 3</coord></Track></kml>",
    "a.kmz": "",
    "a.geojson": '{"type": "LineString", "coordinates": [[0.1, 51.5, 3], [0.2, 51.5], [0.3, 51]]}',
    "a.plan": '{"mission": {"items": [{"command": 16, "params": [0, 0, 0, 0, 51.5, 0.1, 9]}, '
    '{"command": 16, "params": [0, 0, 0, 0, 51.6, 0.1, 9]}]}}',
    "a.waypoints": "QGC WPL 110\n0 1 0 16 0 0 0 0 1 2 3 1\n1 0 3 16 0 0 0 0 51 0.1 9 1\n"
    "2 0 3 16 0 0 0 0 52 0.1 9 1\n",
    "a.tum": "1 2 3 4 0 0 0 1\n2 2 4 4 0 0 0 1\n3 2 5 4 0 0 0 1\n",
}


def _of_tracks(name: str, content: bytes):
    def make(folder, chance, most):
        from eyas.engine.custom.tracks import Placement, on_map

        path = folder / name
        path.write_bytes(content)

        def read() -> None:
            for _, each in on_map([path], Placement("here", None, (0.0, 0.0, 0.5), 2.0)):
                each.at(np.linspace(0.0, each.time[-1], 50))

        bombs: list[Any] = [gzip_bomb]
        if name in TRACKS:
            bombs += with_words(TRACKS[name], ABSURD_WORDS)
        if name == "a.kmz":
            bombs = [lambda: zipped(b"doc.kml", bytes(BOMB))]
        return of_bytes(path, read, chance, most, *bombs)

    return make


def zipped(name: bytes, content: bytes) -> bytes:
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as file:
        file.writestr(name.decode(), content)
    return archive.getvalue()


def _add_tracks() -> None:
    sys.path.insert(0, str(Path(__file__).parents[1] / "kit"))
    from flight_logs import ardupilot_flight, px4_flight, telemetry

    made = {name: text.encode() for name, text in TRACKS.items()}
    made["a.kmz"] = zipped(b"doc.kml", made["a.kml"])
    made |= {"a.ulg": px4_flight(), "a.bin": ardupilot_flight(), "a.tlog": telemetry()}
    ROWS.update({name: _of_tracks(name, content) for name, content in made.items()})


_add_tracks()

OBJ = """mtllib a.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 0 1
vt 0 0
usemtl red
f 1/1 2/1 3/1
f 1 2 4
f -1 -2 -3
"""


def of_mesh(folder, name, content, chance, most, *bombs):
    from eyas.engine.custom.config import CustomConfig
    from eyas.engine.custom.kind import own_target

    path = folder / name
    path.write_bytes(content)
    return of_bytes(path, lambda: own_target(CustomConfig(mesh=str(path))), chance, most, *bombs)


@row("obj")
def _obj(folder, chance, most):
    (folder / "a.mtl").write_text("newmtl red\nKd 1 0 0\nmap_Kd /dev/zero\n")
    words = with_words(OBJ, ABSURD_WORDS)
    return of_mesh(folder, "box.obj", OBJ.encode(), chance, most, b"mtllib /dev/zero\n", *words)


def _export(ending: str) -> Make:
    def make(folder, chance, most):
        import trimesh

        content = trimesh.creation.box((1.0, 2.0, 0.5)).export(file_type=ending)
        return of_mesh(folder, f"box.{ending}", content, chance, most)

    return make


ROWS.update({ending: _export(ending) for ending in ("stl", "ply", "glb")})


@row("gltf")
def _gltf(folder, chance, most):
    import base64

    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32).tobytes()
    data = points + np.array([0, 1, 2, 0, 1, 3], np.uint16).tobytes()
    header = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [1, 1, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR",
             "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123},
                        "values": {"bufferView": 1}}},
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
                        {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": 60, "uri": "data:;base64," + base64.b64encode(data).decode()}],
    }  # fmt: skip
    row = of_mesh(folder, "box.gltf", json.dumps(header).encode(), chance, most)
    return of_json(row.path, row.read, chance, most)


PROTO = """#VRML_SIM R2023b utf8
EXTERNPROTO "Leg.proto"
PROTO Cart [ field SFVec3f translation 0 0 0.4 field SFFloat high 0.5 field MFNode load [] ]
{ Robot { translation IS translation children [
 DEF BODY Shape { appearance PBRAppearance { baseColor 1 0.5 0 } geometry Box { size 2 1 0.5 } }
 Pose { rotation 1 0 0 1.57 scale 1 1 2 children [ USE BODY Leg { length 2 } ] }
 Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] }
 coordIndex [ 0 1 2 -1 ] } } Group { children IS load } ] } }
"""


@row("proto")
def _proto(folder, chance, most):
    leg = "PROTO Leg [ field SFFloat length 1 ]\n{ Shape { geometry Cone { height IS length } } }"
    (folder / "Leg.proto").write_text(leg)
    words = with_words(PROTO, ABSURD_WORDS)
    deep = ("PROTO a []{" + "Group{children[" * 5000).encode()
    return of_mesh(folder, "cart.proto", PROTO.encode(), chance, most, deep, *words)


SCRIPTS = {
    "javascript": """const a = [1, 2.5]; let s = '';
for (let i = 0; i < 3; ++i) { a.push(i * a[0] + Math.sin(i)); s += `${i}` + fields.name.value; }
function f(x, y) { return x > y ? x : f(y, x) ** 2; }
const o = {x: 1, 'y': [2]}; while (o.x < 3) { o.x += 1; if (a.length > 9) break; }""",
    "lua": """local a, s = {1, 2.5}, ''
for i = 1, 3 do table.insert(a, i * a[1] + math.sin(i)) s = s .. i .. fields.name.value end
local function f(x, y) if x > y then return x end return f(y, x) ^ 2 end
for w in ('a b'):gmatch('%w+') do s = s .. w end
local o = {x = 1, [2] = 3} while o.x < 3 do o.x = o.x + 1 if #a > 9 then break end end""",
}
BUSY = ("while (true) { s += s; }", "let z = [1]; for (;;) z = z.concat(z);", "a[1e9] = 1; s.x.y;",
        "while true do s = s .. s end", "while true do table.insert(a, 1, s:rep(9)) end",
        "f(f, f)", "(" * 5000, "[" * 5000, "1 + " * 5000, "/*" * 5000, "'" * 5001,
        "{" * 5000)  # fmt: skip


def _template(language: str) -> Make:
    def make(folder, chance, most):
        text = (
            f'# template language: {language}\nPROTO T [ field SFString name "t" ] {{\n'
            f"%<\n{SCRIPTS[language]}\n>% Shape {{ geometry Box {{ size 1 %<= f(1, 2) >% 1 }} }} }}"
        )
        bombs = (text.replace("\n>%", f"\n{busy} >%").encode() for busy in BUSY)
        words = with_words(text, ABSURD_WORDS)
        return of_mesh(folder, f"{language}.proto", text.encode(), chance, most, *bombs, *words)

    return make


ROWS.update({f"proto in {language}": _template(language) for language in SCRIPTS})

URDF = """<?xml version="1.0"?>
<robot name="r"><material name="red"><color rgba="1 0 0 1"/></material>
<link name="a"><visual><origin xyz="0 0 1" rpy="0 0.5 0"/><geometry><box size="1 2 0.5"/></geometry>
<material name="red"/></visual></link>
<link name="b"><visual><geometry><cylinder radius="0.2" length="0.4"/></geometry></visual>
<visual><geometry><mesh filename="package://r/m.stl" scale="1 1 2"/></geometry></visual></link>
<joint name="j" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0 1 0"/></joint>
</robot>
"""
XML_BOMB = b"""<?xml version="1.0"?><!DOCTYPE r [<!ENTITY a "aaaaaaaaaa">
<!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">]><robot>&c;</robot>"""


@row("urdf")
def _urdf(folder, chance, most):
    import trimesh

    (folder / "m.stl").write_bytes(trimesh.creation.box((0.1, 0.2, 0.3)).export(file_type="stl"))
    loop = URDF.replace("</robot>", "") + (
        '<joint name="k"><parent link="b"/><child link="a"/></joint><link name="c"/></robot>'
    )
    many = "<joint><parent link='a'/><child link='b'/></joint>" * 5000 + "</robot>"
    bombs = (XML_BOMB, loop.encode(), URDF.replace("</robot>", many).encode(), b"<r>" * 100_000)
    words = with_words(URDF, ABSURD_WORDS)
    return of_mesh(folder, "r.urdf", URDF.encode(), chance, most, *bombs, *words)


@row("dae")
def _dae(folder, chance, most):
    import trimesh

    content = trimesh.creation.box((1.0, 2.0, 0.5)).export(file_type="dae").decode()
    nodes = "".join(
        f'<node id="n{k}">' + 8 * f'<instance_node url="#n{k + 1}"/>' + "</node>" for k in range(30)
    )
    scene = "<library_visual_scenes>"
    bombs = (
        XML_BOMB,
        content.replace(scene, f"<library_nodes>{nodes}</library_nodes>{scene}").replace(
            "</visual_scene>", '<node><instance_node url="#n0"/></node></visual_scene>'
        ).encode(),
        content.replace("<node ", "<node><node>" * 400 + "<node ", 1).encode(),
    )  # fmt: skip
    words = with_words(content, ABSURD_WORDS)
    return of_mesh(folder, "box.dae", content.encode(), chance, most, *bombs, *words)


@row("draco")
def _draco(folder, chance, most):
    import DracoPy
    import trimesh

    box = trimesh.creation.box((1.0, 2.0, 0.5))
    packed = DracoPy.encode(box.vertices, box.faces)
    names = {"POSITION": DracoPy.decode(packed).attributes[0]["unique_id"]}
    extension = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": names}}
    header = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "extensionsRequired": [*extension], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1,
                                    "extensions": extension}]}],
        "accessors": [{"componentType": 5126, "count": 8, "type": "VEC3"},
                      {"componentType": 5125, "count": 36, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(packed)}],
        "buffers": [{"byteLength": len(packed), "uri": "box.bin"}],
    }  # fmt: skip
    huge = packed[:12] + b"\xff\xff\xff\xff\x0f" * 2 + packed[14:]
    (folder / "box.gltf").write_text(json.dumps(header))
    (folder / "box.bin").write_bytes(packed)
    row = of_mesh(folder, "box.gltf", json.dumps(header).encode(), chance, most)
    return of_bytes(folder / "box.bin", row.read, chance, most, huge)


@row("meshopt")
def _meshopt(folder, chance, most):
    sys.path.insert(0, str(Path(__file__).parents[1] / "engine" / "custom"))
    import base64

    from test_meshopt import POINTS, TRIANGLES, gltf

    header = gltf()
    contents = [base64.b64decode(text) for text in (POINTS, TRIANGLES)]
    for k, content in enumerate(contents):
        header["buffers"][k]["uri"] = "packed.bin"
        header["bufferViews"][k]["extensions"]["EXT_meshopt_compression"]["byteOffset"] = k * len(
            contents[0]
        )
        header["buffers"][k]["byteLength"] = len(content)
    (folder / "packed.bin").write_bytes(b"".join(contents))
    row = of_mesh(folder, "a.gltf", json.dumps(header).encode(), chance, most)
    return of_bytes(folder / "packed.bin", row.read, chance, most)


# Policies, latencies, logs of flights.


@row("latencies")
def _latencies(folder, chance, most):
    from eyas.benchmark.plan.latency import delay_from

    path = folder / "latency.txt"
    path.write_text("12.5\n30\n44\n")
    words = with_words(path.read_text(), ABSURD_WORDS)
    return of_bytes(path, lambda: delay_from(str(path)), chance, most, *words)


@row("drone log")
def _drone_log(folder, chance, most):
    from eyas.robotics.fitting.log import read_log

    path = folder / "flight.csv"
    names = ["time", *(f"velocity_{axis}" for axis in "xyz")]
    names += [*(f"orientation_{axis}" for axis in "wxyz"), *(f"rotor_{k}" for k in range(1, 5))]
    rows = (f"{0.01 * k:.2f},1,0,0,1,0,0,0,5,5,5,5" for k in range(220))
    path.write_text("\n".join([",".join(names), *rows]))
    words = with_words(path.read_text(), ABSURD_WORDS)
    return of_bytes(path, lambda: read_log(path), chance, most, *words)


@row("policy messages")
def _messages(folder, chance, most):
    from eyas.benchmark.policies.sandbox import receive, send

    path, stream = folder / "message", io.BytesIO()
    send(stream, {"a": 1}, [np.zeros((3, 4), np.float32)])
    path.write_bytes(stream.getvalue())

    def read() -> None:
        try:
            receive(io.BytesIO(path.read_bytes()))
        except (EOFError, ValueError) as error:  # what its caller expects
            raise EyasError(str(error)) from None

    huge = json.dumps({"arrays": [["<f8", [10**9, 10**9]]]}).encode()
    deep = b"[" * 100_000
    framed = [len(text).to_bytes(4, "little") + text for text in (huge, deep, b"[1]", b'{"a":1}')]
    return of_bytes(path, read, chance, most, b"\xff" * 8, *framed)


@row("onnx")
def _onnx(folder, chance, most):
    from eyas.benchmark.policies import trained
    from eyas.benchmark.policies.onnx import load_onnx

    path = folder / "fast.onnx"
    shutil.copy(Path(trained.__path__[0]) / "fast.onnx", path)
    return of_bytes(path, lambda: load_onnx(path, {}, sampled=False), chance, most // 2)


# Evaluations.


RECORD = {
    "name": "a", "map": "citystreet", "weather": "day", "target": "SUMO_VEHICLE", "direction": 0.5,
    "seed": 3, "reason": "time", "duration": 90.0, "cr": 100.5, "tsr": 0.5, "seen": 0.5,
    "visible": 0.5, "clear": 0.9, "found_after": 0.0, "lost_after": None, "watched": 90.0,
    "losses": 1, "found_again": 1, "search_time": 0.5, "crashed": False, "centre_error": 0.1,
    "path": 100.0, "height": 20.0, "jerk": 1.0, "figures": {"own": 0.5},
    "published": {"actions": 5, "cr": 3.0, "tsr": 0.5},
    "trace": {"reward": [0.5], "drone": [[0.0, 1.0]], "target": [[0.0, 2.0]]},
}  # fmt: skip


@row("records")
def _records(folder, chance, most):
    from eyas.benchmark.protocols.table import PROTOCOLS, protocol_named
    from eyas.benchmark.records.record import read_records
    from eyas.benchmark.records.result import table
    from eyas.benchmark.statistics.table_rows import rows_of

    path = folder / "episodes.jsonl"
    path.write_text(json.dumps(RECORD))
    name = PROTOCOLS.built_in[0]

    def read() -> None:
        path.write_bytes(path.read_bytes().replace(b"\n", b" ") + b"\n")
        records = read_records(path)
        if records:
            table(rows_of(records, protocol_named(name)), name).encode()

    return of_json(path, read, chance, most)


@row("flights")
def _flights(folder, chance, most):
    from eyas.benchmark.policies.person import RecordedPeople
    from eyas.engine.policies.policy import Start

    path, whole = folder / "line.json", folder / "people.flights"
    first = b'{"env": {"actions": "velocity"}}\n'
    begun = b'{"attempt": 1, "episode": "a", "pilot": "1", "device": "touch"}\n'
    actions = [[3, [20.0, 0.0, 0.0, 0.5]], [1, [0.0, 0.0, 0.0, 0.0]]]
    path.write_text(json.dumps({"attempt": 1, "actions": actions, "left": "", "pace": 1.0}))

    def read() -> None:
        whole.write_bytes(first + begun + path.read_bytes().replace(b"\n", b" ") + b"\n")
        people = RecordedPeople(whole, {})
        people.choose(["a"])
        people.begin(Start(np.zeros(1, np.int64), lambda: np.zeros((1, 4), np.int32)))

    return of_json(path, read, chance, most)


@row("stamp")
def _stamp(folder, chance, most):
    from eyas.benchmark.plan.plan import EvaluationPlan, stamp
    from eyas.benchmark.records.result import STAMP, load_run

    path = folder / STAMP
    path.write_text(stamp(EvaluationPlan(policy="hover")).model_dump_json())
    return of_json(path, lambda: load_run(folder)[0].model_dump_json().encode(), chance, most)


@row("card")
def _card(folder, chance, most):
    from eyas.benchmark.report.leaderboard.submission import CARD, read_card

    path = folder / CARD
    path.write_text(json.dumps({"name": "x", "authors": ["y"], "link": "https://a.b/c"}))
    return of_json(path, lambda: read_card(folder).model_dump_json().encode(), chance, most)


@row("entry")
def _entry(folder, chance, most):
    from eyas.benchmark.report.leaderboard import pack
    from eyas.benchmark.report.leaderboard.submission import read_card

    limited(pack, "_UNPACKED")
    path = folder / "entry.zip"

    def zipped(size: int) -> bytes:
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            archive.writestr("card.json", json.dumps({"name": "x"}))
            with archive.open("mine.onnx", "w", force_zip64=True) as file:
                for _ in range(size >> 10):
                    file.write(bytes(1 << 10))
        return buffer.getvalue()

    def read() -> None:
        with pack.unpacked(path) as entry:
            read_card(entry)

    path.write_bytes(zipped(1 << 12))
    return of_bytes(path, read, chance, most, lambda: zipped(BOMB))


@row("mark")
def _mark(folder, chance, most):
    from eyas.benchmark.report.leaderboard.mark import MARK, fitting_mark

    path = folder / MARK
    path.write_text(json.dumps({"build": "b", "seed": 1, "flown": ["a"], "episodes": 2,
                                "content": "c", "signature": "s"}))  # fmt: skip
    return of_json(path, lambda: fitting_mark(folder), chance, most, refuses=False)


@row("submission")
def _submission(folder, chance, most):
    from eyas.benchmark.report.leaderboard.submission import _text_in

    path = folder / "timing.json"
    path.write_text(json.dumps({"machine": "a fast one", "mean_ms": 3.5}))
    return of_json(path, lambda: _text_in(path, "machine").encode(), chance, most, refuses=False)


# Recordings and data sets.


def recorded(folder: Path) -> Path:
    """Return a copy of a recording of two frames, which is made once."""
    from eyas.engine.camera.config import CameraConfig
    from eyas.engine.settings.config import EyasConfig
    from eyas.engine.video.run import run
    from eyas.engine.world.config import WorldConfig

    made = folder.parent / "recorded"
    if not made.exists():
        writers = ("jpeg", "labels", "masks", "depth", "arrays", "flow")
        config = EyasConfig(
            world=WorldConfig(map="simpleway-grass"), camera=CameraConfig(width=48, height=32)
        )
        video = config.video.model_copy(
            update={"channels": 1, "fps": 10.0, "total_time": 0.1, "writers": writers}
        )
        run(config.model_copy(update={"video": video}), made, quiet=True)
    return shutil.copytree(made, folder / "run")


def of_frame(folder, name: str, pattern: str, *bombs: Callable[[bytes], bytes]) -> Any:
    run = recorded(folder)
    path = sorted(run.glob(pattern))[0]
    content = path.read_bytes()
    frame = eyas.load(run)[0][0]
    return path, getattr(frame, name), [bomb(content) for bomb in bombs]


@cache
def deflated_zeros() -> bytes:
    return zlib.compress(bytes(BOMB), 1)


def png_bomb(content: bytes) -> bytes:
    """Return a PNG of the same size in its header, whose data unpack to much."""
    data = deflated_zeros()
    check = zlib.crc32(b"IDAT" + data).to_bytes(4, "big")
    return content[:33] + len(data).to_bytes(4, "big") + b"IDAT" + data + check + content[-12:]


def png_of_giants(content: bytes) -> bytes:
    """Return a PNG that claims to have 50,000 x 50,000 pixels."""
    head = content[12:16] + (50_000).to_bytes(4, "big") * 2 + content[24:29]
    return content[:12] + head + zlib.crc32(head).to_bytes(4, "big") + content[33:]


@row("mask")
def _mask(folder, chance, most):
    path, read, bombs = of_frame(folder, "masks", "*/*/masks/*.png", png_bomb, png_of_giants)
    return of_bytes(path, read, chance, most, *bombs)


@row("depth")
def _depth(folder, chance, most):
    path, read, bombs = of_frame(folder, "depth", "*/*/depth/*.png", png_bomb, png_of_giants)
    return of_bytes(path, read, chance, most, *bombs)


@row("picture")
def _picture(folder, chance, most):
    path, read, _ = of_frame(folder, "picture", "*/*/*.jpeg")
    return of_bytes(path, read, chance, most)


@row("flow")
def _flow(folder, chance, most):
    path, read, bombs = of_frame(folder, "flow", "*/*/flow/*.png", png_bomb, png_of_giants)
    return of_bytes(path, read, chance, most, *bombs)


@row("arrays")
def _arrays(folder, chance, most):
    from eyas.engine.recordings import recording

    path, read, _ = of_frame(folder, "arrays", "*/*/arrays/*.npz")
    limited(recording)
    return of_bytes(path, read, chance, most, npz_bomb())


@row("labels")
def _labels(folder, chance, most):
    run = recorded(folder)
    path = sorted(run.glob("*/*/labels.jsonl"))[0]
    rest = path.read_bytes().partition(b"\n")[2]
    path.write_bytes(path.read_bytes().partition(b"\n")[0])

    def read() -> None:
        whole = path.read_bytes().replace(b"\n", b" ") + b"\n" + rest
        path.write_bytes(whole)
        for frame in eyas.load(run)[0]:
            frame.picture()
            frame.masks()

    return of_json(path, read, chance, most)


@row("checksums")
def _checksums(folder, chance, most):
    run = recorded(folder)
    path = run / "checksums.sha256"
    row = of_bytes(path, lambda: len(eyas.load(run)[0]), chance, most)
    return row._replace(refuses=False)


@row("export")
def _exported(folder, chance, most):
    from eyas.engine.recordings.export import ExportOptions, export

    data = eyas.load(recorded(folder))
    out = folder / "otb"
    export(data, "otb", out, ExportOptions())
    path = out / "export.json"
    good = path.read_bytes()

    def read() -> None:
        try:
            export(data, "otb", out, ExportOptions(resume=True))
        finally:
            path.write_bytes(good)

    return of_json(path, read, chance, min(most, 20))


@row("dataset")
def _dataset(folder, chance, most):
    path = folder / "dataset.json"
    part = recorded(folder)
    (folder / "parts" / "train").mkdir(parents=True)
    part.rename(folder / "parts" / "train" / "first")
    path.write_text(json.dumps({"parts": [{"split": "train", "name": "first"}]}))
    return of_json(path, lambda: len(eyas.load(folder)), chance, most)


@row("dataset plan")
def _dataset_plan(folder, chance, most):
    from eyas.datasets.layout import MAKING_FILE, Plan, read_plan, write_plan
    from eyas.datasets.recipe import read_recipe

    write_plan(folder, Plan.of(read_recipe("sot"), "sot", sample=False, shard=None))
    path = folder / MAKING_FILE
    return of_json(path, lambda: read_plan(path).parts(), chance, most)


@row("boxes")
def _boxes(folder, chance, most):
    from eyas.datasets.tracking.clip import RecordedClip
    from eyas.datasets.tracking.run import _boxes_file, _scored

    episode = RecordedClip(eyas.load(recorded(folder))[0])
    path = _boxes_file(folder, episode)
    path.parent.mkdir(parents=True, exist_ok=True)
    text = "# failures 0\n" + "1,2,3,4,1\n" * len(episode)
    path.write_text(text)
    return of_bytes(
        path, lambda: _scored(folder, episode), chance, most, *with_words(text, ABSURD_WORDS)
    )


@row("any picture")
def _any_picture(folder, chance, most):
    from PIL import Image

    from eyas.engine.core.decoding import any_picture

    path = folder / "0001.png"
    Image.fromarray(np.zeros((16, 24, 3), np.uint8)).save(path)
    content = path.read_bytes()
    bombs = [png_bomb(content), png_of_giants(content)]
    return of_bytes(path, lambda: any_picture(path, 1 << 24), chance, most, *bombs)


SEQUENCES = ("1,2,3,4\n" * 3, "1,7,1,2,3,4,1,1,0.5\n2,7,1,2,3,4,1,1,1\n", "m1,2,3,2,1,4\n1\n0\n")


@row("sequence")
def _sequence(folder, chance, most):
    from eyas.datasets.tracking import sequences

    path = folder / "groundtruth.txt"
    path.write_text(SEQUENCES[0])
    (folder / "cover.label").write_text("8\n8\n1\n")
    sequences._SHORTEST = 1
    bombs = [each for text in SEQUENCES for each in with_words(text, ABSURD_WORDS)]
    bombs += [text.encode() for text in SEQUENCES]

    def read() -> None:
        for truth in sequences.read_truth(path):
            clip = sequences.PictureSequence("a", [path] * 3, truth)
            clip.strata(), clip.visible.any()
        sequences._column(path, 3)

    path.write_text("1\n0\n1\n")
    return of_bytes(path, read, chance, most, *bombs)


@row("sequence facts")
def _sequence_facts(folder, chance, most):
    from eyas.datasets.tracking import sequences

    path = folder / "seqinfo.ini"
    path.write_text("[Sequence]\nframeRate=30\nimDir=img1\n")
    listed = "'name','a','path','.\\data_seq\\UAV123\\a\\','startFrame',1,'endFrame',9\n"

    def read() -> None:
        content = path.read_bytes()
        (folder / "sequence").write_bytes(content)
        sequences._rate_of(folder)
        (folder / "configSeqs.m").write_bytes(listed.encode() + content)
        sequences._uav123_parts([folder / "configSeqs.m"])

    return of_bytes(path, read, chance, most, listed.encode(), b"fps=1e999", refuses=False)


CALIBRATION = (
    "image_width: 640\nimage_height: 480\n"
    "k:\n- 500.0\n- 0\n- 320\n- 0\n- 500\n- 240\n- 0\n- 0\n- 1\n"
    "d: [0.1, 0.2, 0.0, 0.0, 0.1]\n"
)


@row("calibration")
def _calibration(folder, chance, most):
    from eyas.engine.camera.calibration import read_calibration
    from eyas.engine.camera.config import CameraConfig
    from eyas.engine.core.config import validated

    path = folder / "camera.yaml"
    path.write_text(CALIBRATION)

    def read() -> None:
        validated(CameraConfig, read_calibration(path)[0], "camera")

    slow = b"camera_matrix: " * 20000 + b"k:" + b" -1" * 20000
    bombs = with_words(CALIBRATION, ABSURD_WORDS)
    return of_bytes(path, read, chance, most, slow, *bombs)


@row("film")
def _film(folder, chance, most):
    import av

    from eyas.datasets.tracking.sequences import sequences_in

    path = folder / "a.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=10)
        stream.width, stream.height = 64, 48
        for _ in range(4):
            frame = av.VideoFrame.from_ndarray(np.zeros((48, 64, 3), np.uint8))
            container.mux(stream.encode(frame))
        container.mux(stream.encode())

    def read() -> None:
        for each in sequences_in(path, box=(1.0, 2.0, 3.0, 4.0)):
            for _ in each.pictures():
                pass

    return of_bytes(path, read, chance, most)


@row("checkpoint")
def _checkpoint(folder, chance, most):
    import torch

    from eyas.learning.checkpoint import RunFolder, TrainingProgress

    network = torch.nn.Linear(3, 2)
    optimiser = torch.optim.Adam(network.parameters())
    files = RunFolder(folder)
    files.save(TrainingProgress(rows=[{"step": 1}]), network, optimiser)
    path = next(folder.glob("*.pt"))
    return of_bytes(path, lambda: files.load(network, optimiser), chance, most // 2)


# The run.


class _TooLongError(BaseException):
    """Not an `Exception`, which a reader might catch."""


def _too_long(number: int, frame: object) -> None:
    raise _TooLongError


def tried(name: str, folder: Path, most: int, seed: int) -> dict[str, Any]:
    """Return the report about a row."""
    folder.mkdir(parents=True)
    chance = random.Random(f"{name} {seed}")
    begun = time.process_time()
    made = ROWS[name](folder, chance, most)
    made.read()
    faults, count, refused = [], 0, 0
    for content in made.contents:
        count += 1
        made.path.write_bytes(content)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        try:
            made.read()
        except EyasError as error:
            refused += 1
            line = str(error)
            if "\n" in line or len(line) > 1500:
                faults.append(f"{content[:60]!r}: a line of {len(line)} characters: {line[:200]!r}")
        except _TooLongError:
            faults.append(f"{content[:60]!r}: more than {SECONDS} s")
        except Exception as error:
            kept = folder / f"fault-{count}"
            kept.write_bytes(content)
            faults.append(f"{content[:60]!r}: {error!r:.300} ({kept})")
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        if grown > MEMORY >> 10:
            faults.append(f"{content[:60]!r}: {grown >> 10} MiB")
    spent = time.process_time() - begun
    return {"tried": count, "refused": refused, "refuses": made.refuses, "faults": faults,
            "seconds": round(spent, 2)}  # fmt: skip


def main(folder: str, most: str, seed: str, *names: str) -> None:
    warnings.simplefilter("error")
    logging.getLogger("eyas").setLevel(logging.CRITICAL)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (12 << 30, 12 << 30))
    signal.signal(signal.SIGPROF, _too_long)
    report = {}
    for name in names or ROWS:
        try:
            report[name] = tried(name, Path(folder, name.replace(" ", "-")), int(most), int(seed))
        except ImportError as error:
            report[name] = {"missing": str(error)}
    print(json.dumps(report))


if __name__ == "__main__":
    main(*sys.argv[1:])
