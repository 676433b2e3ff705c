"""Files of meshes and motions that someone else has made: used, or refused in one line."""

import json
import random
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.custom.config import CustomConfig
from eyas.engine.custom.mesh_file import loaded
from eyas.engine.custom.tracks import tracks_in
from eyas.engine.custom.trajectory import read_trajectory

CSV = b't,x,y,z,yaw\n0,0,0,1,"0"\n1,1e0,2,1,.1\n2.5,3,4,1,0.2\n'
OBJ = b"""mtllib box.mtl
o box
v 0 0 0
v 1 0 0
v 1 1 0
v 0 0 1
vt 0 0
vn 0 0 1
usemtl red
f 1/1/1 2/1/1 3/1/1
f 1 2 4
f -1 -2 -3
"""
PARTS = [bytes([byte]) for byte in b'\0\r\n",-9[ /\xff'] + [b"", b"1e999", b"nan", b"{}"]
TRIES = 400


def gltf() -> bytes:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32).tobytes()
    corners = np.array([0, 1, 2, 0, 1, 3], np.uint16).tobytes()
    import base64

    data = base64.b64encode(points + corners).decode()
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [
                {
                    **{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                    **{"min": [0, 0, 0], "max": [1, 1, 1]},
                },
                {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            ],
            "bufferViews": [
                {"buffer": 0, "byteOffset": 0, "byteLength": 48},
                {"buffer": 0, "byteOffset": 48, "byteLength": 12},
            ],
            "buffers": [{"byteLength": 60, "uri": f"data:application/octet-stream;base64,{data}"}],
        }
    ).encode()


def mutated(content: bytes, chance: random.Random) -> bytes:
    """Return a content with one to four places replaced, doubled or cut."""
    for _ in range(chance.randint(1, 4)):
        first = chance.randrange(len(content) + 1)
        last = min(len(content), first + chance.choice([0, 1, 1, 2, 8]))
        part = chance.choice([*PARTS, content[first:last] * 2, bytes([chance.randrange(256)])])
        content = content[:first] + part + content[last:]
    return content


def read(path: Path) -> None:
    if path.suffix == ".csv":
        read_trajectory(path)
    else:
        loaded(CustomConfig(mesh=str(path)))


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ["track.csv", "box.obj", "box.gltf"])
def test_what_is_damaged_is_used_or_refused_in_one_line(name, tmp_path):
    if not name.endswith(".csv"):
        pytest.importorskip("trimesh")
    path, good = tmp_path / name, {"csv": CSV, "obj": OBJ, "gltf": gltf()}[name.rpartition(".")[2]]
    path.write_bytes(good)
    read(path)
    refused = []
    for seed in range(TRIES):
        path.write_bytes(mutated(good, random.Random(seed)))
        try:
            read(path)
        except EyasError as error:
            refused.append(str(error))
    assert 0 < len(refused) < TRIES
    assert not [line for line in refused if "\n" in line or str(path) not in line]


def test_lines_may_end_with_a_carriage_return(tmp_path):
    path = tmp_path / "mac.csv"
    path.write_bytes(b"t,x,y\r0,0,0\r1,1,1\r")
    assert read_trajectory(path).time.tolist() == [0.0, 1.0]


def test_a_quotation_mark_that_is_never_closed_is_one_line(tmp_path):
    path = tmp_path / "open.csv"
    path.write_text('t,x,y\n0,"0,0\n' + "1,1,1\n" * 50_000)
    with pytest.raises(EyasError, match=r"not a CSV file: field larger than"):
        read_trajectory(path)


def test_a_triangle_with_a_corner_that_is_not_there_is_one_line(tmp_path):
    pytest.importorskip("trimesh")
    path = tmp_path / "box.obj"
    path.write_bytes(OBJ + b"f 1 2 99\n")
    with pytest.raises(EyasError, match="cannot read as a mesh"):
        read(path)


@pytest.mark.parametrize(
    "text",
    [
        "# a1b2\n# c3d4\n# s_m; x_m; y_m; psi_rad\n0.0; 1.5; 2; -0.7\n3; 4.5; 2; 0\n",
        "# x_m,y_m,w_tr_right_m,w_tr_left_m\n1.5,2,5.7,6.4\n4.5,2,5.7,6.4\n",
        "# made by hand\nx,y\n1.5,2\n4.5,2\n",
    ],
)
def test_racing_lines_have_comments_and_no_times(tmp_path, text):
    path = tmp_path / "line.csv"
    path.write_text(text)
    (track,) = tracks_in(path)
    assert track.time is None
    assert track.place[:, :2].tolist() == [[1.5, 2.0], [4.5, 2.0]]
    path.write_text("# note\nid,x,y\n1,0,0\n")
    with pytest.raises(EyasError, match="line 2: no column 't' in 'id,x,y'"):
        tracks_in(path)


def test_a_table_of_recorded_road_users_holds_many_bodies(tmp_path):
    path = tmp_path / "tracks.csv"  # the columns of inD
    rows = [f"0,{who},{frame},{10 * who + frame},{who}" for who in (7, 3) for frame in range(5)]
    path.write_text("\n".join(["recordingId,trackId,frame,xCenter,yCenter", *rows, "0,9,1,0,0"]))
    seven, three = tracks_in(path)
    assert (seven.name, three.name) == ("7", "3")
    assert seven.time.tolist() == pytest.approx([0.0, 0.04, 0.08, 0.12, 0.16])
    assert three.place[:, :2].tolist() == [[30.0 + k, 3.0] for k in range(5)]
    with pytest.raises(EyasError, match="2 bodies; allowed here: one"):
        read_trajectory(path)
    many = [f"0,{who},{frame},0,0" for who in range(201) for frame in range(2)]
    path.write_text("\n".join(["recordingId,trackId,frame,xCenter,yCenter", *many]))
    with pytest.raises(EyasError, match="201 bodies; allowed: up to 200"):
        tracks_in(path)
