"""glTF files that trimesh alone would misread."""

import base64
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


@pytest.mark.parametrize(
    "name",
    ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu", "X_unknown"],
)
def test_extensions_that_are_not_read_are_refused_by_name(read, name):
    with pytest.raises(EyasError, match=f"it needs {name}, which is not read"):
        read(gltf(POINTS.astype("f4")) | {"extensionsRequired": [name]})


def test_geometry_in_an_extension_is_refused_though_the_file_does_not_require_it(read, capfd):
    header = gltf(POINTS.astype("f4"))
    del header["accessors"][0]["bufferView"]
    header["meshes"][0]["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": {}}
    with pytest.raises(EyasError, match="it needs KHR_draco_mesh_compression"):
        read(header)
    assert capfd.readouterr().err == ""


def test_what_is_used_but_not_read_is_named(read):
    header = gltf(POINTS.astype("f4")) | {"extensionsUsed": ["KHR_texture_transform"]}
    header["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 1})
    told = "KHR_texture_transform, 1 primitives of points, lines or fans"
    assert read(header).left_out == f"left out, as not read: {told}"


def test_accessors_that_claim_much_are_refused_before_they_are_made(read):
    header = gltf(POINTS.astype("f4"))
    del header["accessors"][0]["bufferView"]
    header["accessors"][0]["count"] = 10**11
    with pytest.raises(EyasError, match=r"its accessors have 1\.2e"):
        read(header)
