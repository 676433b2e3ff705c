"""Bitstreams of `EXT_meshopt_compression`: a grid of 6 x 6 points, written by meshoptimizer 1.3."""

import base64
import json

import numpy as np
import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.custom.mesh_file import read_mesh
from eyas.engine.custom.meshopt import decoded

POINTS = "oAUADADA398MAMAM39/fBQAIAMAECADACAQfAFhYWFhYSFhYWFhYSFhYWFhYSFhYWFhYSFhYWFhYSFj/AAAAWFhYWBUqrqrqCQmuququCQkJqgAAAB8AlJSUlJTdlJmUlJTdlJSUmZRQmZSUlJTdlJSZlJTdlP8AAACUlJSZFQCAQAhJCGEAIQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA="  # noqa: E501
FLOATS = "oAUADMzAZs5mzMwAwAzOZ2VlBQAMzMBmMxlOzADADDMaGiUABTiMiEDGA4AAAAgdM/M/P8xoZ8vMaGfLZmZoZ8sAy83LzcsAy83LzcsAZf8AAABlZ2VlHwBMACYlFF9MACYlFF8mJiYlFF8SFBIUFF8SFBIUFF8I/wAAAAoKCgoABTiMiEDGA4AAAAgfAPIAh4i8oPLAhwC+AIeHhZ+88rC8vry85ry8sLy+hl7/AAAAXl5gpxoPCpT/+AYIqhIsElP0/0RkVE9EcikSExOrAAAACQAFOIyIQMYDgAAACAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAjgAAAI4AAACO"  # noqa: E501
TRIANGLES = "4f4eEA4QDhAOEA7+HhkOGA4XDhYO/x4WDhYOFg4WDv8eFg4WDhYOFg7/HhYOFg4WDhYO//8PDJ8CXwkMXwkMXwkMH0UijxsKAHaHVmd4qYZliWiYAWkAAA=="  # noqa: E501
INDICES = "0QAEFAASGBYEFAASGBYEFAASGBYEFAASGBYEFAASGBIEFAASGBYEFAASGBYEFAASGBYEFAASGBYEFAASGBIEFAASGBYEFAASGBYEFAASGBYEFAASGBYEFAASGBIEFAASGBYEFAASGBYEFAASGBYEFAASGBYEFAASGBIEFAASGBYEFAASGBYEFAASGBYEFAASGBYEFAASGAEARjZsVgAAAAA="  # noqa: E501

SIDE = 6
GRID = np.array(
    [[i * 400, j * 300, (i * 7 + j * 13) % 11 * 37, 0] for i in range(SIDE) for j in range(SIDE)]
)
CORNERS = [
    corner
    for a in (SIDE * i + j for i in range(SIDE - 1) for j in range(SIDE - 1))
    for corner in (a, a + 1, a + SIDE, a + SIDE, a + 1, a + SIDE + 1)
]
CORNERS += [0, 35, 17, 3, 30, 8]


def read(text, mode, count, stride, **more):
    packed = {"mode": mode, "count": count, "byteStride": stride, **more}
    return decoded(base64.b64decode(text), packed)


def test_attributes_are_those_that_were_packed():
    values = np.frombuffer(read(POINTS, "ATTRIBUTES", 36, 8), "<i2").reshape(36, 4)
    assert (values == GRID).all()


def test_floats_have_the_exponents_of_their_filter():
    content = read(FLOATS, "ATTRIBUTES", 36, 12, filter="EXPONENTIAL")
    values = np.frombuffer(content, "<f4").reshape(36, 3)
    assert np.allclose(values, GRID[:, :3] / 1000, atol=5e-4)


def test_triangles_are_those_that_were_packed():
    found = np.frombuffer(read(TRIANGLES, "TRIANGLES", len(CORNERS), 2), "<u2").reshape(-1, 3)
    # The first corner of a triangle may be another one.
    turned = [min(tuple(np.roll(one, k)) for k in range(3)) for one in found.tolist()]
    wanted = np.reshape(CORNERS, (-1, 3)).tolist()
    assert turned == [min(tuple(np.roll(one, k)) for k in range(3)) for one in wanted]


def test_indices_are_those_that_were_packed():
    assert np.frombuffer(read(INDICES, "INDICES", len(CORNERS), 4), "<u4").tolist() == CORNERS


def gltf(**more):
    contents = [base64.b64decode(text) for text in (POINTS, TRIANGLES)]
    modes = [("ATTRIBUTES", 36, 8), ("TRIANGLES", len(CORNERS), 2)]
    views = [
        {"buffer": 2, "byteLength": count * stride, **({"byteStride": 8} if stride == 8 else {}),
         "extensions": {"EXT_meshopt_compression": {
             "buffer": k, "byteLength": len(contents[k]), "byteStride": stride, "mode": mode,
             "count": count, **more}}}
        for k, (mode, count, stride) in enumerate(modes)
    ]  # fmt: skip
    addresses = [f"data:;base64,{base64.b64encode(content).decode()}" for content in contents]
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [0.001, 0.001, 0.001]}],
        "extensionsRequired": ["EXT_meshopt_compression", "KHR_mesh_quantization"],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5122, "count": 36, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": len(CORNERS), "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": len(content), "uri": address}
                    for content, address in zip(contents, addresses, strict=True)]
        + [{"byteLength": 1000, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}],
    }  # fmt: skip


def test_a_file_of_them_is_a_shape(tmp_path):
    pytest.importorskip("trimesh")
    path = tmp_path / "a.gltf"
    path.write_text(json.dumps(gltf()))
    shape = read_mesh(path)
    assert shape.size == pytest.approx((2.0, 1.5, 0.37))
    assert len(shape.corners) == len(CORNERS) // 3
    assert shape.left_out == ""


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"mode": "OTHER"}, "its meshopt data are no 'OTHER' of version 0"),
        ({"count": 10**6}, "meshopt: cut off"),
        ({"count": 10**12}, "its meshopt data have 8e"),
        ({"byteStride": 6}, "meshopt: a vertex of 6 bytes"),
        ({"byteLength": 40}, "meshopt: cut off|not that of glTF"),
    ],
)
def test_damaged_data_are_refused_in_one_line(tmp_path, change, problem):
    pytest.importorskip("trimesh")
    path = tmp_path / "a.gltf"
    path.write_text(json.dumps(gltf(**change)))
    with pytest.raises(EyasError, match=problem) as caught:
        read_mesh(path)
    assert "\n" not in str(caught.value)
