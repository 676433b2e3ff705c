"""Tracks in the files that receivers, odometry and flight controllers write, put on a map."""

import io
import json
import math
import re
import zipfile
from functools import partial

import numpy as np
import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.custom.tracks import Placement, on_map, tracks_in
from eyas.engine.world.projection import Projection
from tests.kit.flight_logs import ardupilot_flight, px4_flight, telemetry

LONDON = Projection(-0.1, 51.5)

NORTH = [(51.5 + 9e-5 * k, -0.1) for k in range(5)]
"""Points about 10 m apart, to the north."""


def trackpoints(seconds=True):
    times = (f"<time>2026-05-01T10:00:{k:02d}Z</time>" if seconds else "" for k in range(5))
    return "".join(
        f'<trkpt lat="{lat}" lon="{lon}"><ele>12.5</ele>{time}</trkpt>'
        for (lat, lon), time in zip(NORTH, times, strict=True)
    )


def gpx(inside):
    space = "http://www.topografix.com/GPX/1/1"
    return f'<?xml version="1.0"?><gpx version="1.1" xmlns="{space}">{inside}</gpx>'


WHEN = "".join(f"<when>2026-05-01T10:00:0{k}Z</when>" for k in range(5))
COORD = "".join(f"<gx:coord>{lon} {lat} 12</gx:coord>" for lat, lon in NORTH)
LINE = " ".join(f"{lon},{lat},12" for lat, lon in NORTH)
KML = (
    '<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2">'
    "<Document><Placemark>{}</Placemark></Document></kml>"
)


def kmz():
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("doc.kml", KML.format(f"<gx:Track>{WHEN}{COORD}</gx:Track>"))
    return content.getvalue()


def geojson():
    line = {"type": "LineString", "coordinates": [[lon, lat, 12.0] for lat, lon in NORTH]}
    times = [f"2026-05-01T10:00:0{k}Z" for k in range(5)]
    feature = {"type": "Feature", "properties": {"coordTimes": times}, "geometry": line}
    return json.dumps({"type": "FeatureCollection", "features": [feature]})


def plan():
    items = [
        {"type": "SimpleItem", "command": 16, "params": [0, 0, 0, None, lat, lon, 30]}
        for lat, lon in NORTH
    ]
    speed = {"type": "SimpleItem", "command": 178, "params": [1, 5, -1, 0, 0, 0, 0]}
    mission = {"items": [items[0], speed, *items[1:]], "cruiseSpeed": 15}
    return json.dumps({"fileType": "Plan", "mission": mission})


def waypoints():
    head = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t51.4\t-0.2\t9\t1\n"
    rows = (
        f"{k + 1}\t0\t3\t16\t0\t0\t0\t0\t{lat:.7f}\t{lon:.7f}\t30\t1\n"
        for k, (lat, lon) in enumerate(NORTH)
    )
    return head + "1\t0\t3\t178\t0\t5\t0\t0\t0\t0\t0\t1\n" + "".join(rows)


TIMED = {
    "a.gpx": gpx(f"<trk><trkseg>{trackpoints()}</trkseg></trk>"),
    "a.kml": KML.format(f"<gx:Track>{WHEN}{COORD}</gx:Track>"),
    "a.kmz": kmz(),
    "a.geojson": geojson(),
    "comma.csv": "time,lat,lon\n" + "".join(f"{k},{a},{b}\n" for k, (a, b) in enumerate(NORTH)),
    "stamp.csv": '"Timestamp";"Latitude";"Longitude";note\n'
    + "".join(
        f"2026-05-01 10:00:0{k};{a:.7f};{b:.7f};x y\n".replace(".", ",")
        for k, (a, b) in enumerate(NORTH)
    ),
    "epoch.csv": "timestamp_ms\tlng\tlat\n"
    + "".join(f"{1_777_000_000_000 + 1000 * k}\t{b}\t{a}\n" for k, (a, b) in enumerate(NORTH)),
}
UNTIMED = {
    "route.gpx": gpx("<rte>" + trackpoints(seconds=False).replace("trkpt", "rtept") + "</rte>"),
    "points.gpx": gpx(trackpoints(seconds=False).replace("trkpt", "wpt")),
    "line.kml": KML.format(f"<LineString><coordinates>{LINE}</coordinates></LineString>"),
    "a.plan": plan(),
    "a.waypoints": waypoints(),
}


