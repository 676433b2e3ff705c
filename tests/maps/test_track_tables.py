"""Tables of recorded vehicles: their forms, where they lie, and the traffic that they become."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from eyas.cli.app import app
from eyas.engine.core.errors import EyasError
from eyas.engine.traffic.recording_file import load
from eyas.engine.world.maps import MAPS
from eyas.engine.world.projection import Projection
from eyas.maps.traffic.tables import form_of, forms, read_columns, read_tracks
from eyas.maps.traffic.tracks_traffic import Put, put_by_place, traffic_of

GRAPH = MAPS.get("citystreet").roads(0)
HIGHD = "frame,id,x,y,width,height,xVelocity,yVelocity,xAcceleration,yAcceleration,dhw,thw,ttc"
IND = "recordingId,trackId,frame,trackLifetime,xCenter,yCenter,heading,width,length,xVelocity"
INTERACTION = "track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy,psi_rad,length,width"
NGSIM = "Vehicle_ID,Frame_ID,Global_Time,Local_X,Local_Y,v_Length,v_Width,v_Class"


def written(path: Path, names: str, rows: list[list[object]]) -> Path:
    with path.open("w", newline="") as file:
        table = csv.writer(file)
        if names:
            table.writerow(names.split(","))
        table.writerows(rows)
    return path


def highd(folder: Path) -> Path:
    """A car of 4 m to the right at 25 m/s, and a truck of 12 m to the left, at 50 Hz."""
    meta = [[1, 4, 2, "Car"], [2, 12, 2, "Truck"]]
    written(folder / "03_tracksMeta.csv", "id,width,height,class", meta)
    written(folder / "03_recordingMeta.csv", "id,frameRate", [[3, 50]])
    rows = [[k, 1, 0.5 * k, 10, 4, 2] + [0] * 7 for k in range(101)]
    rows += [[k, 2, 100 - 0.5 * k, 20, 12, 2] + [0] * 7 for k in range(50, 151)]
    return written(folder / "03_tracks.csv", HIGHD, rows)


def test_highd_counts_corners_in_pictures_and_has_classes_beside_it(tmp_path):
    table = read_tracks(highd(tmp_path))
    assert table.form == "highD"
    car, truck = table.vehicles
    assert (car.kind, truck.kind, car.length, truck.length) == ("passenger", "truck", 4.0, 12.0)
    assert car.time[[0, -1]].tolist() == [0.0, 2.0]  # 50 Hz
    np.testing.assert_allclose(car.place[0], [2.0, -11.0])  # the middle; y points up
    assert car.yaw == pytest.approx(0.0)
    assert np.abs(truck.yaw) == pytest.approx(math.pi)


def test_ind_has_degrees_and_leaves_people_out(tmp_path):
    meta = [[0, 7, "bus"], [0, 8, "pedestrian"]]
    written(tmp_path / "00_tracksMeta.csv", "recordingId,trackId,class", meta)
    names = "recordingId,frameRate,xUtmOrigin,yUtmOrigin,lonLocation,latLocation"
    # Aachen, in zone 32
    written(tmp_path / "00_recordingMeta.csv", names, [[0, 25, 293487.1, 5629711.6, 6.07, 50.78]])
    rows = [[0, who, k, k, 3, 4 + k, 90, 2, 12, 0] for who in (7, 8) for k in range(26)]
    table = read_tracks(written(tmp_path / "00_tracks.csv", IND, rows))
    (bus,) = table.vehicles
    assert (bus.kind, bus.length) == ("bus", 12.0)
    assert bus.yaw == pytest.approx(math.pi / 2)
    assert dict(table.left_out) == {"tracks of the class 'pedestrian'": 1}
    assert table.origin == pytest.approx((6.0703762, 50.7823296), abs=3e-7)  # pyproj's
    projection = Projection(6.07, 50.78)
    put = put_by_place(table, projection)
    assert put is not None
    np.testing.assert_allclose((put.x, put.y), projection.metres(table.origin)[0])
    assert put_by_place(table, None) is None
    assert put_by_place(table, Projection(11.5, 48.1)) is None  # another town


def test_a_place_south_of_the_equator_is_found(tmp_path):
    names = "frameRate,xUtmOrigin,yUtmOrigin,lonLocation,latLocation"
    written(tmp_path / "1_recordingMeta.csv", names, [[25, 321000.5, 5812000.25, 144.97, -37.82]])
    rows = [[0, 1, k, k, k, 0, 0, 2, 4, 0] for k in range(3)]
    table = read_tracks(written(tmp_path / "1_tracks.csv", IND, rows))
    assert table.origin == pytest.approx((144.9662361, -37.8218680), abs=3e-7)  # pyproj's, zone 55


def test_interaction_and_ngsim(tmp_path):
    rows = [[1, k, 100 * k, "car", 2 * k, 3, 20, 0, 0.25, 4.4, 1.8] for k in range(1, 9)]
    rows += [[2, k, 100 * k, "pedestrian/bicycle", 0, k, 0, 10, 1.5, 1, 1] for k in range(1, 9)]
    (car,) = read_tracks(written(tmp_path / "a.csv", INTERACTION, rows)).vehicles
    assert (car.length, float(car.yaw[3])) == (4.4, 0.25)
    assert car.time[-1] == pytest.approx(0.7)
    rows = [[5, k, 1.1e12 + 100 * k, 10, 100 + 10 * k, 20, 6, 3] for k in range(8)]
    (truck,) = read_tracks(written(tmp_path / "b.csv", NGSIM, rows)).vehicles
    assert truck.kind == "truck"
    assert truck.length == pytest.approx(6.096)  # 20 feet
    # Its front is told: the middle is ten feet behind.
    np.testing.assert_allclose(truck.place[0], [3.048, 27.432], atol=1e-9)


def test_pixels_need_a_unit(tmp_path):
    rows = [[k, 1, 100 + 5 * k, 40, 20, 10, 1, 4, 0, 0] for k in range(1, 31)]
    rows += [[k, 2, 0, 0, 5, 5, 1, 1, 0, 0] for k in range(1, 31)]
    path = written(tmp_path / "uav.csv", "", rows)
    assert form_of(path) == "VisDrone (MOT), without a line of names"
    with pytest.raises(EyasError, match="its lengths are pixels: --unit says"):
        read_tracks(path)
    table = read_tracks(path, unit=0.2)
    (car,) = table.vehicles
    np.testing.assert_allclose(car.place[0], [0.2 * 115, -0.2 * 45])
    assert dict(table.left_out) == {"tracks of the class '1'": 1}


def test_other_columns_are_described_by_a_file(tmp_path):
    rows = [["van 1", 0.5 * k, 7, 100 * k, "VAN"] for k in range(5)]
    path = written(tmp_path / "mine.csv", "who,when,north,east,what", rows)
    with pytest.raises(EyasError, match=r"is of no known table; allowed: highD; inD.*--columns"):
        read_tracks(path)
    mine = {"id": "who", "time": "when", "x": "east", "y": "north", "unit": 0.01, "class": "what",
            "classes": {"VAN": "truck"}}  # fmt: skip
    (tmp_path / "mine.json").write_text(json.dumps(mine))
    (van,) = read_tracks(path, read_columns(tmp_path / "mine.json")).vehicles
    assert (van.kind, van.place[-1].tolist()) == ("truck", [4.0, 0.07])
    for wrong, line in (
        ({"x": 1}, "columns must be all names or all numbers"),
        ({"frame": "n"}, "one of frame and time must be given"),
        ({"classes": {"VAN": "buss"}}, "classes.VAN: 'buss' .*; did you mean 'bus'"),
        ({"yy": "north"}, "yy: unknown key"),
    ):
        (tmp_path / "wrong.json").write_text(json.dumps(mine | wrong))
        with pytest.raises(EyasError, match=line):
            read_columns(tmp_path / "wrong.json")


def test_vehicles_become_traffic_that_is_turned_and_put(tmp_path):
    table = read_tracks(highd(tmp_path))
    recording = traffic_of(table, GRAPH, Put(30.0, 40.0, math.pi / 2, (0.0, 0.0)), tmp_path / "a")
    assert (recording.rate, recording.duration) == (10.0, 3.0)
    assert recording.present.sum(axis=0).tolist() == [21, 21]
    np.testing.assert_allclose(recording.position[0, 0], [41.0, 42.0], atol=0.01)
    assert recording.yaw[0, 0] == pytest.approx(math.pi / 2, abs=1e-3)
    assert recording.vehicle_types == ("passenger", "truck")
    assert recording.vehicle_length.tolist() == [4.0, 12.0]


def test_an_actor_stands_for_vehicles_one_after_another(tmp_path):
    rows = [
        [n, k, 100 * k + 1000 * n, "car", k, n, 1, 0, 0, 4, 2] for n in range(4) for k in range(8)
    ]
    table = read_tracks(written(tmp_path / "a.csv", INTERACTION, rows))
    recording = traffic_of(table, GRAPH, Put(), tmp_path / "a.csv")
    assert (len(table.vehicles), recording.actors) == (4, 1)
    assert not recording.present[8:10].any()  # between two of them


def test_the_command_makes_what_a_recording_replays(tmp_path):
    out = tmp_path / "out.npz"
    asked = ["traffic", "import", str(highd(tmp_path)), "--at", "10,0,0", "--out", str(out)]
    ran = CliRunner().invoke(app, asked)
    assert ran.exit_code == 0, ran.output
    assert "2 vehicles of a table highD, at 10,0,0" in ran.output
    middle = load(out).position.reshape(-1, 2)
    assert 0.5 * (middle.min(axis=0) + middle.max(axis=0)) == pytest.approx([10.0, 0.0], abs=0.02)
    for more, line in (
        ([], "already exists"),
        (["--overwrite", "--at", "10,0"], "--at: '10,0' is not allowed: X,Y,TURN"),
        (["--overwrite", "--unit", "0"], "--unit: 0 is not allowed"),
    ):
        with pytest.raises(EyasError, match=line):
            CliRunner().invoke(app, [*asked, *more], catch_exceptions=False)


@pytest.mark.parametrize(
    ("cell", "line"),
    [
        ("far", "is not allowed: numbers in"),
        ("nan", "data row 6: x is nan; allowed: finite, up to 1e\\+07"),
        ("1e300", r"data row 6: x is 1e\+300; allowed"),
    ],
)
def test_what_is_no_place_is_one_line(tmp_path, cell, line):
    path = highd(tmp_path)
    path.write_text(path.read_text().replace("\n5,1,2.5,", f"\n5,1,{cell},"))
    with pytest.raises(EyasError, match=line) as caught:
        read_tracks(path)
    assert "\n" not in str(caught.value)


def test_times_in_another_unit_are_named(tmp_path):
    rows = [[1, k, 1e8 * k, "car", k, 0, 1, 0, 0, 4, 2] for k in range(8)]
    table = read_tracks(written(tmp_path / "a.csv", INTERACTION, rows))
    with pytest.raises(EyasError, match=r"it lasts 700000 s; allowed: up to 7200 s"):
        traffic_of(table, GRAPH, Put(), tmp_path / "a.csv")


def test_every_form_is_whole():
    assert len(forms()) == 5
