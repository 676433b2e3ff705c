"""glTF files that trimesh alone would misread."""

import base64
import io
import json
import struct

import numpy as np
import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.custom.mesh_file import read_mesh

pytest.importorskip("trimesh")

POINTS = np.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 1]], np.float64)
CORNERS = np.array([0, 2, 1, 0, 1, 3], np.uint16)
KINDS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "f4": 5126}


def gltf(points, **position) -> dict:
    """Return a file of two triangles, whose points stand at every multiple of 4 bytes."""
    stride = -(-points.itemsize * 3 // 4) * 4
    rows = [row.tobytes().ljust(stride, b"\0") for row in points]
    data = b"".join(rows) + CORNERS.tobytes()
    address = f"data:application/octet-stream;base64,{base64.b64encode(data).decode()}"
    views = [
        {"buffer": 0, "byteLength": len(data) - 12, "byteStride": stride},
        {"buffer": 0, "byteOffset": len(data) - 12, "byteLength": 12},
    ]
    kind = KINDS[points.dtype.str[1:]]
    accessors = [
        {"bufferView": 0, "componentType": kind, "count": 4, "type": "VEC3", **position},
        {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
    ]
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [2, 2, 2]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": address}],
    }  # fmt: skip


@pytest.fixture
def read(tmp_path):
    def read_one(header, *, binary=False):
        path = tmp_path / ("a.glb" if binary else "a.gltf")
        content = json.dumps(header).encode()
        if binary:
            uri = header["buffers"][0].pop("uri")
            data = base64.b64decode(uri.partition(",")[2])
            text = json.dumps(header).encode()
            text += b" " * (-len(text) % 4)
            data += bytes(-len(data) % 4)
            content = struct.pack("<4sIII", b"glTF", 2, 28 + len(text) + len(data), len(text))
            content += b"JSON" + text + struct.pack("<I", len(data)) + b"BIN\0" + data
        path.write_bytes(content)
        return read_mesh(path)

    return read_one


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("kind", ["i1", "u1", "i2", "u2"])
def test_normalised_integers_are_divided(read, kind, binary):
    most = np.iinfo(kind).max
    header = gltf(np.rint(POINTS / 2 * most).astype(kind), normalized=True)
    header["extensionsRequired"] = ["KHR_mesh_quantization"]
    assert np.allclose(read(header, binary=binary).size, (2.0, 1.0, 1.0), atol=0.02)


def test_integers_that_are_not_normalised_are_lengths(read):
    assert read(gltf(POINTS.astype("i2"))).size == (4.0, 2.0, 2.0)


def test_what_hangs_on_a_camera_is_read(read):
    header = gltf(POINTS.astype("f4"))
    header["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]
    header["nodes"] += [{"name": "all", "children": [2]}, {"camera": 0, "children": [0]}]
    header["scenes"][0]["nodes"] = [1]
    assert read(header).size == (4.0, 2.0, 2.0)


def test_sparse_accessors_have_their_values(read):
    header = gltf(POINTS.astype("f4"))
    data = struct.pack("<HH3f", 1, 0, 9.0, 0.0, 0.0)
    header["buffers"].append(
        {"byteLength": len(data), "uri": f"data:;base64,{base64.b64encode(data).decode()}"}
    )
    header["bufferViews"] += [
        {"buffer": 1, "byteLength": 2}, {"buffer": 1, "byteOffset": 4, "byteLength": 12}
    ]  # fmt: skip
    header["accessors"][0]["sparse"] = {
        "count": 1, "indices": {"bufferView": 2, "componentType": 5123},
        "values": {"bufferView": 3},
    }  # fmt: skip
    assert read(header).size == (18.0, 2.0, 2.0)


@pytest.mark.parametrize("name", ["KHR_texture_basisu", "X_unknown"])
def test_extensions_that_are_not_read_are_refused_by_name(read, name):
    with pytest.raises(EyasError, match=f"it needs {name}, which is not read"):
        read(gltf(POINTS.astype("f4")) | {"extensionsRequired": [name]})


def test_geometry_in_an_extension_is_refused_though_the_file_does_not_require_it(read, capfd):
    header = gltf(POINTS.astype("f4"))
    del header["accessors"][0]["bufferView"]
    header["meshes"][0]["primitives"][0]["extensions"] = {"X_packed": {}}
    with pytest.raises(EyasError, match="it needs X_packed"):
        read(header)
    assert capfd.readouterr().err == ""


def packed_by_draco(points, *, colours=None):
    draco = pytest.importorskip("DracoPy")
    faces = CORNERS.reshape(-1, 3).astype(np.uint32)
    data = draco.encode(points.astype(np.float32), faces, colors=colours)
    kinds = {0: "POSITION", 2: "COLOR_0"}
    made = {kinds[one["attribute_type"]]: one["unique_id"] for one in draco.decode(data).attributes}
    header = gltf(POINTS.astype("f4")) | {"extensionsRequired": ["KHR_draco_mesh_compression"]}
    header["extensionsUsed"] = ["KHR_draco_mesh_compression"]
    address = f"data:;base64,{base64.b64encode(data).decode()}"
    header["buffers"] = [{"byteLength": len(data), "uri": address}]
    header["bufferViews"] = [{"buffer": 0, "byteLength": len(data)}]
    header["accessors"] = [
        {"componentType": 5126, "count": 4, "type": "VEC3"},
        {"componentType": 5123, "count": 6, "type": "SCALAR"},
        {"componentType": 5121, "count": 4, "type": "VEC3", "normalized": True},
    ]
    (primitive,) = header["meshes"][0]["primitives"]
    primitive["attributes"] = {"POSITION": 0} | ({} if colours is None else {"COLOR_0": 2})
    primitive["extensions"] = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": made}}
    return header


@pytest.mark.parametrize("binary", [False, True])
def test_what_draco_has_packed_is_read(read, binary):
    shape = read(packed_by_draco(POINTS), binary=binary)
    assert shape.size == pytest.approx((4.0, 2.0, 2.0), abs=1e-3)
    assert len(shape.corners) == 2
    assert shape.left_out == ""
    red = np.tile(np.array([[255, 0, 0]], np.uint8), (4, 1))
    assert (read(packed_by_draco(POINTS, colours=red)).colours == (1.0, 0.0, 0.0)).all()


@pytest.mark.parametrize(
    ("at", "bytes_", "problem"),
    [
        (0, b"DRACX", "are not those of a mesh"),
        (5, b"\1", "are of a version"),
        (7, b"\0", "are of a version"),
        (12, b"\xff\xff\xff\xff\x0f", "has more than 4000000 triangles or vertices"),
        (12, b"\xff\xff\xff\xff\xff", "Draco's data are damaged"),
    ],
)
def test_draco_s_header_is_looked_at_before_anything_is_made(read, at, bytes_, problem):
    header = packed_by_draco(POINTS)
    (buffer,) = header["buffers"]
    data = base64.b64decode(buffer["uri"].partition(",")[2])
    data = data[:at] + bytes_ + data[at + len(bytes_) :]
    buffer["uri"] = f"data:;base64,{base64.b64encode(data).decode()}"
    with pytest.raises(EyasError, match=problem):
        read(header)


@pytest.mark.parametrize(
    ("transform", "colours"),
    [
        ({}, {(1.0, 0.0, 0.0)}),
        ({"offset": [0.5, 0.0]}, {(0.0, 1.0, 0.0)}),
        ({"offset": [0.0, 0.5]}, {(0.0, 0.0, 1.0)}),
        ({"scale": [3.0, 1.0]}, {(0.0, 1.0, 0.0)}),
        ({"offset": [0.0, 1.0], "rotation": 1.5707963267948966}, {(0.0, 0.0, 1.0)}),
    ],
)
def test_transforms_of_textures_are_applied(read, transform, colours):
    """The texture is red at the top left, green beside it, blue and white below."""
    image = pytest.importorskip("PIL.Image")
    picture = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)
    content = io.BytesIO()
    image.fromarray(picture).resize((64, 64), 0).save(content, "PNG")
    header = gltf(POINTS.astype("f4"))
    uv = np.full((4, 2), 0.25, np.float32).tobytes()
    for data in (uv, content.getvalue()):
        address = f"data:image/png;base64,{base64.b64encode(data).decode()}"
        header["buffers"].append({"byteLength": len(data), "uri": address})
        header["bufferViews"].append(
            {"buffer": len(header["buffers"]) - 1, "byteLength": len(data)}
        )
    header["accessors"].append({"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"})
    header["images"] = [{"bufferView": 3, "mimeType": "image/png"}]
    header["textures"] = [{"source": 0}]
    texture = {"index": 0, "extensions": {"KHR_texture_transform": transform}}
    header["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": texture}}]
    header["extensionsRequired"] = ["KHR_texture_transform"]
    header["meshes"][0]["primitives"][0] |= {"material": 0}
    header["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2
    assert set(map(tuple, read(header).colours.tolist())) == colours


def test_what_is_used_but_not_read_is_named(read):
    header = gltf(POINTS.astype("f4")) | {"extensionsUsed": ["KHR_texture_basisu"]}
    header["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 1})
    told = "KHR_texture_basisu, 1 primitives of points, lines or fans"
    assert read(header).left_out == f"left out, as not read: {told}"


def test_accessors_that_claim_much_are_refused_before_they_are_made(read):
    header = gltf(POINTS.astype("f4"))
    del header["accessors"][0]["bufferView"]
    header["accessors"][0]["count"] = 10**11
    with pytest.raises(EyasError, match=r"its accessors have 1\.2e"):
        read(header)