def placed(tmp_path, name, content, **placement):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return on_map([path], Placement("london", **{"projection": LONDON, **placement}))


@pytest.mark.parametrize("name", [*TIMED, *UNTIMED])
def test_each_kind_goes_ten_metres_a_second_to_the_north(tmp_path, name):
    ((start, track),) = placed(tmp_path, name, {**TIMED, **UNTIMED}[name], speed=10.0)
    assert start == 0.0
    np.testing.assert_allclose(track.time, np.arange(5), atol=2e-2)
    np.testing.assert_allclose(track.position[:, 1], 10.01 * np.arange(5), atol=0.05)
    np.testing.assert_allclose(track.position[:, 0], 0.0, atol=1e-3)
    assert np.isnan(track.position[:, 2]).all()  # altitudes are not heights above this ground


@pytest.mark.parametrize(
    ("name", "content", "yaw"),
    [
        ("a.ulg", px4_flight, math.pi / 2),
        ("a.bin", ardupilot_flight, 0.0),
        ("a.tlog", telemetry, 0.0),
        ("old.tlog", partial(telemetry, version=1), 0.0),
    ],
)
def test_logs_of_flights_have_places_times_and_headings(tmp_path, name, content, yaw):
    path = tmp_path / name
    path.write_bytes(content())
    (track,) = tracks_in(path)
    assert track.on_earth
    np.testing.assert_allclose(np.diff(track.time), 0.1, atol=1e-6)
    np.testing.assert_allclose(track.place[:, 1], 51.5 + 9e-6 * np.arange(20), atol=1e-7)
    np.testing.assert_allclose(track.place[:, 2], 20.0 + np.arange(20), atol=1e-4)
    np.testing.assert_allclose(track.yaw, yaw, atol=1e-6)


def test_poses_of_odometry_are_put_where_one_says(tmp_path):
    half = math.sqrt(0.5)
    tum = "# timestamp tx ty tz qx qy qz qw\n" + "".join(
        f"{100 + 0.5 * k} {7 + k} 3 1 0 0 {half} {half}\n" for k in range(4)
    )
    ((_, track),) = placed(tmp_path, "a.tum", tum, at=(50.0, -20.0, math.pi / 2))
    np.testing.assert_allclose(track.position[:, :2], [(50, -20 + k) for k in range(4)], atol=1e-9)
    np.testing.assert_allclose(track.yaw, math.pi, atol=1e-9)
    kitti = "".join(f"1 0 0 {k} 0 1 0 0 0 0 1 {2 * k}\n" for k in range(4))
    ((_, track),) = placed(tmp_path, "00.txt", kitti)
    np.testing.assert_allclose(track.position[:, :2], [(k, 2 * k) for k in range(4)])
    np.testing.assert_allclose(track.time, 0.1 * np.arange(4))


def test_a_track_that_is_one_moment_is_left_out_beside_others(tmp_path):
    moment = 2 * (trackpoints().partition("</trkpt>")[0] + "</trkpt>")
    segments = f"<trk><trkseg>{moment}</trkseg><trkseg>{trackpoints()}</trkseg></trk>"
    ((_, track),) = placed(tmp_path, "a.gpx", gpx(segments))
    assert len(track.time) == 5
    with pytest.raises(EyasError, match="1 points; a trajectory has two or more"):
        placed(tmp_path, "b.gpx", gpx(f"<trk><trkseg>{moment}</trkseg></trk>"))


def test_a_convoy_keeps_its_distances_in_time(tmp_path):
    files = []
    for name, second in (("a", 0), ("b", 3)):
        path = tmp_path / f"{name}.csv"
        rows = (f"{1_777_000_000 + second + k},{k},{second}\n" for k in range(5))
        path.write_text("time,x,y\n" + "".join(rows))
        files.append(path)
    found = on_map(files, Placement("m", None))
    assert [start for start, _ in found] == [0.0, 3.0]


