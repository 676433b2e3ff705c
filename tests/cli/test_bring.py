"""`eyas bring`: what files of others are, and the commands that use them."""

import json
import zipfile

import pytest

from eyas.cli.bring import Brought, Refused, bring

OSM = """<osm version="0.6"><node id="1" lat="51.4993" lon="-0.1314"/>
<node id="2" lat="51.4993" lon="-0.1285"/>
<way id="9"><nd ref="1"/><nd ref="2"/><tag k="highway" v="residential"/></way></osm>"""
GPX = """<gpx><trk><trkseg>
<trkpt lat="51.4993" lon="-0.1312"><ele>9</ele><time>2026-05-01T10:00:00Z</time></trkpt>
<trkpt lat="51.4993" lon="-0.1290"><ele>9</ele><time>2026-05-01T10:00:20Z</time></trkpt>
</trkseg></trk></gpx>"""
CAMERA = """image_width: 640
image_height: 480
distortion_model: plumb_bob
camera_matrix:
  data: [500.0, 0.0, 319.5, 0.0, 500.0, 239.5, 0.0, 0.0, 1.0]
distortion_coefficients:
  data: [-0.2, 0.05, 0.0, 0.0, 0.0]
"""


def written(folder, name, content):
    path = folder / name
    path.write_text(content)
    return path


def test_a_place_and_a_track_are_a_ride(tmp_path):
    written(tmp_path, "place.osm", OSM)
    written(tmp_path, "ride.gpx", GPX)
    written(tmp_path, "notes.md", "mine")
    place, track, other, ride = bring([tmp_path])
    assert "1 street, 0 buildings" in place.what
    assert "1 track, 2 points, 20 s, about latitude 51.4993" in track.what
    assert isinstance(other, Refused)
    assert ride.what == "a ride on place.osm"
    assert ride.commands[1].startswith("eyas video --map place --set custom=")


def test_a_ride_on_a_large_place_imports_the_part_around_it(tmp_path):
    written(tmp_path, "place.osm", OSM.replace("-0.1285", "0.2"))
    written(tmp_path, "ride.gpx", GPX)
    written(tmp_path, "elsewhere.gpx", GPX.replace("51.4993", "48.1"))
    *_, place, _, ride = bring(
        [tmp_path / name for name in ("elsewhere.gpx", "place.osm", "ride.gpx")]
    )
    assert "larger than 8 km: a part is imported" in " ".join(place.notes)
    assert "--bbox=" in place.commands[0]
    assert ride.path.name == "ride.gpx"  # and none of the track that lies elsewhere
    west, south, east, north = map(float, ride.commands[0].partition("--bbox=")[2].split(","))
    assert west < -0.1312 < -0.1290 < east
    assert south < 51.4993 < north
    assert north - south < 0.01


@pytest.mark.parametrize(
    ("name", "content", "what", "command"),
    [
        ("a.csv", "t,x,y\n0,0,0\n5,5,0\n", "1 track, 2 points, 5 s, in metres", "eyas video"),
        ("a.proto", "PROTO A [] { Shape { geometry Box { size 1 1 1 } } }", "a shape", "custom"),
        (
            "a_tracks.csv",
            "track_id,timestamp_ms,agent_type,x,y,psi_rad,length,width\n"
            + "".join(f"1,{100 * k},car,{k},0,0,4,2\n" for k in range(20)),
            "1 recorded vehicle of a table INTERACTION, 2 s",
            "eyas traffic import",
        ),
        ("a.yaml", CAMERA, "a calibrated camera, 640 x 480, lens brown", "camera.field_of_view"),
        ("a.json", '{"world": {"map": "village"}}', "settings", "--config"),
        (
            "agent.json",
            '{"url": "http://localhost:8000/v1", "model": "m"}',
            "a model of language and vision",
            "eyas evaluate --policy",
        ),
    ],
)
def test_each_kind_has_its_command(tmp_path, name, content, what, command):
    (found,) = bring([written(tmp_path, name, content)])
    assert isinstance(found, Brought), found
    assert found.what.startswith(what)
    assert command in " ".join(found.commands)


@pytest.mark.parametrize("ending", ["onnx", "osm", "osm.pbf", "mp4", "pt", "glb", "ulg", "gpx"])
def test_a_pointer_of_git_lfs_is_called_one(tmp_path, ending):
    pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:81\nsize 7\n"
    (found,) = bring([written(tmp_path, f"a.{ending}", pointer)])
    assert isinstance(found, Refused)
    assert found.why.endswith(
        "a pointer of Git LFS in the place of the file; get it with git lfs pull"
    )


