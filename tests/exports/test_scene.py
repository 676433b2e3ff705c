import dataclasses
import json
import math
import struct

import numpy as np
import pytest

from eyas.exports.frame import CameraPose
from eyas.exports.gltf import flight
from eyas.exports.gltf.boxes import box_mesh
from eyas.exports.gltf.flight import SceneWriter
from eyas.exports.writer import Summary
from eyas.state.scene import ObjectClass, Scene


@pytest.fixture
def film(run, episode, frame, monkeypatch):
    """The scene of four frames in an empty world, in which the camera turns by more than half a
    turn, and another car is seen in the second and third frame only."""
    monkeypatch.setattr(flight, "load_scene", lambda *_: Scene.empty())
    other = dataclasses.replace(
        frame(0).target, object_id=65536 + 9, type="Bus", object_class=ObjectClass.BUS
    )

    def write():
        part = SceneWriter(run).begin(episode)
        for number in range(4):
            yaw = 1.2 * number
            c, s = math.cos(yaw), math.sin(yaw)
            turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            pose = CameraPose(np.array([number, 2.0, 20.0]), turn, 0.8, 64, 48)
            part.add(frame(number, camera=pose, others=(other,) if number in (1, 2) else ()))
        part.finish()
        return episode.folder / "scene.glb"

    return write


def opened(path):
    """What a file tells, and a reader of its accessors."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    told, body = json.loads(data[20 : 20 + length]), data[28 + length :]

    def values(index):
        accessor = told["accessors"][index]
        view = told["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        count = accessor["count"] * width
        return np.frombuffer(body, np.float32, count, view["byteOffset"]).reshape(-1, width)

    return told, values


def track(told, values, name, path):
    """Times and values of a property of a node."""
    (animation,) = told["animations"]
    names = {index: node["name"] for index, node in enumerate(told["nodes"])}
    for channel in animation["channels"]:
        if (names[channel["target"]["node"]], channel["target"]["path"]) == (name, path):
            sampler = animation["samplers"][channel["sampler"]]
            return values(sampler["input"])[:, 0], values(sampler["output"])
    raise KeyError((name, path))


def axes(quaternion):
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_the_camera_moves_and_looks_as_in_the_frames(film):
    told, values = opened(film())
    times, places = track(told, values, "camera", "translation")
    assert times == pytest.approx(0.002 * (31 + 20 * np.arange(4)))
    assert places.tolist() == [[number, 2.0, 20.0] for number in range(4)]
    _, turns = track(told, values, "camera", "rotation")
    for number, turn in enumerate(turns):
        yaw = 1.2 * number
        ahead = axes(turn) @ [0, 0, -1]  # where cameras of glTF look
        assert ahead == pytest.approx([math.cos(yaw), math.sin(yaw), 0.0], abs=1e-6)
        assert axes(turn) @ [0, 1, 0] == pytest.approx([0, 0, 1], abs=1e-6)
    assert ((turns[1:] * turns[:-1]).sum(axis=1) > 0).all()  # never the long way round
    lens = told["cameras"][0]["perspective"]
    assert lens["aspectRatio"] == pytest.approx(64 / 48)
    assert math.tan(0.5 * lens["yfov"]) == pytest.approx(0.75 * math.tan(0.4))


def test_movers_are_there_while_they_are_seen(film):
    told, values = opened(film())
    _, scale = track(told, values, "bus-65545", "scale")
    assert scale[:, 0].tolist() == [0.0, 1.0, 1.0, 0.0]
    _, places = track(told, values, "target-65539", "translation")
    assert places[0] == pytest.approx([13.0, 2.0, 0.85])
    with pytest.raises(KeyError):
        track(told, values, "target-65539", "scale")


def test_a_scene_tells_how_many_frames_it_has(film, run, episode):
    assert SceneWriter(run).read(episode.folder) is None
    path = film()
    assert SceneWriter(run).read(episode.folder) == Summary(4)
    whole = path.read_bytes()
    film()
    assert path.read_bytes() == whole
    path.write_bytes(whole[:-1])
    assert SceneWriter(run).read(episode.folder) is None


def test_boxes_face_outwards_and_have_their_size():
    box = box_mesh((4.0, 2.0, 1.5), ObjectClass.CAR)
    assert np.ptp(box.positions, axis=0).tolist() == [4.0, 2.0, 1.5]
    corners = box.positions[box.triangles].astype(float)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((across * box.normals[box.triangles[:, 0]]).sum(axis=1) > 0).all()
    assert np.einsum("ij,ij->", corners[:, 0], across) / 6 == pytest.approx(4.0 * 2.0 * 1.5)