def test_a_track_elsewhere_or_on_a_map_that_is_nowhere_is_one_line(tmp_path):
    with pytest.raises(EyasError, match=r"latitude 51\.5002, longitude -0\.1000, the map 'london'"):
        placed(tmp_path, "a.gpx", TIMED["a.gpx"], projection=Projection(139.7, 35.7))
    with pytest.raises(EyasError, match=r"lies nowhere on earth.*custom\.at=\[0,0,0\]"):
        placed(tmp_path, "a.gpx", TIMED["a.gpx"], projection=None)


@pytest.mark.parametrize(
    ("name", "content", "line"),
    [
        ("a.gpx", gpx(""), "no track, route or waypoints"),
        ("a.gpx", "<gpx><trk>", "not XML"),
        ("a.gpx", "<kml/>", "its content is <kml>, not <gpx>"),
        ("a.gpx", "<!DOCTYPE x [<!ENTITY a 'b'>]><gpx/>", "DOCTYPE"),
        ("a.gpx", TIMED["a.gpx"].replace("51.5", "151.5"), "latitude 151.5 is nowhere on earth"),
        ("a.kml", KML.format(f"<gx:Track><when/>{COORD}</gx:Track>"), "1 times for 5 places"),
        ("a.kmz", b"PK\3\4 broken", "cannot read"),
        ("a.geojson", "[1]", "no LineString"),
        ("a.plan", "{}", "not a plan of QGroundControl"),
        ("a.waypoints", "QGC WPL 110\n1 2 3\n", "line 2: 3 columns, not 12"),
        ("a.tum", "1 2 3\n", "3 numbers a line"),
        ("a.tum", "1 2 3 4 5 6 7 nine\n", "is not a pose"),
        ("a.ulg", b"ULog", "not a log of PX4"),
        ("a.bin", b"\xa3\x95", "has no POS and no GPS"),
        ("a.tlog", telemetry(1), "has no GLOBAL_POSITION_INT with a place"),
        ("a.csv", "lat,lon\n1,2\n", "no column 't'"),
        ("a.csv", "t,x,east\n0,1,2\n", "no column 'y'"),
        ("a.csv", "t,x,east,y\n0,1,2,3\n", "two columns are 'x'"),
        ("a.fit", b"..", ".fit is not read as a track; allowed: .csv, .gpx"),
    ],
    ids=lambda one: str(one)[:24].encode("unicode_escape").decode(),
)
def test_what_is_no_track_is_one_line(tmp_path, name, content, line):
    with pytest.raises(EyasError) as caught:
        placed(tmp_path, name, content)
    assert line in str(caught.value)
    assert "\n" not in str(caught.value)


def test_times_that_are_all_one_say_nothing(tmp_path):
    text = re.sub(
        r"<time>[^<]*",
        "<time>2015-01-01T11:35:02Z",
        gpx(f"<trk><trkseg>{trackpoints()}</trkseg></trk>"),
    )
    path = tmp_path / "a.gpx"
    path.write_text(text)
    (track,) = tracks_in(path)
    assert track.time is None
    assert len(track.place) > 2


@pytest.mark.parametrize(
    "head",
    [
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w []",
        "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w []",
        "#time(ns),px,py,pz,qw",
    ],
)
def test_truth_of_euroc_and_tum_vi_is_a_track(tmp_path, head):
    path = tmp_path / "data.csv"
    rows = [f"{1403715524907143168 + k * 500_000_000},{k},2.0,1.0,1.0" for k in range(4)]
    path.write_text("\n".join([head, *rows]))
    (track,) = tracks_in(path)
    assert np.allclose(np.diff(track.time), 0.5)
    assert track.place[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0]


def test_a_track_of_a_history_of_places_has_no_times(tmp_path):
    path = tmp_path / "history.kml"
    path.write_text(
        '<kml xmlns:gx="g"><gx:Track xmlns:gx="g"><gx:coord>100.55 13.79 0</gx:coord>'
        "<gx:coord>100.56 13.80 0</gx:coord></gx:Track></kml>"
    )
    (track,) = tracks_in(path)
    assert track.time is None