def zipped(path, **files):
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name.replace("__", "/").replace("_pkl", ".pkl"), content)
    return path


def layer(*shape):
    """The weight of a layer in a pickle: a storage, the offset in it, and its shape."""
    ends = {2: b"\x86", 4: b"t"}
    numbers = b"".join(b"K" + bytes([one]) for one in shape)
    begin = b"" if len(shape) < 4 else b"("
    return b"\x80\x02X\x01\x00\x00\x00aQK\x00" + begin + numbers + ends[len(shape)] + b"."


def test_a_zip_is_what_it_holds(tmp_path):
    with zipfile.ZipFile(tmp_path / "ppo.zip", "w") as archive:
        archive.writestr("data", "{}")
        archive.writestr("policy.pth", "")
    (tmp_path / "old.pth").write_bytes(b"\x80\x02 only tensors")
    cases = {
        tmp_path / "ppo.zip": "a policy of stable-baselines3",
        zipped(tmp_path / "script.pt", m__constants_pkl="", m__data_pkl=""): "a policy of PyTorch",
        zipped(tmp_path / "whole.pt", m__data_pkl="_modules"): "a network of PyTorch",
        zipped(tmp_path / "state.pt", m__data_pkl="OrderedDict"): "weights without their network",
        tmp_path / "old.pth": "weights without their network",
        zipped(tmp_path / "pictures.zip", a__b="c"): "neither a policy of stable-baselines3",
        zipped(
            tmp_path / "legs.pt", m__constants_pkl="", m__data_pkl=layer(8, 45)
        ): "without convolutions whose layers take 45 numbers",
        zipped(
            tmp_path / "eye.pt", m__constants_pkl="", m__data_pkl=layer(8, 3, 5, 5)
        ): "a policy of PyTorch",
        written(tmp_path, "cut.zip", "PK"): "neither a zip file nor one of PyTorch",
    }
    for path, said in cases.items():
        (found,) = bring([path])
        assert said in (found.what if isinstance(found, Brought) else found.why), path


def test_a_shape_with_too_many_triangles_is_simplified(tmp_path):
    side = 330
    rows = [
        f"v {x * 0.01} {y * 0.01} {(x * y % 7) * 0.01}" for y in range(side) for x in range(side)
    ]
    rows += [
        f"f {k + 1} {k + 2} {k + side + 1}\nf {k + 2} {k + side + 2} {k + side + 1}"
        for y in range(side - 1)
        for k in range(y * side, y * side + side - 1)
    ]
    (found,) = bring([written(tmp_path, "hill.obj", "\n".join(rows))])
    assert isinstance(found, Brought), found
    assert '"most_triangles": 20000' in found.commands[0]
    assert "of 216482 triangles" in " ".join(found.notes)


def test_a_refused_robot_says_why_and_not_what_was_left_out(tmp_path):
    urdf = """<robot name="a"><link name="b"><visual><geometry><mesh filename="c.stl"/></geometry>
    </visual></link></robot>"""
    (found,) = bring([written(tmp_path, "a.urdf", urdf)])
    assert isinstance(found, Refused)
    assert "left out, as not read" not in found.why.partition(": ")[2][:22]


def test_what_cannot_be_used_says_why_and_the_exit_code_is_1(tmp_path, eyas_command):
    bad = [
        written(tmp_path, "a.gpx", "<gpx/>"),
        written(tmp_path, "a.docx", "?"),
        tmp_path / "gone.osm",
    ]
    done = eyas_command("bring", *map(str, bad))
    assert done.returncode == 1
    lines = done.stdout.splitlines()
    assert [line.startswith("not usable: ") for line in lines] == [True] * 3
    assert "has no track" in lines[0]
    assert "of no kind that is read: .avi, " in lines[1]
    assert "no such file" in lines[2]


def test_a_calibration_becomes_settings(tmp_path, eyas_command):
    out = tmp_path / "camera.json"
    file = str(written(tmp_path, "a.yaml", CAMERA))
    assert eyas_command("bring", file, "--out", str(out)).returncode == 0
    camera = json.loads(out.read_text())["camera"]
    assert camera["lens"]["k1"] == -0.2
    assert eyas_command("config", "show", "--config", str(out)).returncode == 0
